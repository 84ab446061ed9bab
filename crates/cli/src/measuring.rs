//! What `bilux bench` is told.

use crate::values::parse_rival;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Measure.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    bilux bench teapots --counts 2,3,4,5 --accel brute,bsp,bsp-sah,kd,bvh\n  \
    bilux bench visibility --json\n  \
    bilux bench paper -o figures.png\n  \
    bilux bench rays                                  on our own scenes\n  \
    bilux bench rays room.toml --accel bvh,kd --json\n  \
    bilux bench rays --against embree=libembree4.so.4  beside Embree\n  \
    bilux bench rays teapot1k teapot10k teapot100k teapot1m teapots10m --accel bvh8,bvh8-best\n  \
    bilux bench rays teapots3 --dump batches           meshes and rays for other programs\n  \
    bilux bench rays --mesh batches/teapots3.msh --rays batches/teapots3-ao.ray --hits ao.hit\n  \
    bilux bench load                                  files of 100 MB that it makes, and a million instances\n  \
    bilux bench load scan.ply house.glb --json\n  \
    bilux bench models                                a dozen models, five minutes\n  \
    bilux bench render --report measured              ten minutes, and a page to look at\n  \
    bilux bench render --scenes caustics,pool --integrators path,vcm --seconds 1,4,16\n  \
    bilux bench render room.pbrt --reference-seconds 30 --integrators auto,path,bdpt,auto:path-photons")]
pub struct Bench {
    /// What to measure
    #[arg(value_enum)]
    pub kind: BenchKind,
    /// `render`: scene files, measured in place of the shipped scenes. `load`: scene files; without any, some are made. `models`: model files; without any, ours and those of ../shared/scenes. `rays`: scene files, or teapots3, interior, scan, teapot1m, which are all four traced if none is given, or
    /// teapot1k, teapot10k, teapot100k, teapots10m
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// As JSON
    #[arg(long)]
    pub json: bool,
    /// Numbers of teapots
    #[arg(long, value_name = "N,N,…", value_delimiter = ',')]
    pub counts: Vec<u32>,
    /// Accelerators
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub accel: Vec<String>,
    /// Width and height
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// Repeats, of which the median counts
    #[arg(long, value_name = "N")]
    pub repeats: Option<u32>,
    /// The teapots' places: at the paper's fixed offset, or covering equally much of the picture
    #[arg(long, value_name = "paper|coverage")]
    pub layout: Option<String>,
    /// A picture of what was rendered, where there is one
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// `rays`: how many in each class (1048576), or with --mesh a file of rays
    #[arg(long, value_name = "N|FILE")]
    pub rays: Vec<String>,
    /// `rays`: rounds, in each of which every engine has a turn; medians count (5)
    #[arg(long, value_name = "N")]
    pub rounds: Option<u32>,
    /// `rays`: a rival in a shared library, such as embree=libembree4.so.4
    #[arg(long, value_name = "NAME=PATH", value_parser = parse_rival)]
    pub against: Vec<(String, PathBuf)>,
    /// `rays`: write meshes and rays into this folder
    #[arg(long, value_name = "DIR")]
    pub dump: Option<PathBuf>,
    /// `rays`: a mesh file in place of scenes
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// `rays`: write the hits of the rays of --rays FILE
    #[arg(long, value_name = "FILE")]
    pub hits: Option<PathBuf>,
    /// `render`: which of its scenes (all)
    #[arg(long = "scenes", value_name = "NAME,…", value_delimiter = ',')]
    pub gallery: Vec<String>,
    /// `render`: which integrators (path, bdpt, vcm, sppm, auto); auto:WAYS is `auto` held to one of its choices, such as
    /// auto:path-photons
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub integrators: Vec<String>,
    /// `render`: CPU seconds a picture, all threads together (1,4). `models`: seconds for each half of a reference (8)
    #[arg(long, value_name = "S,S,…", value_delimiter = ',')]
    pub seconds: Vec<f64>,
    /// `models`: keep the references in this folder, and take them from there
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
    /// `render`: CPU seconds of each of the two integrators that make the reference of a scene file (60)
    #[arg(long, value_name = "S")]
    pub reference_seconds: Option<f64>,
    /// `render`: pictures of each kind, over which medians are taken (5)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub seeds: Option<u32>,
    /// `render`: threads; 0 for all cores
    #[arg(long, value_name = "N", default_value = "0")]
    pub threads: u32,
    /// `render`: write a page with pictures, maps of errors and curves into this folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// `render`: make references of so many --seconds by each of two integrators, as files in this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["report", "integrators", "seeds"])]
    pub make_references: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BenchKind {
    /// The paper's Figure 1 and section 4.2 anew
    Paper,
    /// The paper's Figure 2 anew: teapots by accelerator
    Teapots,
    /// Moving scenes: what rebuilding only what moved saves
    Frames,
    /// Seeing without rays: painter's, Warnock's, z-buffer, BSP
    Visibility,
    /// How fast trees are built, and how large they are
    Build,
    /// Rays a second, beside other libraries
    Rays,
    /// Errors of integrators at equal time, on eight scenes
    Render,
    /// How fast scene files are read, and how much memory that takes
    Load,
    /// Models as they come: what is seen of their errors at nothing said, in a second, and fast
    Models,
}
