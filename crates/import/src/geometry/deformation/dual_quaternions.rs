//! Dual quaternion skinning: each vertex follows a blend of its joints' motions that is a motion again, so that twisted joints keep
//! their volume. Scales are blended linearly. [Kavan 2008]

use bilux_math::glam::{DMat3, DQuat};
use bilux_math::{DMat4, DVec3};

/// A motion: a rotation, its translation as the dual part, and the scale that comes before both.
#[derive(Clone, Copy)]
struct Motion {
    rotation: DQuat,
    dual: DQuat,
    scale: DVec3,
}

impl Motion {
    const ZERO: Motion = Motion {
        rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
        dual: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
        scale: DVec3::ZERO,
    };

    /// Motion of a matrix, whose shear is lost.
    fn of(matrix: &DMat4) -> Motion {
        let axes = DMat3::from_mat4(*matrix);
        let side = if axes.determinant() < 0.0 { -1.0 } else { 1.0 };
        let scale = DVec3::new(side * axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
        let x = (axes.x_axis * side).normalize_or(DVec3::X);
        let z = x.cross(axes.y_axis).normalize_or(DVec3::Z);
        let rotation = DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z));
        let t = matrix.w_axis * 0.5;
        Motion { rotation, dual: DQuat::from_xyzw(t.x, t.y, t.z, 0.0) * rotation, scale }
    }

    fn matrix(&self) -> DMat4 {
        let length = self.rotation.length();
        let rotation = self.rotation / length;
        let t = (self.dual / length * rotation.conjugate()) * 2.0;
        DMat4::from_scale_rotation_translation(self.scale, rotation, DVec3::new(t.x, t.y, t.z))
    }
}

/// The motions of all vertices, while joint after joint adds its share.
pub struct DualBlends {
    motions: Vec<Motion>,
    sums: Vec<f64>,
}

/// Motion of a joint, to be added to many vertices.
pub struct DualJoint(Motion);

impl DualJoint {
    pub fn of(joint: &DMat4) -> DualJoint {
        DualJoint(Motion::of(joint))
    }
}

impl DualBlends {
    /// The size of its memory, with that of the matrices that it becomes.
    pub fn bytes(vertices: usize) -> u64 {
        (vertices * size_of::<(Motion, f64, DMat4)>()) as u64
    }

    pub fn new(vertices: usize) -> DualBlends {
        DualBlends { motions: vec![Motion::ZERO; vertices], sums: vec![0.0; vertices] }
    }

    /// Adds the share of a joint. Weights that are not finite are skipped.
    pub fn add(&mut self, vertex: usize, joint: &DualJoint, weight: f64) {
        if weight == 0.0 || !weight.is_finite() {
            return;
        }
        let (sum, joint) = (&mut self.motions[vertex], &joint.0);
        // A rotation and its negative are the same, and are blended the shorter way around.
        let same = if sum.rotation.dot(joint.rotation) < 0.0 { -weight } else { weight };
        sum.rotation += joint.rotation * same;
        sum.dual += joint.dual * same;
        sum.scale += joint.scale * weight;
        self.sums[vertex] += weight;
    }

    /// The matrix of each vertex; `unbound` for those without weights, or whose motions cancel.
    pub fn matrices(self, unbound: impl Fn(usize) -> DMat4) -> Vec<DMat4> {
        let all = self.motions.into_iter().zip(self.sums).enumerate();
        let matrix = |(vertex, (motion, sum)): (usize, (Motion, f64))| {
            let scale = motion.scale / sum;
            let matrix = Motion { scale, ..motion }.matrix();
            if sum == 0.0 || !matrix.is_finite() { unbound(vertex) } else { matrix }
        };
        all.map(matrix).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of two motions turns half as far about the same axis: a quarter turn about z through (1, 0, 0) becomes an eighth.
    #[test]
    fn half_of_a_turn_about_an_axis_is_half_the_turn() {
        let turn = |degrees: f64| {
            DMat4::from_translation(DVec3::X)
                * DMat4::from_rotation_z(degrees.to_radians())
                * DMat4::from_translation(-DVec3::X)
        };
        let mut blends = DualBlends::new(2);
        // The same motion as a quaternion of either sign.
        for (joint, weight) in [(DMat4::IDENTITY, 0.5), (turn(90.0), 0.5)] {
            blends.add(0, &DualJoint::of(&joint), weight);
        }
        let doubled = turn(45.0) * DMat4::from_scale(DVec3::new(-2.0, 1.0, 3.0));
        blends.add(1, &DualJoint::of(&doubled), 7.0);
        let found = blends.matrices(|_| DMat4::ZERO);
        assert!(found[0].abs_diff_eq(turn(45.0), 1e-12), "{}", found[0]);
        assert!(found[1].abs_diff_eq(doubled, 1e-12), "{}", found[1]);
    }
}
