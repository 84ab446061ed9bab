//! Polygons, as one mesh of each material.

use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::polygon::Triangulator;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DVec3, Vec3};
use bilux_scene::{Mesh, Object, Span, Spec, Visibility};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// All polygons so far.
#[derive(Default)]
pub(super) struct Polygons {
    groups: Vec<Group>,
    by_key: HashMap<Key, usize>,
    triangulator: Triangulator,
}

/// Properties that polygons of one mesh have in common.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Key {
    /// The index of their material.
    pub(super) material: usize,
    /// Prefix of their names: the copies of an array are objects of their own.
    pub(super) prefix: Option<Rc<str>>,
    /// Whether the camera does not see them.
    pub(super) is_hidden: bool,
}

struct Group {
    key: Key,
    mesh: Mesh,
    /// Vertices by the bits of their positions, so that the polygons of a solid close.
    vertices: HashMap<[u32; 3], u32>,
    at: Span,
}

/// Bytes of a vertex with its place in the table.
const VERTEX: u64 = 64;

impl Polygons {
    /// Adds a polygon by its corners in the world, in which its front is where they run counter-clockwise.
    pub(super) fn add(
        &mut self,
        key: Key,
        corners: &[DVec3],
        at: &Span,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<(), FormatError> {
        let count = corners.len() as u64;
        budget.take_bytes(count * (VERTEX + size_of::<[[u32; 3]; 2]>() as u64), &at.file)?;
        let Polygons { groups, by_key, triangulator } = self;
        let index = match by_key.get(&key) {
            Some(index) => *index,
            None => {
                budget.take_bytes(2 * size_of::<Group>() as u64, &at.file)?;
                by_key.insert(key.clone(), groups.len());
                let (mesh, vertices) = (Mesh::default(), HashMap::new());
                groups.push(Group { key, mesh, vertices, at: at.clone() });
                groups.len() - 1
            }
        };
        let Group { mesh, vertices, .. } = &mut groups[index];
        let indices: Vec<u32> =
            corners.iter().map(|corner| vertex(mesh, vertices, corner.as_vec3())).collect();
        let points = indices.iter().map(|&i| mesh.positions[i as usize]);
        let triangles = &mut mesh.triangles;
        let whole = triangulator.triangulate(points, |t| {
            let [a, b, c] = t.map(|corner| indices[corner as usize]);
            // The seams to the holes of a polygon have the same corners twice.
            if a != b && b != c && c != a {
                triangles.push([a, b, c]);
            }
        });
        if whole.is_none() {
            let what = "a concave polygon has too many corners: it is drawn as if it were convex";
            diagnostics.note(what, || at.clone());
        }
        Ok(())
    }

    /// An object of each mesh, with the place of its first polygon.
    pub(super) fn objects(self, materials: &[Spec]) -> Vec<(Object, Span)> {
        let groups = self.groups.into_iter().filter(|group| !group.mesh.triangles.is_empty());
        groups.map(|group| group.object(materials)).collect()
    }
}

impl Group {
    fn object(self, materials: &[Spec]) -> (Object, Span) {
        let Group { key, mut mesh, at, .. } = self;
        let of_material = materials.get(key.material).map_or("", |spec| &spec.name);
        let name = match &key.prefix {
            Some(prefix) => format!("{prefix}.{of_material}"),
            None => of_material.to_owned(),
        };
        mesh.name.clone_from(&name);
        let visibility = if key.is_hidden { Visibility::NoCamera } else { Visibility::Full };
        (Object { visibility, ..Object::new(&name, Arc::new(mesh), key.material) }, at)
    }
}

/// The index of a vertex at a position.
fn vertex(mesh: &mut Mesh, vertices: &mut HashMap<[u32; 3], u32>, position: Vec3) -> u32 {
    // Both zeros are the same place.
    let position = position + Vec3::ZERO;
    *vertices.entry(position.to_array().map(f32::to_bits)).or_insert_with(|| {
        mesh.positions.push(position);
        (mesh.positions.len() - 1) as u32
    })
}
