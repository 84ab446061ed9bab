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
    /// A frame around a unit normal, computed without a branch that could leave a seam. [Duff 2017]
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

    /// This frame rotated about its normal, so that its x axis is as close to `tangent` as possible; unchanged
    /// where the tangent is along the normal or zero.
    #[inline]
    pub fn along(self, tangent: Vec3) -> Frame {
        match (tangent - self.n * tangent.dot(self.n)).try_normalize() {
            Some(s) => Frame { s, t: self.n.cross(s), n: self.n },
            None => self,
        }
    }

    /// Transforms a world direction to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Transforms a local direction to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

/// `wo` reflected about `n`; both are unit vectors pointing away from the surface.
#[inline]
pub fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * wo.dot(n)) - wo
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normals() -> impl Iterator<Item = Vec3> {
        let ring = |z: f32| {
            (0..12).map(move |i| {
                let (sin, cos) = crate::transcendental::sin_cos(0.5 + i as f32);
                let r = (1.0 - z * z).sqrt();
                Vec3::new(r * cos, r * sin, z).normalize()
            })
        };
        [-0.999, -0.6, -0.1, 0.0, 0.3, 0.9].into_iter().flat_map(ring).chain([Vec3::Z, -Vec3::Z, Vec3::X])
    }

    fn assert_right_handed(frame: &Frame, n: Vec3) {
        let Frame { s, t, .. } = *frame;
        assert_eq!(frame.n, n);
        assert!((s.cross(t) - n).length() < 1e-5 && (s.length() - 1.0).abs() < 1e-5, "{n}: {frame:?}");
        assert!((t.length() - 1.0).abs() < 1e-5 && s.dot(t).abs() < 1e-5, "{n}: {frame:?}");
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for n in normals() {
            let frame = Frame::from_normal(n);
            assert_right_handed(&frame, n);
            let tangent = Vec3::new(0.5, 2.0, -1.0);
            let turned = frame.along(tangent);
            assert_right_handed(&turned, n);
            // Of all directions perpendicular to the normal, this is the closest one.
            let across = (tangent - n * n.dot(tangent)).normalize();
            assert!((turned.s - across).length() < 1e-4, "{n}: {turned:?}");
            assert_eq!(frame.along(Vec3::ZERO).s, frame.s);
        }
    }

    #[test]
    fn directions_round_trip_through_the_frame() {
        let v = Vec3::new(0.3, -0.7, 0.4);
        for n in normals() {
            let frame = Frame::from_normal(n);
            let local = frame.to_local(v);
            assert!((local.z - v.dot(n)).abs() < 1e-6 && (frame.to_world(local) - v).length() < 1e-6, "{n}");
            assert!((frame.to_world(Vec3::X) - frame.s).length() < 1e-6);
            assert!((frame.to_world(Vec3::Y) - frame.t).length() < 1e-6);
        }
    }

    #[test]
    fn reflection_keeps_the_normal_component_and_flips_the_tangential_one() {
        assert_eq!(reflect(Vec3::new(0.6, 0.0, 0.8), Vec3::Z), Vec3::new(-0.6, 0.0, 0.8));
        assert_eq!(reflect(Vec3::new(0.0, -0.8, 0.6), Vec3::NEG_Y), Vec3::new(0.0, -0.8, -0.6));
    }
}
