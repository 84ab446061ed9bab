//! A perspective camera without a lens that does not move: what is needed to compute many of its rays at once.

use bilux_math::{Vec2, Vec3};

/// All of its rays start at one point.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    /// Point at which the rays start.
    pub position: Vec3,
    /// To the right and upwards along the film, and to its middle at distance 1. They are unit vectors and perpendicular unless
    /// the film is shifted or skewed: each such film is what an oblique frame makes of a plain one, at no cost for the plain one.
    pub(super) axes: [Vec3; 3],
    /// Half the height of the film at distance 1.
    pub(super) tan_half_fov: f32,
    /// Width over height; negative when mirrored.
    pub(super) aspect: f32,
}

impl Pinhole {
    /// The direction, not normalised, to a point of the film (0..=1 on both axes, y downwards) at distance 1.
    #[inline(always)]
    pub(super) fn through(&self, film: Vec2) -> Vec3 {
        let [right, up, forward] = self.axes;
        let x = (2.0 * film.x - 1.0) * self.tan_half_fov * self.aspect;
        let y = (1.0 - 2.0 * film.y) * self.tan_half_fov;
        right * x + up * y + forward
    }

    /// The unit direction of the ray through a point of the film. Compiles to vector instructions in a loop.
    #[inline(always)]
    pub fn direction(&self, film: Vec2) -> Vec3 {
        let through = self.through(film);
        through * (1.0 / through.length_squared().sqrt())
    }
}
