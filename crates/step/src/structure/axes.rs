//! Points, directions and placements.

use crate::part21::Table;
use bilux_math::{DMat4, DVec3};

/// A right-handed frame of unit axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    pub(crate) origin: DVec3,
    pub(crate) x: DVec3,
    pub(crate) y: DVec3,
    pub(crate) z: DVec3,
}

impl Axes {
    /// The frame with this axis; x is made perpendicular to it. [ISO 10303-42, 4.4.17, build_axes]
    pub(crate) fn new(origin: DVec3, z: Option<DVec3>, x: Option<DVec3>) -> Axes {
        let z = z.and_then(DVec3::try_normalize).unwrap_or(DVec3::Z);
        let perpendicular = |x: DVec3| (x - z * x.dot(z)).try_normalize();
        // Without a reference direction, x is that of the space, unless that is the axis.
        let default = || perpendicular(if z.x.abs() > 0.9999 { DVec3::Y } else { DVec3::X });
        let x = x.and_then(perpendicular).or_else(default).unwrap_or_else(|| z.any_orthonormal_vector());
        Axes { origin, x, y: z.cross(x), z }
    }

    /// The point with these coordinates in the frame.
    pub(crate) fn point(&self, x: f64, y: f64, z: f64) -> DVec3 {
        self.origin + self.x * x + self.y * y + self.z * z
    }

    /// The coordinates of a point in the frame.
    pub(crate) fn local(&self, p: DVec3) -> DVec3 {
        let d = p - self.origin;
        DVec3::new(d.dot(self.x), d.dot(self.y), d.dot(self.z))
    }

    pub(crate) fn matrix(&self) -> DMat4 {
        DMat4::from_cols(self.x.extend(0.0), self.y.extend(0.0), self.z.extend(0.0), self.origin.extend(1.0))
    }
}

/// A CARTESIAN_POINT; the coordinates that it lacks are 0.
pub(crate) fn point(table: &Table, id: u64) -> Option<DVec3> {
    triple(table, id, "CARTESIAN_POINT")
}

/// A DIRECTION, not of unit length.
pub(crate) fn direction(table: &Table, id: u64) -> Option<DVec3> {
    triple(table, id, "DIRECTION")
}

fn triple(table: &Table, id: u64, name: &str) -> Option<DVec3> {
    let numbers = table.part(id, name)?.list(1)?;
    let at = |index: usize| if index < numbers.len() { numbers.number(index) } else { Some(0.0) };
    Some(DVec3::new(at(0)?, at(1)?, at(2)?))
}

/// A VECTOR: its direction of unit length times its magnitude.
pub(crate) fn vector(table: &Table, id: u64) -> Option<DVec3> {
    let values = table.part(id, "VECTOR")?;
    let along = direction(table, values.reference(1)?)?.try_normalize()?;
    Some(along * values.number(2)?)
}

/// An AXIS2_PLACEMENT_3D, or one of fewer dimensions.
pub(crate) fn axes(table: &Table, id: u64) -> Option<Axes> {
    let optional = |reference: Option<u64>| reference.and_then(|id| direction(table, id));
    if let Some(values) = table.part(id, "AXIS2_PLACEMENT_3D") {
        let origin = point(table, values.reference(1)?)?;
        return Some(Axes::new(origin, optional(values.reference(2)), optional(values.reference(3))));
    }
    if let Some(values) = table.part(id, "AXIS1_PLACEMENT") {
        let origin = point(table, values.reference(1)?)?;
        return Some(Axes::new(origin, optional(values.reference(2)), None));
    }
    let values = table.part(id, "AXIS2_PLACEMENT_2D")?;
    Some(Axes::new(point(table, values.reference(1)?)?, None, optional(values.reference(2))))
}

/// The map that takes one item to another: placements, or a transformation operator in place of the second. The lengths of each
/// are multiplied by a factor.
pub(crate) fn between(table: &Table, from: (u64, f64), to: (u64, f64)) -> Option<DMat4> {
    let scaled = |mut matrix: DMat4, factor: f64| {
        matrix.w_axis = (matrix.w_axis.truncate() * factor).extend(1.0);
        matrix
    };
    let target = axes(table, to.0).map(|axes| axes.matrix()).or_else(|| operator(table, to.0))?;
    let source = axes(table, from.0).map_or(DMat4::IDENTITY, |axes| axes.matrix());
    Some(scaled(target, to.1) * scaled(source, from.1).inverse())
}

/// A CARTESIAN_TRANSFORMATION_OPERATOR_3D, which may scale and mirror. [ISO 10303-42, 4.4.22]
pub(crate) fn operator(table: &Table, id: u64) -> Option<DMat4> {
    let own = table.part(id, "CARTESIAN_TRANSFORMATION_OPERATOR_3D")?;
    let values = table.part(id, "CARTESIAN_TRANSFORMATION_OPERATOR").unwrap_or(own);
    // Before the two axes there are one or more names; after the origin come the scale and the third axis.
    let at = (2..values.len())
        .find(|&index| values.reference(index).is_some_and(|id| table.is(id, "CARTESIAN_POINT")))?;
    let axis = |index: usize| values.reference(index).and_then(|id| direction(table, id));
    let third = match table.simple(id) {
        Some(_) => axis(at + 2),
        None => own.reference(0).and_then(|id| direction(table, id)),
    };
    let (origin, scale) = (point(table, values.reference(at)?)?, values.number(at + 1).unwrap_or(1.0));
    let (first, second) = (axis(at - 2), axis(at - 1));
    let frame = Axes::new(origin, third.or_else(|| Some(first?.cross(second?))), first);
    // The second axis may be that of a mirror.
    let y = if second.is_some_and(|y| y.dot(frame.y) < 0.0) { -frame.y } else { frame.y };
    let [x, y, z] = [frame.x, y, frame.z].map(|axis| (axis * scale).extend(0.0));
    Some(DMat4::from_cols(x, y, z, origin.extend(1.0)))
}
