//! Meshes that are subdivision surfaces.

use super::context::{Context, Worn};
use super::meshes::{Part, Subset, name_of, uvs};
use super::polygons::Polygons;
use super::primvars::{Interpolation, Place};
use super::stage::Stage;
use super::subdivision::Subdivision;
use crate::FormatError;
use crate::subdivision::{Cage, PendingCage};
use bilux_math::{Rgb, Vec2};

/// From this sharpness on, an edge is as sharp as it can be. [OpenUSD, UsdGeomMesh]
const SHARPEST: f32 = 10.0;

/// The parts of a subdivision surface, one for each subset and one for all other faces; they are refined when the whole
/// scene is known. `None` if the surface has what only polygons have here: normals of its own, a second set of texture
/// coordinates, or colours and opacities that change from face to face.
pub(super) fn parts(
    stage: &Stage,
    prim: u32,
    polygons: &Polygons,
    subdivision: &Subdivision,
    subsets: &[Subset],
    rest: &Worn,
    scene: &mut Context,
) -> Result<Option<Vec<Part>>, FormatError> {
    let Some(scheme) = subdivision.scheme.refined() else { return Ok(None) };
    let of_vertices = |interpolation| interpolation == Interpolation::Vertex;
    let is_plain = !polygons.has_normals
        && polygons.opacities.is_none()
        && polygons.colours.as_ref().is_none_or(|colours| of_vertices(colours.interpolation))
        && subsets.iter().map(|subset| &subset.worn).chain([rest]).all(|worn| worn.uvs[1].is_none());
    if !is_plain {
        return Ok(None);
    }
    let worn: Vec<&Worn> = subsets.iter().map(|subset| &subset.worn).chain([rest]).collect();
    let file = stage.layers[0].name.clone();
    let bytes = polygons.points.len() * 48 + polygons.corners.len() * 16 + polygons.ends.len() * 12;
    scene.reading.budget.take_bytes(bytes as u64, &file)?;
    let mut cage = Cage::new(scheme, &polygons.points);
    if let Some(colours) = &polygons.colours {
        let colour = |vertex| Rgb::from_array(colours.at::<3>(Place { corner: 0, vertex, face: 0 }));
        cage.set_colours(&(0..polygons.points.len()).map(colour).collect::<Vec<_>>());
    }
    let coordinates = worn.iter().map(|worn| uvs(stage, prim, worn, scene)).collect::<Result<Vec<_>, _>>()?;
    let has_uvs = coordinates.iter().any(|[first, _]| first.is_some());
    let groups = groups(polygons, subsets);
    let (mut points, mut places) = (Vec::new(), Vec::new());
    for (face, &group) in groups.iter().enumerate() {
        let mut corners: Vec<usize> = polygons.face(face).collect();
        if corners.len() < 3 || polygons.is_hole.get(face).is_some_and(|hole| *hole) {
            continue;
        }
        if polygons.is_left_handed {
            corners.reverse();
        }
        points.clear();
        points.extend(corners.iter().map(|&corner| polygons.corners[corner]));
        places.clear();
        if has_uvs {
            let primvar = &coordinates[group as usize][0];
            places.extend(corners.iter().map(|&corner| {
                let place = Place { corner, vertex: polygons.corners[corner] as usize, face };
                primvar.as_ref().map_or(Vec2::ZERO, |uv| uv.at::<2>(place).into())
            }));
        }
        cage.add_face(&points, &places, group);
    }
    sharpen(&mut cage, subdivision);
    let name = name_of(stage, prim).to_owned();
    let pending = PendingCage::new(cage, worn.iter().map(|_| name.clone()), stage.at(prim));
    let part =
        |(group, worn): (usize, &&Worn)| Part { mesh: pending.mesh(group).clone(), material: worn.index };
    let parts = worn.iter().enumerate().map(part).collect();
    scene.reading.cages.push(pending);
    Ok(Some(parts))
}

/// The group of each face: the first subset that has it, or that of all others.
fn groups(polygons: &Polygons, subsets: &[Subset]) -> Vec<u32> {
    let mut groups = vec![subsets.len() as u32; polygons.ends.len()];
    for (group, subset) in subsets.iter().enumerate().rev() {
        for &face in &subset.faces {
            if let Some(slot) = groups.get_mut(face as usize) {
                *slot = group as u32;
            }
        }
    }
    groups
}

/// Adds creases and corners.
fn sharpen(cage: &mut Cage, subdivision: &Subdivision) {
    let sharpness = |s: f64| if s as f32 >= SHARPEST { f32::INFINITY } else { s as f32 };
    if subdivision.rounds_corners {
        cage.round_corners();
    }
    if let (Some(points), Some(lengths), Some(sharp)) =
        (&subdivision.crease_indices, &subdivision.crease_lengths, &subdivision.crease_sharpnesses)
    {
        let is_per_crease = sharp.len() == lengths.len();
        let (mut first, mut edge) = (0usize, 0);
        for crease in 0..lengths.len() {
            let end = first.saturating_add(lengths.numbers.at(crease).max(0.0) as usize).min(points.len());
            for i in first + 1..end {
                let which = if is_per_crease { crease } else { edge };
                let ends = [i - 1, i].map(|i| points.numbers.at(i) as u32);
                if which < sharp.len() {
                    cage.crease(ends, sharpness(sharp.numbers.at(which)));
                }
                edge += 1;
            }
            first = end;
        }
    }
    if let (Some(points), Some(sharp)) = (&subdivision.corner_indices, &subdivision.corner_sharpnesses) {
        for i in 0..points.len().min(sharp.len()) {
            cage.sharpen(points.numbers.at(i) as u32, sharpness(sharp.numbers.at(i)));
        }
    }
}
