//! Everything that can be typed. Help, completions and the man page are made from this one description.

use crate::choices::{Choices, Posed};
pub use crate::comparison::Compare;
pub use crate::denoising::Denoise;
pub use crate::measuring::{Bench, BenchKind};
use crate::studio::StudioArguments;
use crate::values::{
    Exposure, parse_bytes, parse_crop, parse_exposure, parse_frames, parse_replay, parse_samples,
    parse_seconds, parse_vector,
};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// Physically right pictures of 3D scenes on plain CPUs, with light traced from both ends.
#[derive(Parser)]
#[command(name = "bilux", version = crate::version::text(), about, long_about = None, max_term_width = 100)]
#[command(after_help = "Examples:\n  \
    bilux generate trio -o trio.toml             a scene that we ship\n  \
    bilux render trio.toml -o trio.png           its picture\n  \
    bilux render model.obj -o model.png          a bare model, framed and lit\n  \
    bilux render pot.asc --preset course -i cast -o pot.ppm\n  \
    bilux list integrators")]
pub struct Arguments {
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Command,
}

/// What every command understands.
#[derive(Args)]
pub struct Common {
    /// Say nothing but errors
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Say more
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
    /// Progress: a bar on a terminal, lines elsewhere
    #[arg(long, global = true, value_enum, default_value = "auto", value_name = "HOW")]
    pub progress: ProgressStyle,
    /// Most memory that reading a file may take, and about that of rendering it
    #[arg(long, global = true, default_value = "8G", value_name = "SIZE", value_parser = parse_bytes)]
    pub max_memory: u64,
    /// Turn warnings into errors
    #[arg(long, global = true)]
    pub strict: bool,
    /// Let scene files name files outside of their own folder
    #[arg(long, global = true)]
    pub allow_outside: bool,
    /// For files of strangers: opens nothing outside of a scene's folder, loads no library, writes nothing but OUT
    #[arg(long, global = true, conflicts_with = "allow_outside")]
    pub sandbox: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProgressStyle {
    Auto,
    Bar,
    Lines,
    None,
}

#[derive(Subcommand)]
pub enum Command {
    /// Make pictures from scenes
    Render(Box<Render>),
    /// Say what is in a scene
    Info(Info),
    /// Turn a scene or a picture into another format
    Convert(Convert),
    /// Take the noise out of a picture
    Denoise(Denoise),
    /// Say how far picture A is from the reference B
    Compare(Compare),
    /// Make one of the scenes that we ship
    Generate(Generate),
    /// Join partial films into one picture
    Merge(Merge),
    /// Measure
    Bench(Box<Bench>),
    /// List what there is: integrators, accels, materials, …
    List(List),
    /// Print completions for a shell
    Completions {
        /// For which shell
        shell: clap_complete::Shell,
    },
    /// Print the man page, or write the pages of all commands into a folder
    Man {
        /// Folder for the pages of all commands
        folder: Option<PathBuf>,
    },
    /// Print the JSON schema of scene files, for editors
    Schema,
    /// Print the licences of Bilux and of what it is built from
    Licenses,
}

/// Make pictures from scenes.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    bilux render scene.toml -o scene.png\n  \
    bilux render *.obj -o '{stem}.png'\n  \
    bilux render chair.glb -o chair.png --orbit 40,20 --ground mirror\n  \
    bilux render chair.glb -o chair.png --env sunset.hdr --ground shadow\n  \
    bilux render chair.glb -o 'chair-{frame}.png' --turntable 36\n  \
    bilux render walk.toml --frames 0-47 -o 'walk-{frame}.png'\n  \
    bilux render fox.glb --animation Walk --at 0.5 -o fox.png\n  \
    bilux render scene.toml --samples 0..64 -o a.exr    one half here,\n  \
    bilux render scene.toml --samples 64..128 -o b.exr  the other there:\n  \
    bilux merge a.exr b.exr -o scene.png\n  \
    bilux render scene.toml --spp 64 --aov albedo,normal,depth,variance -o noisy.exr\n  \
    bilux denoise noisy.exr -o smooth.exr")]
pub struct Render {
    /// Scene files; `-` reads standard input (with --input-format)
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// The picture; `{stem}` and `{frame}` are filled in, `-` writes PNG to standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Format of a scene on standard input
    #[arg(long, value_name = "NAME")]
    pub input_format: Option<String>,
    #[command(flatten)]
    pub choices: Choices,
    /// How light is followed (`bilux list integrators`)
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// What finds the triangles that rays hit (`bilux list accels`)
    #[arg(long, value_name = "NAME")]
    pub accel: Option<String>,
    /// Time that it may take to build [default: auto, by samples a triangle]
    #[arg(long, value_name = "fast|balanced|best")]
    pub build: Option<String>,
    /// Width and height
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// Samples per pixel
    #[arg(long, value_name = "N")]
    pub spp: Option<u32>,
    /// Stop when the noise is at most this part of the light, on average: 0.02 is smooth. See pixel by pixel what is left
    /// with --aov interval
    #[arg(long, value_name = "REL")]
    pub noise: Option<f32>,
    /// The cleanest picture that about a second gives, for thumbnails: reading and denoising included
    #[arg(long, conflicts_with_all = ["spp", "noise", "time_limit"])]
    pub fast: bool,
    /// Be done after this time, reading and denoising included; where that is impossible, a line says why
    #[arg(long, value_name = "SECONDS")]
    pub time_limit: Option<f32>,
    /// End the whole command after this time, with the picture as it is by then (exit status 124)
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    pub timeout: Option<Duration>,
    /// Another number gives other noise
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads; 0 for all cores
    #[arg(long, value_name = "N")]
    pub threads: Option<u32>,
    /// Scattering events after the camera; 0 is emission only
    #[arg(long, value_name = "N")]
    pub max_depth: Option<u32>,
    /// Which camera
    #[arg(long, value_name = "NAME|INDEX")]
    pub camera: Option<String>,
    #[command(flatten)]
    pub studio: StudioArguments,
    /// When, in moving scenes
    #[arg(long, value_name = "SECONDS")]
    pub at: Option<f32>,
    /// Frames A to B, both included; needs {frame} in OUT
    #[arg(long, value_name = "A-B", value_parser = parse_frames)]
    pub frames: Option<(u32, u32)>,
    /// Only samples A up to (not including) B of each pixel: a partial film, in an .exr
    #[arg(long, value_name = "A..B", value_parser = parse_samples)]
    pub samples: Option<(u32, u32)>,
    /// Only a window of the picture
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop)]
    pub crop: Option<[u32; 4]>,
    /// Brighten by powers of two; or to the brightness of a photograph
    #[arg(long, value_name = "EV|auto", allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: Option<Exposure>,
    /// Tone curve (`bilux list tonemaps`)
    #[arg(long, value_name = "NAME")]
    pub tonemap: Option<String>,
    /// Take the noise away, by the best that there is or by what is named (`bilux list denoisers`). Pictures for a display
    /// that noise or time ends are denoised unless this is off
    #[arg(long, value_name = "auto|oidn|builtin|off", num_args = 0..=1, default_missing_value = "auto",
        require_equals = true)]
    pub denoise: Option<String>,
    /// Bits per sample of PNG and PPM
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = ["8", "16"])]
    pub bits: String,
    /// The highlight of `cast` and `whitted`: Eq. 1's halfway vector, or section 3.1's reflected one
    #[arg(long, value_name = "halfway|reflect")]
    pub specular: Option<String>,
    /// Local light in `whitted`: off where every light is blocked (paper), or light by light
    #[arg(long, value_name = "paper|per-light")]
    pub shadow_rule: Option<String>,
    /// How `bsp` chooses its planes
    #[arg(long, value_name = "mean|fuchs")]
    pub bsp_split: Option<String>,
    /// What `bsp` keeps together
    #[arg(long, value_name = "polygons|objects")]
    pub bsp_group: Option<String>,
    /// Any other setting (`bilux list settings`)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// What else to give (`bilux list aovs`): albedo, normal, depth, ids, variance as layers of an .exr (OUT.layers.exr where OUT is none);
    /// with `strategies`, each strategy's picture in a folder OUT.strategies; with `interval`, OUT.interval.exr: half of each
    /// pixel's 95% interval
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub aov: Vec<String>,
    /// Write what it took as JSON; counts every node and triangle test, which is slower
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Follow one sample again and say what happened to it
    #[arg(long, value_name = "X,Y,SAMPLE", value_parser = parse_replay)]
    pub replay: Option<[u32; 3]>,
}

/// Say what is in a scene.
#[derive(Args)]
pub struct Info {
    /// The scene file
    pub scene: PathBuf,
    /// As JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub posed: Posed,
}

/// Turn a scene or a picture into another format.
#[derive(Args)]
#[command(after_help = "Examples:\n  bilux convert pot.asc -o pot.obj\n  bilux convert sky.hdr -o sky.exr")]
pub struct Convert {
    /// What to turn
    pub input: PathBuf,
    /// Into what, by its extension
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Text in place of binary, where the format has both
    #[arg(long)]
    pub ascii: bool,
    #[command(flatten)]
    pub posed: Posed,
}

/// Make one of the scenes that we ship.
#[derive(Args)]
#[command(after_help = "Examples:\n  bilux generate teapots --set count=5 -o five.toml\n  \
    bilux generate teapots --from pot.asc --count 3 --offset 4,0,0 -o three.asc")]
pub struct Generate {
    /// Which (`bilux list generators`)
    pub name: String,
    /// Where to, by its extension
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// How many
    #[arg(long, value_name = "N")]
    pub count: Option<u32>,
    /// From each to the next
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub offset: Option<[f32; 3]>,
    /// Copies of this file's model in place of our own
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
    /// Any other parameter (`bilux list generators`)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// Join partial films into one picture.
#[derive(Args)]
pub struct Merge {
    /// Partial films, in any order
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// The picture, or with `.exr` a film that can be joined further
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
}

/// List what there is.
#[derive(Args)]
pub struct List {
    /// What: integrators, accels, materials, lights, cameras, formats, …
    pub what: String,
    /// As JSON
    #[arg(long)]
    pub json: bool,
}
