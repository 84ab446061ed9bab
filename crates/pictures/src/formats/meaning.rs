//! Meaning of a file's samples: by a curve alone, or by a curve for each channel and primaries of its own.

use super::curve::Curve;
use super::primaries::Matrix;
use crate::{ColourSpace, Picture};

/// Meaning of the samples of colours.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meaning {
    /// The primaries of Rec. 709, by a curve that a picture can have.
    Plain(ColourSpace),
    /// Other primaries.
    Wide {
        /// From the samples of red, green and blue to light.
        curves: Box<[Curve; 3]>,
        /// From that light to light of the primaries of Rec. 709.
        matrix: Matrix,
    },
}

impl Meaning {
    pub(super) fn is_srgb(&self) -> bool {
        *self == Meaning::Plain(ColourSpace::Srgb)
    }

    /// Gives a picture this meaning: with other primaries its colours become linear. What Rec. 709 cannot show has a channel
    /// below 0, which no light has, and becomes 0; above 1 there is no bound.
    pub(super) fn apply(&self, picture: &mut Picture) {
        let (curves, matrix) = match self {
            Meaning::Plain(space) => return picture.colour_space = *space,
            Meaning::Wide { curves, matrix } => (curves, matrix),
        };
        picture.colour_space = ColourSpace::LinearRec709;
        let light = |curve: &Curve, samples: &[f32]| -> Vec<f32> {
            samples.iter().map(|sample| curve.light(f64::from(*sample)) as f32).collect()
        };
        if let Some(grey) = picture.channel_mut("Y") {
            let found = light(&curves[1], grey);
            grey.copy_from_slice(&found);
        }
        let [Some(r), Some(g), Some(b)] = ["R", "G", "B"].map(|name| picture.channel(name)) else { return };
        let planes = [light(&curves[0], r), light(&curves[1], g), light(&curves[2], b)];
        for (name, row) in ["R", "G", "B"].into_iter().zip(matrix) {
            let samples = picture.channel_mut(name).unwrap_or_default();
            for (i, sample) in samples.iter_mut().enumerate() {
                let sum: f64 = row.iter().zip(&planes).map(|(m, plane)| m * f64::from(plane[i])).sum();
                *sample = (sum as f32).max(0.0);
            }
        }
    }
}
