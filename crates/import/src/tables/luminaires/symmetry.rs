//! The planes that a file leaves out, because they are mirror images of others.

use super::words::Words;
use crate::FormatError;
use bilux_scene::{Goniometer, IntensityDistribution};

/// Measured planes, each with its azimuth in degrees and its intensities in candela from the first polar angle to the last.
#[derive(Clone, Debug, Default)]
pub(super) struct Planes(pub(super) Vec<(f64, Vec<f32>)>);

impl Planes {
    /// Planes from azimuths and intensities, all of the first plane first.
    pub(super) fn new(azimuths: &[f64], candela: &[f32]) -> Planes {
        let each = candela.len() / azimuths.len().max(1);
        let planes = candela.chunks_exact(each.max(1)).map(<[f32]>::to_vec);
        Planes(azimuths.iter().copied().zip(planes).collect())
    }

    /// With the mirror images of all planes but the last or the first, which lies in the mirror.
    pub(super) fn mirrored(mut self, about: f64) -> Planes {
        let images = self.0.iter().filter(|(azimuth, _)| *azimuth != about);
        let images: Vec<_> = images.map(|(azimuth, plane)| (2.0 * about - azimuth, plane.clone())).collect();
        self.0.extend(images);
        self.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        self
    }

    /// With the mirror image of each plane, whose first polar angle lies in the mirror.
    pub(super) fn with_both_sides(self) -> Planes {
        let both = |plane: Vec<f32>| both_sides(&plane, |candela| candela);
        Planes(self.0.into_iter().map(|(azimuth, plane)| (azimuth, both(plane))).collect())
    }

    /// With the first plane once more, a turn later.
    pub(super) fn closed(mut self) -> Planes {
        if let Some((first, plane)) = self.0.first().cloned() {
            self.0.push((first + 360.0, plane));
        }
        self
    }

    /// The distribution that they describe.
    pub(super) fn distribution(
        self,
        name: &str,
        goniometer: Goniometer,
        polar: Vec<f64>,
        words: &Words,
    ) -> Result<IntensityDistribution, FormatError> {
        let azimuths = self.0.iter().map(|(azimuth, _)| *azimuth).collect();
        let candela = self.0.into_iter().flat_map(|(_, plane)| plane).collect();
        let distribution = IntensityDistribution::new(name, goniometer, azimuths, polar, candela);
        distribution.map_err(|why| words.wrong_file(why))
    }
}

/// Numbers with the images of all but the first before them, in reverse order.
pub(super) fn both_sides<T: Copy>(numbers: &[T], image: impl Fn(T) -> T) -> Vec<T> {
    numbers.iter().skip(1).rev().map(|number| image(*number)).chain(numbers.iter().copied()).collect()
}
