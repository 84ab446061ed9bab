//! Refines subdivision surfaces as far as a picture of the scene needs.

use crate::bytes::budget::Budget;
use crate::geometry::subdivision::{Cage, PendingCage};
use crate::input::reading::Reading;
use crate::world::views::Views;
use bilux_math::Aabb;
use bilux_scene::{Mesh, Object, SceneBuilder, Warning};
use std::collections::HashMap;
use std::sync::Arc;

/// The longest edge of a refined cage in pixels: a surface as round as a ball of 80 pixels is met within a tenth of one.
const EDGE: f32 = 8.0;
/// Polygons of a refined cage.
const MOST: usize = 1 << 21;
/// Levels of any cage: an edge becomes 256.
const LEVELS: u32 = 8;

impl Reading<'_> {
    /// Refines the cages that this scene has waited for.
    pub fn refine_cages(&mut self, scene: &mut SceneBuilder, file: &Arc<str>) {
        let cages = std::mem::take(&mut self.cages);
        if cages.is_empty() {
            return;
        }
        let waiting = Waiting::of(scene);
        let of_cage = |pending: &PendingCage| {
            let bounds = Aabb::of_points(pending.cage.positions());
            let objects = waiting.objects(scene, pending).into_iter();
            objects.map(|object| object.motion.at(0.0).bounds(&bounds)).fold(Aabb::EMPTY, Aabb::union)
        };
        let views = Views::of(scene, cages.iter().map(of_cage).fold(Aabb::EMPTY, Aabb::union));
        let wanted: Vec<u32> =
            cages.iter().map(|pending| levels(&views, &waiting.objects(scene, pending), pending)).collect();
        let mut coarse = None;
        for (pending, wanted) in cages.into_iter().zip(wanted) {
            let PendingCage { mut cage, stand_ins, at } = pending;
            let mut level = 0;
            while level < wanted {
                if !fits(&cage, &mut self.budget, file) {
                    coarse.get_or_insert((at.clone(), level, wanted));
                    break;
                }
                cage = cage.refined();
                level += 1;
            }
            let meshes = cage.meshes(stand_ins.len());
            for (stand_in, mesh) in stand_ins.iter().zip(meshes) {
                let mesh = Arc::new(Mesh { name: stand_in.name.clone(), ..mesh });
                for &object in waiting.indices(stand_in) {
                    scene.objects[object].mesh = mesh.clone();
                }
            }
        }
        scene.objects.retain(|object| !object.mesh.positions.is_empty());
        if let Some((at, level, wanted)) = coarse {
            let message = format!(
                "a subdivision surface is refined {level} times, not {wanted}: it would have too many polygons, or take \
                 more memory than is allowed"
            );
            scene.warnings.push(Warning { message, at });
        }
    }
}

/// True if the next level has room; its memory then counts.
fn fits(cage: &Cage, budget: &mut Budget, file: &str) -> bool {
    cage.faces() * 4 <= MOST && budget.take_bytes(cage.bytes_of_next(), file).is_ok()
}

/// Which objects have which mesh, so that many cages of many objects take no longer than there are of both.
struct Waiting(HashMap<*const Mesh, Vec<usize>>);

impl Waiting {
    fn of(scene: &SceneBuilder) -> Waiting {
        let mut by_mesh: HashMap<*const Mesh, Vec<usize>> = HashMap::new();
        for (index, object) in scene.objects.iter().enumerate().filter(|(_, o)| o.mesh.positions.is_empty()) {
            by_mesh.entry(Arc::as_ptr(&object.mesh)).or_default().push(index);
        }
        Waiting(by_mesh)
    }

    fn indices(&self, stand_in: &Arc<Mesh>) -> &[usize] {
        self.0.get(&Arc::as_ptr(stand_in)).map_or(&[], Vec::as_slice)
    }

    /// The objects that wait for a cage.
    fn objects<'s>(&self, scene: &'s SceneBuilder, pending: &PendingCage) -> Vec<&'s Object> {
        let indices = pending.stand_ins.iter().flat_map(|stand_in| self.indices(stand_in));
        indices.map(|&index| &scene.objects[index]).collect()
    }
}

/// Number of times that a cage is refined until its edges are short in every view.
fn levels(views: &Views, objects: &[&Object], pending: &PendingCage) -> u32 {
    let bounds = Aabb::of_points(pending.cage.positions());
    let pixels = objects.iter().map(|object| views.pixel_on(object, &bounds));
    let longest = pending.cage.longest_edge() as f32 / pixels.fold(f32::INFINITY, f32::min);
    (1..LEVELS).find(|&level| longest <= EDGE * (1 << level) as f32).unwrap_or(LEVELS)
}
