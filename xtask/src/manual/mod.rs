//! `cargo xtask manual`: the manual as static pages in `target/manual`, from the chapters that `docs/SUMMARY.md` lists.
//! `--check` builds and checks it without writing. A link that leads nowhere and a picture from another server are errors;
//! `cargo xtask tidy` refuses a page that is not listed.

mod links;
mod page;
mod paths;
mod sources;
mod summary;
mod theme;

use crate::process::{root, target_folder};
use anyhow::{Context, Result, bail};
use links::Problem;
use page::Page;
use paths::{Files, output_path};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
pub(crate) use summary::SUMMARY;

/// Builds the manual, and writes it unless it is only to be checked.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let check = match arguments {
        [] => false,
        [word] if word == "--check" => true,
        _ => bail!("the only option is `--check`"),
    };
    let (files, chapters) = build(&root())?;
    let size: usize = files.values().map(Vec::len).sum();
    println!("{chapters} chapters, {} files, {:.1} MB", files.len(), size as f64 / 1e6);
    if check {
        return Ok(());
    }
    let folder = target_folder().join("manual");
    write(&folder, &files)?;
    println!("{}", folder.join("index.html").display());
    Ok(())
}

/// Which of these files of the repository are pages of `docs` that the list of chapters does not name.
///
/// # Errors
/// When the list is not one.
pub(crate) fn unlisted<'a>(list: &str, files: impl Iterator<Item = &'a str>) -> Result<Vec<String>> {
    let summary = summary::read(list)?;
    let is_listed = |path: &str| path == SUMMARY || summary.chapters().any(|chapter| chapter.path == path);
    let pages = files.filter(|path| path.starts_with("docs/") && path.ends_with(".md"));
    Ok(pages.filter(|path| !is_listed(path)).map(str::to_owned).collect())
}

/// Every file of the manual of the repository in `root`, and the number of chapters.
fn build(root: &Path) -> Result<(Files, usize)> {
    let text = read(root, SUMMARY)?;
    let summary = summary::read(&text)?;
    let mut problems = Vec::new();
    let mut pages = Vec::new();
    for chapter in summary.chapters() {
        pages.push(Page::read(&chapter.path, &read(root, &chapter.path)?));
    }
    let mut targets = BTreeSet::new();
    for page in &pages {
        let (found, faults) = links::check(root, page, &pages);
        targets.extend(found);
        problems.extend(faults);
    }
    report(&problems)?;
    let mut files = theme::files(&summary, &pages);
    for target in targets.iter().filter(|target| pages.iter().all(|page| page.path != **target)) {
        if paths::is_picture(target) {
            files.insert(output_path(target), fs::read(root.join(target)).with_context(|| target.clone())?);
        } else {
            files.extend(sources::files(root, target, &summary)?);
        }
    }
    Ok((files, pages.len()))
}

fn read(root: &Path, path: &str) -> Result<String> {
    fs::read_to_string(root.join(path)).with_context(|| format!("cannot read {path}"))
}

fn report(problems: &[Problem]) -> Result<()> {
    for problem in problems {
        println!("{problem}");
    }
    if problems.is_empty() { Ok(()) } else { bail!("{} faults in the manual", problems.len()) }
}

/// Replaces the folder, so that no page of an earlier manual stays.
fn write(folder: &Path, files: &Files) -> Result<()> {
    if folder.is_dir() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot replace {}", folder.display()))?;
    }
    for (path, bytes) in files {
        let path = folder.join(path);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).with_context(|| format!("cannot make {}", parent.display()))?;
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A repository of these files, in a folder of its own.
    fn planted(name: &str, files: &[(&str, &str)]) -> std::path::PathBuf {
        let root = std::env::temp_dir().join(format!("bilux-manual-{}-{name}", std::process::id()));
        let files: Files =
            files.iter().map(|(path, text)| ((*path).to_owned(), text.as_bytes().to_vec())).collect();
        write(&root, &files).expect("a folder for the test");
        root
    }

    const LIST: &str =
        "# Summary\n\n[Bilux](../README.md)\n\n# Part\n\n- [One](one.md)\n  - [Two](a/README.md)\n";

    #[test]
    fn chapters_pictures_and_sources_are_written() {
        let root = planted(
            "fine",
            &[
                ("docs/SUMMARY.md", LIST),
                ("README.md", "# Bilux\n![p](docs/p.png) [one](docs/one.md#a-b) [s](src/x.rs)\n"),
                ("docs/one.md", "# One\n## A `b`\n[two](a/README.md) [up](../README.md)\n"),
                ("docs/a/README.md", "# Two\n"),
                ("docs/p.png", "not really"),
                ("src/x.rs", "fn x() -> Vec<u8>;\n"),
            ],
        );
        let (files, chapters) = build(&root).expect("nothing is wrong with it");
        fs::remove_dir_all(&root).ok();
        assert_eq!(chapters, 3);
        let text = |path: &str| String::from_utf8_lossy(&files[path]).into_owned();
        assert!(text("index.html").contains("href=\"one.html#a-b\""), "{}", text("index.html"));
        assert!(text("index.html").contains("src=\"p.png\"") && files.contains_key("p.png"));
        assert!(text("a/index.html").contains("href=\"../manual.css\""));
        assert!(text("source/src/x.rs.html").contains("Vec&lt;u8&gt;"));
        assert!(text("search.js").contains("one.html#a-b"));
    }

    #[test]
    fn planted_faults_are_found() {
        let faulty = [
            ("README.md", "# Bilux\n[gone](docs/gone.md)\n"),
            ("README.md", "# Bilux\n[one](docs/one.md#nowhere)\n"),
            ("README.md", "# Bilux\n![p](https://example.org/p.png)\n"),
            ("README.md", "# Bilux\n\n<hr>\n"),
        ];
        for (number, (path, text)) in faulty.iter().enumerate() {
            let mut files = vec![
                ("docs/SUMMARY.md", LIST),
                ("README.md", "# Bilux\n"),
                ("docs/one.md", "# One\n"),
                ("docs/a/README.md", "# Two\n"),
            ];
            files.retain(|file| file.0 != *path);
            files.push((path, text));
            let root = planted(&format!("fault-{number}"), &files);
            let error = build(&root).err().map(|error| error.to_string());
            fs::remove_dir_all(&root).ok();
            assert_eq!(error.as_deref(), Some("1 faults in the manual"), "{path}: {text}");
        }
    }
}
