//! Runs other programs from the root of the repository.

use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::time::Duration;

/// The root of the repository that this program was built from.
pub(crate) fn root() -> PathBuf {
    let manifest = std::env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    manifest.parent().map_or(manifest.clone(), PathBuf::from)
}

/// The folder where cargo builds.
pub(crate) fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// A command for the cargo that runs us, in the root of the repository.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root());
    if *IS_FRESH && std::env::var_os("CARGO_INCREMENTAL").is_none() {
        command.env("CARGO_INCREMENTAL", "0");
    }
    command
}

/// Whether nobody has developed here yet. Code that can be compiled in increments takes longer to compile, which is wasted
/// where all is compiled once; but whoever develops keeps their increments.
pub(crate) static IS_FRESH: LazyLock<bool> = LazyLock::new(|| {
    let increments = std::fs::read_dir(target_folder().join("debug/incremental"));
    let mut folders = increments.into_iter().flatten().flatten();
    !folders.any(|folder| is_of_a_developer(&folder.file_name().to_string_lossy()))
});

/// Whether increments are of a crate that this program is not built from: its own are there in any case.
fn is_of_a_developer(folder: &str) -> bool {
    folder.starts_with("bilux") && !folder.starts_with("bilux_testing-")
}

/// The time that this process and its children that have ended spent on all cores, on Linux.
pub(crate) fn cpu_time() -> Option<Duration> {
    cpu_time_of(std::process::id())
}

/// The time that a process and those of its children that it has waited for spent on all cores, on Linux. A process that has
/// ended still has it until it is waited for.
pub(crate) fn cpu_time_of(process: u32) -> Option<Duration> {
    // In hundredths of a second, after a name in parentheses: user and system time, and those of the children.
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let fields: Vec<_> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = fields.get(11..15)?.iter().map(|field| field.parse::<u64>().ok()).sum::<Option<u64>>()?;
    Some(Duration::from_millis(10 * ticks))
}

/// Runs a program to its end; its output goes straight to the user.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot start {}", spoken(command)))?;
    if !status.success() {
        bail!("{} failed ({status})", spoken(command));
    }
    Ok(())
}

/// Runs a program, passes its standard output on, and hands each line of it to `watch`. Returns whether the program
/// succeeded.
pub(crate) fn run_watched(command: &mut Command, mut watch: impl FnMut(&str)) -> Result<bool> {
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {}", spoken(command)))?;
    let stdout = child.stdout.take().context("the child has no standard output")?;
    let mut line = Vec::new();
    let mut reader = BufReader::new(stdout);
    while reader.read_until(b'\n', &mut line)? > 0 {
        std::io::stdout().write_all(&line)?;
        watch(String::from_utf8_lossy(&line).trim_end());
        line.clear();
    }
    Ok(child.wait()?.success())
}

/// Whether a process that was started here has ended; its number and its CPU time remain until it is waited for. Where the
/// system does not tell, it may have.
pub(crate) fn has_ended(process: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat"));
    stat.map_or(true, |stat| stat.rsplit_once(") ").is_none_or(|(_, rest)| rest.starts_with('Z')))
}

/// A command as a user would type it.
fn spoken(command: &Command) -> String {
    let program = PathBuf::from(command.get_program());
    let mut words = vec![program.file_name().unwrap_or_default().to_string_lossy().into_owned()];
    words.extend(command.get_args().map(|word| word.to_string_lossy().into_owned()));
    format!("`{}`", words.join(" "))
}
/// Runs a program and returns what it writes to standard output.
pub(crate) fn output(command: &mut Command) -> Result<String> {
    let output = command.stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("cannot start {}", spoken(command)))?;
    if !output.status.success() {
        bail!("{} failed ({})", spoken(command), output.status);
    }
    String::from_utf8(output.stdout).with_context(|| format!("{} wrote no UTF-8", spoken(command)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn increments_of_this_program_are_nobodys_work() {
        assert!(is_of_a_developer("bilux_scene-0abc") && is_of_a_developer("bilux-0abc"));
        assert!(!is_of_a_developer("xtask-0abc") && !is_of_a_developer("bilux_testing-0abc"));
        // Those crates are what the manifest names.
        let manifest = std::fs::read_to_string(root().join("xtask/Cargo.toml")).unwrap();
        let own: Vec<_> = manifest.lines().filter(|line| line.starts_with("bilux")).collect();
        assert_eq!(own, ["bilux-testing.workspace = true"]);
    }
}
