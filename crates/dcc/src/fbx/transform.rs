//! The transforms of nodes, with all their pivots and offsets. [Autodesk FBX SDK, "Computing transformation matrices"]

use super::document::Properties;
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{DMat3, DMat4, DVec2, DVec3};

/// The order in which rotations about the axes are applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RotationOrder([usize; 3]);

impl RotationOrder {
    /// About x first, then y, then z.
    pub(super) const XYZ: RotationOrder = RotationOrder([0, 1, 2]);

    /// The order of a number in the file; unknown numbers are as the first.
    fn numbered(number: i64) -> RotationOrder {
        RotationOrder(match number {
            1 => [0, 2, 1],
            2 => [1, 2, 0],
            3 => [1, 0, 2],
            4 => [2, 0, 1],
            5 => [2, 1, 0],
            _ => [0, 1, 2],
        })
    }

    /// The order of a node.
    pub(super) fn of(properties: &Properties) -> RotationOrder {
        RotationOrder::numbered(properties.integer("RotationOrder").unwrap_or(0))
    }

    /// The rotation by angles in degrees about x, y and z.
    pub(super) fn matrix(self, degrees: DVec3) -> DMat3 {
        self.0.iter().fold(DMat3::IDENTITY, |sum, &axis| about(axis, degrees[axis]) * sum)
    }

    /// The angles in degrees about x, y and z of a rotation. Where the second one makes the first and the last turn about the same
    /// axis, the last is zero.
    pub(super) fn angles(self, rotation: &DMat3) -> DVec3 {
        let [i, j, k] = self.0;
        let side = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
        let entry = |row: usize, column: usize| rotation.col(column)[row];
        let flat = DVec2::new(entry(i, i), entry(j, i)).length();
        let mut angles = DVec3::ZERO;
        angles[j] = atan2_f64(-side * entry(k, i), flat);
        if flat > 1e-9 {
            angles[i] = atan2_f64(side * entry(k, j), entry(k, k));
            angles[k] = atan2_f64(side * entry(j, i), entry(i, i));
        } else {
            angles[i] = atan2_f64(-side * entry(j, k), entry(j, j));
        }
        angles * 1f64.to_degrees()
    }
}

/// The rotation about an axis, exact for quarter turns.
fn about(axis: usize, degrees: f64) -> DMat3 {
    let degrees = degrees % 360.0;
    let quarters = degrees / 90.0;
    let (sin, cos) = match quarters.round() {
        whole if whole == quarters => {
            [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][whole as i64 as usize & 3]
        }
        _ => sin_cos_f64(degrees.to_radians()),
    };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut columns = DVec3::AXES;
    columns[u] = DVec3::AXES[u] * cos + DVec3::AXES[v] * sin;
    columns[v] = DVec3::AXES[v] * cos - DVec3::AXES[u] * sin;
    DMat3::from_cols(columns[0], columns[1], columns[2])
}

/// Inheritance of a parent's scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Inheritance {
    /// The scales of all are multiplied by axis, and come before their rotations.
    RotationsFirst,
    /// Each node's transform is in the space of its parent's.
    Plain,
    /// As the first, without the parent's own scale.
    WithoutParentScale,
}

/// The transform of a node relative to its parent, in the parts that inheritance needs.
pub(super) struct Local {
    matrix: DMat4,
    rotation: DMat3,
    scale: DVec3,
    inheritance: Inheritance,
}

impl Local {
    pub(super) fn of(properties: &Properties) -> Local {
        let vector = |name: &str| properties.vector(name).unwrap_or(DVec3::ZERO);
        let rotation_is_active = properties.integer("RotationActive").unwrap_or(1) != 0
            && properties.integer("RotationSpaceForLimitOnly").unwrap_or(0) == 0;
        let mut rotation = RotationOrder::XYZ.matrix(vector("Lcl Rotation"));
        if rotation_is_active {
            let own = RotationOrder::of(properties).matrix(vector("Lcl Rotation"));
            let [before, after] =
                ["PreRotation", "PostRotation"].map(|name| RotationOrder::XYZ.matrix(vector(name)));
            rotation = before * own * after.transpose();
        }
        let scale = properties.vector("Lcl Scaling").unwrap_or(DVec3::ONE);
        let (turned_about, scaled_about) = (vector("RotationPivot"), vector("ScalingPivot"));
        let moved = DMat4::from_translation;
        let matrix = moved(vector("Lcl Translation") + vector("RotationOffset") + turned_about)
            * DMat4::from_mat3(rotation)
            * moved(vector("ScalingOffset") + scaled_about - turned_about)
            * DMat4::from_scale(scale)
            * moved(-scaled_about);
        let inheritance = match properties.integer("InheritType").unwrap_or(1) {
            0 => Inheritance::RotationsFirst,
            2 => Inheritance::WithoutParentScale,
            _ => Inheritance::Plain,
        };
        Local { matrix, rotation, scale, inheritance }
    }
}

/// The transform of a node to world space, with what its children inherit.
#[derive(Clone, Copy)]
pub(super) struct Inherited {
    pub(super) matrix: DMat4,
    /// Without `scale`, and without translation.
    unscaled: DMat3,
    /// The node's own scale by the one that it has inherited by axis.
    scale: DVec3,
    inherited_scale: DVec3,
}

impl Inherited {
    /// The values for the scene, whose axes and unit are those of the file.
    pub(super) fn root() -> Inherited {
        Inherited {
            matrix: DMat4::IDENTITY,
            unscaled: DMat3::IDENTITY,
            scale: DVec3::ONE,
            inherited_scale: DVec3::ONE,
        }
    }

    /// The values for a child.
    pub(super) fn child(&self, local: &Local) -> Inherited {
        let mut matrix = self.matrix * local.matrix;
        let (above, inherited_scale) = match local.inheritance {
            Inheritance::Plain => (DMat3::from_mat4(self.matrix), DVec3::ONE),
            Inheritance::RotationsFirst => (self.unscaled, self.scale),
            Inheritance::WithoutParentScale => (self.unscaled, self.inherited_scale),
        };
        let (unscaled, scale) = (above * local.rotation, local.scale * inherited_scale);
        if local.inheritance != Inheritance::Plain {
            let place = matrix.w_axis;
            matrix = DMat4::from_mat3(unscaled * DMat3::from_diagonal(scale));
            matrix.w_axis = place;
        }
        Inherited { matrix, unscaled, scale, inherited_scale }
    }
}

/// The transform of what is attached to a node, which its children do not inherit.
pub(super) fn geometric(properties: &Properties) -> DMat4 {
    let vector = |name: &str, default: DVec3| properties.vector(name).unwrap_or(default);
    DMat4::from_translation(vector("GeometricTranslation", DVec3::ZERO))
        * DMat4::from_mat3(RotationOrder::XYZ.matrix(vector("GeometricRotation", DVec3::ZERO)))
        * DMat4::from_scale(vector("GeometricScaling", DVec3::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_that_a_rotation_was_made_of() {
        for order in (0..6).map(RotationOrder::numbered) {
            for angles in
                [DVec3::new(10.0, -60.0, 130.0), DVec3::new(-170.0, 20.0, -45.0), DVec3::splat(90.0)]
            {
                let rotation = order.matrix(angles);
                let again = order.matrix(order.angles(&rotation));
                assert!(rotation.abs_diff_eq(again, 1e-12), "{order:?} {angles}");
            }
        }
    }
}
