//! Guide features that distinguish surfaces, whatever light falls on them.

use super::planes::Planes;
use crate::PictureError;
use crate::denoise::Noisy;
use bilux_math::Rgb;

/// The planes: within the picture the fraction of the pixel that is not background, and 0 beyond; albedo; normals; depth, its slope across columns and down rows, and
/// the reciprocal of the expected depth difference between neighbours; and inverse depth, 0 where nothing is visible.
pub(super) struct Guides {
    pub(super) planes: Planes,
    /// The share of haze; `None` where there is none.
    pub(super) haze: Option<Planes>,
}

/// Index of each guide's first plane.
pub(super) const WITHIN: usize = 0;
pub(super) const ALBEDO: usize = 1;
pub(super) const NORMAL: usize = 4;
pub(super) const DEPTH: usize = 7;
pub(super) const SLOPE: usize = 8;
pub(super) const TIGHTNESS: usize = 10;
pub(super) const INVERSE: usize = 11;
const COUNT: usize = 12;

/// Surfaces closer to each other than this, relative to their distance, may be the same.
const NEAR: f32 = 0.005;

impl Guides {
    /// Missing layers are constant.
    pub(super) fn of(noisy: &Noisy, coverage: Option<&[f32]>) -> Result<Guides, PictureError> {
        let (width, height) = (noisy.width, noisy.height);
        let depth = |i: usize| {
            noisy.depth.as_ref().map_or(1.0, |depth| if depth[i].is_finite() { depth[i] } else { 0.0 })
        };
        let mut planes = Planes::filled((width, height), |i| {
            let albedo = noisy.albedo.as_ref().map_or([1.0; 3], |albedo| albedo[i].to_array());
            let [nx, ny, nz] = noisy.normal.as_ref().map_or([0.0; 3], |normal| normal[i]);
            let (x, y) = (i % width, i / width);
            let row = [x.checked_sub(1).map(|_| i - 1), (x + 1 < width).then_some(i + 1)];
            let column = [y.checked_sub(1).map(|_| i - width), (y + 1 < height).then_some(i + width)];
            let slope = |[before, after]: [Option<usize>; 2]| {
                let z = depth(i);
                gentler(before.map(|j| z - depth(j)), after.map(|j| depth(j) - z))
            };
            let (across, down) = (slope(row), slope(column));
            let may_differ = NEAR * depth(i) + 0.5 * (across.abs() + down.abs()) + f32::MIN_POSITIVE;
            let [r, g, b] = albedo;
            let inverse = if depth(i) > 0.0 { (1.0 / depth(i)).min(1e9) } else { 0.0 };
            [1.0, r, g, b, nx, ny, nz, depth(i), across, down, (1.0 / may_differ).min(1e9), inverse]
        })?;
        debug_assert_eq!(planes.planes.len(), COUNT);
        planes.planes[WITHIN] = {
            let mut within = vec![0.0; planes.planes[WITHIN].len()];
            for y in 0..height {
                let first = planes.index(0, y);
                let row = &mut within[first..first + width];
                match coverage {
                    Some(coverage) => row.copy_from_slice(&coverage[y * width..(y + 1) * width]),
                    None => row.fill(1.0),
                }
            }
            within
        };
        let haze = noisy.haze.as_ref().filter(|haze| haze.iter().any(|&share| share > 0.0));
        let haze = haze.map(|haze| Planes::filled((width, height), |i| [haze[i]])).transpose()?;
        Ok(Guides { planes, haze })
    }

    /// The albedo at an index of the planes.
    pub(super) fn albedo(&self, i: usize) -> Rgb {
        let [r, g, b] = [0, 1, 2].map(|c| self.planes.planes[ALBEDO + c][i]);
        Rgb::new(r, g, b)
    }
}

/// The gentler of two slopes: the other may cross an edge.
fn gentler(a: Option<f32>, b: Option<f32>) -> f32 {
    match (a, b) {
        (Some(a), Some(b)) => {
            if a.abs() < b.abs() {
                a
            } else {
                b
            }
        }
        (one, other) => one.or(other).unwrap_or(0.0),
    }
}
