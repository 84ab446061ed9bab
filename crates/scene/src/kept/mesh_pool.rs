//! The meshes of a scene, each once, so that whatever was made from a mesh is found again by its address.

use super::Same;
use crate::mesh::Mesh;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The meshes of the last build. An equal mesh of the next one is replaced by the one that is known: grounds and
/// panels of light are made anew each time.
#[derive(Clone, Default)]
pub(crate) struct MeshPool {
    known: HashSet<Same<Mesh>>,
    now: HashSet<Same<Mesh>>,
    /// The known ones by their sizes; filled when an unknown mesh comes.
    by_size: Option<HashMap<[usize; 3], Vec<Same<Mesh>>>>,
}

impl MeshPool {
    /// The mesh with which to build. `check` checks one that is not known yet.
    pub(crate) fn of<E>(
        &mut self,
        mesh: &Arc<Mesh>,
        check: impl FnOnce() -> Result<(), E>,
    ) -> Result<Arc<Mesh>, E> {
        let mesh = Same(mesh.clone());
        if self.now.contains(&mesh) {
            return Ok(mesh.0);
        }
        let mut found = self.known.get(&mesh).cloned();
        if found.is_none() && !self.known.is_empty() {
            let by_size = self.by_size.get_or_insert_with(|| by_size(&self.known));
            let alike = by_size.get(&size(&mesh.0));
            found = alike.into_iter().flatten().find(|known| is_same_mesh(&known.0, &mesh.0)).cloned();
        }
        let found = match found {
            Some(found) => found,
            None => {
                check()?;
                mesh
            }
        };
        self.now.insert(found.clone());
        Ok(found.0)
    }

    /// The build ends: a successful one keeps its meshes, a failed one those from before.
    pub(crate) fn end(&mut self, succeeded: bool) {
        let now = std::mem::take(&mut self.now);
        if succeeded {
            self.known = now;
        }
        self.by_size = None;
    }

    /// The number of meshes.
    pub(crate) fn len(&self) -> usize {
        self.known.len()
    }
}

fn size(mesh: &Mesh) -> [usize; 3] {
    [mesh.positions.len(), mesh.triangles.len(), mesh.stroke_count()]
}

fn by_size(meshes: &HashSet<Same<Mesh>>) -> HashMap<[usize; 3], Vec<Same<Mesh>>> {
    let mut by_size: HashMap<_, Vec<_>> = HashMap::new();
    for mesh in meshes {
        by_size.entry(size(&mesh.0)).or_default().push(mesh.clone());
    }
    by_size
}

/// True when two meshes agree in every bit.
fn is_same_mesh(a: &Mesh, b: &Mesh) -> bool {
    // Whoever adds a field is told to compare it here.
    let Mesh {
        name,
        positions,
        normals,
        uvs,
        uvs2,
        tangents,
        vertex_kd,
        vertex_ks,
        emission_by_kd,
        vertex_opacity,
        opacity_threshold,
        point_widths,
        triangles,
        points,
        lines,
    } = a;
    name == &b.name
        && (triangles, points, lines) == (&b.triangles, &b.points, &b.lines)
        && (*emission_by_kd, opacity_threshold.map(f32::to_bits))
            == (b.emission_by_kd, b.opacity_threshold.map(f32::to_bits))
        && alike(vertex_opacity, &b.vertex_opacity, |x| [*x])
        && alike(point_widths, &b.point_widths, |x| [*x])
        && alike(positions, &b.positions, |v| v.to_array())
        && alike(normals, &b.normals, |v| v.to_array())
        && alike(uvs, &b.uvs, |v| v.to_array())
        && alike(uvs2, &b.uvs2, |v| v.to_array())
        && alike(tangents, &b.tangents, |v| v.to_array())
        && alike(vertex_kd, &b.vertex_kd, |c| c.to_array())
        && alike(vertex_ks, &b.vertex_ks, |c| c.to_array())
}

fn alike<T, const N: usize>(a: &[T], b: &[T], numbers: impl Fn(&T) -> [f32; N]) -> bool {
    let bits = |v: &T| numbers(v).map(f32::to_bits);
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| bits(a) == bits(b))
}
