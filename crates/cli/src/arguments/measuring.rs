//! The options of `bilux bench`: each benchmark is a command of its own, so that its help lists what it takes, and what it
//! does not take is refused.

use crate::arguments::help;
use crate::arguments::values::{parse_count, parse_cpu_seconds, parse_engine, parse_seeds};
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Run a benchmark
#[derive(Args)]
#[command(help_template = help::TEMPLATE, disable_help_subcommand = true, arg_required_else_help = false)]
#[command(subcommand_value_name = "KIND", subcommand_help_heading = "Benchmarks")]
#[command(after_help = "Examples:\n  \
    bilux bench render --help                          Describe the options of a benchmark\n  \
    bilux bench teapots --counts 2,3,4,5 --accel brute,bsp,bsp-sah,kd,bvh\n  \
    bilux bench paper -o figures.png\n  \
    bilux bench rays room.toml --accel bvh,kd --json\n  \
    bilux bench load scan.ply house.glb\n  \
    bilux bench render --report measured               Writes a page of pictures; ten minutes\n  \
    bilux bench models                                 Up to a dozen models, in five minutes\n  \
    bilux bench speed --json                           Speed and size, in ten minutes")]
pub struct Bench {
    /// The benchmark to run
    #[command(subcommand)]
    pub kind: BenchKind,
    /// Print JSON instead of text
    #[arg(long, global = true, help_heading = help::OUTPUT)]
    pub json: bool,
}

#[derive(Subcommand)]
pub enum BenchKind {
    /// The paper's Figure 1 and section 4.4
    Paper(PaperBench),
    /// The paper's Figure 2: render times of teapots, by acceleration structure
    Teapots(TeapotsBench),
    /// Animated scenes: how much time is saved by rebuilding only what has moved
    Frames(FramesBench),
    /// Hidden-surface algorithms: painter's, Warnock's, z-buffer, BSP
    Visibility(VisibilityBench),
    /// How fast acceleration structures are built, and how large they are
    Build(BuildBench),
    /// Rays per second, compared with other libraries
    Rays(RaysBench),
    /// The integrators' errors at equal time, on eight scenes
    Render(RenderBench),
    /// How fast scene files are read, and how much memory that takes
    Load(LoadBench),
    /// Models as they are: the visible error with default settings, in one second, and with --fast
    Models(ModelsBench),
    /// Speed and size, row by row against their goals, and against Mitsuba and Embree where they are installed
    Speed(SpeedBench),
}

/// How large pictures are.
#[derive(Args)]
pub struct PictureSize {
    /// The width and height in pixels [default: 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
}

/// What is compared.
#[derive(Args)]
pub struct Structures {
    /// The acceleration structures (`bilux list accels`)
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub accel: Vec<String>,
}

/// How often, and where teapots stand meanwhile.
#[derive(Args)]
pub struct Repeated {
    /// The number of repeats; the median is reported [default: 3]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub repeats: Option<u32>,
    /// Where the teapots stand: at the paper's fixed offset, or so that they always cover the same part of the picture
    /// [default: paper]
    #[arg(long, value_name = "paper|coverage")]
    pub layout: Option<String>,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Example:\n  \
    bilux bench paper --size 512x288 -o figures.png")]
pub struct PaperBench {
    /// The width and height in pixels [default: 256x144]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// Write the four panels of Figure 1 as a picture
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: Option<PathBuf>,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Example:\n  \
    bilux bench teapots --counts 2,3,4,5 --accel brute,bsp,bsp-sah,kd,bvh")]
pub struct TeapotsBench {
    /// The numbers of teapots [default: 2,3,4,5]
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', value_parser = parse_count)]
    pub counts: Vec<u32>,
    #[command(flatten)]
    pub structures: Structures,
    #[command(flatten)]
    pub picture: PictureSize,
    #[command(flatten)]
    pub repeated: Repeated,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Example:\n  \
    bilux bench frames --counts 25 --accel bsp,bvh")]
pub struct FramesBench {
    /// The number of teapots [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub counts: Option<u32>,
    #[command(flatten)]
    pub structures: Structures,
    #[command(flatten)]
    pub picture: PictureSize,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Example:\n  \
    bilux bench visibility --json")]
pub struct VisibilityBench {
    /// The number of teapots [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub counts: Option<u32>,
    #[command(flatten)]
    pub picture: PictureSize,
    #[command(flatten)]
    pub repeated: Repeated,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Example:\n  \
    bilux bench build --counts 5,25 --accel bvh,bvh8")]
pub struct BuildBench {
    /// The numbers of teapots [default: 1,5,25]
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', value_parser = parse_count)]
    pub counts: Vec<u32>,
    #[command(flatten)]
    pub structures: Structures,
    #[command(flatten)]
    pub repeated: Repeated,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux bench rays                                   On the built-in scenes\n  \
    bilux bench rays room.toml --accel bvh,kd --json\n  \
    bilux bench rays --against embree=libembree4.so.4  Compared with Embree\n  \
    bilux bench rays teapot1k teapot10k teapot100k teapot1m teapots10m --accel bvh8,bvh8-best\n  \
    bilux bench rays teapots3 --dump batches           Write meshes and rays for other programs\n  \
    bilux bench rays --mesh batches/teapots3.msh --rays batches/teapots3-ao.ray --hits ao.hit")]
pub struct RaysBench {
    /// Scene files, or the built-in scenes teapots3, interior, scan, teapot1m [default: these four], teapot1k, teapot10k,
    /// teapot100k and teapots10m
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub structures: Structures,
    /// The number of rays in each class [default: 1048576], or with --mesh a file of rays
    #[arg(long, value_name = "N|FILE")]
    pub rays: Vec<String>,
    /// The number of rounds; every engine takes a turn in each, and the median is reported [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub rounds: Option<u32>,
    /// Compare with another engine from a shared library, such as embree=libembree4.so.4
    #[arg(long, value_name = "NAME=PATH", value_parser = parse_engine)]
    pub against: Vec<(String, PathBuf)>,
    /// Trace this mesh file instead of scenes
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Write the meshes and rays to this folder
    #[arg(long, value_name = "DIR", help_heading = help::OUTPUT)]
    pub dump: Option<PathBuf>,
    /// Write the hits of the rays in --rays FILE
    #[arg(long, value_name = "FILE", help_heading = help::OUTPUT)]
    pub hits: Option<PathBuf>,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux bench render --report measured               Writes a page of pictures; ten minutes\n  \
    bilux bench render --scenes caustics,pool --integrators path,vcm --seconds 1,4,16\n  \
    bilux bench render room.pbrt --reference-seconds 30 --integrators auto,path,auto:path-photons")]
pub struct RenderBench {
    /// Scene files [default: the built-in scenes]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// The built-in scenes to use [default: all]
    #[arg(long = "scenes", value_name = "NAME,…", value_delimiter = ',')]
    pub gallery: Vec<String>,
    /// The integrators [default: path, bdpt, vcm, sppm, auto]; auto:TECHNIQUES restricts `auto` to one of its
    /// strategies, such as auto:path-photons
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub integrators: Vec<String>,
    /// The CPU seconds per picture, summed over all threads [default: 1,4, and 60 with --make-references]
    #[arg(long, value_name = "S,S,…", value_delimiter = ',', value_parser = parse_cpu_seconds)]
    pub seconds: Vec<f64>,
    /// The CPU seconds for each of the two integrators that make the reference of a scene file [default: 60]
    #[arg(long, value_name = "S", value_parser = parse_cpu_seconds)]
    pub reference_seconds: Option<f64>,
    /// The number of pictures per scene, integrator and budget; the median is reported [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_seeds)]
    pub seeds: Option<u32>,
    /// The number of threads; 0 uses all cores
    #[arg(long, value_name = "N", default_value = "0", value_parser = parse_count)]
    pub threads: u32,
    /// Write a page with pictures, error maps and curves to this folder
    #[arg(long, value_name = "DIR", help_heading = help::OUTPUT)]
    pub report: Option<PathBuf>,
    /// Write references to this folder; each of two integrators spends --seconds on a scene
    #[arg(long, value_name = "DIR", conflicts_with_all = ["report", "integrators", "seeds"], help_heading = help::OUTPUT)]
    pub make_references: Option<PathBuf>,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux bench load                                   On generated files of 100 MB\n  \
    bilux bench load scan.ply house.glb --json")]
pub struct LoadBench {
    /// Scene files [default: files that it generates]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// The number of repeats; the median is reported [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub repeats: Option<u32>,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux bench models                                 Up to a dozen models, in five minutes\n  \
    bilux bench models chair.glb lamp.glb --seconds 2 --references kept")]
pub struct ModelsBench {
    /// Model files [default: six built-in ones, and public ones if they lie in ../shared/scenes]
    #[arg(value_name = "MODEL")]
    pub scenes: Vec<PathBuf>,
    /// The seconds for each half of a reference [default: 8]
    #[arg(long, value_name = "S", value_parser = parse_cpu_seconds)]
    pub seconds: Option<f64>,
    /// Keep the references in this folder, and reuse those that are already there
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
}

#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux bench speed --json                           Speed and size, in ten minutes\n  \
    bilux bench speed --rows box,model --model WaterBottle.gltf --python venv/bin/python")]
pub struct SpeedBench {
    /// The rows to measure: box, bidirectional, model, studio, auto, lamps, threads, memory, principled and rays [default:
    /// all]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub rows: Vec<String>,
    /// The glTF model for the rows model and studio, which are skipped without one
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The CPU seconds of a picture where integrators are compared at equal time [default: 1]
    #[arg(long, value_name = "S", value_parser = parse_cpu_seconds)]
    pub seconds: Option<f64>,
    /// The number of repeats; the median is reported [default: 3]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub repeats: Option<u32>,
    /// The Python that can import Mitsuba; without it, rows have our side only [default: python3]
    #[arg(long, value_name = "PATH")]
    pub python: Option<PathBuf>,
    /// The library of Embree, as embree=PATH [default: where the system has it]
    #[arg(long, value_name = "NAME=PATH", value_parser = parse_engine)]
    pub against: Vec<(String, PathBuf)>,
}
