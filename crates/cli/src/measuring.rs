//! The options of `bilux bench`.

use crate::help;
use crate::values::{parse_count, parse_cpu_seconds, parse_engine, parse_seeds};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Run a benchmark
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux bench teapots --counts 2,3,4,5 --accel brute,bsp,bsp-sah,kd,bvh\n  \
    bilux bench visibility --json\n  \
    bilux bench paper -o figures.png\n  \
    bilux bench rays                                   On the built-in scenes\n  \
    bilux bench rays room.toml --accel bvh,kd --json\n  \
    bilux bench rays --against embree=libembree4.so.4  Compared with Embree\n  \
    bilux bench rays teapot1k teapot10k teapot100k teapot1m teapots10m --accel bvh8,bvh8-best\n  \
    bilux bench rays teapots3 --dump batches           Write meshes and rays for other programs\n  \
    bilux bench rays --mesh batches/teapots3.msh --rays batches/teapots3-ao.ray --hits ao.hit\n  \
    bilux bench load                                   On generated files of 100 MB\n  \
    bilux bench load scan.ply house.glb --json\n  \
    bilux bench render --report measured               Writes a page of pictures; ten minutes\n  \
    bilux bench render --scenes caustics,pool --integrators path,vcm --seconds 1,4,16\n  \
    bilux bench render room.pbrt --reference-seconds 30 --integrators auto,path,auto:path-photons\n  \
    bilux bench models                                 Up to a dozen models, in five minutes\n  \
    bilux bench speed --json                           Speed and size, in ten minutes\n  \
    bilux bench speed --rows box,model --model WaterBottle.gltf --python venv/bin/python")]
pub struct Bench {
    /// The benchmark to run
    #[arg(value_enum)]
    pub kind: BenchKind,
    /// `render`: scene files [default: the built-in scenes]. `load`: scene files [default: files that it generates].
    /// `models`: model files [default: six built-in ones, and public ones if they lie in ../shared/scenes]. `rays`:
    /// scene files, or the built-in scenes teapots3, interior, scan, teapot1m [default: these four], teapot1k, teapot10k,
    /// teapot100k and teapots10m
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
    /// `teapots`, `build`: the numbers of teapots [default: 2,3,4,5 and 1,5,25]. `frames`, `visibility`: one number
    /// [default: 5]
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', value_parser = parse_count)]
    pub counts: Vec<u32>,
    /// `teapots`, `frames`, `build`, `rays`: the acceleration structures (`bilux list accels`)
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub accel: Vec<String>,
    /// `paper`, `teapots`, `frames`, `visibility`: the width and height in pixels [default: 256x144 for `paper`, else
    /// 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// `teapots`, `visibility`, `build`, `load`, `speed`: the number of repeats; the median is reported [default: 5 for
    /// `load`, else 3]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub repeats: Option<u32>,
    /// `teapots`, `visibility`, `build`: where the teapots stand: at the paper's fixed offset, or so that they always
    /// cover the same part of the picture [default: paper]
    #[arg(long, value_name = "paper|coverage")]
    pub layout: Option<String>,
    /// `paper`: write the four panels of Figure 1 as a picture
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// `rays`: the number of rays in each class [default: 1048576], or with --mesh a file of rays
    #[arg(long, value_name = "N|FILE")]
    pub rays: Vec<String>,
    /// `rays`: the number of rounds; every engine takes a turn in each, and the median is reported [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub rounds: Option<u32>,
    /// `rays`, `speed`: compare with another engine from a shared library, such as embree=libembree4.so.4, which `speed`
    /// looks for itself
    #[arg(long, value_name = "NAME=PATH", value_parser = parse_engine)]
    pub against: Vec<(String, PathBuf)>,
    /// `rays`: write the meshes and rays to this folder
    #[arg(long, value_name = "DIR")]
    pub dump: Option<PathBuf>,
    /// `rays`: trace this mesh file instead of scenes
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// `rays`: write the hits of the rays in --rays FILE
    #[arg(long, value_name = "FILE")]
    pub hits: Option<PathBuf>,
    /// `render`: the built-in scenes to use [default: all]
    #[arg(long = "scenes", value_name = "NAME,…", value_delimiter = ',')]
    pub gallery: Vec<String>,
    /// `render`: the integrators [default: path, bdpt, vcm, sppm, auto]; auto:TECHNIQUES restricts `auto` to one of its
    /// strategies, such as auto:path-photons
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub integrators: Vec<String>,
    /// `render`: the CPU seconds per picture, summed over all threads [default: 1,4, and 60 with --make-references].
    /// `models`: the seconds for each half of a reference [default: 8]. `speed`: the CPU seconds of a picture where
    /// integrators are compared at equal time [default: 1]
    #[arg(long, value_name = "S,S,…", value_delimiter = ',', value_parser = parse_cpu_seconds)]
    pub seconds: Vec<f64>,
    /// `speed`: the rows to measure: box, bidirectional, model, studio, auto, lamps, threads, memory, principled and rays
    /// [default: all]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub rows: Vec<String>,
    /// `speed`: the glTF model for the rows model and studio, which are skipped without one
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// `speed`: the Python that can import Mitsuba; without it, rows have our side only [default: python3]
    #[arg(long, value_name = "PATH")]
    pub python: Option<PathBuf>,
    /// `models`: keep the references in this folder, and reuse those that are already there
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
    /// `render`: the CPU seconds for each of the two integrators that make the reference of a scene file [default: 60]
    #[arg(long, value_name = "S", value_parser = parse_cpu_seconds)]
    pub reference_seconds: Option<f64>,
    /// `render`: the number of pictures per scene, integrator and budget; the median is reported [default: 5]
    #[arg(long, value_name = "N", value_parser = parse_seeds)]
    pub seeds: Option<u32>,
    /// `render`: the number of threads; 0 uses all cores
    #[arg(long, value_name = "N", default_value = "0", value_parser = parse_count)]
    pub threads: u32,
    /// `render`: write a page with pictures, error maps and curves to this folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// `render`: write references to this folder; each of two integrators spends --seconds on a scene
    #[arg(long, value_name = "DIR", conflicts_with_all = ["report", "integrators", "seeds"])]
    pub make_references: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BenchKind {
    /// The paper's Figure 1 and section 4.4
    Paper,
    /// The paper's Figure 2: render times of teapots, by acceleration structure
    Teapots,
    /// Animated scenes: how much time is saved by rebuilding only what has moved
    Frames,
    /// Hidden-surface algorithms: painter's, Warnock's, z-buffer, BSP
    Visibility,
    /// How fast acceleration structures are built, and how large they are
    Build,
    /// Rays per second, compared with other libraries
    Rays,
    /// The integrators' errors at equal time, on eight scenes
    Render,
    /// How fast scene files are read, and how much memory that takes
    Load,
    /// Models as they are: the visible error with default settings, in one second, and with --fast
    Models,
    /// Speed and size, row by row against their goals, and against Mitsuba and Embree where they are installed
    Speed,
}
