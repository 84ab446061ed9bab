//! What `bilux denoise` is told.

use crate::arguments::{Common, Render};
use crate::values::{Exposure, parse_exposure};
use anyhow::bail;
use bilux::pictures::denoise::preload;
use clap::Args;
use std::path::PathBuf;

/// Take the noise out of a picture. The layers albedo, normal, depth and variance help much, where it has them: `bilux render
/// --aov albedo,normal,depth,variance`.
#[derive(Args)]
#[command(after_help = "Examples:\n  bilux denoise noisy.exr -o smooth.exr\n  \
    bilux denoise noisy.exr -o smooth.png --tonemap agx\n  \
    bilux denoise photo.png -o smooth.png --by builtin")]
pub struct Denoise {
    /// The noisy picture
    pub input: PathBuf,
    /// The smooth one
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// What takes the noise away (`bilux list denoisers`)
    #[arg(long, value_name = "auto|oidn|builtin", default_value = "auto")]
    pub by: String,
    /// Threads; 0 for all cores
    #[arg(long, value_name = "N", default_value = "0")]
    pub threads: usize,
    /// Brighten by powers of two, in pictures for a display; or to the brightness of a photograph
    #[arg(long, value_name = "EV|auto", allow_negative_numbers = true, default_value = "0",
        value_parser = parse_exposure)]
    pub exposure: Exposure,
    /// Tone curve, in pictures for a display (`bilux list tonemaps`)
    #[arg(long, value_name = "NAME", default_value = "none")]
    pub tonemap: String,
}

/// Finds out whether a denoiser is taken for a scene, since it stands apart from its flag.
pub fn check_scenes(scenes: &[PathBuf]) -> anyhow::Result<()> {
    let is_denoiser =
        |scene: &&PathBuf| bilux::settings::DENOISE.iter().any(|name| scene.as_os_str() == *name);
    if let Some(name) = scenes.iter().find(is_denoiser).filter(|name| !name.exists()) {
        bail!("'{0}' is no scene: write --denoise={0}, with the sign between", name.display());
    }
    Ok(())
}

/// Begins to load the libraries of denoisers, while the scene is read, where one is likely to be used. In a sandbox they are loaded
/// before the first byte of a file is read, and none is loaded after that.
pub fn begin_loading(arguments: &Render, common: &Common) {
    let may_use = match arguments.denoise.as_deref() {
        Some("auto" | "oidn") => true,
        Some(_) => false,
        // A number of samples gives the same bytes as ever.
        None => arguments.spp.is_none() || arguments.noise.is_some() || arguments.time_limit.is_some(),
    };
    if may_use && arguments.samples.is_none() && arguments.crop.is_none() {
        load(arguments.threads.unwrap_or(0) as usize, common);
    }
}

/// Loads them, or in a sandbox waits until they are loaded.
pub fn load(threads: usize, common: &Common) {
    let loading = preload(threads);
    if common.sandbox {
        loading.wait();
    }
}
