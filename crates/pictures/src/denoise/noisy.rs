//! The input of a denoiser.

use crate::limits::reserved;
use crate::{Picture, PictureError};
use bilux_math::Rgb;
use std::collections::VecDeque;
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
    /// The fraction of each pixel that is not background, 0..=1, of a picture that was cut out; its light is
    /// multiplied by it.
    pub coverage: Option<Vec<f32>>,
    /// The fraction of light that surfaces reflect, 0..=1.
    pub albedo: Option<Vec<Rgb>>,
    /// Shading normals, zero where nothing is visible.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Metres from the camera; infinite where nothing is visible.
    pub depth: Option<Vec<f32>>,
    /// The share of each pixel that fog, smoke, milk or skin show, 0..=1: light without sharp edges.
    pub haze: Option<Vec<f32>>,
}

/// A part of the picture.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Light of the layer.
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
        let plane = |names: [&str; 2]| {
            let plane = names.into_iter().find_map(|name| picture.channel(name));
            plane.map(|plane| plane[pixels.clone()].to_vec())
        };
        let coverage = plane(["guides.A", "A"]);
        // Layers that are not meant as guides are second best: normals and depths do not know mixtures, and the albedo is
        // multiplied by alpha.
        let normal = match rgb(["guides.X", "guides.Y", "guides.Z"])? {
            Some(normal) => Some(normal),
            None => rgb(["normal.X", "normal.Y", "normal.Z"])?,
        };
        let mut albedo = rgb(["guides.R", "guides.G", "guides.B"])?;
        if albedo.is_none() {
            albedo = rgb(["albedo.R", "albedo.G", "albedo.B"])?;
            if let (Some(albedo), Some(coverage)) = (&mut albedo, &coverage) {
                divide(albedo, coverage, |coverage| coverage);
            }
        }
        let noisy = Noisy {
            width,
            height,
            layers,
            coverage,
            albedo,
            normal: normal.map(|plane| plane.into_iter().map(|n| n.to_array()).collect()),
            depth: plane(["guides.depth", "depth.Z"]),
            haze: plane(["guides.haze", "guides.haze"]),
        };
        Ok(noisy.separated())
    }

    /// Takes the other layers out of the first, which is still the whole picture, and makes every value finite; none has been
    /// checked before. Pixels that are not finite become black, without affecting anything else.
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
        for haze in self.haze.iter_mut().flatten() {
            *haze = if haze.is_finite() { haze.clamp(0.0, 1.0) } else { 0.0 };
        }
        for coverage in self.coverage.iter_mut().flatten() {
            *coverage = if coverage.is_finite() { coverage.clamp(0.0, 1.0) } else { 0.0 };
        }
        self.coverage = self.coverage.filter(|coverage| coverage.iter().any(|&coverage| coverage < 1.0));
        self
    }

    /// Divides light by the coverage, and takes that out: in a cut-out, light varies with the coverage, which has no noise
    /// that is independent of it. Where nothing covers the pixel, light stays as it is.
    pub(super) fn take_coverage(&mut self) -> Option<Vec<f32>> {
        let coverage = self.coverage.take()?;
        for layer in &mut self.layers {
            divide(&mut layer.colour, &coverage, |coverage| coverage);
            if let Some(variance) = &mut layer.variance {
                divide(variance, &coverage, |coverage| coverage * coverage);
            }
        }
        Some(coverage)
    }

    /// Extends everything beyond the outline of a cut-out: a denoiser that knows no coverage would mix the background in.
    pub(super) fn extend(&mut self, coverage: &[f32]) {
        let nearest = nearest_covered(coverage, self.width);
        for layer in &mut self.layers {
            extend(&mut layer.colour, &nearest);
        }
        self.albedo.iter_mut().for_each(|albedo| extend(albedo, &nearest));
        self.normal.iter_mut().for_each(|normal| extend(normal, &nearest));
    }

    /// Total number of pixels.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }
}

/// Divides colours where something covers the pixel.
fn divide(colours: &mut [Rgb], coverage: &[f32], by: fn(f32) -> f32) {
    for (colour, &coverage) in colours.iter_mut().zip(coverage) {
        if coverage > 0.0 {
            *colour = *colour / by(coverage);
        }
    }
}

/// For each pixel of a picture of this width, the nearest that is mostly covered, counted in steps to neighbours; itself if it is
/// covered at all, or none is.
fn nearest_covered(coverage: &[f32], width: usize) -> Vec<usize> {
    const MOSTLY: f32 = 0.5;
    const UNKNOWN: usize = usize::MAX;
    let mut nearest = vec![UNKNOWN; coverage.len()];
    let mut waiting: VecDeque<usize> = (0..coverage.len()).filter(|&i| coverage[i] >= MOSTLY).collect();
    waiting.iter().for_each(|&i| nearest[i] = i);
    while let Some(i) = waiting.pop_front() {
        let (x, below) = (i % width, i + width);
        let beside = [(x > 0).then(|| i - 1), (x + 1 < width).then_some(i + 1)];
        let across = [i.checked_sub(width), (below < coverage.len()).then_some(below)];
        for j in beside.into_iter().chain(across).flatten() {
            if nearest[j] == UNKNOWN {
                nearest[j] = nearest[i];
                waiting.push_back(j);
            }
        }
    }
    let own = |(i, nearest)| if coverage[i] > 0.0 || nearest == UNKNOWN { i } else { nearest };
    nearest.into_iter().enumerate().map(own).collect()
}

fn extend<T: Copy>(pixels: &mut [T], nearest: &[usize]) {
    for (i, &from) in nearest.iter().enumerate() {
        pixels[i] = pixels[from];
    }
}

/// Multiplies denoised light by the coverage that it was divided by.
pub(super) fn multiply(light: &mut [Rgb], coverage: Option<&[f32]>) {
    for (light, &coverage) in light.iter_mut().zip(coverage.unwrap_or_default()) {
        *light *= coverage;
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
