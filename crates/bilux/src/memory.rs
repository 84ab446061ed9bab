//! How much memory a picture is going to take, so that none is begun that cannot be held.

use crate::{Error, Job, Settings};
use bilux_scene::{Parameters, SceneBuilder};
use std::collections::HashSet;
use std::sync::Arc;

/// A triangle in trees of its own, while they are built; measured up to 150.
const TRIANGLE: u64 = 160;
/// An object that repeats another, with its place in the tree of all; measured up to 400.
const INSTANCE: u64 = 450;
/// A pixel, with its sums, its layers, and what tells noise and takes it away; measured up to 180.
const PIXEL: u64 = 200;

/// About how many bytes it takes to render a scene, at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Meshes and textures.
    pub scene: u64,
    /// What finds hits.
    pub trees: u64,
    /// The picture while it is made.
    pub picture: u64,
}

impl Memory {
    /// What these settings ask for.
    pub fn of(scene: &SceneBuilder, settings: &Settings) -> Memory {
        let mut meshes = HashSet::new();
        let (mut held, mut trees) = (0, 0);
        for object in &scene.objects {
            let (mesh, is_new) = (&object.mesh, meshes.insert(Arc::as_ptr(&object.mesh)));
            if is_new {
                held += mesh.size();
            }
            // What stands still goes into one tree, as often as it is there.
            let is_still = !object.instanced && object.motion.is_still();
            trees += INSTANCE + if is_new || is_still { mesh.triangles.len() as u64 * TRIANGLE } else { 0 };
        }
        let mut images = HashSet::new();
        let new_images = scene.textures.iter().filter(|texture| images.insert(Arc::as_ptr(&texture.image)));
        // With its coarser levels.
        held += new_images.map(|texture| texture.image.size() / 3 * 4).sum::<u64>();
        let picture = u64::from(settings.width) * u64::from(settings.height) * PIXEL;
        Memory { scene: held, trees, picture }
    }

    /// All of it.
    pub fn total(&self) -> u64 {
        self.scene.saturating_add(self.trees).saturating_add(self.picture)
    }
}

impl Job {
    /// As [`Job::new`], if so many bytes are enough for it.
    ///
    /// # Errors
    /// As there; and before anything is built, when the picture is going to take more.
    pub fn within(scene: &SceneBuilder, user: &Parameters, most: u64) -> Result<Job, Error> {
        let needed = Memory::of(scene, &Settings::resolve(&joined(scene, user))?);
        if needed.total() > most {
            return Err(Error::TooLarge { needed, most });
        }
        Job::new(scene, user)
    }
}

/// The scene file's own settings and the user's, which win.
pub(crate) fn joined(scene: &SceneBuilder, user: &Parameters) -> Parameters {
    let mut all = scene.settings.clone();
    for (key, value, span) in &user.0 {
        all.set_at(key, value.clone(), span.clone());
    }
    all
}
