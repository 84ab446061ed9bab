//! `cargo xtask mutants [--since COMMIT] [-- MORE]`: plants small bugs with the tool cargo-mutants in the lines that
//! have changed since a commit, and reports which of them no test noticed. With `--turn [NUMBER]` the lines are those of one part of
//! the sources, whether they have changed or not: each day has its part ([`part_of`]), and after as many days all have had their turn.

use crate::process::{cargo, output, root, target_folder};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::SystemTime;

/// The folder of each crate, and the packages whose tests cover it: the consequences of one crate's mathematics are
/// mostly tested in the crates above it.
const SUITES: &[(&str, &[&str])] = &[
    ("math", &["bilux-math", "bilux-accel", "bilux-pictures", "bilux-scene", "bilux-transport"]),
    ("accel", &["bilux-accel"]),
    ("visibility", &["bilux-visibility"]),
    ("scene", &["bilux-scene", "bilux-transport", "bilux-validation"]),
    ("gallery", &["bilux-gallery", "bilux-formats"]),
    ("transport", &["bilux-transport", "bilux-validation"]),
    ("import", &["bilux-import", "bilux-formats"]),
    ("meshes", &["bilux-meshes", "bilux-formats"]),
    ("gltf", &["bilux-gltf", "bilux-formats"]),
    ("usd", &["bilux-usd", "bilux-formats"]),
    ("dcc", &["bilux-dcc", "bilux-formats"]),
    ("renderers", &["bilux-renderers", "bilux-formats"]),
    ("step", &["bilux-step", "bilux-formats"]),
    ("formats", &["bilux-formats", "bilux-validation"]),
    ("pictures", &["bilux-pictures", "bilux"]),
    ("bilux", &["bilux", "bilux-cli"]),
    ("bench", &["bilux-bench"]),
    ("cli", &["bilux-cli"]),
    ("validation", &["bilux-validation"]),
    ("testing", &["bilux-testing"]),
    ("viewer", &["bilux-viewer"]),
];

/// Seconds: a mutant that loops is stopped after this time, and no test takes as long by itself.
const MIN_TIMEOUT: &str = "120";

/// Lines of code that are one turn's: a few dozen bugs, each of which costs a build and the tests of a few crates.
const LINES: usize = 1000;

/// The arguments of the chore.
#[derive(Debug, PartialEq)]
struct Arguments<'a> {
    lines: Lines<'a>,
    /// Further arguments for cargo-mutants itself.
    more: &'a [String],
}

/// Lines in which bugs are planted.
#[derive(Debug, PartialEq)]
enum Lines<'a> {
    /// In what has changed since this commit.
    Since(&'a str),
    /// In the part of the sources whose turn it is.
    OfTurn(usize),
}

/// A part of the sources.
#[derive(Debug, PartialEq)]
struct Part {
    /// The place of its crate in the table.
    row: usize,
    /// Number among the parts of the crate, from 0.
    number: usize,
    /// Number of parts of the crate.
    of: usize,
}

/// Runs the tool once for each crate, since each crate has its own test suites.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let Arguments { lines, more } = read(arguments)?;
    if !is_installed() {
        bail!("cargo-mutants is not installed: `cargo install --locked cargo-mutants` installs it");
    }
    let folder = target_folder().join("mutants");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    match lines {
        Lines::Since(commit) => report(&in_changes(commit, &folder, more)?),
        Lines::OfTurn(turn) => report(&in_part(turn, &folder, more)?),
    }
}

/// The bugs that no test noticed in the part whose turn it is.
fn in_part(turn: usize, folder: &Path, more: &[String]) -> Result<Vec<String>> {
    let sizes = SUITES.iter().map(|(name, _)| lines_of(&root().join("crates").join(name).join("src")));
    let Part { row, number, of } = part_of(turn, &sizes.collect::<Result<Vec<_>>>()?);
    let (name, suites) = SUITES[row];
    println!(
        "==> part {} of {of} of crates/{name}, held against the tests of {}",
        number + 1,
        suites.join(", ")
    );
    let out = folder.join(format!("{name}-{number}"));
    plant(name, suites, &["--shard".to_owned(), format!("{number}/{of}")], &out, more)?;
    listed(&out.join("mutants.out/missed.txt"))
}

/// The part of a turn, where each crate has so many lines: the crates in order, each in as many parts as its size asks for.
fn part_of(turn: usize, sizes: &[usize]) -> Part {
    let parts = |row: usize| sizes[row].div_ceil(LINES).max(1);
    let all: usize = (0..sizes.len()).map(parts).sum();
    let mut number = turn % all.max(1);
    let mut row = 0;
    while number >= parts(row) {
        number -= parts(row);
        row += 1;
    }
    Part { row, number, of: parts(row) }
}

/// The number of lines of the Rust files in a folder.
fn lines_of(folder: &Path) -> Result<usize> {
    let mut sum = 0;
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            sum += lines_of(&path)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            sum += fs::read_to_string(&path)?.lines().count();
        }
    }
    Ok(sum)
}

/// The bugs that no test noticed in what has changed since a commit.
fn in_changes(since: &str, folder: &Path, more: &[String]) -> Result<Vec<String>> {
    let mut survivors = Vec::new();
    for (name, suites) in SUITES {
        let sources = format!("crates/{name}/src");
        let changes = output(Command::new("git").args(["diff", since, "--", &sources]).current_dir(root()))?;
        if changes.is_empty() {
            continue;
        }
        println!("==> {sources}: changes since {since}, held against the tests of {}", suites.join(", "));
        let (diff, out) = (folder.join(format!("{name}.diff")), folder.join(name));
        fs::write(&diff, changes).with_context(|| format!("cannot write {}", diff.display()))?;
        plant(name, suites, &["--in-diff".to_owned(), diff.display().to_string()], &out, more)?;
        survivors.extend(listed(&out.join("mutants.out/missed.txt"))?);
    }
    Ok(survivors)
}

fn read(arguments: &[String]) -> Result<Arguments<'_>> {
    let (own, more) = match arguments.iter().position(|argument| argument == "--") {
        Some(end) => (&arguments[..end], &arguments[end + 1..]),
        None => (arguments, &[][..]),
    };
    let words: Vec<&str> = own.iter().map(String::as_str).collect();
    let lines = match words.as_slice() {
        [] => Some(Lines::Since("HEAD^")),
        ["--since", commit] if !commit.starts_with('-') => Some(Lines::Since(commit)),
        ["--turn"] => Some(Lines::OfTurn(today())),
        ["--turn", number] => number.parse().ok().map(Lines::OfTurn),
        _ => None,
    };
    let usage =
        "usage: cargo xtask mutants [--since COMMIT | --turn [NUMBER]] [-- ARGUMENTS OF CARGO-MUTANTS]";
    Ok(Arguments { lines: lines.context(usage)?, more })
}

/// The number of the day, which is the turn if none is named.
fn today() -> usize {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    (since.as_secs() / 86_400) as usize
}

fn is_installed() -> bool {
    let mut version = cargo(&["mutants", "--version"]);
    version.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

/// Plants bugs in one crate. Surviving bugs are not a failure of the tool.
fn plant(name: &str, suites: &[&str], lines: &[String], out: &Path, more: &[String]) -> Result<()> {
    let mut command = cargo(&["mutants"]);
    command.args(lines).arg("--output").arg(out);
    command.args(["--package", &package_in(name), "--test-package", &suites.join(",")]);
    command.args(["--minimum-test-timeout", MIN_TIMEOUT, "--timeout-multiplier", "3"]).args(more);
    let status = command.status().context("cannot start cargo-mutants")?;
    // Exit status 2: some bugs survived; 3: some ran out of time, which counts as noticed.
    match status.code() {
        Some(0 | 2 | 3) => Ok(()),
        _ => bail!("cargo-mutants failed ({status})"),
    }
}

/// The package whose folder is `crates/NAME`.
fn package_in(name: &str) -> String {
    if name == "bilux" { name.to_owned() } else { format!("bilux-{name}") }
}

/// The lines of a file; none if there is no such file, for example because nothing that has changed can be mutated.
fn listed(path: &Path) -> Result<Vec<String>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(text.lines().map(str::to_owned).collect())
}

fn report(survivors: &[String]) -> Result<()> {
    if survivors.is_empty() {
        println!("\nno planted bug survived");
        return Ok(());
    }
    println!("\nno test noticed:");
    survivors.iter().for_each(|survivor| println!("  {survivor}"));
    bail!("{} planted bugs survived: write a test for each, or say why none is needed", survivors.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn arguments_after_two_dashes_are_passed_on() {
        assert_eq!(read(&[]).unwrap(), Arguments { lines: Lines::Since("HEAD^"), more: &[] });
        let given = words("--since main -- --in-place -j 2");
        let more = words("--in-place -j 2");
        assert_eq!(read(&given).unwrap(), Arguments { lines: Lines::Since("main"), more: &more });
        assert_eq!(read(&words("--turn 7")).unwrap().lines, Lines::OfTurn(7));
        assert!(matches!(read(&words("--turn -- -j 2")).unwrap().lines, Lines::OfTurn(20_000..)));
        for wrong in
            ["--since", "main", "--since -- -j 2", "--sinc main", "--turn x", "--turn 1 --since main"]
        {
            let message = read(&words(wrong)).unwrap_err().to_string();
            assert!(message.starts_with("usage: cargo xtask mutants"), "{wrong}: {message}");
        }
    }

    #[test]
    fn every_part_of_every_crate_has_its_turn() {
        let sizes = [LINES * 5 / 2, 0, LINES];
        let found: Vec<_> = (0..6).map(|turn| part_of(turn, &sizes)).collect();
        let part = |row, number, of| Part { row, number, of };
        let wanted =
            [part(0, 0, 3), part(0, 1, 3), part(0, 2, 3), part(1, 0, 1), part(2, 0, 1), part(0, 0, 3)];
        assert_eq!(found, wanted);
        assert!(lines_of(&root().join("xtask/src")).unwrap() > 5000);
    }

    #[test]
    fn every_crate_has_its_suites() {
        let mut folders: Vec<String> = fs::read_dir(root().join("crates"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            // Its tests are in Python, and the tool runs those of cargo.
            .filter(|name| name != "python")
            .collect();
        let mut known: Vec<&str> = SUITES.iter().map(|(name, _)| *name).collect();
        folders.sort();
        known.sort_unstable();
        assert_eq!(folders, known);
        for (name, suites) in SUITES {
            assert!(suites.contains(&&*package_in(name)), "the tests of {name} itself");
        }
    }

    #[test]
    fn surviving_mutants_fail_the_chore() {
        assert!(report(&[]).is_ok());
        let error = report(&words("a.rs:1:replace b.rs:2:replace")).unwrap_err().to_string();
        assert!(error.starts_with("2 planted bugs survived"), "{error}");
        assert_eq!(listed(Path::new("there/is/none")).unwrap(), Vec::<String>::new());
    }
}
