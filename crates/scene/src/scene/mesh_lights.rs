//! The lights of emissive objects, kept from one build to the next.

use crate::geometry::Geometry;
use crate::geometry::corners::corner_uvs;
use crate::kept::{Kept, Place, Same};
use crate::lights::{MeshLight, Picture, SurfaceEmission};
use crate::materials::Material;
use crate::mesh::Mesh;
use crate::texture::ColourMap;
use bilux_accel::Primitive;
use bilux_math::Rgb;
use std::sync::Arc;

/// The pictures of a scene's lights are cut into up to so many pieces, all together: a city has thousands of windows.
const MAX_PIECES: usize = 1 << 16;

/// Key of a light, all that it was made from: mesh, place, material, whether the object has a tree of its own, its first
/// triangle, the bits of its classic colour, and into how many pieces its picture may be cut.
type Key = (Same<Mesh>, Place, Same<dyn Material>, bool, Primitive, Option<[u32; 3]>, usize);

/// The lights of objects that do not move; `None` for one without area.
#[derive(Clone, Default)]
pub(crate) struct MeshLights(pub(crate) Kept<Key, Option<Arc<MeshLight>>>);

impl MeshLights {
    /// The light of an object of this material; `None` if it has no area. `max_pieces` is what [`max_pieces`] gives.
    pub(crate) fn of_object(
        &mut self,
        geometry: &Geometry,
        index: u32,
        material: &Arc<dyn Material>,
        classic: Option<Rgb>,
        max_pieces: usize,
    ) -> Option<Arc<MeshLight>> {
        let object = &geometry.objects()[index as usize];
        let max_pieces = if varies(&object.mesh, &**material) { max_pieces } else { 0 };
        let make = || of_object(geometry, index, &**material, classic, max_pieces).map(Arc::new);
        // Keyframes are not compared.
        let place = object.motion.static_transform().and_then(|_| Place::of(&object.motion));
        let Some(place) = place else { return make() };
        let (mesh, material) = (Same(object.mesh.clone()), Same(material.clone()));
        let bits = classic.map(|colour| colour.to_array().map(f32::to_bits));
        let first = geometry.first_primitive(index);
        self.0.or_make_surely((mesh, place, material, object.in_own_tree(), first, bits, max_pieces), make)
    }
}

/// Into how many pieces each picture of a scene's lights may be cut.
pub(crate) fn max_pieces(geometry: &Geometry, materials: &[Arc<dyn Material>]) -> usize {
    let lights = geometry.objects().iter().filter(|object| object.gives_light);
    let pictures = lights.filter(|object| varies(&object.mesh, &*materials[object.material as usize]));
    MAX_PIECES / pictures.count().max(1)
}

/// Whether an object's emission varies across it.
fn varies(mesh: &Mesh, material: &dyn Material) -> bool {
    material.emission_map().is_some()
        || material.opacity().is_some()
        || mesh.emission_by_kd
        || !mesh.vertex_opacity.is_empty()
}

fn of_object(
    geometry: &Geometry,
    index: u32,
    material: &dyn Material,
    classic: Option<Rgb>,
    max_pieces: usize,
) -> Option<MeshLight> {
    let object = &geometry.objects()[index as usize];
    let (triangles, motion) = geometry.object_triangles(index);
    let even = || ColourMap { colour: material.emission(), texture: None };
    let mesh = &object.mesh;
    let picture = varies(mesh, material).then(|| Picture {
        map: material.emission_map().cloned().unwrap_or_else(even),
        opacity: material.opacity().cloned(),
        uvs: corner_uvs(mesh),
        mesh: mesh.clone(),
        max_pieces,
    });
    let (radiance, sides) = (material.emission(), material.emission_sides());
    let emitted = SurfaceEmission { radiance, picture, sides };
    let mirrored = object.motion.at(0.0).mirrors();
    MeshLight::new(triangles, mirrored, geometry.first_primitive(index), motion, emitted, classic)
}
