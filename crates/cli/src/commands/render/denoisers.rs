//! Whether a render uses a denoiser, and the libraries of denoisers, which load while scenes are read.

use crate::arguments::{Common, Render};
use anyhow::bail;
use bilux::pictures::denoise::preload;
use std::path::{Path, PathBuf};

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
    let is_given = |key: &str| arguments.settings.has(key);
    let may_use = match arguments.settings.text("denoise") {
        Some("auto" | "oidn") => true,
        Some(_) => false,
        // A fixed number of samples is not denoised, so its bytes never depend on a denoiser.
        None => !is_given("spp") || is_given("noise") || is_given("time_limit"),
    };
    may_use && arguments.samples.is_none() && arguments.crop.is_none()
}

/// Starts loading the denoisers' libraries while the scene is being read, if one is likely to be used. In a sandbox the
/// libraries are loaded before the first byte of a file is read, and none is loaded afterwards.
pub fn begin_loading(arguments: &Render, common: &Common) {
    if may_denoise(arguments) {
        load(arguments.settings.number("threads").unwrap_or(0.0) as usize, common);
    }
}

/// Loads the libraries; in a sandbox, waits until they are loaded.
pub fn load(threads: usize, common: &Common) {
    let loading = preload(threads);
    if common.sandbox {
        loading.wait();
    }
}
