//! The options of `bilux denoise`.

use crate::arguments::{Common, Render};
use crate::help;
use crate::values::{Exposure, parse_count, parse_exposure, parse_quality};
use anyhow::bail;
use bilux::pictures::denoise::preload;
use clap::Args;
use std::path::{Path, PathBuf};

/// Remove the noise from a picture
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux denoise noisy.exr -o clean.exr\n  \
    bilux denoise noisy.exr -o clean.png --tonemap agx\n  \
    bilux denoise photo.png -o clean.png --by builtin\n\n\
    The result is much better if the .exr has the layers albedo, normal, depth and variance. To write them:\n  \
    bilux render scene.toml -o noisy.exr --aov guides,variance")]
pub struct Denoise {
    /// The noisy picture
    pub input: PathBuf,
    /// The denoised picture to write; its extension sets the format
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// The layer to denoise, of an EXR that has several [default: its main picture]
    #[arg(long, value_name = "NAME", help_heading = help::PICTURE)]
    pub layer: Option<String>,
    /// The denoiser (`bilux list denoisers`)
    #[arg(long, value_name = "auto|oidn|builtin", default_value = "auto", help_heading = help::PICTURE)]
    pub by: String,
    /// Brighten display formats by this many stops (powers of two), or automatically to the brightness of a photograph
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true, default_value = "0",
        value_parser = parse_exposure, help_heading = help::PICTURE)]
    pub exposure: Exposure,
    /// The tone-mapping curve for display formats (`bilux list tonemaps`)
    #[arg(long, value_name = "NAME", default_value = "none", help_heading = help::PICTURE)]
    pub tonemap: String,
    /// The quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_quality, help_heading = help::OUTPUT)]
    pub quality: Option<u8>,
    /// The number of threads; 0 uses all cores
    #[arg(long, value_name = "N", allow_hyphen_values = true, default_value = "0", value_parser = parse_count,
        help_heading = help::SPEED)]
    pub threads: u32,
}

/// Refuses a denoiser's name that was taken for a scene because it follows `--denoise` after a space.
pub fn check_scenes(scenes: &[PathBuf]) -> anyhow::Result<()> {
    let line: Vec<_> = std::env::args_os().collect();
    let follows = |scene: &Path| line.windows(2).any(|pair| pair[0] == "--denoise" && pair[1] == scene);
    let is_denoiser = |scene: &&PathBuf| {
        bilux::settings::DENOISE.iter().chain(&["none"]).any(|name| scene.as_os_str() == *name)
    };
    let mistaken = scenes.iter().filter(is_denoiser).find(|name| follows(name) && !name.exists());
    if let Some(name) = mistaken {
        bail!(
            "--denoise {0}: '{0}' is not a scene file: write --denoise={0}, with an equals sign",
            name.display()
        );
    }
    Ok(())
}

/// True if a render is likely to use a denoiser.
pub fn may_denoise(arguments: &Render) -> bool {
    let may_use = match arguments.denoise.as_deref() {
        Some("auto" | "oidn") => true,
        Some(_) => false,
        // A fixed number of samples is not denoised, so its bytes never depend on a denoiser.
        None => arguments.spp.is_none() || arguments.noise.is_some() || arguments.time_limit.is_some(),
    };
    may_use && arguments.samples.is_none() && arguments.crop.is_none()
}

/// Starts loading the denoisers' libraries while the scene is being read, if one is likely to be used. In a sandbox the
/// libraries are loaded before the first byte of a file is read, and none is loaded afterwards.
pub fn begin_loading(arguments: &Render, common: &Common) {
    if may_denoise(arguments) {
        load(arguments.threads.unwrap_or(0) as usize, common);
    }
}

/// Loads the libraries; in a sandbox, waits until they are loaded.
pub fn load(threads: usize, common: &Common) {
    let loading = preload(threads);
    if common.sandbox {
        loading.wait();
    }
}
