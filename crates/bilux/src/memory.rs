//! How much memory a picture is going to take, so that none is begun that cannot be held.

use crate::Settings;
use bilux_scene::{Mesh, SceneBuilder};
use std::collections::HashSet;
use std::sync::Arc;

/// A triangle in trees of its own, while they are built; measured up to 157.
const TRIANGLE: u64 = 170;
/// A point or a line in a tree, with the place of its vertices in the world, while that is built; an estimate.
const STROKE: u64 = 150;
/// An object that repeats another, with its place in the tree of all; measured at 295.
const INSTANCE: u64 = 350;
/// A pixel, with its sums, its layers, and what tells noise and takes it away; measured up to 180.
const PIXEL: u64 = 200;

fn trees_over(mesh: &Mesh) -> u64 {
    mesh.triangles.len() as u64 * TRIANGLE + mesh.stroke_count() as u64 * STROKE
}

/// About how many bytes it takes to render a scene, at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Meshes as they are held, each once.
    pub meshes: u64,
    /// Textures as they are held, each picture once.
    pub textures: u64,
    /// Their coarser levels, where a render makes them.
    pub levels: u64,
    /// What finds hits.
    pub trees: u64,
    /// The picture while it is made.
    pub picture: u64,
}

impl Memory {
    /// What a scene takes, whatever the picture.
    pub fn of_scene(scene: &SceneBuilder) -> Memory {
        let mut all = Memory::default();
        let mut meshes = HashSet::new();
        for object in &scene.objects {
            let (mesh, is_new) = (&object.mesh, meshes.insert(Arc::as_ptr(&object.mesh)));
            if is_new {
                all.meshes += mesh.size();
            }
            // What stands still goes into one tree, as often as it is there.
            let is_still = !object.instanced && object.motion.is_still();
            all.trees += INSTANCE + if is_new || is_still { trees_over(mesh) } else { 0 };
        }
        let mut images = HashSet::new();
        let new_images = scene.textures.iter().filter(|texture| images.insert(Arc::as_ptr(&texture.image)));
        all.textures = new_images.map(|texture| texture.image.size()).sum();
        all.levels = all.textures / 3;
        all
    }

    /// What a picture of it takes with these settings.
    pub fn of(scene: &SceneBuilder, settings: &Settings) -> Memory {
        let picture = u64::from(settings.width) * u64::from(settings.height) * PIXEL;
        Memory { picture, ..Memory::of_scene(scene) }
    }

    /// All of it.
    pub fn total(&self) -> u64 {
        let Memory { meshes, textures, levels, trees, picture } = *self;
        [meshes, textures, levels, trees, picture].into_iter().fold(0, u64::saturating_add)
    }
}
