//! The options of `bilux render`.

use super::help;
use crate::arguments::choices::Choices;
use crate::arguments::lasting::Lasting;
use crate::arguments::studio::StudioArguments;
use crate::arguments::tables::TableOptions;
use crate::arguments::tables::settings::OfPicture;
use crate::arguments::values::{
    parse_crop, parse_duration, parse_frames, parse_lengths, parse_quality, parse_replay, parse_samples,
    parse_turntable,
};
use anyhow::Context;
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
    #[command(flatten)]
    pub studio: StudioArguments,
    #[command(flatten)]
    pub settings: TableOptions<OfPicture>,
    #[command(flatten)]
    pub choices: Choices,
    /// The format of the scene on standard input; auto detects it from the first bytes
    #[arg(long, value_name = "NAME|auto", default_value = "auto", help_heading = help::WHAT)]
    pub input_format: String,
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
    /// Render the cleanest picture that about a second allows, including reading and denoising; for thumbnails
    #[arg(long, conflicts_with_all = ["spp", "noise", "time_limit"], display_order = 0, help_heading = help::SPEED)]
    pub fast: bool,
    /// Stop the whole command after this time and save the picture so far (exit status 124)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse_duration, help_heading = help::SPEED)]
    pub timeout: Option<Duration>,
    /// Take only samples A to B (B excluded) of each pixel, for a partial render in an .exr (`bilux merge`)
    #[arg(long, value_name = "A..B", conflicts_with = "turntable", value_parser = parse_samples, help_heading = help::PICTURE)]
    pub samples: Option<(u32, u32)>,
    /// Change any other setting (`bilux list settings`)
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = help::PICTURE)]
    pub set: Vec<String>,
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

    /// Refuses a tone curve that there is not.
    pub fn check_tonemap(&self) -> anyhow::Result<()> {
        match self.settings.text("tonemap").filter(|name| *name != "auto") {
            Some(curve) => bilux::pictures::tone_map(curve).map(drop).context("--tonemap"),
            None => Ok(()),
        }
    }

    /// True if only a part of the picture is rendered.
    pub fn is_part(&self) -> bool {
        self.samples.is_some() || self.crop.is_some()
    }
}
