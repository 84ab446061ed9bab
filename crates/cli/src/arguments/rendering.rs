//! The options of `bilux render`.

use super::help;
use crate::arguments::choices::Choices;
use crate::arguments::values::{
    Exposure, parse_count, parse_crop, parse_duration, parse_exposure, parse_frames, parse_lengths,
    parse_noise, parse_quality, parse_replay, parse_samples, parse_seconds, parse_seed, parse_spp,
    parse_time, parse_turntable,
};
use crate::arguments::{lasting::Lasting, studio::StudioArguments};
use bilux::transport::LengthBins;
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Duration;

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
        crate::arguments::streams::named(output, self.output_format.as_deref())
    }

    /// True if only a part of the picture is rendered.
    pub fn is_part(&self) -> bool {
        self.samples.is_some() || self.crop.is_some()
    }
}
