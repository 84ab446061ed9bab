//! Displaces surfaces, on triangles as fine as the map and a picture of the scene need.

use crate::geometry::displacement::{Displacement, Moved, moved, tessellated};
use crate::input::reading::Reading;
use crate::world::views::Views;
use bilux_math::Aabb;
use bilux_scene::{Mesh, SceneBuilder, Warning};
use std::collections::HashMap;
use std::sync::Arc;

/// The longest edge of a displaced surface, in pixels of the finest picture.
const EDGE: f32 = 2.0;
/// The shortest, in texels of the map: nothing is gained below.
const TEXELS: f32 = 0.5;
/// The triangles of a displaced mesh.
const MOST: usize = 1 << 21;

impl Reading<'_> {
    /// Displaces the surfaces of this scene for which [`Reading::displacements`] has a map.
    pub fn displace(&mut self, scene: &mut SceneBuilder, file: &Arc<str>) {
        let pending = std::mem::take(&mut self.displacements);
        if pending.is_empty() {
            return;
        }
        let views = Views::of(scene, Aabb::EMPTY);
        let moved = moved_objects(scene, &pending);
        for (what, map) in pending {
            let mut by_mesh: HashMap<*const Mesh, Vec<usize>> = HashMap::new();
            let mut meshes = Vec::new();
            for &index in moved.get(&what).into_iter().flatten() {
                let object = &scene.objects[index];
                let objects = by_mesh.entry(Arc::as_ptr(&object.mesh)).or_insert_with(|| {
                    meshes.push(object.mesh.clone());
                    Vec::new()
                });
                objects.push(index);
            }
            for mesh in meshes {
                let objects = &by_mesh[&Arc::as_ptr(&mesh)];
                match self.displaced(&mesh, objects, &map, scene, &views, file) {
                    Ok(moved) => {
                        let moved = Arc::new(moved);
                        objects.iter().for_each(|&index| scene.objects[index].mesh = moved.clone());
                    }
                    Err(why) => {
                        let name = &scene.objects[objects[0]].name;
                        let message = format!("the displacement of '{name}' is not shown: {why}");
                        scene.warnings.push(Warning { message, at: map.at.clone() });
                    }
                }
            }
        }
    }

    /// The mesh of some objects, tessellated and moved; or why it stays as it is.
    fn displaced(
        &mut self,
        mesh: &Mesh,
        objects: &[usize],
        map: &Displacement,
        scene: &mut SceneBuilder,
        views: &Views,
        file: &str,
    ) -> Result<Mesh, &'static str> {
        if map.uvs(mesh).is_empty() {
            return Err("the mesh has no texture coordinates");
        }
        if self.budget.take_bytes(mesh.size(), file).is_err() {
            return Err("it would take more memory than is allowed");
        }
        let bounds = Aabb::of_points(mesh.positions.iter().copied());
        let pixels = objects.iter().map(|&index| views.pixel_on(&scene.objects[index], &bounds));
        let pixel = pixels.fold(f32::INFINITY, f32::min);
        let longest = (EDGE * pixel).max(TEXELS * map.texel(mesh));
        let (fine, is_fine) = tessellated(mesh, longest, MOST, &mut self.budget, file);
        if !is_fine {
            let message = "a displaced surface is coarser than its map: it would have too many triangles, or take more \
                           memory than is allowed";
            scene.warnings.push(Warning { message: message.to_owned(), at: map.at.clone() });
        }
        Ok(moved(fine, map))
    }
}

/// The objects that each map moves, so that many maps of many objects take no longer than there are of both.
fn moved_objects(scene: &SceneBuilder, pending: &[(Moved, Displacement)]) -> HashMap<Moved, Vec<usize>> {
    let mut found: HashMap<Moved, Vec<usize>> = pending.iter().map(|(what, _)| (*what, Vec::new())).collect();
    for (index, object) in scene.objects.iter().enumerate().filter(|(_, o)| !o.mesh.triangles.is_empty()) {
        for what in [Moved::Material(object.material), Moved::Object(index)] {
            if let Some(objects) = found.get_mut(&what) {
                objects.push(index);
            }
        }
    }
    found
}
