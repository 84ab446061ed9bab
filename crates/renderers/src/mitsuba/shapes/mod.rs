//! Shapes; the table is [`SHAPES`].

mod attributes;
mod curves;
mod files;
mod groups;
mod maker;
mod serialized;
mod solids;

pub(super) use groups::{FLAT, LOST_MOTION};
pub(super) use maker::{Piece, ShapeCache, ShapeMaker};

use super::plugin::{Plugin, row};
use bilux_import::FormatError;
use maker::Make;
use std::rc::Rc;

/// Every shape; those that are not supported come last.
const SHAPES: &[(&str, Make)] = &[
    ("bsplinecurve", curves::bspline),
    ("cube", solids::cube),
    ("cylinder", solids::cylinder),
    ("disk", solids::disk),
    ("hair", curves::hair),
    ("instance", groups::instance),
    ("linearcurve", curves::linear),
    ("merge", groups::merge),
    ("obj", files::obj),
    ("ply", files::ply),
    ("rectangle", solids::rectangle),
    ("serialized", serialized::make),
    ("shapegroup", groups::not_yet),
    ("sphere", solids::sphere),
    ("deformable", not_shown),
    ("ellipsoids", not_shown),
    ("ellipsoidsmesh", not_shown),
    ("heightfield", not_shown),
    ("sdfgrid", not_shown),
];

/// The pieces of a shape.
pub(super) fn pieces(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let make = row(plugin, SHAPES)?;
    let made = make(maker, plugin)?;
    plugin.ignore(&["flip_normals", "face_normals", "id"]);
    plugin.report_unused(&mut maker.maker.diagnostics);
    Ok(made)
}

fn not_shown(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    maker.maker.not_shown(plugin);
    plugin.properties.iter().for_each(|property| property.used.set(true));
    Ok(Vec::new())
}
