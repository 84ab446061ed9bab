//! Memory that a picture will take, so that Bilux refuses to start one that does not fit.

use bilux_scene::{Mesh, SceneBuilder};
use std::collections::HashSet;
use std::sync::Arc;

/// Bytes per triangle in its mesh's own tree, while the tree is built; measured up to 157.
const TRIANGLE: u64 = 170;
/// Bytes per point or line in a tree, including the positions of its vertices in world space, while the tree is built;
/// an estimate.
const STROKE: u64 = 150;
/// Bytes per instance of a repeated object, including its entry in the top-level tree; measured at 295.
const INSTANCE: u64 = 350;
fn trees_over(mesh: &Mesh) -> u64 {
    mesh.triangles.len() as u64 * TRIANGLE + mesh.stroke_count() as u64 * STROKE
}

/// An upper estimate of the bytes that rendering a scene takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Meshes as they are stored, each counted once.
    pub meshes: u64,
    /// Textures as they are stored, each image counted once.
    pub textures: u64,
    /// The textures' coarser mipmap levels, if the render makes them.
    pub levels: u64,
    /// Grids as they are stored, each counted once.
    pub grids: u64,
    /// The acceleration structures.
    pub trees: u64,
    /// The picture while it is rendered.
    pub picture: u64,
}

impl Memory {
    /// The memory for a scene, whatever the picture.
    pub fn of_scene(scene: &SceneBuilder) -> Memory {
        let mut all = Memory::default();
        let mut meshes = HashSet::new();
        for object in &scene.objects {
            let (mesh, is_new) = (&object.mesh, meshes.insert(Arc::as_ptr(&object.mesh)));
            if is_new {
                all.meshes += mesh.size();
            }
            // A static object goes into one tree, once for each of its occurrences.
            let is_still = !object.instanced && object.motion.is_still();
            all.trees += INSTANCE + if is_new || is_still { trees_over(mesh) } else { 0 };
        }
        let mut images = HashSet::new();
        let new_images = scene.textures.iter().filter(|texture| images.insert(Arc::as_ptr(&texture.image)));
        all.textures = new_images.map(|texture| texture.image.size()).sum();
        all.levels = all.textures / 3;
        all.grids = scene.grids().iter().map(|grid| grid.bytes()).sum();
        all
    }

    /// The sum of all parts.
    pub fn total(&self) -> u64 {
        let Memory { meshes, textures, levels, grids, trees, picture } = *self;
        [meshes, textures, levels, grids, trees, picture].into_iter().fold(0, u64::saturating_add)
    }
}
