//! Shapes, one per file; the table is [`SHAPES`].

mod bilinear;
mod curve;
mod files;
mod loop_subdivision;
mod maker;
mod quadrics;
mod triangles;

pub(super) use maker::ShapeCache;
pub(super) use quadrics::unit_sphere;

use super::document::{Alpha, Piece, ShapeGeometry, SurfaceAttributes};
use super::entity::Entity;
use super::loader::Loader;
use super::parameters::ParameterList;
use super::state::State;
use bilux_import::FormatError;
use bilux_import::input::names::unknown;
use maker::ShapeMaker;

/// Builds a shape; `None` if it is invisible.
type Make = fn(&mut ShapeMaker, &ParameterList) -> Result<Option<ShapeGeometry>, FormatError>;

/// Every supported shape.
const SHAPES: &[(&str, Make)] = &[
    ("bilinearmesh", bilinear::make),
    ("curve", curve::make),
    ("cylinder", quadrics::cylinder),
    ("disk", quadrics::disk),
    ("loopsubdiv", loop_subdivision::make),
    ("plymesh", files::make),
    ("sphere", quadrics::sphere),
    ("trianglemesh", triangles::make),
];

/// Shapes of version 3 that are not supported.
const LEFT_OUT: [&str; 5] = ["cone", "paraboloid", "hyperboloid", "heightfield", "nurbs"];

/// Builds the shape of a directive in a graphics state.
pub(super) fn shape(
    entity: &Entity,
    state: &State,
    cache: &mut ShapeCache,
    loader: &mut Loader,
) -> Result<Option<Piece>, FormatError> {
    let list = &entity.parameters;
    let alpha = alpha(list)?;
    let made = match SHAPES.iter().find(|(name, _)| *name == entity.kind) {
        Some((_, make)) => make(&mut ShapeMaker { reverses: state.reverses, cache, loader }, list)?,
        None if LEFT_OUT.contains(&entity.kind.as_str()) => {
            let what = format!("the pbrt-v3 shape '{}' is left out", entity.kind);
            loader.note(&what, || entity.at.clone());
            None
        }
        None => {
            let names = SHAPES.iter().map(|(name, _)| *name);
            return Err(unknown("shape", &entity.kind, names, &entity.at));
        }
    };
    loader.reading.budget.take::<Piece>(1, &entity.at.file)?;
    let attributes = SurfaceAttributes {
        material: state.material.clone(),
        area_light: state.area_light,
        alpha,
        media: state.media.clone(),
    };
    let (matrices, at) = (state.matrices, entity.at.clone());
    Ok(made.map(|form| Piece { shapes: count(entity, &form), form, matrices, attributes, at }))
}

/// The number of shapes that pbrt counts for a directive.
fn count(entity: &Entity, form: &ShapeGeometry) -> u32 {
    let count = match (entity.kind.as_str(), form) {
        ("bilinearmesh", _) => entity.parameters.integers("indices").map_or(1, |list| list.len() / 4),
        ("trianglemesh" | "plymesh" | "loopsubdiv", ShapeGeometry::Mesh(mesh)) => mesh.triangles.len(),
        _ => 1,
    };
    u32::try_from(count).unwrap_or(u32::MAX).max(1)
}

/// The opacity of a shape from its alpha parameter.
fn alpha(list: &ParameterList) -> Result<Alpha, FormatError> {
    if let Some((name, at)) = list.texture("alpha") {
        return Ok(Alpha::Texture(name.into(), at.line, at.column));
    }
    let number = list.finite("alpha", 1.0)?;
    Ok(if number == 1.0 { Alpha::Whole } else { Alpha::Even(number.to_bits()) })
}
