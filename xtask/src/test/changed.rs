//! Changes since a commit, asked of git: in commits, in the working tree, and in files that git does not know.

use super::reach::Reached;
use crate::misuse::Misuse;
use crate::process::root;
use crate::workspace;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Command;

/// Branches that a branch may have left, the likeliest first.
const ORIGINS: &[&str] = &["@{upstream}", "origin/HEAD", "main", "master"];

/// Steps and packages that the changes since a commit reach; if none is named, since this branch left [the one it is of](ORIGINS).
pub(super) fn reached(base: Option<&str>) -> Result<Reached> {
    let (base, changes) = changes(&root(), base)?;
    Ok(Reached::by(&base, &changes, &workspace::packages()?))
}

/// The commit, shortened, and the files that differ from it, relative to the folder.
fn changes(folder: &Path, base: Option<&str>) -> Result<(String, Vec<String>)> {
    let git = |arguments: &[&str]| git(folder, arguments);
    if git(&["rev-parse", "--is-inside-work-tree"]).is_none() {
        bail!(Misuse(
            "`--changed` needs git and a checkout: without them, run all of `cargo xtask test`".to_owned()
        ));
    }
    let found = match base {
        Some(name) => git(&["rev-parse", "--verify", "--quiet", &format!("{name}^{{commit}}")]),
        None => ORIGINS.iter().find_map(|origin| git(&["merge-base", "HEAD", origin])),
    };
    let Some(base) = found else {
        let what = base.map_or_else(
            || format!("there is no branch that this one has left ({})", ORIGINS.join(", ")),
            |name| format!("git knows no commit '{name}'"),
        );
        bail!(Misuse(format!("{what}: name one, as in `cargo xtask test --changed HEAD^`")));
    };
    let base = base.trim();
    let differing = git(&["diff", "--name-only", "--no-renames", "--relative", "-z", base]);
    let unknown = git(&["ls-files", "--others", "--exclude-standard", "-z"]);
    let (Some(differing), Some(unknown)) = (differing, unknown) else {
        bail!("git does not say what has changed")
    };
    let mut files: Vec<String> = differing
        .split('\0')
        .chain(unknown.split('\0'))
        .filter(|file| !file.is_empty())
        .map(str::to_owned)
        .collect();
    files.sort();
    Ok((base.chars().take(12).collect(), files))
}

/// Answer of git, if there is one.
fn git(folder: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).current_dir(folder).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn done(folder: &Path, line: &str) {
        let who = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"];
        let words: Vec<&str> = who.into_iter().chain(line.split(' ')).collect();
        assert!(git(folder, &words).is_some(), "{line}");
    }

    fn misuse(folder: &Path, base: Option<&str>) -> String {
        let error = changes(folder, base).unwrap_err();
        assert!(error.is::<Misuse>(), "{error:#}");
        error.to_string()
    }

    #[test]
    fn commits_and_files_that_are_in_none_count() {
        // Outside every checkout.
        let folder = std::env::temp_dir().join(format!("bilux-changed-{}", std::process::id()));
        fs::create_dir_all(folder.join("sub")).unwrap();
        assert!(misuse(&folder, None).starts_with("`--changed` needs git and a checkout"));
        done(&folder, "init --quiet --initial-branch=main");
        let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
        write("a", "1");
        write("b", "1");
        write(".gitignore", "ignored\n");
        done(&folder, "add .");
        done(&folder, "commit --quiet -m one");
        done(&folder, "checkout --quiet -b work");
        write("sub/c d", "1");
        done(&folder, "add .");
        done(&folder, "commit --quiet -m two");
        write("b", "2");
        write("new", "1");
        write("ignored", "1");
        let files = |base| changes(&folder, base).unwrap().1;
        assert_eq!(files(None), ["b", "new", "sub/c d"]);
        assert_eq!(files(Some("HEAD")), ["b", "new"]);
        assert_eq!(misuse(&folder, Some("nowhere")).split(':').next(), Some("git knows no commit 'nowhere'"));
        done(&folder, "branch --quiet -D main");
        assert!(misuse(&folder, None).starts_with("there is no branch that this one has left"));
        fs::remove_dir_all(&folder).unwrap();
    }
}
