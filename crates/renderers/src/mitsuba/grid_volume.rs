//! Volumes of Mitsuba that files of voxels give, also with a colour for each voxel: Bilux has one colour for a whole medium.

use bilux_import::appearance::filling::Density;
use bilux_math::{DVec3, Rgb};
use bilux_scene::media::Grid;
use std::sync::Arc;

/// The number of places in each direction, at most, of which means are made.
const PLACES: usize = 64;

/// A number for each voxel, and the channels of colours.
pub(super) struct GridVolume {
    /// The mean of the channels where there are three.
    pub(super) density: Density,
    /// Red, green and blue, or none.
    pub(super) channels: Vec<Arc<Grid>>,
}

impl GridVolume {
    /// The colour that, times the density, has the mean of each channel.
    pub(super) fn tint(&self) -> Rgb {
        let [r, g, b] = self.means(None);
        let mean = (r + g + b) / 3.0;
        if mean > 0.0 { Rgb::new(r / mean, g / mean, b / mean) } else { Rgb::WHITE }
    }

    /// The mean colour, where another volume is dense: each place counts as much as the density there.
    pub(super) fn mean_in(&self, other: Option<&GridVolume>) -> Rgb {
        let [r, g, b] = self.means(other);
        Rgb::new(r, g, b)
    }

    fn means(&self, weights: Option<&GridVolume>) -> [f32; 3] {
        let density = &self.density;
        let to_other = weights.map(|w| w.density.to_world.inverse() * density.to_world);
        let weight = |p: DVec3| match (weights, &to_other) {
            (Some(weights), Some(matrix)) => {
                f64::from(weights.density.grid.value(matrix.transform_point3(p).as_vec3()))
            }
            _ => 1.0,
        };
        let (mut sums, mut total) = ([0.0; 3], 0.0);
        for p in places(&density.grid) {
            let weight = weight(p);
            if weight <= 0.0 {
                continue;
            }
            total += weight;
            for (c, sum) in sums.iter_mut().enumerate() {
                let grid = self.channels.get(c).unwrap_or(&density.grid);
                *sum += weight * f64::from(grid.value(p.as_vec3()));
            }
        }
        if total > 0.0 { sums.map(|sum| (sum / total) as f32) } else { [density.grid.maximum(); 3] }
    }
}

/// Places in the space of a grid: the middles of its voxels, or of as many as [`PLACES`] allows.
fn places(grid: &Grid) -> impl Iterator<Item = DVec3> {
    let to_object = grid.to_object().matrix().as_dmat4();
    let counts = grid.size().map(|side| side.min(PLACES));
    let steps =
        DVec3::from(grid.size().map(|side| side as f64)) / DVec3::from(counts.map(|count| count as f64));
    let [x, y, z] = counts;
    (0..x * y * z).map(move |i| {
        let at = DVec3::new((i % x) as f64, (i / x % y) as f64, (i / x / y) as f64);
        to_object.transform_point3((at + 0.5) * steps)
    })
}
