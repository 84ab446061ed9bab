//! `oidn`: Open Image Denoise, where its library is found; nothing of it is linked. Albedo and normals are denoised first, by
//! themselves, and then taken as clean. [Áfra 2025]

mod library;
mod places;

use super::builtin::Builtin;
use super::{Denoiser, DenoiserEntry, Source};
use crate::PictureError;
use crate::limits::reserved;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use library::{Device, Image};
use std::time::Duration;

pub(super) const ENTRY: DenoiserEntry = DenoiserEntry {
    entry: Entry {
        name: "oidn",
        summary: "Open Image Denoise 2: a trained network, where its library is found",
        source: "Áfra 2025",
        parameters: &[],
    },
    time: |pixels, threads| BEGIN + Duration::from_nanos(pixels.saturating_mul(NANOSECONDS) / threads as u64),
    is_library: true,
    find,
};

/// How to get it, for people.
const ADVICE: &str = "Open Image Denoise does better: pip install pyoidn, or name its library in OIDN_LIB";

fn find(threads: usize) -> Result<Box<dyn Denoiser>, String> {
    let mut refused = None;
    for place in places::places() {
        match Device::open(&place, threads) {
            Ok(Some(device)) => return Ok(Box::new(Oidn { device, threads })),
            Ok(None) => {}
            Err(why) => refused = refused.or(Some(why)),
        }
    }
    // What was found and does not work is said; that nothing was found needs no reason.
    Err(refused.map_or(ADVICE.to_owned(), |why| format!("{ADVICE} ({why})")))
}

/// Of smaller pictures the network makes another brightness.
const LEAST_SIDE: usize = 16;

/// What it takes to begin with, and for a pixel on one thread, about: three networks, one after the other.
const BEGIN: Duration = Duration::from_millis(700);
const NANOSECONDS: u64 = 6200;

struct Oidn {
    device: Device,
    threads: usize,
}

impl Denoiser for Oidn {
    fn describe(&self) -> String {
        self.device.describe()
    }

    fn denoise(&self, source: &dyn Source) -> Result<Vec<Rgb>, PictureError> {
        let size = source.size();
        if size.0.min(size.1) < LEAST_SIDE {
            return Builtin::new(self.threads)?.denoise(source);
        }
        let noisy = source.rows(0..size.1)?;
        let image = |plane: &[Rgb]| Image::new(size, plane.iter().map(|c| c.to_array()));
        let failed = |what: String| PictureError::NoDenoiser { what: format!("Open Image Denoise: {what}") };
        let albedo = noisy.albedo.as_deref().map(image).transpose()?;
        let normal = noisy.normal.as_deref().map(|n| Image::new(size, n.iter().copied())).transpose()?;
        let clean = |name: &str, plane: Option<Image>| {
            plane.map(|plane| self.device.filter(&[(name, &plane)], false).map_err(failed)).transpose()
        };
        // Normals help only beside albedo.
        let albedo = clean("albedo", albedo)?;
        let normal = clean("normal", normal.filter(|_| albedo.is_some()))?;
        let mut sum: Vec<Rgb> = reserved("denoising", noisy.pixels())?;
        sum.resize(noisy.pixels(), Rgb::BLACK);
        for layer in &noisy.layers {
            let colour = image(&layer.colour)?;
            let mut inputs = vec![("color", &colour)];
            inputs.extend(albedo.as_ref().map(|plane| ("albedo", plane)));
            inputs.extend(normal.as_ref().map(|plane| ("normal", plane)));
            let smooth = self.device.filter(&inputs, true).map_err(failed)?;
            sum.iter_mut().zip(smooth.pixels()).for_each(|(sum, pixel)| *sum += Rgb::from_array(pixel));
        }
        Ok(sum)
    }
}
