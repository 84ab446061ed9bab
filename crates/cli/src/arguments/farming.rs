//! The arguments of `bilux farm`.

use crate::arguments::help;
use crate::arguments::values::{parse_chunks, parse_frames, parse_turntable};
use clap::Args;
use std::path::PathBuf;

/// Split a picture or an animation into tasks for a farm
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux farm walk.toml --frames 0-47 --chunks 8 -o job           Six frames per task\n  \
    bilux farm model.glb --turntable 36 --chunks 6 -o job          Six pictures of a turn per task\n  \
    bilux farm model.glb --chunks 16 -o job -- --spp 1024          64 samples per task, then merge\n  \
    bilux farm model.glb --chunks 4 -o job -- --spp 256 --size 1920x1080 --env sunset.hdr\n  \
    openjd run job/template.yaml --step Merge --run-dependencies   Run the whole job here\n\n\
    Every task passes the options after `--` to `bilux render`; options before it, such as --max-memory and \
    --strict, are for this command only.\n\n\
    The folder contains the scene's files, an Open Job Description (OpenJD) template, a Slurm job array, and a README \
    that explains how to run the job with either of them or with GNU parallel.")]
pub struct Farm {
    /// The scene file; it is copied into the folder with every file that it refers to
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The folder to create
    #[arg(short, long, value_name = "DIR", help_heading = help::COMMON_OPTIONS)]
    pub output: PathBuf,
    /// The number of tasks, at most 1024
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_chunks, help_heading = help::COMMON_OPTIONS)]
    pub chunks: u32,
    /// Render frames A to B, inclusive, divided among the tasks [default: one picture, whose samples are divided]
    #[arg(long, value_name = "A-B", value_parser = parse_frames, help_heading = help::COMMON_OPTIONS)]
    pub frames: Option<(u32, u32)>,
    /// Render N pictures from all around the model, divided among the tasks
    #[arg(long, value_name = "N", allow_hyphen_values = true, conflicts_with = "frames", value_parser = parse_turntable, help_heading = help::COMMON_OPTIONS)]
    pub turntable: Option<u32>,
    /// The name of the picture, or of the frames, where `{frame}` is their number [default: the scene's name and .png]
    #[arg(long, value_name = "NAME", help_heading = help::OUTPUT)]
    pub picture: Option<String>,
    /// Options of `bilux render`
    #[arg(last = true, value_name = "OPTIONS")]
    pub options: Vec<String>,
}
