//! The command line. Help, shell completions and man pages are all generated from this one description.

use crate::choices::{Choices, Posed};
pub use crate::measuring::Bench;
use crate::values::{
    Exposure, parse_bytes, parse_count, parse_crop, parse_duration, parse_exposure, parse_frames,
    parse_lengths, parse_noise, parse_quality, parse_replay, parse_samples, parse_seconds, parse_seed,
    parse_spp, parse_time, parse_turntable, parse_vector,
};
pub use crate::{
    comparison::Compare, converting::Convert, denoising::Denoise, explaining::Explain, farming::Farm,
    sensing::Sensor, working::Worker,
};
use crate::{help, lasting::Lasting, serving::Serve, studio::StudioArguments};
use bilux::transport::LengthBins;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Render physically based pictures of 3D scenes on the CPU
#[derive(Parser)]
#[command(name = "bilux", about = "Render physically based pictures of 3D scenes on the CPU", long_about = None, version = crate::version::text(), max_term_width = 100)]
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

/// Render pictures of scenes
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux render scene.toml -o scene.png\n  \
    bilux render model.glb -o model.png --size 1920x1080 --time-limit 30\n  \
    bilux render model.glb -o model.jpg --orbit 40,20 --ground mirror\n  \
    bilux render model.glb -o model.png --env sunset.hdr --ground shadow\n  \
    bilux render model.glb -o 'model-{frame}.png' --turntable 36\n  \
    bilux render *.obj -o '{stem}.png'\n  \
    bilux render fox.glb -o fox.png --animation Walk --at 0.5\n  \
    bilux render walk.toml -o 'walk-{frame}.png' --frames 0-47\n  \
    bilux render scene.toml -o noisy.exr --spp 64 --aov guides,variance\n  \
    bilux render scene.toml -o comp.exr --spp 64 --aov crypto_object,direct,indirect,groups,position\n  \
    bilux render scene.toml -o scene.png --noise 0.5% --resume    Resume if it was interrupted\n  \
    bilux render scene.toml -o draft.png --fast --watch --preview\n  \
    bilux render scene.toml -o a.exr --spp 128 --samples 0..64    One half here,\n  \
    bilux render scene.toml -o b.exr --spp 128 --samples 64..128  and the other half elsewhere:\n  \
    bilux merge a.exr b.exr -o scene.png                          Merge them\n\n\
    Exit status:\n  \
    0         Every picture was written\n  \
    1         Something failed\n  \
    2         The command line is wrong\n  \
    124       --timeout ended it; the picture so far is saved\n  \
    130, 143  Ctrl-C or SIGTERM ended it; the picture so far is saved, and --resume continues\n  \
    141       The reader of standard output closed it")]
pub struct Render {
    /// The scene files to render (`bilux list formats`); `-` reads a scene from standard input
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// The picture to write, replacing an older one; its extension sets the format (`bilux list picture-formats`),
    /// `{stem}` stands for the scene's name, `{frame}` for the frame's number, and `-` writes to standard output
    #[arg(short, long, value_name = "OUT", required_unless_present = "replay", help_heading = help::COMMON_OPTIONS)]
    pub output: Option<PathBuf>,
    /// The width and height of the picture in pixels [default: 512x512]
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, help_heading = help::COMMON_OPTIONS)]
    pub size: Option<String>,
    /// Take N samples per pixel; the picture is then the same on every machine [default: stop at 2% noise or after 5
    /// seconds, whichever comes first]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_spp, help_heading = help::COMMON_OPTIONS)]
    pub spp: Option<u32>,
    /// Stop when the average noise is at most this fraction of the light, such as 2% or 0.02; 2% looks smooth
    #[arg(long, value_name = "REL", allow_hyphen_values = true, value_parser = parse_noise, help_heading = help::COMMON_OPTIONS)]
    pub noise: Option<f32>,
    /// Finish within this time, including reading and denoising; if that is impossible, Bilux says why
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse_seconds, help_heading = help::COMMON_OPTIONS)]
    pub time_limit: Option<f32>,
    /// The integrator, the algorithm that computes the light (`bilux list integrators`) [default: auto]
    #[arg(short, long, value_name = "NAME", help_heading = help::COMMON_OPTIONS)]
    pub integrator: Option<String>,
    /// The camera of the scene, by name or by number from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX", help_heading = help::COMMON_OPTIONS)]
    pub camera: Option<String>,
    #[command(flatten)]
    pub studio: StudioArguments,
    #[command(flatten)]
    pub choices: Choices,
    /// The format of the scene on standard input; auto detects it from the first bytes
    #[arg(long, value_name = "NAME|auto", default_value = "auto", help_heading = help::WHAT)]
    pub input_format: String,
    /// The time to show, in seconds, for animated scenes [default: 0]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse_time, help_heading = help::WHAT)]
    pub at: Option<f32>,
    /// Render frames A to B, inclusive, at 24 frames per second (`--set fps=30` changes that); with --turntable, only these of
    /// its pictures, from 0
    #[arg(long, value_name = "A-B", value_parser = parse_frames, help_heading = help::WHAT)]
    pub frames: Option<(u32, u32)>,
    /// Render N pictures from all around the model, a full turn
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_turntable, help_heading = help::STUDIO)]
    pub turntable: Option<u32>,
    /// Render only a window of the picture: its left and upper edge, its width and its height, in pixels
    #[arg(long, value_name = "X,Y,W,H", allow_hyphen_values = true, value_parser = parse_crop, help_heading = help::PICTURE)]
    pub crop: Option<[u32; 4]>,
    /// Brighten by this many stops (powers of two), or automatically to the brightness of a photograph
    /// [default: 0, or what a display needs to show the light that a glTF or OBJ file brings]
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true, value_parser = parse_exposure, help_heading = help::PICTURE)]
    pub exposure: Option<Exposure>,
    /// The tone-mapping curve (`bilux list tonemaps`) [default: auto]
    #[arg(long, value_name = "NAME", help_heading = help::PICTURE)]
    pub tonemap: Option<String>,
    /// Denoise with the best available denoiser, or with the one named (`bilux list denoisers`) [default: auto for
    /// display formats when noise or time ends the render, else off]
    #[arg(long, value_name = "auto|oidn|builtin|off", num_args = 0..=1, default_missing_value = "auto",
        require_equals = true, help_heading = help::PICTURE)]
    pub denoise: Option<String>,
    /// Render the cleanest picture that about a second allows, including reading and denoising; for thumbnails
    #[arg(long, conflicts_with_all = ["spp", "noise", "time_limit"], help_heading = help::SPEED)]
    pub fast: bool,
    /// Stop the whole command after this time and save the picture so far (exit status 124)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse_duration, help_heading = help::SPEED)]
    pub timeout: Option<Duration>,
    /// The seed of the random numbers; a different seed gives different noise [default: 0]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_seed, help_heading = help::PICTURE)]
    pub seed: Option<u64>,
    /// Take only samples A to B (B excluded) of each pixel, for a partial render in an .exr (`bilux merge`)
    #[arg(long, value_name = "A..B", conflicts_with = "turntable", value_parser = parse_samples, help_heading = help::PICTURE)]
    pub samples: Option<(u32, u32)>,
    /// Change any other setting (`bilux list settings`)
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = help::PICTURE)]
    pub set: Vec<String>,
    /// The maximum number of bounces; those inside milk and skin do not count; 0 shows only emitters [default: 16, or 8 with --fast]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_count, help_heading = help::LIGHT)]
    pub max_depth: Option<u32>,
    /// How `cast`, `whitted` and `cook` compute highlights: from the halfway vector of the paper's Equation 1, or from
    /// the reflected ray of its section 3.1 [default: halfway]
    #[arg(long, value_name = "halfway|reflect", help_heading = help::LIGHT)]
    pub specular: Option<String>,
    /// How `whitted` and `cook` compute shadows: dark where all lights are blocked, as in the paper, or per light
    /// [default: per-light]
    #[arg(long, value_name = "paper|per-light", help_heading = help::LIGHT)]
    pub shadow_rule: Option<String>,
    /// The number of threads; 0 uses all cores [default: 0]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_count, help_heading = help::SPEED)]
    pub threads: Option<u32>,
    /// The acceleration structure (`bilux list accels`) [default: auto]
    #[arg(long, value_name = "NAME", help_heading = help::SPEED)]
    pub accel: Option<String>,
    /// How much time building the acceleration structure may take [default: auto, by the number of samples per
    /// triangle]
    #[arg(long, value_name = "fast|balanced|best", help_heading = help::SPEED)]
    pub build: Option<String>,
    /// How `bsp` chooses its splitting planes [default: mean]
    #[arg(long, value_name = "mean|fuchs", help_heading = help::SPEED)]
    pub bsp_split: Option<String>,
    /// Whether `bsp` groups polygons or whole objects [default: polygons]
    #[arg(long, value_name = "polygons|objects", help_heading = help::SPEED)]
    pub bsp_group: Option<String>,
    /// The format of a picture on standard output (`bilux list picture-formats`) [default: png]
    #[arg(long, value_name = "NAME", requires = "output", help_heading = help::OUTPUT)]
    pub output_format: Option<String>,
    /// The bits per channel of PNG and PPM files
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = ["8", "16"], help_heading = help::OUTPUT)]
    pub bits: String,
    /// The quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_quality, help_heading = help::OUTPUT)]
    pub quality: Option<u8>,
    /// Write more outputs (`bilux list aovs`): most become layers of an .exr (of OUT.layers.exr if OUT is not an .exr),
    /// interval writes OUT.interval.exr, and strategies writes the folder OUT.strategies
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', help_heading = help::OUTPUT)]
    pub aov: Vec<String>,
    /// Divide the light by the optical length of paths: N intervals of WIDTH metres from BEGIN on become layers of
    /// OUT.lengths.exr, and what is outside of them the layer rest (path and bdpt)
    #[arg(long, value_name = "BEGIN,WIDTH,N", value_parser = parse_lengths, help_heading = help::OUTPUT)]
    pub lengths: Option<LengthBins>,
    /// Write all labels of the pixels' centres as such layers: distances, normals, ids, categories, motion and more
    #[arg(long, help_heading = help::OUTPUT)]
    pub labels: bool,
    /// Print one line of JSON per picture to standard output
    #[arg(long, help_heading = help::OUTPUT)]
    pub json: bool,
    /// Write statistics as JSON to a file, or to standard output with `-`; this counts every node visit and triangle
    /// test, which is slower
    #[arg(long, value_name = "FILE.json|-", help_heading = help::OUTPUT)]
    pub stats: Option<PathBuf>,
    #[command(flatten)]
    pub lasting: Lasting,
    /// Trace one sample of a pixel again and print what happens along its path; with --output, also render the picture and
    /// draw the path into it
    #[arg(long, value_name = "X,Y,SAMPLE", allow_hyphen_values = true, value_parser = parse_replay, help_heading = help::OUTPUT)]
    pub replay: Option<[u32; 3]>,
}

impl Render {
    /// The name of the picture. Where there is none, as with `--replay`, only text is written, to standard output.
    pub fn output_or_stdout(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new("-"))
    }

    /// The frames of an animation: those of a turntable are moments of none.
    pub fn moments(&self) -> Option<(u32, u32)> {
        self.frames.filter(|_| self.turntable.is_none())
    }

    /// The name of a picture, which says its format: on standard output one of its own.
    pub fn named(&self, output: &Path) -> PathBuf {
        crate::streams::named(output, self.output_format.as_deref())
    }

    /// True if only a part of the picture is rendered.
    pub fn is_part(&self) -> bool {
        self.samples.is_some() || self.crop.is_some()
    }
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
