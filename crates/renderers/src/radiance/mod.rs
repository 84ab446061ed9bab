//! Scenes of Radiance: `.rad`, with the files that they name, and `.rif`, which lists the files of a scene and its views. See
//! `docs/formats/radiance.md`.

mod command;
mod compose;
mod distant;
mod files;
mod finish;
mod genbox;
mod kinds;
mod lexer;
mod lights;
mod look;
mod looks;
mod materials;
mod modifiers;
mod place;
mod polygons;
mod reader;
mod rif;
mod round;
mod sky;
mod sky_model;
mod sources;
mod statement;
mod surfaces;
mod units;
mod views;
mod world;
mod xform;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "radiance",
        summary: "scenes of Radiance, with the files that they name, boxes, arrays and skies",
        source: "Ward 1994",
        parameters: &[],
    },
    extensions: &["rad", "rif"],
    capabilities: &[
        "polygons",
        "objects",
        "instances",
        "transforms",
        "materials",
        "media",
        "lights",
        "cameras",
    ],
    sniff: reader::sniff,
    // The files have z up; the reader turns them, since skies have y up here.
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Whole(reader::read)),
    write: None,
};
