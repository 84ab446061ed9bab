//! The settings of the whole file: axes and unit.

use super::properties::Properties;
use crate::fbx::tree::Node;
use bilux_math::{DMat3, DMat4, DVec3};

/// What holds for all of a file.
pub(in crate::fbx) struct Settings {
    /// From the file's axes and unit to metres with y up: x to the right, and z to the front.
    pub(in crate::fbx) to_world: DMat4,
}

impl Settings {
    pub(super) fn read(root: Node) -> Settings {
        // Since version 7 they are next to the objects, before among them.
        let inner = || root.child("Objects").and_then(|objects| objects.child("GlobalSettings"));
        let node = root.child("GlobalSettings").or_else(inner).unwrap_or(root);
        let properties = Properties::read(node, None);
        // A file without a unit is in centimetres.
        let unit = properties.number("UnitScaleFactor").filter(|unit| *unit > 0.0).unwrap_or(1.0) / 100.0;
        let to_world = DMat4::from_mat3(axes(&properties) * unit);
        Settings { to_world }
    }
}

/// From the file's axes to ours. Axes that do not span space are as if they were missing.
fn axes(properties: &Properties) -> DMat3 {
    let axis = |name: &str| {
        let index = usize::try_from(properties.integer(name)?).ok().filter(|&index| index < 3)?;
        let sign = properties.integer(&format!("{name}Sign")).unwrap_or(1);
        Some(DVec3::AXES[index] * if sign < 0 { -1.0 } else { 1.0 })
    };
    let stated =
        || Some(DMat3::from_cols(axis("CoordAxis")?, axis("UpAxis")?, axis("FrontAxis")?).transpose());
    stated().filter(|axes| axes.determinant() != 0.0).unwrap_or(DMat3::IDENTITY)
}
