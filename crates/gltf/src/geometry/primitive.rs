//! Mesh primitives: converts attributes and indices to triangles.

use crate::document::data::{DataReader, check_count};
use crate::document::json::JsonNode;
use crate::geometry::tangents;
use crate::geometry::topology::{Mode, corners, triangles};
use crate::graph::posed::Posed;
use crate::graph::skin::{Joints, bend};
use crate::materials::draft::{Alpha, OnMesh};
use crate::materials::glass;
use crate::materials::material::{Materials, UsedMaterial};
use bilux_import::FormatError;
use bilux_import::bytes::text::quoted;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_math::glam::Vec4;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::sync::Arc;

/// The result of one primitive.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) mesh: Arc<Mesh>,
    /// The index of its material in the scene.
    pub(crate) material: usize,
}

/// Attributes that a node adds to its mesh.
pub(crate) struct NodeMesh<'a> {
    pub(crate) name: &'a str,
    /// The weights of the morph targets.
    pub(crate) weights: &'a [f64],
    pub(crate) joints: Option<&'a Joints>,
}

/// Attributes that are read here, or reported elsewhere.
const ATTRIBUTES: [&str; 4] = ["POSITION", "NORMAL", "TANGENT", "COLOR_0"];

/// Reads a primitive of a mesh; `None` if there is nothing to render.
pub(crate) fn part<'d>(
    node: JsonNode<'d>,
    worn: &NodeMesh,
    posed: &Posed<'d>,
    materials: &mut Materials,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<Option<Part>, FormatError> {
    let mode = Mode::of(node)?;
    let attributes = node.need("attributes")?;
    let Some(position) = attributes.get("POSITION") else {
        sink.diagnostics.note("a primitive has no POSITION and is left out", || node.at());
        return Ok(None);
    };
    let mut data = DataReader::new(posed.document, &mut reading.budget, &mut sink.diagnostics);
    let mut mesh = Mesh { name: worn.name.to_owned(), ..Mesh::default() };
    mesh.positions = vec3(data.attribute::<3>(position, None)?);
    let count = mesh.positions.len();
    mesh.triangles = match mode {
        Mode::Triangles | Mode::Strip | Mode::Fan => triangles(node, mode, count, &mut data)?,
        _ => Vec::new(),
    };
    let named = posed.variants.material_of(node)?.or(node.get("material"));
    let is_solid = glass::is_solid(named, &mesh, reading.options.glass, &mut data)?;
    let (kd, alphas) = match attributes.get("COLOR_0") {
        Some(colour) => colours(colour, count, &mut data)?,
        None => Default::default(),
    };
    let on = OnMesh { is_solid, has_alpha: !alphas.is_empty() };
    let material = materials.material(named, on, posed.document, reading, sink)?;
    let mut data = DataReader::new(posed.document, &mut reading.budget, &mut sink.diagnostics);
    directions(attributes, material, &mut mesh, &mut data)?;
    morph(node, worn.weights, &mut mesh, &mut data)?;
    if let Some(joints) = worn.joints {
        bend(node, joints, &mut mesh, &mut data)?;
    }
    if mesh.positions.iter().any(|p| !p.is_finite()) {
        let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
        data.note(what, || position.at());
    }
    coordinates(attributes, material, &mut mesh, &mut data)?;
    colour(&mut mesh, material, kd, alphas);
    note_unused(attributes, material, &mut data);
    match mode {
        Mode::Triangles | Mode::Strip | Mode::Fan => add_tangents(material, &mut mesh, &mut data)?,
        thin => add_strokes(node, thin, &mut mesh, &mut data)?,
    }
    if mesh.is_empty() {
        data.note("a primitive has nothing to render and is left out", || node.at());
        return Ok(None);
    }
    Ok(Some(Part { mesh: Arc::new(mesh), material: material.index }))
}

/// Gives a mesh the colours and the alphas of its vertices, as far as its material uses them.
fn colour(mesh: &mut Mesh, material: UsedMaterial, kd: Vec<Rgb>, alphas: Vec<f32>) {
    // Of what is unlit, the colour is what it emits.
    (mesh.emission_by_kd, mesh.vertex_kd) = (material.is_unlit && !kd.is_empty(), kd);
    if material.alpha != Alpha::Opaque {
        mesh.vertex_opacity = alphas;
        mesh.opacity_threshold = match material.alpha {
            Alpha::Mask(cutoff) if !mesh.vertex_opacity.is_empty() => Some(cutoff),
            _ => None,
        };
    }
}

/// Reads normals, and tangents if the material depends on a direction.
fn directions<'d>(
    attributes: JsonNode<'d>,
    material: UsedMaterial,
    mesh: &mut Mesh,
    data: &mut DataReader<'d, '_>,
) -> Result<(), FormatError> {
    let count = mesh.positions.len();
    if let Some(normal) = attributes.get("NORMAL") {
        mesh.normals = vec3(data.attribute::<3>(normal, Some(count))?);
        if mesh.normals.iter().any(|n| (n.length_squared() - 1.0).abs() > 0.1) {
            data.note("some normals do not have length 1; they are normalised", || normal.at());
        }
    }
    if let Some(tangent) = attributes.get("TANGENT").filter(|_| material.has_direction) {
        let tangents = data.attribute::<4>(tangent, Some(count))?;
        if tangents.iter().any(|t| t[3].abs() != 1.0) {
            let what = "the fourth number of a tangent must be 1 or -1; its sign is used";
            data.note(what, || tangent.at());
        }
        mesh.tangents = tangents.into_iter().map(Vec4::from).collect();
    }
    Ok(())
}

/// Reads the sets of texture coordinates that the material uses.
fn coordinates<'d>(
    attributes: JsonNode<'d>,
    material: UsedMaterial,
    mesh: &mut Mesh,
    data: &mut DataReader<'d, '_>,
) -> Result<(), FormatError> {
    let count = mesh.positions.len();
    // If no texture uses any, the first set is kept for a texture that may be applied later.
    let sets = [material.uv_sets[0].or(Some(0)), material.uv_sets[1]];
    for (slot, set) in sets.into_iter().enumerate() {
        let Some(set) = set else { continue };
        let key = format!("TEXCOORD_{set}");
        let found = attributes.entries().find(|(name, _)| *name == key);
        let uvs = match found {
            // In Bilux, v points up.
            Some((_, uv)) => data
                .attribute::<2>(uv, Some(count))?
                .into_iter()
                .map(|[u, v]| Vec2::new(u, 1.0 - v))
                .collect(),
            None if material.uv_sets[slot].is_some() => {
                let what =
                    "a material needs texture coordinates that its mesh does not have; they are set to 0";
                data.note(what, || attributes.at());
                data.take_bytes(count as u64 * 8)?;
                vec![Vec2::Y; count]
            }
            None => Vec::new(),
        };
        if slot == 0 { mesh.uvs = uvs } else { mesh.uvs2 = uvs }
    }
    Ok(())
}

/// Generates tangents if they are needed and the file has none.
fn add_tangents(material: UsedMaterial, mesh: &mut Mesh, data: &mut DataReader) -> Result<(), FormatError> {
    if !material.has_direction || !mesh.tangents.is_empty() || mesh.uvs.is_empty() {
        return Ok(());
    }
    // Lists that the generator makes for every corner.
    data.take_bytes(mesh.triangles.len() as u64 * 400)?;
    tangents::add(mesh, material.normal_by_second);
    Ok(())
}

/// The colours of vertices, which are linear, and their alphas if any is not 1. All are clamped to 0 to 1.
/// [glTF 2.0, 3.7.2.1]
fn colours<'d>(
    index: JsonNode<'d>,
    count: usize,
    data: &mut DataReader<'d, '_>,
) -> Result<(Vec<Rgb>, Vec<f32>), FormatError> {
    let mut accessor = data.accessor(index)?;
    check_count(index, &accessor, Some(count))?;
    if accessor.normalise() {
        let what = "colours of vertices are integers without 'normalized'; they are taken as if they had it";
        data.note(what, || index.at());
    }
    if accessor.width() == 3 {
        let colours = accessor.floats::<3>(data.budget)?;
        return Ok((colours.into_iter().map(|c| Rgb::from_array(c).clamp(0.0, 1.0)).collect(), Vec::new()));
    }
    let colours = accessor.floats::<4>(data.budget)?;
    let mut alphas = Vec::new();
    if colours.iter().any(|c| c[3] != 1.0) {
        data.take_bytes(count as u64 * 4)?;
        alphas = colours.iter().map(|c| c[3].clamp(0.0, 1.0)).collect();
    }
    let kd = colours.into_iter().map(|[r, g, b, _]| Rgb::new(r, g, b).clamp(0.0, 1.0)).collect();
    Ok((kd, alphas))
}

/// Adds the weighted displacements of the morph targets. [glTF 2.0, 3.7.2.2]
fn morph<'d>(
    node: JsonNode<'d>,
    weights: &[f64],
    mesh: &mut Mesh,
    data: &mut DataReader<'d, '_>,
) -> Result<(), FormatError> {
    let targets = node.list("targets")?;
    if targets.len() != weights.len() && !weights.is_empty() {
        let what = "the number of weights differs from the number of morph targets";
        data.note(what, || node.at_key("targets"));
    }
    for (target, &weight) in targets.into_iter().zip(weights) {
        for (key, used) in target.entries() {
            if !matches!(key, "POSITION" | "NORMAL" | "TANGENT") && !key.starts_with('_') {
                let what = "a morph target moves something other than positions, normals and tangents, which is ignored";
                data.note(what, || used.at());
            }
        }
        if weight == 0.0 {
            continue;
        }
        let mut by = |key: &'static str, count: usize| -> Result<Vec<Vec3>, FormatError> {
            let Some(index) = target.get(key).filter(|_| count > 0) else { return Ok(Vec::new()) };
            let by = vec3(data.attribute::<3>(index, Some(count))?);
            Ok(by.into_iter().map(|by| by * weight as f32).collect())
        };
        let [positions, normals, tangents] = [
            by("POSITION", mesh.positions.len())?,
            by("NORMAL", mesh.normals.len())?,
            by("TANGENT", mesh.tangents.len())?,
        ];
        mesh.positions.iter_mut().zip(positions).for_each(|(v, by)| *v += by);
        mesh.normals.iter_mut().zip(normals).for_each(|(v, by)| *v += by);
        mesh.tangents.iter_mut().zip(tangents).for_each(|(v, by)| *v += by.extend(0.0));
    }
    Ok(())
}

fn note_unused(attributes: JsonNode, material: UsedMaterial, data: &mut DataReader) {
    let used_uv = |key: &str| {
        let set = key.strip_prefix("TEXCOORD_").and_then(|set| set.parse().ok());
        set.is_some_and(|set: usize| set == 0 || material.uv_sets.contains(&Some(set)))
    };
    for (key, node) in attributes.entries() {
        let is_skin = key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_");
        // Application-specific attributes begin with an underscore.
        let is_used = ATTRIBUTES.contains(&key) || used_uv(key) || is_skin || key.starts_with('_');
        // Unused sets of texture coordinates have no effect.
        if !is_used && !key.starts_with("TEXCOORD_") {
            data.diagnostics.not_shown(&format!("{} of meshes", quoted(key.as_bytes())), || node.at());
        }
    }
}

/// Reads the points or the lines of a primitive.
fn add_strokes<'d>(
    node: JsonNode<'d>,
    mode: Mode,
    mesh: &mut Mesh,
    data: &mut DataReader<'d, '_>,
) -> Result<(), FormatError> {
    let corners = corners(node, mesh.positions.len(), data)?;
    data.take_bytes(corners.len() as u64 * 8)?;
    (mesh.points, mesh.lines) = mode.points_and_lines(corners);
    // Points and lines are round, so normals and tangents have no meaning.
    (mesh.normals, mesh.tangents) = (Vec::new(), Vec::new());
    Ok(())
}

fn vec3(list: Vec<[f32; 3]>) -> Vec<Vec3> {
    list.into_iter().map(Vec3::from).collect()
}
