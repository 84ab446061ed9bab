//! Settings of the whole file: its axes, its unit, and the program that wrote it.

use super::element::Element;
use bilux_import::bytes::float::parse_f64;
use bilux_import::input::authors::program;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DMat3, DMat4, DVec3};

/// Settings of a file, as its asset element states them.
pub(super) struct Settings {
    /// The axes and the unit of what states none of its own.
    pub(super) frame: Frame,
    /// Metres per unit of length.
    pub(super) unit: f64,
    /// True for files in which 0 is opaque, as ColladaMax writes them: some material is wholly transparent, and none opaque.
    pub(super) has_inverted_opacity: bool,
    /// The program that wrote the file; may be empty.
    pub(super) tool: String,
    /// True for files that Blender wrote: its colours are linear.
    pub(super) is_of_blender: bool,
    /// True for those of Blender 2.80 and later, whose lights are in watts.
    pub(super) is_of_new_blender: bool,
}

/// The axes and the unit of an element and of what is in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// From these axes to y up: x to the right, and z to the front.
    axes: DMat3,
    /// Metres per unit of length.
    unit: f64,
}

impl Frame {
    /// The frame where nothing is stated.
    const UNSTATED: Frame = Frame { axes: DMat3::IDENTITY, unit: 1.0 };

    /// Frame of an element in this one: as its own asset says, and as here where it says nothing.
    pub(super) fn within(self, element: Element, diagnostics: &mut Diagnostics) -> Frame {
        let Some(asset) = element.child("asset") else { return self };
        let stated = asset.child("unit").and_then(|unit| unit.attribute("meter"));
        let unit = stated.map(|meter| parse_f64(meter.trim().as_bytes()).unwrap_or(0.0)).unwrap_or(self.unit);
        let is_length = (1e-12..=1e12).contains(&unit);
        if !is_length {
            let what = "the unit is not the length of a unit that anybody has: it is read as a metre";
            diagnostics.note(what, || element.at());
        }
        let axes = match asset.child("up_axis").map(Element::text) {
            Some("Z_UP") => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
            Some("X_UP") => DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z),
            Some("Y_UP") => DMat3::IDENTITY,
            _ => self.axes,
        };
        Frame { axes, unit: if is_length { unit } else { 1.0 } }
    }

    /// From here to metres with y up.
    pub(super) fn to_world(self) -> DMat4 {
        DMat4::from_mat3(self.axes * self.unit)
    }

    /// From another frame to this one.
    pub(super) fn from(self, other: Frame) -> DMat4 {
        if self == other {
            return DMat4::IDENTITY;
        }
        DMat4::from_mat3(self.axes.transpose() * other.axes * (other.unit / self.unit))
    }
}

impl Settings {
    pub(super) fn read(root: Element, diagnostics: &mut Diagnostics) -> Settings {
        let asset = root.child("asset");
        let frame = Frame::UNSTATED.within(root, diagnostics);
        let has_inverted_opacity = has_inverted_opacity(root);
        if has_inverted_opacity {
            let what = "wholly transparent materials are read as opaque, and all others the other way round too, as the \
                        programs mean it that write this";
            diagnostics.note(what, || root.at());
        }
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
            frame,
            unit: frame.unit,
            has_inverted_opacity,
            is_of_blender: version.is_some(),
            is_of_new_blender: version.flatten().is_some_and(|version| version >= (2, 80)),
            tool,
        }
    }
}

/// True if a file calls some surface wholly transparent and none opaque, all in the mode in which 1 is opaque.
fn has_inverted_opacity(root: Element) -> bool {
    let stated = |shader: Element| {
        let number = parse_f64(shader.child("transparency")?.child("float")?.text().as_bytes())?;
        let transparent = shader.child("transparent");
        let is_usual = transparent.is_none_or(|t| t.attribute("opaque").is_none_or(|mode| mode == "A_ONE"));
        is_usual.then_some(number)
    };
    let shaders = || {
        let effects = root.children_named("library_effects").flat_map(Element::children);
        effects.filter_map(|effect| effect.path(&["profile_COMMON", "technique"])?.children().find(is_shader))
    };
    let has = |is_it: fn(f64) -> bool| shaders().any(|shader| stated(shader).is_some_and(is_it));
    has(|number| number <= 0.0) && !shaders().any(|shader| stated(shader).is_none_or(|number| number >= 1.0))
}

fn is_shader(element: &Element) -> bool {
    matches!(element.name(), "constant" | "lambert" | "phong" | "blinn")
}
