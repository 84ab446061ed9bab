//! Orthonormal frames around a normal.

use glam::Vec3;

/// A right-handed orthonormal frame; `n` is the local z axis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x axis.
    pub s: Vec3,
    /// Local y axis.
    pub t: Vec3,
    /// Local z axis, the normal.
    pub n: Vec3,
}

impl Frame {
    /// A frame around a unit normal, without a branch that could seam. [Duff 2017]
    #[inline]
    pub fn from_normal(n: Vec3) -> Frame {
        let sign = 1f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Frame {
            s: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// The same frame turned about its normal, so that its x axis is as near to `tangent` as may be; as it was where
    /// the tangent is along the normal or zero.
    #[inline]
    pub fn along(self, tangent: Vec3) -> Frame {
        match (tangent - self.n * tangent.dot(self.n)).try_normalize() {
            Some(s) => Frame { s, t: self.n.cross(s), n: self.n },
            None => self,
        }
    }

    /// World direction to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local direction to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

/// `wo` mirrored about `n`, both unit and both away from the surface.
#[inline]
pub fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * wo.dot(n)) - wo
}
