//! The arguments of `bilux farm`.

use crate::help;
use crate::values::{parse_chunks, parse_frames};
use clap::Args;
use std::path::PathBuf;

/// Split a picture or an animation into tasks for a farm
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux farm walk.toml --frames 0-47 --chunks 8 -o job           Six frames a task\n  \
    bilux farm model.glb --chunks 16 -o job -- --spp 1024          64 samples a task, and a merge\n  \
    bilux farm model.glb --chunks 4 -o job -- --spp 256 --size 1920x1080 --env sunset.hdr\n  \
    openjd run job/template.yaml --step Merge --run-dependencies   Run all of it here\n\n\
    What follows `--` are options of `bilux render`, which every task gets; those before it are for this\n\
    command alone, such as --max-memory and --strict.\n\n\
    The folder then has the files of the scene, a job template in the form of Open Job Description (OpenJD), a job \
    array for Slurm, and a README that says how to run them, or the same with GNU parallel.")]
pub struct Farm {
    /// The scene file; it and every file that it names are copied into the folder
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The folder to make
    #[arg(short, long, value_name = "DIR", help_heading = help::COMMON_OPTIONS)]
    pub output: PathBuf,
    /// The number of tasks, at most 1024
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_chunks, help_heading = help::COMMON_OPTIONS)]
    pub chunks: u32,
    /// Render frames A to B, inclusive, some in each task [default: one picture, some of its samples in each task]
    #[arg(long, value_name = "A-B", value_parser = parse_frames, help_heading = help::COMMON_OPTIONS)]
    pub frames: Option<(u32, u32)>,
    /// The name of the picture, or of the frames with `{frame}` for their number [default: the scene's name, and .png]
    #[arg(long, value_name = "NAME", help_heading = help::OUTPUT)]
    pub picture: Option<String>,
    /// Options of `bilux render`
    #[arg(last = true, value_name = "OPTIONS")]
    pub options: Vec<String>,
}
