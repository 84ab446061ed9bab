//! How a picture is looked up: beyond its edges, between its texels, and where it lies.

use bilux_math::Vec2;
use bilux_math::transcendental::{atan2, cos, sin};

/// What lies beyond an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture again, every second time the other way round.
    Mirror,
    /// The texel at the edge.
    Clamp,
}

/// What lies between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// A blend of the four around.
    #[default]
    Linear,
    /// The nearest.
    Nearest,
}

impl Wrap {
    /// The texels of a row of `n` at a coordinate rounded down, and at the next.
    #[inline]
    pub(super) fn pair(self, x: f32, n: usize) -> [usize; 2] {
        let n = n as i64;
        // Beyond this, numbers of 32 bits are even, and sums of two do not overflow.
        let first = (x.floor() as i64).clamp(-1 << 40, 1 << 40);
        [first, first + 1].map(|i| match self {
            Wrap::Repeat => i.rem_euclid(n) as usize,
            Wrap::Mirror => {
                let i = i.rem_euclid(2 * n);
                i.min(2 * n - 1 - i) as usize
            }
            Wrap::Clamp => i.clamp(0, n - 1) as usize,
        })
    }
}

/// Where a picture lies: texture coordinates, with v downwards, are scaled, turned and shifted before it is looked up, as
/// `KHR_texture_transform` of glTF has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    u: Vec2,
    v: Vec2,
    offset: Vec2,
}

impl UvTransform {
    /// Scale first, then a turn in radians, then a shift.
    pub fn new(offset: [f32; 2], radians: f32, scale: [f32; 2]) -> UvTransform {
        let (s, c) = (sin(radians), cos(radians));
        let [x, y] = scale;
        UvTransform { u: Vec2::new(c, -s) * x, v: Vec2::new(s, c) * y, offset: Vec2::from(offset) }
    }

    /// The shift, the turn in radians and the scale that it was made of.
    pub fn parts(&self) -> ([f32; 2], f32, [f32; 2]) {
        let turn = atan2(-self.u.y, self.u.x);
        let sign = if self.u.perp_dot(self.v) < 0.0 { -1.0 } else { 1.0 };
        (self.offset.to_array(), turn, [self.u.length(), self.v.length() * sign])
    }

    /// Moves coordinates.
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        self.u * uv.x + self.v * uv.y + self.offset
    }

    /// How wide along either coordinate is what was so wide.
    #[inline]
    pub(super) fn widen(&self, width: Vec2) -> Vec2 {
        let (u, v) = (self.u * width.x, self.v * width.y);
        Vec2::new(Vec2::new(u.x, v.x).length(), Vec2::new(u.y, v.y).length())
    }
}
