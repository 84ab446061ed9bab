//! What a denoiser is given.

use crate::limits::reserved;
use crate::{Picture, PictureError};
use bilux_math::Rgb;
use std::ops::Range;

/// Where a denoiser gets its picture from, as many rows at a time as it has use for: of a large picture, all that denoisers go
/// by is several times as large.
pub trait Source: Sync {
    /// Pixels across and down.
    fn size(&self) -> (usize, usize);

    /// Some rows, counted from the top one, as a picture of their own.
    ///
    /// # Errors
    /// When there are no colours, or the machine has no room.
    fn rows(&self, rows: Range<usize>) -> Result<Noisy, PictureError>;
}

/// A linear picture, with its layers.
impl Source for Picture {
    fn size(&self) -> (usize, usize) {
        (self.width(), self.height())
    }

    fn rows(&self, rows: Range<usize>) -> Result<Noisy, PictureError> {
        Noisy::of(self, rows)
    }
}

/// A noisy picture and what is known of what it shows; all in rows, the top one first, all linear and finite.
#[derive(Clone, Debug)]
pub struct Noisy {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// What adds up to the picture: first what camera paths have brought, then, if there is any, what light paths have left. Each has its own noise.
    pub layers: Vec<Layer>,
    /// The part of the light that surfaces send on, 0..=1.
    pub albedo: Option<Vec<Rgb>>,
    /// Shading normals, zero where nothing is seen.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Metres from the camera; infinite where nothing is seen.
    pub depth: Option<Vec<f32>>,
}

/// A part of the picture.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its light.
    pub colour: Vec<Rgb>,
    /// The variance of each pixel, as far as one estimate of it tells.
    pub variance: Option<Vec<Rgb>>,
}

/// What it is called in messages.
const NAME: &str = "denoising";

impl Noisy {
    /// What some rows of a linear picture's layers tell.
    ///
    /// # Errors
    /// When it has no colours, or the machine has no room.
    pub fn of(picture: &Picture, rows: Range<usize>) -> Result<Noisy, PictureError> {
        let (width, height) = (picture.width(), rows.len());
        let pixels = rows.start * width..rows.end * width;
        let rgb = |names: [&str; 3]| match names.map(|name| picture.channel(name)) {
            [Some(r), Some(g), Some(b)] => joined([r, g, b].map(|plane| &plane[pixels.clone()])).map(Some),
            _ => Ok(None),
        };
        let Some(planes) = picture.rgb_planes() else {
            let what = "there is nothing to denoise without the channels R, G and B, or Y";
            return Err(PictureError::Malformed(what.to_owned()));
        };
        let mut colour = joined(planes.map(|plane| &plane[pixels.clone()]))?;
        let mut light = rgb(["light.R", "light.G", "light.B"])?;
        for (i, colour) in colour.iter_mut().enumerate() {
            // What is infinite is left out, and nothing else with it.
            if !colour.is_finite() {
                *colour = Rgb::BLACK;
                continue;
            }
            if let Some(light) = &mut light {
                light[i] = if light[i].is_finite() { light[i] } else { Rgb::BLACK };
                *colour = *colour - light[i];
            }
        }
        let variance = rgb(["variance.R", "variance.G", "variance.B"])?;
        let mut layers = vec![Layer { colour, variance: variance.map(tamed) }];
        if let Some(colour) = light {
            let variance = rgb(["light_variance.R", "light_variance.G", "light_variance.B"])?;
            layers.push(Layer { colour, variance: variance.map(tamed) });
        }
        let normal = rgb(["normal.X", "normal.Y", "normal.Z"])?.map(tamed);
        Ok(Noisy {
            width,
            height,
            layers,
            albedo: rgb(["albedo.R", "albedo.G", "albedo.B"])?
                .map(|plane| tamed(plane).into_iter().map(|c| c.clamp(0.0, 1.0)).collect()),
            normal: normal.map(|plane| plane.into_iter().map(|n| n.to_array()).collect()),
            depth: picture.channel("depth.Z").map(|depth| depth[pixels.clone()].to_vec()),
        })
    }

    /// Pixels in all.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }
}

/// Three planes as one.
fn joined([r, g, b]: [&[f32]; 3]) -> Result<Vec<Rgb>, PictureError> {
    let mut all = reserved(NAME, r.len())?;
    all.extend(r.iter().zip(g).zip(b).map(|((&r, &g), &b)| Rgb::new(r, g, b)));
    Ok(all)
}

/// Without what is not finite.
fn tamed(mut plane: Vec<Rgb>) -> Vec<Rgb> {
    plane.iter_mut().filter(|c| !c.is_finite()).for_each(|c| *c = Rgb::BLACK);
    plane
}
