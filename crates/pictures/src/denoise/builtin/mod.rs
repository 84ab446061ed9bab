//! `builtin`: a filter of our own, for where there is no other. Light is told from the surface that sends it on by dividing by
//! albedo, so that textures stay sharp; what is left is averaged over neighbours that show the same surface and, as far as
//! the noise lets one tell, the same light: small patches are compared, against the variance that is known of both.
//! Over wider and wider distances, with holes. [Dammertz 2010; Rousselle 2012; Schied 2017]

mod guides;
mod outliers;
mod pass;
mod planes;

use super::{Denoiser, DenoiserEntry, Layer, Noisy};
use crate::PictureError;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use guides::Guides;
use pass::pass;
use planes::{Light, Planes};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::time::Duration;

pub(super) const ENTRY: DenoiserEntry = DenoiserEntry {
    entry: Entry {
        name: "builtin",
        summary: "averages over what is alike by albedo, normal, depth and, as far as its variance tells, light",
        source: "Dammertz 2010",
        parameters: &[],
    },
    time: |pixels, threads| Duration::from_nanos(pixels.saturating_mul(900) / threads as u64),
    find: |threads| match Builtin::new(threads) {
        Ok(builtin) => Ok(Box::new(builtin)),
        Err(why) => Err(why.to_string()),
    },
};

/// Pixels between neighbours, pass by pass.
const STEPS: [usize; 4] = [1, 2, 4, 8];

/// No pass looks farther than this: two steps and half a patch.
const MARGIN: usize = 2 * 8 + 1;

pub(super) struct Builtin {
    pool: ThreadPool,
}

impl Builtin {
    pub(super) fn new(threads: usize) -> Result<Builtin, PictureError> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool =
            pool.map_err(|why| PictureError::NoDenoiser { what: format!("no threads for it: {why}") })?;
        Ok(Builtin { pool })
    }
}

impl Denoiser for Builtin {
    fn describe(&self) -> String {
        "the built-in filter".to_owned()
    }

    fn denoise(&self, noisy: &Noisy) -> Result<Vec<Rgb>, PictureError> {
        self.pool.install(|| {
            let guides = Guides::of(noisy)?;
            let mut sum = vec![Rgb::BLACK; noisy.pixels()];
            for layer in &noisy.layers {
                let smooth = smoothed(noisy, layer, &guides)?;
                sum.iter_mut().zip(smooth).for_each(|(sum, pixel)| *sum += pixel);
            }
            Ok(sum)
        })
    }
}

/// One layer without its noise.
fn smoothed(noisy: &Noisy, layer: &Layer, guides: &Guides) -> Result<Vec<Rgb>, PictureError> {
    let mut light = Light::of(noisy, layer)?;
    for step in STEPS {
        light = pass(&light, guides, step)?;
    }
    let back = |i: usize, light: Rgb| match &noisy.albedo {
        Some(albedo) => light * planes::divisor(albedo[i]),
        None => light,
    };
    let planes: &Planes = &light.planes;
    Ok((0..noisy.pixels()).map(|i| back(i, planes.rgb(i))).collect())
}
