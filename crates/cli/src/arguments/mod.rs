//! The command line. Help, shell completions and man pages are all generated from this one description.

pub(crate) mod assignments;
pub(crate) mod choices;
pub(crate) mod comparison;
pub(crate) mod converting;
pub(crate) mod denoising;
pub(crate) mod explaining;
pub(crate) mod farming;
pub(crate) mod help;
pub(crate) mod lasting;
pub(crate) mod measuring;
pub(crate) mod rendering;
pub(crate) mod sensing;
pub(crate) mod serving;
pub(crate) mod settings_from;
pub(crate) mod streams;
pub(crate) mod studio;
pub(crate) mod tables;
pub(crate) mod values;
pub(crate) mod version;
pub(crate) mod working;

use crate::arguments::choices::Posed;
pub use crate::arguments::measuring::Bench;
use crate::arguments::serving::Serve;
use crate::arguments::values::{parse_bytes, parse_count, parse_vector};
pub use crate::arguments::{
    comparison::Compare, converting::Convert, denoising::Denoise, explaining::Explain, farming::Farm,
    rendering::Render, sensing::Sensor, working::Worker,
};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Render physically based pictures of 3D scenes on the CPU
#[derive(Parser)]
#[command(name = "bilux", about = "Render physically based pictures of 3D scenes on the CPU", long_about = None, version = crate::arguments::version::text(), max_term_width = 100)]
#[command(help_template = help::TEMPLATE, disable_help_flag = true, disable_version_flag = true)]
#[command(after_help = "Examples:\n  \
    bilux generate trio -o trio.toml             Write a built-in scene to a file\n  \
    bilux render trio.toml -o trio.png           Render it\n  \
    bilux render model.glb -o model.png          Render a model in a photo studio\n  \
    bilux render model.glb -o model.jpg --env sunset.hdr --ground shadow\n  \
    bilux serve model.glb                        Watch it in the browser\n  \
    bilux info model.glb                         Show what is in a file\n  \
    bilux list integrators                       List what --integrator can name\n  \
    bilux render --help                          Describe the options of a command")]
pub struct Arguments {
    #[command(flatten)]
    pub common: Common,
    /// Print the version, the commit, the CPU level in use and whether the kernel enforces --sandbox
    #[arg(short = 'V', long, action = clap::ArgAction::Version, display_order = help::LAST + 4, help_heading = help::OUTPUT)]
    version: Option<bool>,
    #[command(subcommand)]
    pub command: Command,
}

/// The options of every command.
#[derive(Args)]
pub struct Common {
    /// Print only errors
    #[arg(short, long, global = true, display_order = help::LAST, help_heading = help::OUTPUT)]
    pub quiet: bool,
    /// Print more detail, such as what `auto` chose and why, and notes on the scene file
    #[arg(short, long, global = true, action = clap::ArgAction::Count, display_order = help::LAST + 1, help_heading = help::OUTPUT)]
    pub verbose: u8,
    /// Show progress as a bar or as lines [default: a bar on a terminal, lines elsewhere]
    #[arg(long, global = true, value_enum, default_value = "auto", hide_default_value = true, value_name = "HOW", display_order = help::LAST + 2, help_heading = help::OUTPUT)]
    pub progress: ProgressStyle,
    /// Print this help
    #[arg(short, long, global = true, action = clap::ArgAction::Help, display_order = help::LAST + 3, help_heading = help::OUTPUT)]
    help: Option<bool>,
    /// Limit the memory for reading a file and, approximately, for rendering it
    #[arg(long, global = true, default_value = "8G", value_name = "SIZE", value_parser = parse_bytes, help_heading = help::FILES)]
    pub max_memory: u64,
    /// Treat warnings as errors
    #[arg(long, global = true, help_heading = help::FILES)]
    pub strict: bool,
    /// Let scene files refer to files outside their own folder
    #[arg(long, global = true, help_heading = help::FILES)]
    pub allow_outside: bool,
    /// Read nothing outside the scene's folder and write nothing outside OUT's folder, for files from untrusted
    /// sources; on Linux the kernel enforces this (see -V)
    #[arg(long, global = true, conflicts_with = "allow_outside", help_heading = help::FILES)]
    pub sandbox: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProgressStyle {
    Auto,
    Bar,
    Lines,
    /// Lines for the scheduler of a farm that runs jobs of Open Job Description
    Openjd,
    None,
}

#[derive(Subcommand)]
pub enum Command {
    /// Render pictures of scenes
    Render(Box<Render>),
    /// Watch a scene in the browser while it renders
    Serve(Box<Serve>),
    /// Show what is in a scene file
    Info(Info),
    /// Explain why a scene is slow or noisy, and what would help
    Explain(Box<Explain>),
    /// Convert a scene or a picture to another format
    Convert(Convert),
    /// Remove the noise from a picture
    Denoise(Denoise),
    /// Make a picture of photons: what the sensor of a camera reads, with its noise
    Sensor(Box<Sensor>),
    /// Compare pictures with references, by FLIP and other metrics
    Compare(Compare),
    /// Write a built-in scene to a file
    Generate(Generate),
    /// Merge partial renders into one picture
    Merge(Merge),
    /// Split a picture or an animation into tasks for a farm
    Farm(Farm),
    /// Render a stream of jobs in one process that stays warm
    Worker(Worker),
    /// Run a benchmark
    Bench(Box<Bench>),
    /// List integrators, accelerators, materials, formats and more
    List(List),
    /// Print shell completions
    #[command(help_template = help::TEMPLATE)]
    #[command(after_help = "Examples:\n  \
        bilux completions bash > ~/.local/share/bash-completion/completions/bilux\n  \
        bilux completions fish > ~/.config/fish/completions/bilux.fish\n  \
        bilux completions zsh > ~/.zfunc/_bilux")]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the man page, or write the man pages of all commands to a folder
    #[command(help_template = help::TEMPLATE)]
    #[command(after_help = "Examples:\n  \
        bilux man | man -l -                Read the page of bilux\n  \
        bilux man ~/.local/share/man/man1   Install all pages, for `man bilux-render`")]
    Man {
        /// The folder for the man pages of all commands; it is created if it does not exist
        folder: Option<PathBuf>,
    },
    /// Print the JSON Schema of TOML scenes, for use in editors
    #[command(help_template = help::TEMPLATE)]
    #[command(after_help = "Example:\n  \
        bilux schema > bilux.schema.json\n\n\
        Editors with a TOML language server such as Taplo then complete and check scenes that begin with:\n  \
        #:schema ./bilux.schema.json")]
    Schema,
    /// Print the licences of Bilux and of its dependencies
    #[command(help_template = help::TEMPLATE)]
    Licenses,
}

/// Show what is in a scene file
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux info model.glb\n  bilux info model.glb --json")]
pub struct Info {
    /// The scene file; `-` reads it from standard input
    pub scene: PathBuf,
    /// Print JSON instead of text
    #[arg(long, help_heading = help::OUTPUT)]
    pub json: bool,
    #[command(flatten)]
    pub posed: Posed,
}

/// Write a built-in scene to a file
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux generate trio -o trio.toml\n  \
    bilux generate teapots --set count=5 -o five.toml\n  \
    bilux generate teapots --from pot.asc --count 3 --offset 4,0,0 -o three.asc")]
pub struct Generate {
    /// The built-in scene (`bilux list generators`)
    pub name: String,
    /// The file to write; its extension sets the format
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// The number of copies [default: 3 for teapots, 1 with --from]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_count, help_heading = help::WHAT)]
    pub count: Option<u32>,
    /// The offset from each copy to the next [default: 1.6,0,-4.6 for teapots, 1,0,0 with --from]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector, help_heading = help::WHAT)]
    pub offset: Option<[f32; 3]>,
    /// Copy the model in this file instead of a built-in one
    #[arg(long, value_name = "FILE", help_heading = help::WHAT)]
    pub from: Option<PathBuf>,
    /// Set any other parameter (`bilux list generators`)
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = help::WHAT)]
    pub set: Vec<String>,
}

/// Merge partial renders into one picture
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux merge a.exr b.exr -o scene.png\n  \
    bilux merge a.exr b.exr -o so-far.exr --partial    Other parts are still missing")]
pub struct Merge {
    /// The partial renders to merge, in any order
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// The picture to write; an .exr can be merged again
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// Merge what there is even if samples are missing, which is otherwise an error
    #[arg(long, help_heading = help::OUTPUT)]
    pub partial: bool,
}

/// List integrators, accelerators, materials, formats and more
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(
    after_help = "Examples:\n  bilux list integrators\n  bilux list settings    What --set and [render] accept\n  \
    bilux list materials --json"
)]
pub struct List {
    /// What to list: integrators, accels, visibility, materials, textures, bsdfs, phases, densities, lights, cameras, generators,
    /// presets, formats, picture-formats, tonemaps, denoisers, filters, aovs, metrics, sensor, lidar or settings
    pub what: String,
    /// Print JSON instead of text
    #[arg(long, help_heading = help::OUTPUT)]
    pub json: bool,
}
