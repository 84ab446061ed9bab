//! Mesh primitives: converts attributes and indices to triangles.

use super::accessor::Accessor;
use super::alpha::Alpha;
use super::json::JsonNode;
use super::material::UsedMaterial;
use super::reader::Gltf;
use super::skin::Joints;
use super::tangents;
use super::topology::Mode;
use crate::FormatError;
use crate::text::quoted;
use bilux_math::glam::Vec4;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::sync::Arc;

/// The result of one primitive.
#[derive(Clone)]
pub(super) struct Part {
    pub(super) mesh: Arc<Mesh>,
    /// The index of its material in the scene.
    pub(super) material: usize,
}

/// What a node adds to its mesh.
pub(super) struct NodeMesh<'a> {
    pub(super) name: &'a str,
    /// The weights of the morph targets.
    pub(super) weights: &'a [f64],
    pub(super) joints: Option<&'a Joints>,
}

/// Attributes that are read here, or reported elsewhere.
const ATTRIBUTES: [&str; 4] = ["POSITION", "NORMAL", "TANGENT", "COLOR_0"];

impl<'d> Gltf<'d, '_, '_> {
    /// Reads a primitive of a mesh; `None` if there is nothing to render.
    pub(super) fn primitive(
        &mut self,
        node: JsonNode<'d>,
        worn: &NodeMesh,
    ) -> Result<Option<Part>, FormatError> {
        let mode = Mode::of(node)?;
        let attributes = node.need("attributes")?;
        let Some(position) = attributes.get("POSITION") else {
            self.oddities.note("a primitive has no POSITION and is left out", || node.at());
            return Ok(None);
        };
        let mut mesh = Mesh { name: worn.name.to_owned(), ..Mesh::default() };
        mesh.positions = vec3(self.attribute::<3>(position, None)?);
        let count = mesh.positions.len();
        mesh.triangles = match mode {
            Mode::Triangles | Mode::Strip | Mode::Fan => self.triangles(node, mode, count)?,
            _ => Vec::new(),
        };
        let named = self.variant_of(node)?.or(node.get("material"));
        let is_solid = self.is_solid_glass(named, &mesh)?;
        let (kd, alphas) = match attributes.get("COLOR_0") {
            Some(colour) => self.colours(colour, count)?,
            None => Default::default(),
        };
        let material = self.material(named, (is_solid, !alphas.is_empty()))?;
        self.directions(attributes, material, &mut mesh)?;
        self.morph(node, worn.weights, &mut mesh)?;
        if let Some(joints) = worn.joints {
            self.bend(node, joints, &mut mesh)?;
        }
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
            self.oddities.note(what, || position.at());
        }
        self.coordinates(attributes, material, &mut mesh)?;
        // Of what is unlit, the colour is what it emits.
        (mesh.emission_by_kd, mesh.vertex_kd) = (material.is_unlit && !kd.is_empty(), kd);
        if material.alpha != Alpha::Opaque {
            mesh.vertex_opacity = alphas;
            mesh.opacity_threshold = match material.alpha {
                Alpha::Mask(cutoff) if !mesh.vertex_opacity.is_empty() => Some(cutoff),
                _ => None,
            };
        }
        self.note_unused(attributes, material);
        match mode {
            Mode::Triangles | Mode::Strip | Mode::Fan => self.add_tangents(material, &mut mesh)?,
            thin => self.add_strokes(node, thin, &mut mesh)?,
        }
        if mesh.is_empty() {
            self.oddities.note("a primitive has nothing to render and is left out", || node.at());
            return Ok(None);
        }
        Ok(Some(Part { mesh: Arc::new(mesh), material: material.index }))
    }

    /// Reads normals, and tangents if the material depends on a direction.
    fn directions(
        &mut self,
        attributes: JsonNode<'d>,
        material: UsedMaterial,
        mesh: &mut Mesh,
    ) -> Result<(), FormatError> {
        let count = mesh.positions.len();
        if let Some(normal) = attributes.get("NORMAL") {
            mesh.normals = vec3(self.attribute::<3>(normal, Some(count))?);
            if mesh.normals.iter().any(|n| (n.length_squared() - 1.0).abs() > 0.1) {
                self.oddities.note("some normals do not have length 1; they are normalised", || normal.at());
            }
        }
        if let Some(tangent) = attributes.get("TANGENT").filter(|_| material.has_direction) {
            let tangents = self.attribute::<4>(tangent, Some(count))?;
            if tangents.iter().any(|t| t[3].abs() != 1.0) {
                let what = "the fourth number of a tangent must be 1 or -1; its sign is used";
                self.oddities.note(what, || tangent.at());
            }
            mesh.tangents = tangents.into_iter().map(Vec4::from).collect();
        }
        Ok(())
    }

    /// Reads the sets of texture coordinates that the material uses.
    fn coordinates(
        &mut self,
        attributes: JsonNode<'d>,
        material: UsedMaterial,
        mesh: &mut Mesh,
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
                Some((_, uv)) => self
                    .attribute::<2>(uv, Some(count))?
                    .into_iter()
                    .map(|[u, v]| Vec2::new(u, 1.0 - v))
                    .collect(),
                None if material.uv_sets[slot].is_some() => {
                    let what =
                        "a material needs texture coordinates that its mesh does not have; they are set to 0";
                    self.oddities.note(what, || attributes.at());
                    self.reading.budget.take_bytes(count as u64 * 8, &self.file)?;
                    vec![Vec2::Y; count]
                }
                None => Vec::new(),
            };
            if slot == 0 { mesh.uvs = uvs } else { mesh.uvs2 = uvs }
        }
        Ok(())
    }

    /// Generates tangents if they are needed and the file has none.
    fn add_tangents(&mut self, material: UsedMaterial, mesh: &mut Mesh) -> Result<(), FormatError> {
        if !material.has_direction || !mesh.tangents.is_empty() || mesh.uvs.is_empty() {
            return Ok(());
        }
        // Lists that the generator makes for every corner.
        self.reading.budget.take_bytes(mesh.triangles.len() as u64 * 400, &self.file)?;
        tangents::add(mesh, material.normal_by_second);
        Ok(())
    }

    /// The elements of an attribute, one per vertex.
    pub(super) fn attribute<const N: usize>(
        &mut self,
        index: JsonNode<'d>,
        count: Option<usize>,
    ) -> Result<Vec<[f32; N]>, FormatError> {
        let accessor = Accessor::named(self.document, index, &mut self.reading.budget)?;
        same_count(index, &accessor, count)?;
        accessor.floats(&mut self.reading.budget)
    }

    /// The colours of vertices, which are linear, and their alphas if any is not 1. All are clamped to 0 to 1.
    /// [glTF 2.0, 3.7.2.1]
    fn colours(&mut self, index: JsonNode<'d>, count: usize) -> Result<(Vec<Rgb>, Vec<f32>), FormatError> {
        let mut accessor = Accessor::named(self.document, index, &mut self.reading.budget)?;
        same_count(index, &accessor, Some(count))?;
        if accessor.normalise() {
            let what =
                "colours of vertices are integers without 'normalized'; they are taken as if they had it";
            self.oddities.note(what, || index.at());
        }
        let budget = &mut self.reading.budget;
        if accessor.width() == 3 {
            let colours = accessor.floats::<3>(budget)?;
            return Ok((
                colours.into_iter().map(|c| Rgb::from_array(c).clamp(0.0, 1.0)).collect(),
                Vec::new(),
            ));
        }
        let colours = accessor.floats::<4>(budget)?;
        let mut alphas = Vec::new();
        if colours.iter().any(|c| c[3] != 1.0) {
            budget.take_bytes(count as u64 * 4, &self.file)?;
            alphas = colours.iter().map(|c| c[3].clamp(0.0, 1.0)).collect();
        }
        let kd = colours.into_iter().map(|[r, g, b, _]| Rgb::new(r, g, b).clamp(0.0, 1.0)).collect();
        Ok((kd, alphas))
    }

    /// Adds the weighted displacements of the morph targets. [glTF 2.0, 3.7.2.2]
    fn morph(&mut self, node: JsonNode<'d>, weights: &[f64], mesh: &mut Mesh) -> Result<(), FormatError> {
        let targets = node.list("targets")?;
        if targets.len() != weights.len() && !weights.is_empty() {
            let what = "the number of weights differs from the number of morph targets";
            self.oddities.note(what, || node.at_key("targets"));
        }
        for (target, &weight) in targets.into_iter().zip(weights) {
            for (key, used) in target.entries() {
                if !matches!(key, "POSITION" | "NORMAL" | "TANGENT") && !key.starts_with('_') {
                    let what = "a morph target moves something other than positions, normals and tangents, which is ignored";
                    self.oddities.note(what, || used.at());
                }
            }
            if weight == 0.0 {
                continue;
            }
            let mut by = |key: &'static str, count: usize| -> Result<Vec<Vec3>, FormatError> {
                let Some(index) = target.get(key).filter(|_| count > 0) else { return Ok(Vec::new()) };
                let by = vec3(self.attribute::<3>(index, Some(count))?);
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

    fn note_unused(&mut self, attributes: JsonNode<'d>, material: UsedMaterial) {
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
                self.oddities.not_shown(&format!("{} of meshes", quoted(key.as_bytes())), || node.at());
            }
        }
    }

    /// Reads the points or the lines of a primitive.
    fn add_strokes(&mut self, node: JsonNode<'d>, mode: Mode, mesh: &mut Mesh) -> Result<(), FormatError> {
        let corners = self.corners(node, mesh.positions.len())?;
        self.reading.budget.take_bytes(corners.len() as u64 * 8, &self.file)?;
        (mesh.points, mesh.lines) = mode.points_and_lines(corners);
        // Points and lines are round, so normals and tangents have no meaning.
        (mesh.normals, mesh.tangents) = (Vec::new(), Vec::new());
        Ok(())
    }
}

fn vec3(list: Vec<[f32; 3]>) -> Vec<Vec3> {
    list.into_iter().map(Vec3::from).collect()
}

fn same_count(index: JsonNode, accessor: &Accessor, count: Option<usize>) -> Result<(), FormatError> {
    match count {
        Some(count) if count != accessor.count => Err(index.error(format!(
            "this attribute has {} elements for {count} vertices: the numbers must be equal",
            accessor.count
        ))),
        _ => Ok(()),
    }
}
