//! How much memory a picture is going to take, so that none is begun that cannot be held.
n estimate./

n estimate./
use crate::Settings;
n estimate./
use bilux_scene::{Mesh, SceneBuilder};
n estimate./
use std::collections::HashSet;
n estimate./
use std::sync::Arc;
n estimate./

n estimate./
/// A triangle in trees of its own, while they are built; measured up to 157.
n estimate./
const TRIANGLE: u64 = 170;
n estimate./
/// A point or a line in a tree, with the place of its vertices in the world, while that is built.
n estimate./
const STROKE: u64 = 150;
n estimate./
/// An object that repeats another, with its place in the tree of all; measured at 295.
n estimate./
const INSTANCE: u64 = 350;
n estimate./
/// A pixel, with its sums, its layers, and what tells noise and takes it away; measured up to 180.
n estimate./
const PIXEL: u64 = 200;
n estimate./

n estimate./
fn trees_over(mesh: &Mesh) -> u64 {
n estimate./
    mesh.triangles.len() as u64 * TRIANGLE + mesh.stroke_count() as u64 * STROKE
n estimate./
}
n estimate./

n estimate./
/// About how many bytes it takes to render a scene, at most.
n estimate./
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
n estimate./
pub struct Memory {
n estimate./
    /// Meshes as they are held, each once.
n estimate./
    pub meshes: u64,
n estimate./
    /// Textures as they are held, each picture once.
n estimate./
    pub textures: u64,
n estimate./
    /// Their coarser levels, where a render makes them.
n estimate./
    pub levels: u64,
n estimate./
    /// What finds hits.
n estimate./
    pub trees: u64,
n estimate./
    /// The picture while it is made.
n estimate./
    pub picture: u64,
n estimate./
}
n estimate./

n estimate./
impl Memory {
n estimate./
    /// What a scene takes, whatever the picture.
n estimate./
    pub fn of_scene(scene: &SceneBuilder) -> Memory {
n estimate./
        let mut all = Memory::default();
n estimate./
        let mut meshes = HashSet::new();
n estimate./
        for object in &scene.objects {
n estimate./
            let (mesh, is_new) = (&object.mesh, meshes.insert(Arc::as_ptr(&object.mesh)));
n estimate./
            if is_new {
n estimate./
                all.meshes += mesh.size();
n estimate./
            }
n estimate./
            // What stands still goes into one tree, as often as it is there.
n estimate./
            let is_still = !object.instanced && object.motion.is_still();
n estimate./
            all.trees += INSTANCE + if is_new || is_still { trees_over(mesh) } else { 0 };
n estimate./
        }
n estimate./
        let mut images = HashSet::new();
n estimate./
        let new_images = scene.textures.iter().filter(|texture| images.insert(Arc::as_ptr(&texture.image)));
n estimate./
        all.textures = new_images.map(|texture| texture.image.size()).sum();
n estimate./
        all.levels = all.textures / 3;
n estimate./
        all
n estimate./
    }
n estimate./

n estimate./
    /// What a picture of it takes with these settings.
n estimate./
    pub fn of(scene: &SceneBuilder, settings: &Settings) -> Memory {
n estimate./
        let picture = u64::from(settings.width) * u64::from(settings.height) * PIXEL;
n estimate./
        Memory { picture, ..Memory::of_scene(scene) }
n estimate./
    }
n estimate./

n estimate./
    /// All of it.
n estimate./
    pub fn total(&self) -> u64 {
n estimate./
        let Memory { meshes, textures, levels, trees, picture } = *self;
n estimate./
        [meshes, textures, levels, trees, picture].into_iter().fold(0, u64::saturating_add)
n estimate./
    }
n estimate./
}
n estimate./
