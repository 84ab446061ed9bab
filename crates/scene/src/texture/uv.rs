//! Positions at which textures are looked up.

use bilux_math::Vec2;

/// A texture look-up position: texture coordinates, v upwards, and the second set of them.
///
/// Meshes with one set use it for both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvPair(pub [Vec2; 2]);

impl UvPair {
    /// Interpolates between the corners of a triangle.
    pub fn between(corners: [UvPair; 3], weights: [f32; 3]) -> UvPair {
        let [a, b, c] = corners.map(|corner| corner.0);
        UvPair([0, 1].map(|set| a[set] * weights[0] + b[set] * weights[1] + c[set] * weights[2]))
    }
}

impl From<Vec2> for UvPair {
    fn from(uv: Vec2) -> UvPair {
        UvPair([uv; 2])
    }
}

/// The part of a texture that a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Position of the patch.
    pub at: UvPair,
    /// Width of the patch along each coordinate, for each set; 0 for a point.
    pub width: [Vec2; 2],
}

impl<T: Into<UvPair>> From<T> for Patch {
    #[inline]
    fn from(at: T) -> Patch {
        Patch { at: at.into(), width: [Vec2::ZERO; 2] }
    }
}
