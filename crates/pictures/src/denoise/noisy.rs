//! The input of a denoiser.

use crate::limits::reserved;
use crate::{Picture, PictureError};
use bilux_math::Rgb;
use std::ops::Range;

/// Supplies a denoiser with its picture, as many rows at a time as it needs: for a large picture, the complete input
/// of a denoiser is several times as large.
pub trait Source: Sync {
    /// Width and height in pixels.
    fn size(&self) -> (usize, usize);

    /// Some rows, counted from the top, as a picture of their own.
    ///
    /// # Errors
    /// Returns an error when there are no colours, or the machine has no memory left.
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

/// A noisy picture and the known features of what it shows; all in rows from the top, all linear and finite.
#[derive(Clone, Debug)]
pub struct Noisy {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// The parts whose sum is the picture: first the contribution of camera paths, then, if present, the splats of
    /// light paths. Each has its own noise.
    pub layers: Vec<Layer>,
    /// The fraction of light that surfaces reflect, 0..=1.
    pub albedo: Option<Vec<Rgb>>,
    /// Shading normals, zero where nothing is visible.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Metres from the camera; infinite where nothing is visible.
    pub depth: Option<Vec<f32>>,
}

/// A part of the picture.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its light.
    pub colour: Vec<Rgb>,
    /// The variance of each pixel, as a single estimate.
    pub variance: Option<Vec<Rgb>>,
}

/// The name used in messages.
const NAME: &str = "denoising";

impl Noisy {
    /// Extracts the input from some rows of a linear picture's layers.
    ///
    /// # Errors
    /// Returns an error when the picture has no colours, or the machine has no memory left.
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
        let colour = joined(planes.map(|plane| &plane[pixels.clone()]))?;
        let mut layers = vec![Layer { colour, variance: rgb(["variance.R", "variance.G", "variance.B"])? }];
        if let Some(colour) = rgb(["light.R", "light.G", "light.B"])? {
            let variance = rgb(["light_variance.R", "light_variance.G", "light_variance.B"])?;
            layers.push(Layer { colour, variance });
        }
        let normal = rgb(["normal.X", "normal.Y", "normal.Z"])?;
        let noisy = Noisy {
            width,
            height,
            layers,
            albedo: rgb(["albedo.R", "albedo.G", "albedo.B"])?,
            normal: normal.map(|plane| plane.into_iter().map(|n| n.to_array()).collect()),
            depth: picture.channel("depth.Z").map(|depth| depth[pixels.clone()].to_vec()),
        };
        Ok(noisy.separated())
    }

    /// The same where the first layer is still the whole picture, and nothing has been checked: takes the other layers out of the
    /// first, and makes every value finite. Pixels that are not finite become black, without affecting anything else.
    pub fn separated(mut self) -> Noisy {
        if let [whole, parts @ ..] = &mut *self.layers {
            for part in parts {
                part.colour.iter_mut().for_each(finite_or_black);
                whole.colour.iter_mut().zip(&part.colour).for_each(|(whole, part)| *whole = *whole - *part);
            }
            whole.colour.iter_mut().for_each(finite_or_black);
        }
        let variances = self.layers.iter_mut().filter_map(|layer| layer.variance.as_mut());
        variances.flatten().for_each(finite_or_black);
        for albedo in self.albedo.iter_mut().flatten() {
            finite_or_black(albedo);
            *albedo = albedo.clamp(0.0, 1.0);
        }
        let normals = self.normal.iter_mut().flatten();
        normals.filter(|n| !n.iter().all(|x| x.is_finite())).for_each(|n| *n = [0.0; 3]);
        self
    }

    /// Total number of pixels.
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

fn finite_or_black(colour: &mut Rgb) {
    if !colour.is_finite() {
        *colour = Rgb::BLACK;
    }
}
