//! The types of `bilux_scene::typed`, and those of the makers in Python, match the tables, parameter by parameter.

use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{DVec3, Vec3};
use bilux_scene::cameras::CAMERAS;
use bilux_scene::typed::cameras::{Opencv, Perspective};
use bilux_scene::{LIGHTS, MATERIALS, Reader, Spec};
use std::fmt::Write;

/// Set by `cargo xtask docs`: files are written instead of compared.
const WRITE: &str = "BILUX_WRITE_TYPES";

/// A kind of thing whose table has types.
struct Kind {
    name: &'static str,
    /// The types of numbers and of vectors.
    number: &'static str,
    vector: &'static str,
}

const MATERIAL: Kind = Kind { name: "Materials", number: "f32", vector: "bilux_math::Vec3" };
const LIGHT: Kind = Kind { name: "Lights", ..MATERIAL };

/// Calibrations have more digits than f32.
const CAMERA: Kind = Kind {
    name: "Cameras",
    number: "impl Into<f64> as super::number",
    vector: "impl Into<bilux_math::DVec3> as super::vector",
};

fn source(kind: &Kind, rows: impl Iterator<Item = Entry>) -> String {
    let mut text = format!(
        "//! {} as Rust types. Generated from their table by `cargo xtask docs`; do not edit by hand.\n\ntyped! {{\n",
        kind.name
    );
    for row in rows {
        let _ = writeln!(text, "    /// {}.", documented(row.summary));
        let _ = writeln!(text, "    {} = \"{}\" {{", camel_case(row.name), row.name);
        for parameter in row.parameters {
            let _ = writeln!(text, "        /// {}.", about(parameter));
            let _ = writeln!(text, "        {}: {},", parameter.name, rust_type(kind, parameter.kind));
        }
        text += "    }\n";
    }
    text + "}\n"
}

fn about(parameter: &Parameter) -> String {
    let mut about = documented(parameter.summary);
    if !parameter.unit.is_empty() {
        let _ = write!(about, " ({})", parameter.unit);
    }
    about += &values(parameter.kind);
    match parameter.default {
        "" => about + "; it has to be given",
        default => about + &format!("; default `{default}`"),
    }
}

/// The values that are allowed, unless all are.
fn values(kind: ParameterKind) -> String {
    match kind {
        ParameterKind::Choice(words) => format!(": `{}`", words.join("`, `")),
        ParameterKind::Integer { min, max } => format!("; from {min} to {max}"),
        ParameterKind::Number { min, max }
        | ParameterKind::Colour { min, max }
        | ParameterKind::ColourTexture { min, max }
        | ParameterKind::NumberTexture { min, max }
        | ParameterKind::Stops { min, max } => format!("; from {} to {}", short(min), short(max)),
        _ => String::new(),
    }
}

/// A bound, without long rows of zeros.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// Formats a line of documentation: it starts with a capital letter, and no bracket makes a link.
fn documented(summary: &str) -> String {
    let escaped = summary.replace('[', "\\[").replace('<', "\\<");
    let mut letters = escaped.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn camel_case(name: &str) -> String {
    let word = |word: &str| word[..1].to_uppercase() + &word[1..];
    name.split('-').map(word).collect()
}

fn rust_type(kind: &Kind, parameter: ParameterKind) -> &'static str {
    match parameter {
        ParameterKind::Bool => "bool",
        ParameterKind::Integer { .. } => "i32",
        ParameterKind::Number { .. } => kind.number,
        ParameterKind::Colour { .. } => "bilux_math::Rgb",
        ParameterKind::Vector => kind.vector,
        ParameterKind::Choice(_) | ParameterKind::Text => "&str",
        // A colour or a number, or a texture in its place; for the others, the value that file readers make.
        _ => "impl Into<crate::Value>",
    }
}

/// Beginning of Python's module of makers.
const MAKERS: &str = "\"\"\"The functions that make materials, lights and cameras, with their parameters, for editors and checkers of types.

Generated from the tables by `cargo xtask docs`; do not edit by hand.
\"\"\"

from __future__ import annotations

from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex, TypedDict

from ._tables import Cameras, Makers, made

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._bilux import Spec
";

/// Parameters that a camera of OpenCV takes besides: its matrices.
const OF_OPENCV: &str = "\
        K: ArrayLike | None = None,
        world_to_camera: ArrayLike | None = None,
        *,
        camera_to_world: ArrayLike | None = None,
        distortion: ArrayLike | None = None,
        size: tuple[int, int] | None = None,
        R: ArrayLike | None = None,
        t: ArrayLike | None = None,
        beyond: str = \"error\",
";

/// Words that no parameter in Python can have as its name.
const KEYWORDS: [&str; 8] = ["from", "in", "is", "as", "with", "class", "lambda", "global"];

/// A class of makers, and the types of their parameters.
fn makers(class: &str, base: &str, rows: impl Iterator<Item = Entry> + Clone) -> String {
    let mut text = String::new();
    for row in rows.clone() {
        let _ = write!(text, "\n\nclass {class}{}(TypedDict, total=False):\n", camel_case(row.name));
        let _ = writeln!(text, "    \"\"\"Parameters of `{}`.\"\"\"\n", row.name);
        for parameter in row.parameters {
            assert!(!KEYWORDS.contains(&parameter.name), "{}.{}", row.name, parameter.name);
            let _ = writeln!(text, "    {}: {}", parameter.name, python_type(parameter.kind));
        }
        if row.parameters.is_empty() {
            text += "    pass\n";
        }
    }
    let _ = write!(
        text,
        "\n\nclass {class}Makers({base}):\n    \"\"\"The functions of a table; see `{base}`.\"\"\"\n"
    );
    for row in rows {
        let takes = if row.name.starts_with("opencv") { OF_OPENCV } else { "        *,\n" };
        let _ = write!(
            text,
            "\n    @made\n    def {}(\n        self,\n{takes}        name: str = \"\",\n        **parameters: \
             Unpack[{class}{}],\n    ) -> Spec:\n        raise NotImplementedError\n",
            row.name.replace('-', "_"),
            camel_case(row.name)
        );
    }
    text
}

fn python_type(kind: ParameterKind) -> &'static str {
    match kind {
        ParameterKind::Bool => "bool",
        ParameterKind::Integer { .. } => "SupportsIndex",
        ParameterKind::Number { .. } => "SupportsFloat",
        ParameterKind::Colour { .. } | ParameterKind::Vector => "ArrayLike",
        ParameterKind::Choice(_) | ParameterKind::Text => "str",
        // Textures, other specs and the like, in any of the forms that they can have.
        _ => "Any",
    }
}

fn compare(file: &str, is: &str, wanted: &str) {
    if is == wanted {
        // Writing the same once more would make cargo build all crates anew.
        return;
    }
    if std::env::var_os(WRITE).is_some() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        std::fs::write(path, wanted).unwrap();
    } else {
        panic!("{file} is not what the table says: run `cargo xtask docs`");
    }
}

#[test]
fn every_maker_of_python_has_its_parameters() {
    let materials = MATERIALS.iter().map(|row| row.entry);
    let lights = LIGHTS.iter().map(|row| row.entry);
    let cameras = CAMERAS.iter().map(|row| row.entry);
    let wanted = [
        MAKERS,
        &makers("Material", "Makers", materials),
        &makers("Light", "Makers", lights),
        &makers("Camera", "Cameras", cameras),
        "\n\ncameras = CameraMakers(\"cameras\", \"kinds of camera\")\n",
        "lights = LightMakers(\"lights\", \"light sources\")\n",
        "materials = MaterialMakers(\"materials\", \"what surfaces are made of\")\n",
    ];
    let file = "../python/python/bilux/_makers.py";
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    compare(file, &std::fs::read_to_string(path).unwrap_or_default(), &wanted.concat());
}

#[test]
fn every_material_light_and_camera_has_its_type() {
    let materials = source(&MATERIAL, MATERIALS.iter().map(|row| row.entry));
    compare("src/typed/materials.rs", include_str!("../../src/typed/materials.rs"), &materials);
    let lights = source(&LIGHT, LIGHTS.iter().map(|row| row.entry));
    compare("src/typed/lights.rs", include_str!("../../src/typed/lights.rs"), &lights);
    let cameras = source(&CAMERA, CAMERAS.iter().map(|row| row.entry));
    compare("src/typed/cameras.rs", include_str!("../../src/typed/cameras.rs"), &cameras);
}

#[test]
fn a_typed_camera_is_the_one_written_by_hand() {
    let typed = Perspective::new("eye")
        .position(Vec3::new(0.1, 0.2, 3.0))
        .fov(36.7f32)
        .blades(5)
        .stereo("over-under")
        .mirrored(true);
    let by_hand = Spec::new("eye", "perspective")
        .with("position", Vec3::new(0.1, 0.2, 3.0))
        .with("fov", 36.7f32)
        .with("blades", 5)
        .with("stereo", "over-under")
        .with("mirrored", true);
    assert_eq!(Spec::from(typed), by_hand);
}

#[test]
fn a_typed_calibration_keeps_its_digits() {
    let place = DVec3::new(6_378_137.125, -0.1, 1.0 / 3.0);
    let spec = Spec::from(Opencv::new("left").fx(1234.567890123).k1(-0.1).position(place));
    let row = CAMERAS.iter().find(|row| row.entry.name == "opencv").unwrap();
    let reader = Reader::new(&spec, &row.entry).unwrap();
    assert_eq!([reader.number_f64("fx"), reader.number_f64("k1")], [1234.567890123, -0.1]);
    assert_eq!(reader.vector_f64("position"), place);
}
