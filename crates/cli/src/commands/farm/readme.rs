//! The job's README: how to run it with a farm that knows OpenJD, with Slurm, and with GNU parallel.

use super::FarmJob;
use super::shell::{PROGRAM, merge, render};
use super::split::Split;

/// The text.
pub(super) fn of(job: &FarmJob) -> String {
    let ranges = job.split.ranges();
    let command = render(job, "{}");
    let (steps, joined) = match job.split {
        Split::Frames(_) => ("--step Render", String::new()),
        Split::Samples(_) => ("--step Merge --run-dependencies", merge(job)),
    };
    let (slurm, parallel) = match job.split {
        Split::Frames(_) => ("sbatch slurm.sh\n".to_owned(), String::new()),
        Split::Samples(_) => (
            format!(
                "array=$(sbatch --parsable slurm.sh)\nsbatch --dependency=afterok:\"$array\" --wrap='{PROGRAM} {}'\n",
                joined.replace('\'', "'\\''")
            ),
            format!(" && \\\n  {PROGRAM} {joined}"),
        ),
    };
    format!(
        "# {}\n\nThis folder was written by `bilux farm`. It is complete: put it where every node can read and write it, \
         with the\nprogram `bilux` of the same version on each node's `PATH`, or its path in the variable `BILUX`. Run the \
         commands here.\n{}\n\
         ## A farm that knows OpenJD\nSubmit `template.yaml`. To check it, and to run all of it on this machine:\n\n\
         ```sh\nopenjd check template.yaml\nopenjd run template.yaml {steps} -p Bilux=\"$(command -v \"${{BILUX:-bilux}}\")\"\n```\n\n\
         ## Slurm\n```sh\n{slurm}```\n\n\
         ## GNU parallel\nThis runs one task at a time, on all cores. `--sshlogin node1,node2 --workdir \"$PWD\"` spreads \
         them over nodes.\n\n\
         ```sh\nparallel -j1 -q {PROGRAM} {command} ::: \\\n  {}{parallel}\n```\n\n\
         A task that is repeated writes the same file again, and a file is complete or not there at all. So a task that has \
         failed,\nor was too slow, can be given out once more.\n",
        job.name,
        match job.split {
            Split::Frames(_) => "The frames go to `pictures`, with the bytes that one machine would write.\n",
            Split::Samples(_) =>
                "Each task writes a part of the picture's samples to `parts`; merged, they are the picture that one \
                 machine would\nrender, to the byte. It goes to `pictures`.\n",
        },
        ranges.join(" ")
    )
}
