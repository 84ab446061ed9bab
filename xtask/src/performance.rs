//! `cargo xtask performance [--only WORD] [--python PATH] [--embree PATH] [--model FILE]`: measures every figure of the
//! README and of `docs/performance.md` again, on this machine, and writes them into the pages.
//!
//! A page names a benchmark in a comment, and what it printed follows as a block of text, whose first line names the
//! machine and the day. `; only: WORD, WORD` after the command keeps the lines of the table with one of these words. Both
//! pages take their figures from here, so they cannot disagree; `cargo xtask tidy` checks that.
//! The machine has to be idle. All of it takes half an hour; `--only` measures the benchmarks whose command contains a
//! word.

use crate::process::{cargo, output, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use std::collections::HashMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// The pages with figures, relative to the root of the repository.
pub(crate) const PAGES: &[&str] = &["README.md", "docs/performance.md"];

/// Beginning of the comment that names a benchmark.
const COMMENT: &str = "<!-- figures: ";
/// Separator between the command and the words of the lines that a page wants.
const ONLY: &str = "; only: ";
const BEFORE: &str = "```text\n";
const AFTER: &str = "\n```";

/// A benchmark on a page.
pub(crate) struct Figures<'a> {
    /// The command, as a reader types it.
    pub(crate) command: &'a str,
    /// Words of which the page wants the lines; none for all lines.
    only: Option<&'a str>,
    /// Output of the command, after a line that names the machine and the day.
    pub(crate) printed: &'a str,
    /// Offset of the output on the page, in bytes.
    start: usize,
    /// The number of the comment's line, from 1.
    pub(crate) line: usize,
}

/// Programs of others that a command needs: the word in it, and what stands for the word on this machine.
struct Peers(Vec<(&'static str, String)>);

/// Measures, and rewrites the pages.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let (only, peers) = read(arguments)?;
    let features = ["build", "--locked", "--release", "-p", "bilux-cli", "--features", "peers"];
    run_process(&mut cargo(&features))?;
    let heading = format!("{}, {}", machine()?, today()?);
    let mut measured = HashMap::new();
    for page in PAGES {
        let path = root().join(page);
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read {page}"))?;
        for figures in all(&text) {
            if figures.command.contains(&only) && !measured.contains_key(figures.command) {
                println!("==> {}", figures.command);
                measured.insert(figures.command.to_owned(), measure(figures.command, &peers, &heading)?);
                // Each is kept as soon as it is there, since the next one takes minutes.
                rewrite(&measured)?;
            }
        }
    }
    if measured.is_empty() {
        bail!("no page has figures of a command that contains '{only}'");
    }
    Ok(())
}

/// Every benchmark that a page names, in order.
pub(crate) fn all(text: &str) -> Vec<Figures<'_>> {
    let places = text.match_indices(COMMENT).filter(|(at, _)| text[..*at].ends_with('\n'));
    let figures = places.filter_map(|(at, _)| {
        let (named, rest) = text[at + COMMENT.len()..].split_once(" -->\n")?;
        let (command, only) =
            named.split_once(ONLY).map_or((named, None), |(command, only)| (command, Some(only)));
        let printed = rest.strip_prefix(BEFORE)?;
        let start = text.len() - printed.len();
        let (printed, _) = printed.split_once(AFTER)?;
        Some(Figures { command, only, printed, start, line: text[..at].matches('\n').count() + 1 })
    });
    figures.collect()
}

/// Number of benchmarks that a page names, well-formed or not.
pub(crate) fn named(text: &str) -> usize {
    text.lines().filter(|line| line.starts_with(COMMENT)).count()
}

impl Figures<'_> {
    /// Lines that the page shows of all that the command printed: the first three lines are the machine, the title and the names
    /// of the columns, and the last ones are notes, which belong to the whole table only.
    pub(crate) fn shown(&self, whole: &str) -> String {
        let Some(only) = self.only else { return whole.to_owned() };
        let is_wanted =
            |line: &str| !line.starts_with('[') && only.split(", ").any(|word| line.contains(word));
        let lines = whole.lines().enumerate().filter(|(i, line)| *i < 3 || is_wanted(line));
        let lines: Vec<String> = lines.map(|(_, line)| without_mark(line)).collect();
        lines.join("\n")
    }
}

/// A line whose mark of a note, as in `[2]`, is blank.
fn without_mark(line: &str) -> String {
    let mark = line.find(" [").and_then(|start| Some((start, start + line[start..].find(']')? + 1)));
    match mark {
        Some((start, end)) if line[start + 2..end - 1].bytes().all(|byte| byte.is_ascii_digit()) => {
            format!("{}{}{}", &line[..start], " ".repeat(end - start), &line[end..])
        }
        _ => line.to_owned(),
    }
}

fn read(arguments: &[String]) -> Result<(String, Peers)> {
    let models = root().join("../shared/scenes/gltf/WaterBottle/glTF/WaterBottle.gltf");
    let mut only = String::new();
    let mut peers = Peers(vec![
        ("python3", "python3".to_owned()),
        ("libembree4.so.4", "libembree4.so.4".to_owned()),
        ("WaterBottle.gltf", models.display().to_string()),
    ]);
    for pair in arguments.chunks(2) {
        let [name, value] = pair else { bail!("{}: a value is missing", pair[0]) };
        match name.as_str() {
            "--only" => only.clone_from(value),
            "--python" => peers.0[0].1.clone_from(value),
            "--embree" => peers.0[1].1.clone_from(value),
            "--model" => peers.0[2].1.clone_from(value),
            _ => bail!(
                "the options are --only WORD, --python PATH, --embree PATH and --model FILE, not {name}"
            ),
        }
    }
    Ok((only, peers))
}

/// Runs a benchmark; returns what stands on the page.
fn measure(command: &str, peers: &Peers, heading: &str) -> Result<String> {
    let words = command.strip_prefix("bilux ").with_context(|| format!("'{command}' is not of bilux"))?;
    let words = words.split(' ').map(|word| {
        peers.0.iter().fold(word.to_owned(), |word, (name, path)| {
            if word == *name { path.clone() } else { word.replace(&format!("={name}"), &format!("={path}")) }
        })
    });
    let printed = output(Command::new(program()).args(words).arg("--quiet").current_dir(root()))?;
    let lines: Vec<&str> = printed.trim_end().lines().map(str::trim_end).collect();
    Ok(format!("{heading}\n{}", lines.join("\n")))
}

fn program() -> PathBuf {
    target_folder().join("release").join(format!("bilux{}", std::env::consts::EXE_SUFFIX))
}

/// Writes what was measured into all pages.
fn rewrite(measured: &HashMap<String, String>) -> Result<()> {
    for page in PAGES {
        let path = root().join(page);
        let mut text = fs::read_to_string(&path).with_context(|| format!("cannot read {page}"))?;
        replace(&mut text, measured);
        fs::write(&path, text).with_context(|| format!("cannot write {page}"))?;
    }
    Ok(())
}

fn replace(text: &mut String, measured: &HashMap<String, String>) {
    let old = all(text).into_iter().map(|figures| {
        (
            figures.start..figures.start + figures.printed.len(),
            measured.get(figures.command).map(|whole| figures.shown(whole)),
        )
    });
    // From the last to the first, so that earlier places stay where they are.
    let old: Vec<_> = old.collect();
    for (range, new) in old.into_iter().rev() {
        if let Some(new) = new {
            text.replace_range(range, &new);
        }
    }
}

/// The processor, its vector instructions and its cores, in words.
fn machine() -> Result<String> {
    let cores = std::thread::available_parallelism()?;
    let Ok(about) = fs::read_to_string("/proc/cpuinfo") else {
        return Ok(format!("{}, {cores} cores", std::env::consts::ARCH));
    };
    let value = |key: &str| {
        let line = about.lines().find(|line| line.split(':').next().is_some_and(|name| name.trim() == key));
        line.and_then(|line| line.split_once(':')).map_or("", |(_, value)| value.trim())
    };
    let level =
        ["avx512f", "avx2"].into_iter().find(|level| value("flags").split(' ').any(|flag| flag == *level));
    let vectors = match level {
        Some("avx512f") => "AVX-512",
        Some(_) => "AVX2",
        None => "no AVX2",
    };
    let [name, family, model] = ["model name", "cpu family", "model"].map(value);
    Ok(format!("{name} (family {family}, model {model}, {vectors}), {cores} cores"))
}

fn today() -> Result<String> {
    Ok(output(Command::new("date").arg("+%F"))?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "Words\n\n<!-- figures: bilux bench rays -->\n```text\na CPU, 2026-01-01\n1 2\n```\n\n\
                        <!-- figures: bilux bench load -->\n```text\nold\n```\nend\n";

    #[test]
    fn figures_are_found_and_replaced() {
        let found: Vec<_> =
            all(PAGE).iter().map(|figures| (figures.command, figures.printed, figures.line)).collect();
        assert_eq!(
            found,
            [("bilux bench rays", "a CPU, 2026-01-01\n1 2", 3), ("bilux bench load", "old", 9)]
        );
        assert_eq!(named(PAGE), 2);
        let mut text = PAGE.to_owned();
        replace(&mut text, &HashMap::from([("bilux bench load".to_owned(), "new\n3".to_owned())]));
        assert_eq!(text, PAGE.replace("old", "new\n3"));
        assert!(all("<!-- figures: bilux bench rays -->\nno block\n").is_empty());
    }

    #[test]
    fn a_page_can_show_some_lines() {
        let page = "# Page\n<!-- figures: bilux bench speed; only: box, room -->\n```text\n\n```\n";
        let whole =
            "a CPU, 2026-01-01\nSpeed\n  what  ours\nthe box [1]  1\na pot  2\nthe room  3\n[1] of the box";
        let found = all(page);
        assert_eq!(
            found[0].shown(whole),
            "a CPU, 2026-01-01\nSpeed\n  what  ours\nthe box      1\nthe room  3"
        );
    }
}
