//! Measures how much of an image objects cover.

use bilux_math::transcendental::tan;
use bilux_math::{Vec2, Vec3};

/// A pinhole with a square film, y up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pinhole {
    eye: Vec3,
    axes: [Vec3; 3],
    tan_half_fov: f32,
}

impl Pinhole {
    /// Looks from `eye` to `look_at`, which must not be vertically above or below it; `fov` in degrees.
    pub(super) fn new(eye: Vec3, look_at: Vec3, fov: f32) -> Pinhole {
        let forward = (look_at - eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        Pinhole {
            eye,
            axes: [right, right.cross(forward), forward],
            tan_half_fov: tan(fov.to_radians() * 0.5),
        }
    }

    /// Projects a point to the image, where it is visible within -1..=1; `None` behind the eye.
    fn project(&self, p: Vec3) -> Option<Vec2> {
        let [x, y, z] = self.axes.map(|axis| axis.dot(p - self.eye));
        (z > 0.0).then(|| Vec2::new(x, y) / (z * self.tan_half_fov))
    }

    /// The fraction of the image that triangles cover, by the centres of `RESOLUTION²` pixels.
    pub(super) fn coverage(&self, triangles: impl Iterator<Item = [Vec3; 3]>) -> f64 {
        let mut mask = vec![false; RESOLUTION * RESOLUTION];
        for [a, b, c] in triangles {
            if let (Some(a), Some(b), Some(c)) = (self.project(a), self.project(b), self.project(c)) {
                fill(&mut mask, [a, b, c].map(|p| (p + Vec2::ONE) * (0.5 * RESOLUTION as f32)));
            }
        }
        mask.iter().filter(|&&covered| covered).count() as f64 / mask.len() as f64
    }
}

const RESOLUTION: usize = 128;

/// Marks the pixels whose centres are in a triangle, whose corners are in pixels.
fn fill(mask: &mut [bool], [a, b, c]: [Vec2; 3]) {
    let last = (RESOLUTION - 1) as f32;
    let (low, high) = (a.min(b).min(c) - 0.5, a.max(b).max(c) - 0.5);
    if high.x < 0.0 || high.y < 0.0 || low.x > last || low.y > last {
        return;
    }
    let (low, high) = (low.ceil().max(Vec2::ZERO), high.floor().min(Vec2::splat(last)));
    let side = |p: Vec2, q: Vec2, at: Vec2| (q - p).perp_dot(at - p);
    for y in low.y as usize..=high.y.max(0.0) as usize {
        for x in low.x as usize..=high.x.max(0.0) as usize {
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let sides = [side(a, b, at), side(b, c, at), side(c, a, at)];
            if sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0) {
                mask[y * RESOLUTION + x] = true;
            }
        }
    }
}
