//! The job's README: how to run it with OpenJD, Slurm, or GNU parallel.

use super::farm_job::FarmJob;
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
        "# {}\n\nThis folder was written by `bilux farm`. It is self-contained: put it where every node can read and write \
         it.\nEach node needs the same version of `bilux` on its `PATH`, or the program's path in the variable `BILUX`. Run \
         these commands in\nthis folder.\n{}\n\
         ## OpenJD\nSubmit `template.yaml` to the farm. To check it, and to run the whole job on this machine:\n\n\
         ```sh\nopenjd check template.yaml\nopenjd run template.yaml {steps} -p Bilux=\"$(command -v \"${{BILUX:-bilux}}\")\"\n```\n\n\
         ## Slurm\n```sh\n{slurm}```\n\n\
         ## GNU parallel\nThis runs one task at a time, on all cores. `--sshlogin node1,node2 --workdir \"$PWD\"` distributes \
         them over nodes.\n\n\
         ```sh\nparallel -j1 -q {PROGRAM} {command} ::: \\\n  {}{parallel}\n```\n\n\
         A task writes its file completely or not at all, and a repeated task writes the same bytes. So you can run a failed or \
         slow task\nagain, even while the first attempt is running.\n",
        job.name,
        match job.split {
            Split::Frames(_) =>
                "The frames go to `pictures`, with the same bytes as a render on one machine.\n",
            Split::Samples(_) =>
                "Each task writes some of the picture's samples to `parts`. The merge step writes the picture to \
                 `pictures`, with the\nsame bytes as a render on one machine.\n",
        },
        ranges.join(" ")
    )
}
