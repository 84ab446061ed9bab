//! Morphs: sums of shapes by weights.

use crate::dae::data::{Table, input, inputs, names};
use crate::dae::document::Document;
use crate::dae::element::Element;
use crate::dae::geometry;
use crate::dae::posed::Posed;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::{Layer, PolygonMesh, Workshop};
use bilux_math::{Rgb, Vec3};

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
    let colours = mesh.colours.values().to_vec();
    workshop.budget.take_bytes((12 * (rest.len() + normals.len() + colours.len())) as u64, morph.file())?;
    let mut are_normals_known = true;
    for (shape, weight) in shapes.into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
        let found = document.target(shape);
        let read = found.map(|found| shape_of(found, document, workshop)).transpose()?.flatten();
        let Some(shape) = read.filter(|shape| shape.positions.len() == rest.len()) else {
            let what = "a shape of a morph is missing, or has other vertices than the mesh: it is left out";
            workshop.diagnostics.note(what, || morph.at());
            continue;
        };
        let add = |sums: &mut [Vec3], rest: &[Vec3], shape: &[Vec3]| {
            for ((sum, rest), shape) in sums.iter_mut().zip(rest).zip(shape) {
                *sum += (*shape - if is_relative { Vec3::ZERO } else { *rest }) * weight;
            }
        };
        add(&mut mesh.positions, &rest, &shape.positions);
        if shape.normals.len() == normals.len() {
            add(mesh.normals.values_mut(), &normals, &shape.normals);
        } else {
            are_normals_known = false;
        }
        if shape.colours.len() == colours.len() {
            let sums = mesh.colours.values_mut().iter_mut();
            for ((sum, rest), shape) in sums.zip(&colours).zip(&shape.colours) {
                *sum += (*shape - if is_relative { Rgb::BLACK } else { *rest }) * weight;
            }
        }
    }
    mesh.colours.values_mut().iter_mut().for_each(|colour| *colour = colour.clamp(0.0, 1.0));
    if !are_normals_known {
        // They follow from the faces.
        mesh.normals = Layer::default();
    }
    Ok(())
}

/// Positions, and normals and colours if there are any.
#[derive(Default)]
struct Shape {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    colours: Vec<Rgb>,
}

/// The positions and the normals of a shape, which need not have polygons.
fn shape_of<'d>(
    geometry: Element<'d>,
    document: &Document<'d>,
    workshop: &mut Workshop,
) -> Result<Option<Shape>, FormatError> {
    if let Some(mesh) = geometry::read(geometry, document, workshop)? {
        let PolygonMesh { positions, normals, colours, .. } = mesh.polygons;
        let (normals, colours) = (normals.values().to_vec(), colours.values().to_vec());
        workshop.budget.take::<Vec3>(normals.len() + colours.len(), geometry.file())?;
        return Ok(Some(Shape { positions, normals, colours }));
    }
    let vertices = geometry.path(&["mesh", "vertices"]);
    let source = vertices.and_then(|vertices| input(&inputs(vertices, document), "POSITION"));
    let Some(source) = source else { return Ok(None) };
    let table = Table::<f32>::read(source, document, workshop.budget)?;
    workshop.budget.take::<Vec3>(table.len, geometry.file())?;
    let positions = table.rows().filter_map(|row| row.first_chunk::<3>()).map(|p| Vec3::from(*p)).collect();
    Ok(Some(Shape { positions, ..Shape::default() }))
}
