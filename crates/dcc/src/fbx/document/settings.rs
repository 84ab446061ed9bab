//! The settings of the whole file: axes, unit and time.

use super::properties::Properties;
use crate::fbx::tree::{Node, Value};
use bilux_import::input::authors::program;
use bilux_math::{DMat3, DMat4, DVec3};

/// Ticks of time per second up to version 7.
const TICKS: f64 = 46_186_158_000.0;
/// Ticks of version 8, which files may opt into before.
const NEW_TICKS: f64 = 141_120_000.0;

/// Settings of the whole file.
pub(in crate::fbx) struct Settings {
    /// From the file's axes and unit to metres with y up: x to the right, and z to the front.
    pub(in crate::fbx) to_world: DMat4,
    /// Metres per unit of length.
    pub(in crate::fbx) unit: f64,
    /// Units of time per second.
    pub(in crate::fbx) ticks: f64,
    pub(in crate::fbx) frames_per_second: f64,
    /// The program that wrote the file; may be empty.
    pub(in crate::fbx) creator: String,
    /// True for files that Blender wrote: its colours are linear.
    pub(in crate::fbx) is_of_blender: bool,
    /// True for files of Blender before 2.80, whose lamps are as bright as stated up to a distance, and are not in watts.
    pub(in crate::fbx) lamps_have_reach: bool,
}

impl Settings {
    pub(super) fn read(root: Node) -> Settings {
        // Since version 7 they are next to the objects, before among them.
        let inner = || root.child("Objects").and_then(|objects| objects.child("GlobalSettings"));
        let node = root.child("GlobalSettings").or_else(inner).unwrap_or(root);
        let properties = Properties::read(node, None);
        // A file without a unit is in centimetres.
        let unit = properties.number("UnitScaleFactor").filter(|unit| *unit > 0.0).unwrap_or(1.0) / 100.0;
        let creator = creators(root).next().map(String::from_utf8_lossy);
        let creator = creator.map(|creator| program(&creator)).unwrap_or_default();
        let to_world = DMat4::from_mat3(axes(&properties) * unit);
        Settings {
            to_world,
            unit,
            ticks: ticks(root),
            frames_per_second: frames_per_second(&properties),
            is_of_blender: creators(root).any(is_blender),
            lamps_have_reach: creators(root).any(|creator| is_blender(creator) && is_before_280(creator)),
            creator,
        }
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

fn ticks(root: Node) -> f64 {
    let header = root.child("FBXHeaderExtension");
    let version = header.and_then(|header| header.child_value("FBXHeaderVersion")).and_then(Value::integer);
    let definition = header.and_then(|header| header.child("OtherFlags")?.child_value("TCDefinition"));
    match definition.and_then(Value::integer) {
        Some(definition) if definition != 127 && version.is_some_and(|version| version >= 1004) => NEW_TICKS,
        _ => TICKS,
    }
}

/// By the number of the SDK's `FbxTime::EMode`.
fn frames_per_second(properties: &Properties) -> f64 {
    const NTSC: f64 = 1000.0 / 1001.0;
    match properties.integer("TimeMode").unwrap_or(0) {
        1 => 120.0,
        2 => 100.0,
        3 => 60.0,
        4 => 50.0,
        5 => 48.0,
        8 | 9 => 30.0 * NTSC,
        10 => 25.0,
        11 => 24.0,
        12 => 1000.0,
        13 => 24.0 * NTSC,
        14 => properties.number("CustomFrameRate").filter(|rate| *rate > 0.0).unwrap_or(30.0),
        15 => 96.0,
        16 => 72.0,
        17 => 60.0 * NTSC,
        18 => 120.0 * NTSC,
        _ => 30.0,
    }
}

fn is_blender(creator: &[u8]) -> bool {
    creator.starts_with(b"Blender")
}

/// True if the version in a name like `Blender (stable FBX IO) - 2.76 (sub 0) - 3.6.2` is one before 2.80.
fn is_before_280(creator: &[u8]) -> bool {
    let text = String::from_utf8_lossy(creator);
    let version = text.split(" - ").nth(1).unwrap_or_default();
    let mut numbers = version.split(|c: char| !c.is_ascii_digit()).map(|number| number.parse::<u32>().ok());
    let version = numbers.next().flatten().zip(numbers.next().flatten());
    version.is_some_and(|version| version < (2, 80))
}

/// Names of the program that wrote the file, from two places.
fn creators<'a>(root: Node<'a>) -> impl Iterator<Item = &'a [u8]> {
    let header = root.child("FBXHeaderExtension");
    let creators = [root.child_value("Creator"), header.and_then(|header| header.child_value("Creator"))];
    creators.into_iter().flatten().filter_map(Value::text)
}
