//! The scenes of pages: the files that a page tells its readers to write, so that its pictures show just these.

use crate::process::{root, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Writes the files of a page, from the root of the repository, into a folder of its own, and generates its models.
/// Returns that folder.
pub(super) fn prepare(page: &str, scenes: &Path, bilux: &Path) -> Result<PathBuf> {
    let markdown = fs::read_to_string(root().join(page)).with_context(|| format!("cannot read {page}"))?;
    let folder = scenes.join(Path::new(page).file_stem().context("a page has a name")?);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for (name, text) in files(&markdown) {
        fs::write(folder.join(name), text)?;
    }
    for command in commands(&markdown) {
        let arguments = command.split_whitespace().skip(1);
        run(Command::new(bilux).args(arguments).args(["--progress", "none"]).current_dir(&folder))?;
    }
    Ok(folder)
}

/// The files of a page: the names in comments such as `<!-- test: save as a.toml -->`, and the blocks after them.
pub(super) fn files(markdown: &str) -> Vec<(&str, String)> {
    let mut files = Vec::new();
    let mut lines = markdown.lines();
    while let Some(line) = lines.next() {
        let name = line.strip_prefix("<!-- test: save as ").and_then(|rest| rest.strip_suffix(" -->"));
        if let Some(name) = name {
            let block = lines.by_ref().skip(1).take_while(|line| *line != "```");
            files.push((name, block.map(|line| format!("{line}\n")).collect()));
        }
    }
    files
}

/// The commands of a page whose results other commands read: those that generate models, or render environment maps.
pub(super) fn commands(markdown: &str) -> Vec<&str> {
    let is_source = |line: &&str| {
        line.starts_with("bilux generate ")
            || line.starts_with("bilux render ") && line.contains(".hdr --size")
    };
    markdown.lines().filter(is_source).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_commands_are_found() {
        let page = "# A\n<!-- test: save as a.toml -->\n```toml\nx = 1\n\ny = 2\n```\n```sh\nbilux generate teapot -o pot.obj\n\
            bilux render a.toml -o a.hdr --size 8x4\nbilux render a.toml -o a.png\n```\n";
        assert_eq!(files(page), [("a.toml", "x = 1\n\ny = 2\n".to_owned())]);
        let expected = ["bilux generate teapot -o pot.obj", "bilux render a.toml -o a.hdr --size 8x4"];
        assert_eq!(commands(page), expected);
    }
}
