//! Records in the binary which commit it was built from, and leaves the names of functions out of it.

use std::path::Path;
use std::process::Command;

fn main() {
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "no commit".to_owned());
    println!("cargo::rustc-env=BILUX_COMMIT={commit}");
    // In a worktree, `.git` is a file that says where this is; a file that is not there would count as changed each time.
    if let Some(head) = git(&["rev-parse", "--git-path", "HEAD"]).filter(|head| Path::new(head).exists()) {
        println!("cargo::rerun-if-changed={head}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    // Names of functions are a quarter of the file. (Cargo forgets `strip` where a package has settings of its own.)
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|found| found == value);
    if is("PROFILE", "release") && is("CARGO_CFG_TARGET_OS", "linux") {
        println!("cargo::rustc-link-arg-bins=-Wl,--strip-all");
    }
}

/// Answer of git, if it is there and this is a repository.
fn git(question: &[&str]) -> Option<String> {
    let output = Command::new("git").args(question).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
