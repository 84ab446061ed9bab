//! Image look-up: beyond the edges, between texels, and by placement.

use bilux_math::Vec2;
use bilux_math::transcendental::{atan2, cos, sin};

/// The values beyond an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// The image repeats, mirrored every second time.
    Mirror,
    /// The texel at the edge.
    Clamp,
}

/// The values between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// Bilinear interpolation of the four nearest texels.
    #[default]
    Linear,
    /// The nearest texel.
    Nearest,
}

impl Wrap {
    /// The indices, in a row of `n` texels, at a coordinate rounded down and at the next one, and the fraction by which it
    /// was rounded.
    #[inline]
    pub(super) fn pair(self, x: f32, n: usize) -> ([usize; 2], f32) {
        // Most look-ups are inside the image, where nothing wraps. At old instruction-set levels `f32::floor` is a call.
        if x >= 0.0 && x < (n.min(1 << 23) as f32) - 1.0 {
            let first = x as usize;
            return ([first, first + 1], x - first as f32);
        }
        (self.wrapped_pair(x, n), x - x.floor())
    }

    #[inline(never)]
    fn wrapped_pair(self, x: f32, n: usize) -> [usize; 2] {
        let n = n as i64;
        // Beyond this, 32-bit numbers are even, and sums of two do not overflow.
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

/// The placement of an image: texture coordinates, with v downwards, are scaled, rotated and translated before the
/// look-up, as in glTF's `KHR_texture_transform`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    u: Vec2,
    v: Vec2,
    offset: Vec2,
}

impl UvTransform {
    /// Scales first, then rotates by an angle in radians, then translates.
    pub fn new(offset: [f32; 2], radians: f32, scale: [f32; 2]) -> UvTransform {
        let (s, c) = (sin(radians), cos(radians));
        let [x, y] = scale;
        UvTransform { u: Vec2::new(c, -s) * x, v: Vec2::new(s, c) * y, offset: Vec2::from(offset) }
    }

    /// The translation, the rotation in radians and the scale from which it was made.
    pub fn parts(&self) -> ([f32; 2], f32, [f32; 2]) {
        let turn = atan2(-self.u.y, self.u.x);
        let sign = if self.u.perp_dot(self.v) < 0.0 { -1.0 } else { 1.0 };
        (self.offset.to_array(), turn, [self.u.length(), self.v.length() * sign])
    }

    /// Numbers of the placement, to the bit: the factors of u, those of v, and the translation.
    pub fn to_array(&self) -> [f32; 6] {
        [self.u.x, self.u.y, self.v.x, self.v.y, self.offset.x, self.offset.y]
    }

    /// The placement of these numbers.
    pub fn from_array([a, b, c, d, x, y]: [f32; 6]) -> UvTransform {
        UvTransform { u: Vec2::new(a, b), v: Vec2::new(c, d), offset: Vec2::new(x, y) }
    }

    /// Transforms coordinates.
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        self.u * uv.x + self.v * uv.y + self.offset
    }

    /// The transformed width along each coordinate.
    #[inline]
    pub(super) fn widen(&self, width: Vec2) -> Vec2 {
        let (u, v) = (self.u * width.x, self.v * width.y);
        Vec2::new(Vec2::new(u.x, v.x).length(), Vec2::new(u.y, v.y).length())
    }
}
