//! Primitives of meshes: attributes and indices become triangles.

use super::accessor::Accessor;
use super::json::Node;
use super::material::UsedMaterial;
use super::reader::Gltf;
use crate::FormatError;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::sync::Arc;

/// What one primitive has become.
#[derive(Clone)]
pub(super) struct Part {
    pub(super) mesh: Arc<Mesh>,
    /// Index of its material in the scene.
    pub(super) material: usize,
}

/// How a primitive's vertices make triangles.
#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// Attributes that are read, or told of elsewhere.
const ATTRIBUTES: [&str; 3] = ["POSITION", "NORMAL", "COLOR_0"];

impl<'d> Gltf<'d, '_, '_> {
    /// A primitive of a mesh, with weights for its morph targets; none where there is nothing to draw.
    pub(super) fn primitive(
        &mut self,
        node: Node<'d>,
        name: &str,
        weights: &[f64],
    ) -> Result<Option<Part>, FormatError> {
        let Some(mode) = self.mode(node)? else { return Ok(None) };
        let attributes = node.need("attributes")?;
        let Some(position) = attributes.get("POSITION") else {
            self.oddities.note("a primitive has no positions and is left out", || node.at());
            return Ok(None);
        };
        let vec3 = |v: Vec<[f32; 3]>| -> Vec<Vec3> { v.into_iter().map(Vec3::from).collect() };
        let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
        mesh.positions = vec3(self.attribute::<3>(position, None)?);
        let count = mesh.positions.len();
        if let Some(normal) = attributes.get("NORMAL") {
            mesh.normals = vec3(self.attribute::<3>(normal, Some(count))?);
        }
        self.morph(node, weights, &mut mesh)?;
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or no numbers; they are kept";
            self.oddities.note(what, || position.at());
        }
        let material = self.material(node.get("material"))?;
        if let Some(uv) = attributes.get(if material.uv_set == 1 { "TEXCOORD_1" } else { "TEXCOORD_0" }) {
            // Ours grow upwards.
            let flipped = |[u, v]: [f32; 2]| Vec2::new(u, 1.0 - v);
            mesh.uvs = self.attribute::<2>(uv, Some(count))?.into_iter().map(flipped).collect();
        }
        if let Some(colour) = attributes.get("COLOR_0") {
            mesh.vertex_kd = self.colours(colour, count)?;
        }
        self.note_unused(attributes, material);
        mesh.triangles = self.triangles(node, mode, count)?;
        if mesh.triangles.is_empty() {
            self.oddities.note("a primitive has no triangle and is left out", || node.at());
            return Ok(None);
        }
        Ok(Some(Part { mesh: Arc::new(mesh), material: material.index }))
    }

    /// None, with a warning, for what has no surface.
    fn mode(&mut self, node: Node<'d>) -> Result<Option<Mode>, FormatError> {
        let thin = match node.count("mode")?.unwrap_or(4) {
            4 => return Ok(Some(Mode::Triangles)),
            5 => return Ok(Some(Mode::Strip)),
            6 => return Ok(Some(Mode::Fan)),
            0 => "points",
            1..=3 => "lines",
            other => {
                return Err(node.error(format!("mode {other} is none; there are 0 to 6, and 4 is triangles")));
            }
        };
        let what = format!("{thin} are not drawn: they have no surface");
        self.oddities.note(&what, || node.at());
        Ok(None)
    }

    /// An attribute's elements, as many as there are vertices.
    pub(super) fn attribute<const N: usize>(
        &mut self,
        index: Node<'d>,
        count: Option<usize>,
    ) -> Result<Vec<[f32; N]>, FormatError> {
        let accessor = Accessor::named(self.document, index, &mut self.reading.budget)?;
        same_count(index, &accessor, count)?;
        accessor.floats(&mut self.reading.budget)
    }

    fn colours(&mut self, index: Node<'d>, count: usize) -> Result<Vec<Rgb>, FormatError> {
        let accessor = Accessor::named(self.document, index, &mut self.reading.budget)?;
        same_count(index, &accessor, Some(count))?;
        let budget = &mut self.reading.budget;
        if accessor.width() == 3 {
            let colours = accessor.floats::<3>(budget)?;
            return Ok(colours.into_iter().map(Rgb::from_array).collect());
        }
        let colours = accessor.floats::<4>(budget)?;
        if colours.iter().any(|c| c[3] != 1.0) {
            self.oddities.note("the alpha of vertex colours is not used", || index.at());
        }
        Ok(colours.into_iter().map(|[r, g, b, _]| Rgb::new(r, g, b)).collect())
    }

    /// Adds what the morph targets move. [glTF 2.0, 3.7.2.2]
    fn morph(&mut self, node: Node<'d>, weights: &[f64], mesh: &mut Mesh) -> Result<(), FormatError> {
        for (target, &weight) in node.list("targets")?.into_iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            let mut moved = |key: &'static str, values: &mut Vec<Vec3>| -> Result<(), FormatError> {
                let Some(index) = target.get(key).filter(|_| !values.is_empty()) else { return Ok(()) };
                let by = self.attribute::<3>(index, Some(values.len()))?;
                values.iter_mut().zip(by).for_each(|(v, by)| *v += Vec3::from(by) * weight as f32);
                Ok(())
            };
            moved("POSITION", &mut mesh.positions)?;
            moved("NORMAL", &mut mesh.normals)?;
        }
        Ok(())
    }

    fn note_unused(&mut self, attributes: Node<'d>, material: UsedMaterial) {
        let used_uv = if material.uv_set == 1 { "TEXCOORD_1" } else { "TEXCOORD_0" };
        for (key, node) in attributes.entries() {
            let is_skin = key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_");
            // What programs keep for themselves begins with an underscore.
            if ATTRIBUTES.contains(&key) || key == used_uv || is_skin || key.starts_with('_') {
                continue;
            }
            let what = match key {
                "TANGENT" if !material.has_direction => continue,
                "TANGENT" => "tangents are made from texture coordinates, and those of the file not used",
                _ if key.starts_with("TEXCOORD_") => {
                    "a mesh has one set of texture coordinates here: others are not used"
                }
                _ => "an attribute of a mesh is not used",
            };
            self.oddities.note(what, || node.at());
        }
    }

    fn triangles(
        &mut self,
        node: Node<'d>,
        mode: Mode,
        vertices: usize,
    ) -> Result<Vec<[u32; 3]>, FormatError> {
        let Ok(count) = u32::try_from(vertices) else {
            return Err(node.error("there are more than 4 billion vertices: cut the mesh into several"));
        };
        let corners = match node.get("indices") {
            Some(index) => {
                let accessor = Accessor::named(self.document, index, &mut self.reading.budget)?;
                let corners = accessor.indices(&mut self.reading.budget)?;
                if let Some(at) = corners.iter().position(|&corner| corner >= count) {
                    let message = format!("index {at} is {}, but there are {count} vertices", corners[at]);
                    return Err(accessor.node.error(message));
                }
                corners
            }
            None => {
                self.reading.budget.take_bytes(u64::from(count) * 4, &self.file)?;
                (0..count).collect()
            }
        };
        let n = match mode {
            Mode::Triangles => corners.len() / 3,
            Mode::Strip | Mode::Fan => corners.len().saturating_sub(2),
        };
        if mode == Mode::Triangles && corners.len() % 3 != 0 {
            self.oddities.note("the last corners of a list of triangles make none", || node.at());
        }
        self.reading.budget.take_bytes(n as u64 * 12, &self.file)?;
        // The corners' order keeps all triangles of a strip on one side. [glTF 2.0, 3.7.2.1]
        let corner = |t: usize| match mode {
            Mode::Triangles => [3 * t, 3 * t + 1, 3 * t + 2],
            Mode::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Mode::Fan => [t + 1, t + 2, 0],
        };
        Ok((0..n).map(|t| corner(t).map(|i| corners[i])).collect())
    }
}

fn same_count(index: Node, accessor: &Accessor, count: Option<usize>) -> Result<(), FormatError> {
    match count {
        Some(count) if count != accessor.count => Err(index.error(format!(
            "this attribute has {} elements for {count} vertices: it needs as many",
            accessor.count
        ))),
        _ => Ok(()),
    }
}
