//! Morphs: sums of shapes by weights.

use crate::dae::data::{Table, input, inputs, names};
use crate::dae::document::Document;
use crate::dae::element::Element;
use crate::dae::geometry;
use crate::dae::posed::Posed;
use bilux_import::FormatError;
use bilux_import::polygon_mesh::{Layer, PolygonMesh, Workshop};
use bilux_math::Vec3;

/// Adds the shapes of a morph to a mesh. Normalized, the mesh has the weight that the shapes leave; relative, the shapes are
/// offsets.
pub(super) fn blend<'d>(
    morph: Element<'d>,
    mesh: &mut PolygonMesh,
    posed: &Posed<'_, 'd>,
    workshop: &mut Workshop,
) -> Result<(), FormatError> {
    let document = posed.document;
    let Some(targets) = morph.child("targets") else { return Ok(()) };
    let inputs = inputs(targets, document);
    let (Some(shapes), Some(weights)) = (input(&inputs, "MORPH_TARGET"), input(&inputs, "MORPH_WEIGHT"))
    else {
        return Ok(());
    };
    let is_relative = morph.attribute("method") == Some("RELATIVE");
    let (shapes, _) = names(shapes, document, workshop.budget)?;
    let Some(array) = weights.children().find(|child| child.name() == "float_array") else { return Ok(()) };
    let weights = posed.numbers(array, workshop.budget)?;
    let weights = weights.iter().map(|weight| if weight.is_finite() { *weight as f32 } else { 0.0 });
    let (rest, normals) = (mesh.positions.clone(), mesh.normals.values().to_vec());
    workshop.budget.take_bytes((12 * (rest.len() + normals.len())) as u64, morph.file())?;
    let mut are_normals_known = true;
    for (shape, weight) in shapes.into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
        let found = document.target(shape);
        let read = found.map(|found| shape_of(found, document, workshop)).transpose()?.flatten();
        let Some((positions, turned)) = read.filter(|(positions, _)| positions.len() == rest.len()) else {
            let what = "a shape of a morph is missing, or has other vertices than the mesh: it is left out";
            workshop.oddities.note(what, || morph.at());
            continue;
        };
        let add = |sums: &mut [Vec3], rest: &[Vec3], shape: &[Vec3]| {
            for ((sum, rest), shape) in sums.iter_mut().zip(rest).zip(shape) {
                *sum += (*shape - if is_relative { Vec3::ZERO } else { *rest }) * weight;
            }
        };
        add(&mut mesh.positions, &rest, &positions);
        if turned.len() == normals.len() {
            add(mesh.normals.values_mut(), &normals, &turned);
        } else {
            are_normals_known = false;
        }
    }
    if !are_normals_known {
        // They follow from the faces.
        mesh.normals = Layer::default();
    }
    Ok(())
}

/// Positions, and normals if there are any.
type Shape = (Vec<Vec3>, Vec<Vec3>);

/// The positions and the normals of a shape, which need not have polygons.
fn shape_of<'d>(
    geometry: Element<'d>,
    document: &Document<'d>,
    workshop: &mut Workshop,
) -> Result<Option<Shape>, FormatError> {
    if let Some(mesh) = geometry::read(geometry, document, workshop)? {
        workshop.budget.take::<Vec3>(mesh.polygons.normals.values().len(), geometry.file())?;
        return Ok(Some((mesh.polygons.positions, mesh.polygons.normals.values().to_vec())));
    }
    let vertices = geometry.path(&["mesh", "vertices"]);
    let source = vertices.and_then(|vertices| input(&inputs(vertices, document), "POSITION"));
    let Some(source) = source else { return Ok(None) };
    let table = Table::<f32>::read(source, document, workshop.budget)?;
    workshop.budget.take::<Vec3>(table.len, geometry.file())?;
    let positions = table.rows().filter_map(|row| row.first_chunk::<3>()).map(|p| Vec3::from(*p)).collect();
    Ok(Some((positions, Vec::new())))
}
