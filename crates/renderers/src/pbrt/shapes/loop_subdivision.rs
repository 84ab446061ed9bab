//! `loopsubdiv`: Loop subdivision, which splits each triangle into four per level. [Loop 1987]

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::{ShapeMaker, corners, needed_points};
use bilux_import::FormatError;
use bilux_import::geometry::subdivision::{Cage, Scheme};

/// More levels would be finer than any image.
const MAX_LEVELS: i32 = 8;

pub(super) fn make(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let points = needed_points(list)?;
    let triangles = corners::<3>(list, points.len())?;
    // Version 3 calls the parameter nlevels; the scheme is always this one.
    let levels = match list.integer("levels")? {
        Some(levels) => levels,
        None => list.integer("nlevels")?.unwrap_or(3),
    };
    list.has("scheme");
    if levels > MAX_LEVELS {
        let what = format!("a mesh is subdivided at most {MAX_LEVELS} times");
        maker.loader.note(&what, || list.place("levels"));
    }
    let mut cage = Cage::new(Scheme::Loop, &points);
    cage.round_borders_as_pbrt();
    triangles.iter().for_each(|triangle| cage.add_face(triangle, &[], 0));
    for _ in 0..levels.clamp(0, MAX_LEVELS) {
        maker.loader.reading.budget.take_bytes(cage.bytes_of_next(), &list.at.file)?;
        cage = cage.refined();
    }
    match cage.meshes(1).pop() {
        Some(mesh) => maker.finished(mesh, list),
        None => Ok(None),
    }
}
