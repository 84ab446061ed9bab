//! The transforms of nodes, with all their pivots and offsets. [Autodesk FBX SDK, "Computing transformation matrices"]

use super::document::Properties;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat3, DMat4, DVec3};

/// The order in which rotations about the axes are applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RotationOrder([usize; 3]);

impl RotationOrder {
    /// About x first, then y, then z.
    pub(super) const XYZ: RotationOrder = RotationOrder([0, 1, 2]);

    /// That of a number in the file; others are as the first.
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

    /// That of a node.
    pub(super) fn of(properties: &Properties) -> RotationOrder {
        RotationOrder::numbered(properties.integer("RotationOrder").unwrap_or(0))
    }

    /// The rotation by angles in degrees about x, y and z.
    pub(super) fn matrix(self, degrees: DVec3) -> DMat3 {
        self.0.iter().fold(DMat3::IDENTITY, |sum, &axis| about(axis, degrees[axis]) * sum)
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

/// How the scale of a parent is inherited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Inheritance {
    /// The rotations of all come before the scales of all.
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
    rotation: DMat3,
    /// The node's own scale.
    scale: DVec3,
}

impl Inherited {
    /// That of the scene, whose axes and unit are those of the file.
    pub(super) fn root() -> Inherited {
        Inherited { matrix: DMat4::IDENTITY, rotation: DMat3::IDENTITY, scale: DVec3::ONE }
    }

    /// That of a child.
    pub(super) fn child(&self, local: &Local) -> Inherited {
        let rotation = self.rotation * local.rotation;
        let whole = self.matrix * local.matrix;
        let matrix = match local.inheritance {
            Inheritance::Plain => whole,
            inheritance => {
                let mut scaled = self.rotation.transpose() * DMat3::from_mat4(self.matrix);
                if inheritance == Inheritance::WithoutParentScale {
                    let inverse = |x: f64| if x == 0.0 { 0.0 } else { x.recip() };
                    scaled *= DMat3::from_diagonal(DVec3::from_array(self.scale.to_array().map(inverse)));
                }
                let linear = rotation * scaled * DMat3::from_diagonal(local.scale);
                let mut matrix = DMat4::from_mat3(linear);
                matrix.w_axis = whole.w_axis;
                matrix
            }
        };
        Inherited { matrix, rotation, scale: local.scale }
    }
}

/// The transform of what is attached to a node, which its children do not inherit.
pub(super) fn geometric(properties: &Properties) -> DMat4 {
    let vector = |name: &str, default: DVec3| properties.vector(name).unwrap_or(default);
    DMat4::from_translation(vector("GeometricTranslation", DVec3::ZERO))
        * DMat4::from_mat3(RotationOrder::XYZ.matrix(vector("GeometricRotation", DVec3::ZERO)))
        * DMat4::from_scale(vector("GeometricScaling", DVec3::ONE))
}
