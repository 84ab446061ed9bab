//! What holds for the whole file: its axes, its unit, and the program that wrote it.

use super::element::Element;
use bilux_import::authors::program;
use bilux_import::float::parse_f64;
use bilux_import::oddities::Oddities;
use bilux_math::{DMat3, DMat4, DVec3};

/// What the asset of a file says.
pub(super) struct Settings {
    /// From the file's axes and unit to metres with y up: x to the right, and z to the front.
    pub(super) to_world: DMat4,
    /// Metres per unit of length.
    pub(super) unit: f64,
    /// The program that wrote the file; may be empty.
    pub(super) tool: String,
    /// True for files that Blender wrote: its colours are linear.
    pub(super) is_of_blender: bool,
    /// True for those of Blender 2.80 and later, whose lights are in watts.
    pub(super) is_of_new_blender: bool,
}

impl Settings {
    pub(super) fn read(root: Element, oddities: &mut Oddities) -> Settings {
        let asset = root.child("asset");
        let stated = asset.and_then(|asset| asset.child("unit")?.attribute("meter"));
        let unit = stated.map(|meter| parse_f64(meter.trim().as_bytes()).unwrap_or(0.0)).unwrap_or(1.0);
        let is_length = (1e-12..=1e12).contains(&unit);
        if !is_length {
            let what = "the unit is not the length of a unit that anybody has: it is read as a metre";
            oddities.note(what, || root.at());
        }
        let unit = if is_length { unit } else { 1.0 };
        let axes = match asset.and_then(|asset| asset.child("up_axis")).map(Element::text) {
            Some("Z_UP") => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
            Some("X_UP") => DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z),
            _ => DMat3::IDENTITY,
        };
        let contributors = asset.into_iter().flat_map(|asset| asset.children_named("contributor"));
        let tool = contributors.filter_map(|one| one.child("authoring_tool")).map(Element::text).next();
        let tool = program(tool.unwrap_or_default());
        let version = tool.strip_prefix("Blender").map(|rest| {
            let digits = rest.trim_start().split(|c: char| !c.is_ascii_digit() && c != '.').next();
            digits.and_then(|digits| {
                let mut parts = digits.split('.').map(|part| part.parse::<u32>().unwrap_or(0));
                Some((parts.next()?, parts.next().unwrap_or(0)))
            })
        });
        Settings {
            to_world: DMat4::from_mat3(axes * unit),
            unit,
            is_of_blender: version.is_some(),
            is_of_new_blender: version.flatten().is_some_and(|version| version >= (2, 80)),
            tool,
        }
    }
}
