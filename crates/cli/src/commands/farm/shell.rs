//! The job as a job array for Slurm, and its commands in a shell.

use super::farm_job::{FarmJob, Word};
use super::split::Split;

/// The program, where the environment may name another.
pub(super) const PROGRAM: &str = "\"${BILUX:-bilux}\"";

/// The script of a job array: a task renders the range of its number.
pub(super) fn array(job: &FarmJob) -> String {
    let ranges = job.split.ranges();
    let last = ranges.len() - 1;
    let command = render(job, "$1");
    format!(
        "#!/bin/sh\n#SBATCH --array=0-{last}\n#SBATCH --nodes=1 --exclusive\n\
         # A task of the array renders the range of its number. Submit it from the folder that it is in.\n\
         set -- {}\nshift \"$SLURM_ARRAY_TASK_ID\"\nexec {PROGRAM} {command}\n",
        ranges.join(" ")
    )
}

/// The words of a task's command after the program, for a shell; `range` needs no more quotes than `$1`.
pub(super) fn render(job: &FarmJob, range: &str) -> String {
    let output = match job.split {
        Split::Frames(_) => quoted(&format!("pictures/{}", job.picture)),
        Split::Samples(_) => format!("\"parts/{range}.exr\""),
    };
    let words = job.render(&output, &format!("\"{range}\""), |word| match word {
        Word::Text(text) => quoted(text),
        Word::File(before, name) => quoted(&format!("{before}files/{name}")),
    });
    words.join(" ")
}

/// The words of the merge after the program.
pub(super) fn merge(job: &FarmJob) -> String {
    format!("merge {} -o {}", job.parts("parts").join(" "), quoted(&format!("pictures/{}", job.picture)))
}

/// A word for a POSIX shell.
fn quoted(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+%@".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(quoted("a-b/c.toml"), "a-b/c.toml");
        assert_eq!(quoted("it's {frame} $HOME"), "'it'\\''s {frame} $HOME'");
        assert_eq!(quoted(""), "''");
    }
}
