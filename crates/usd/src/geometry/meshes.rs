//! Meshes, and the parts of them that have materials of their own.

use crate::geometry::polygons::{Polygons, Welder};
use crate::geometry::primvars::{Interpolation, Primvar};
use crate::geometry::subdivision::{Scheme, Subdivision};
use crate::layers::value::{Array, Numbers, Text};
use crate::stage::Stage;
use crate::stage::context::{Context, Worn};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::normals::{BY_ANGLE, Faces};
use bilux_math::Vec3;
use bilux_scene::Mesh;
use std::sync::Arc;

/// The part of a mesh that has one material.
pub(crate) struct Piece {
    pub(crate) mesh: Arc<Mesh>,
    /// Which of the subsets it is; the number of these for all other faces.
    pub(crate) group: usize,
}

/// Part of a mesh with its material.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) mesh: Arc<Mesh>,
    /// Index of a material of the scene.
    pub(crate) material: usize,
}

/// Faces that share a material.
pub(crate) struct Subset {
    pub(crate) faces: Vec<u32>,
    pub(crate) worn: Worn,
}

/// Vertices, faces and their attributes; `None` if there is nothing to draw.
pub(crate) fn polygons(
    stage: &Stage,
    prim: u32,
    points: Vec<Vec3>,
    scene: &mut Context,
) -> Result<Option<Polygons>, FormatError> {
    let budget = &mut scene.reading.budget;
    let counts = stage.array(prim, "faceVertexCounts", budget)?;
    let indices = stage.array(prim, "faceVertexIndices", budget)?;
    let (Some(counts), Some(indices)) = (counts, indices) else { return Ok(None) };
    let file = stage.layers[0].name.clone();
    budget.take_bytes(8 * (counts.len() + indices.len()) as u64, &file)?;
    let mut is_hole = Vec::new();
    let (corners, ends, is_whole) = match sound_faces(&counts, indices, points.len()) {
        Ok((corners, ends)) => (corners, ends, true),
        Err(indices) => faces(&counts, &indices, points.len(), &mut is_hole),
    };
    drop(counts);
    if !is_whole {
        let what = "a mesh has faces with vertices that it does not have: these faces are left out";
        scene.sink.diagnostics.note(what, || stage.at(prim));
    }
    holes(stage, prim, ends.len(), &mut is_hole, &mut scene.reading.budget)?;
    let budget = &mut scene.reading.budget;
    let is_left_handed = stage.text(prim, "orientation", budget)?.as_deref() == Some("leftHanded");
    Ok((!points.is_empty() && !ends.is_empty()).then_some(Polygons {
        points,
        corners,
        ends,
        is_hole,
        is_left_handed,
        normals: None,
        has_normals: false,
        computed: None,
        colours: None,
        opacities: None,
    }))
}

/// The corners of faces and their ends, if all faces have vertices that are there; otherwise gives the indices back.
fn sound_faces(
    counts: &Array,
    indices: Arc<Array>,
    points: usize,
) -> Result<(Vec<u32>, Vec<u32>), Arc<Array>> {
    let (Numbers::Integers(sizes), Numbers::Integers(list)) = (&counts.numbers, &indices.numbers) else {
        return Err(indices);
    };
    let is_there = |&index: &i32| index >= 0 && (index as usize) < points;
    if counts.width != 1 || indices.width != 1 || !list.iter().all(is_there) {
        return Err(indices);
    }
    let mut end = 0;
    let next = |&size: &i32| {
        end += size.max(0) as usize;
        end as u32
    };
    let ends = sizes.iter().map(next).collect();
    if end > list.len() {
        return Err(indices);
    }
    // What no one else holds becomes the corners without a copy.
    let mut corners: Vec<u32> = match Arc::try_unwrap(indices).map(|array| array.numbers) {
        Ok(Numbers::Integers(list)) => list.into_iter().map(|index| index as u32).collect(),
        Ok(_) => Vec::new(),
        Err(shared) => (0..shared.len()).map(|i| shared.numbers.at(i) as u32).collect(),
    };
    corners.truncate(end);
    Ok((corners, ends))
}

/// Corners of any faces and their ends; faces with vertices that are not there become holes, and make the answer false.
fn faces(
    counts: &Array,
    indices: &Array,
    points: usize,
    is_hole: &mut Vec<bool>,
) -> (Vec<u32>, Vec<u32>, bool) {
    let (mut corners, mut ends) = (Vec::with_capacity(indices.len()), Vec::with_capacity(counts.len()));
    let (mut next, mut is_whole) = (0, true);
    for face in 0..counts.len() {
        let count = counts.numbers.at(face).max(0.0) as usize;
        let end = next + count;
        if end > indices.len() {
            is_whole = false;
            break;
        }
        let vertex = |i: usize| indices.numbers.at(i);
        let is_sound = (next..end).all(|i| (0.0..points as f64).contains(&vertex(i)));
        if !is_sound {
            is_whole = false;
            is_hole.resize(counts.len(), false);
            is_hole[face] = true;
        }
        corners.extend((next..end).map(|i| if is_sound { vertex(i) as u32 } else { 0 }));
        ends.push(corners.len() as u32);
        next = end;
    }
    (corners, ends, is_whole)
}

/// Marks faces that are holes.
fn holes(
    stage: &Stage,
    prim: u32,
    faces: usize,
    is_hole: &mut Vec<bool>,
    budget: &mut Budget,
) -> Result<(), FormatError> {
    let Some(list) = stage.array(prim, "holeIndices", budget)?.filter(|list| list.len() > 0) else {
        return Ok(());
    };
    is_hole.resize(faces, false);
    for i in 0..list.len() {
        if let Some(hole) = is_hole.get_mut(list.numbers.at(i) as usize) {
            *hole = true;
        }
    }
    Ok(())
}

/// The normals of the file, or computed ones.
pub(crate) fn add_normals(
    stage: &Stage,
    prim: u32,
    polygons: &mut Polygons,
    subdivision: &Subdivision,
    scene: &mut Context,
) -> Result<(), FormatError> {
    let budget = &mut scene.reading.budget;
    let primvar = Primvar::read(stage, prim, "primvars:normals", Interpolation::Vertex, budget)?;
    let normals = match primvar {
        Some(found) => Some(found),
        None => Primvar::read(stage, prim, "normals", Interpolation::Vertex, budget)?,
    };
    polygons.normals = normals.filter(|normals| normals.values.width == 3);
    polygons.has_normals = polygons.normals.is_some();
    let angle = if subdivision.is_smooth() { 180.0 } else { scene.reading.crease_angle };
    if polygons.normals.is_some() || angle <= 0.0 {
        return Ok(());
    }
    let needed = 24 * polygons.corners.len() + 24 * (polygons.ends.len() + polygons.points.len());
    budget.take_bytes(needed as u64, &stage.layers[0].name)?;
    let faces = Faces {
        positions: &polygons.points,
        corners: std::mem::take(&mut polygons.corners),
        ends: &polygons.ends,
        smoothing: vec![BY_ANGLE],
    };
    let (found, are_needed) = faces.normals_and_whether_needed(angle);
    polygons.corners = found.corners().collect();
    polygons.computed = are_needed.then_some(found);
    if polygons.is_left_handed
        && let Some(found) = &mut polygons.computed
    {
        found.normals.iter_mut().for_each(|normal| *normal = -*normal);
    }
    Ok(())
}

/// Notes what the subdivision of a mesh would change.
pub(crate) fn note_subdivision(stage: &Stage, prim: u32, subdivision: &Subdivision, scene: &mut Context) {
    if subdivision.scheme == Scheme::None {
        return;
    }
    let what = "subdivision surfaces are drawn as the polygons that control them";
    scene.sink.diagnostics.remark(what, || stage.at(prim));
    if subdivision.has_creases() {
        scene.sink.diagnostics.not_shown("creases of subdivision surfaces", || stage.at(prim));
    }
}

/// The pieces of a mesh: one for each subset, and one for all other faces.
pub(crate) fn pieces(
    stage: &Stage,
    prim: u32,
    polygons: &mut Polygons,
    subsets: Vec<Subset>,
    rest: &Worn,
    scene: &mut Context,
) -> Result<Vec<Piece>, FormatError> {
    let file = stage.layers[0].name.clone();
    let corners = polygons.corners.len() as u64;
    // Vertices with all their attributes, triangles, and what finds vertices again.
    scene.reading.budget.take_bytes(corners * 64 + 8 * polygons.points.len() as u64, &file)?;
    let mut welder = None;
    let faces = polygons.ends.len();
    let is_only = subsets.is_empty();
    let mut is_taken = vec![false; if subsets.is_empty() { 0 } else { faces }];
    let mut all = Vec::new();
    let others = subsets.len();
    let mut add = |faces: &mut dyn Iterator<Item = usize>, group: usize, worn: &Worn, scene: &mut Context| {
        let mut uvs = uvs(stage, prim, worn, scene)?;
        let (colours, opacities) = (polygons.colours.take(), polygons.opacities.take());
        polygons.colours = colours.clone().filter(|_| worn.uses_colours);
        polygons.opacities = opacities.clone().filter(|_| worn.uses_opacities);
        let triangles = if is_only { polygons.take_triangles(&mut uvs) } else { None };
        let (mut mesh, is_fine) = triangles.map(|mesh| (mesh, true)).unwrap_or_else(|| {
            let welder = welder.get_or_insert_with(|| Welder::new(polygons.points.len()));
            polygons.part(faces, &uvs, welder, is_only)
        });
        (polygons.colours, polygons.opacities) = (colours, opacities);
        if !is_fine {
            let what = "a face has so many corners that it was treated as convex";
            scene.sink.diagnostics.note(what, || stage.at(prim));
        }
        if !mesh.triangles.is_empty() {
            mesh.name = name_of(stage, prim).to_string();
            scene.finish_mesh(&mut mesh, worn)?;
            all.push(Piece { mesh: Arc::new(mesh), group });
        }
        Ok::<_, FormatError>(())
    };
    for (group, subset) in subsets.into_iter().enumerate() {
        let mut own = subset.faces.into_iter().map(|face| face as usize).filter(|face| {
            // A face is drawn once.
            *face < faces && !std::mem::replace(&mut is_taken[*face], true)
        });
        add(&mut own, group, &subset.worn, scene)?;
    }
    let mut rest_of_faces = (0..faces).filter(|face| !is_taken.get(*face).is_some_and(|taken| *taken));
    add(&mut rest_of_faces, others, rest, scene)?;
    Ok(all)
}

/// The last name of a prim's path.
pub(crate) fn name_of<'s>(stage: &'s Stage, prim: u32) -> &'s str {
    stage.prim(prim).path.rsplit('/').next().unwrap_or_default()
}

/// The texture coordinates that a material asks for; the usual ones if it asks for none.
pub(crate) fn uvs(
    stage: &Stage,
    prim: u32,
    worn: &Worn,
    scene: &mut Context,
) -> Result<[Option<Primvar>; 2], FormatError> {
    let mut found = [None, None];
    for (set, name) in worn.uvs.iter().enumerate() {
        let name = match (name, set) {
            (Some(name), _) => name.clone(),
            (None, 0) => Text::from("st"),
            (None, _) => continue,
        };
        let budget = &mut scene.reading.budget;
        let primvar = Primvar::read(stage, prim, &format!("primvars:{name}"), Interpolation::Vertex, budget)?;
        found[set] = primvar.filter(|uv| uv.values.width >= 2);
        if found[set].is_none() && worn.uvs[set].is_some() {
            let what = "a material needs texture coordinates that its mesh does not have; they are set to 0";
            scene.sink.diagnostics.note(what, || stage.at(prim));
        }
    }
    Ok(found)
}

/// The vertices of a mesh.
pub(crate) fn points(array: &Array) -> Vec<Vec3> {
    match &array.numbers {
        Numbers::Floats(list) if array.width == 3 => {
            list.as_chunks::<3>().0.iter().map(|&point| Vec3::from(point)).collect()
        }
        _ => (0..array.len()).map(|i| Vec3::from(array.floats::<3>(i))).collect(),
    }
}
