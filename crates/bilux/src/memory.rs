//! How much memory a picture will take, so that Bilux refuses to start one that does not fit.

use crate::{Error, Settings};
use bilux_formats::FormatError;
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
/// Bytes per pixel, with its sums, its layers, and what measuring the noise and denoising take; measured up to 180.
const PIXEL: u64 = 200;

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

    /// The memory for a picture of a scene with these settings.
    pub fn of(scene: &SceneBuilder, settings: &Settings) -> Memory {
        let picture = u64::from(settings.width) * u64::from(settings.height) * PIXEL;
        Memory { picture, ..Memory::of_scene(scene) }
    }

    /// The sum of all parts.
    pub fn total(&self) -> u64 {
        let Memory { meshes, textures, levels, grids, trees, picture } = *self;
        [meshes, textures, levels, grids, trees, picture].into_iter().fold(0, u64::saturating_add)
    }
}

/// A reader that was refused memory needs at most so many times what it had asked for by then, in the files that were
/// tried, if that is more than [`LEAST_FOR_READING`].
const TIMES_ASKED: u64 = 4;

/// Bytes that are always allowed where reading was refused memory: compressed textures and meshes take up to a hundred
/// times the size of their file, so what a reader asks for first says little about small files.
const LEAST_FOR_READING: u64 = 1 << 30;

/// A file that asks for so many bytes is broken, or means harm.
const BEYOND_BELIEF: u64 = 1 << 40;

impl Error {
    /// The memory to allow, in bytes, if an error says that less is allowed than is needed. Whole GiB, or below one GiB whole
    /// MiB. A render that was refused then has enough; reading a file, which is refused before all of it is known, most
    /// probably.
    pub fn memory_to_allow(&self) -> Option<u64> {
        let bytes = match self {
            Error::TooLarge { needed, .. } => needed.total(),
            Error::Format(FormatError::TooLarge { asked, .. }) if *asked < BEYOND_BELIEF => {
                (asked * TIMES_ASKED).max(LEAST_FOR_READING)
            }
            _ => return None,
        };
        let unit = if bytes >= 1 << 30 { 1 << 30 } else { 1 << 20 };
        Some(bytes.div_ceil(unit).saturating_mul(unit))
    }
}
