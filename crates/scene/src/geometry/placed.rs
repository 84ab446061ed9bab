//! Objects placed in the scene.

use crate::mesh::Mesh;
use bilux_math::motion::Motion;
use std::sync::Arc;

/// Which rays see an object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Visibility {
    /// All.
    #[default]
    Full,
    /// All but those of the camera, which pass it: it still has a shadow, and mirrors and glass show it.
    NoCamera,
    /// None, as if it were not there.
    Hidden,
}

impl Visibility {
    /// All of them.
    pub const ALL: [Visibility; 3] = [Visibility::Full, Visibility::NoCamera, Visibility::Hidden];

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Visibility::Full => "full",
            Visibility::NoCamera => "no-camera",
            Visibility::Hidden => "hidden",
        }
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Visibility> {
        Visibility::ALL.into_iter().find(|one| one.name() == name)
    }
}

/// An object placed in the scene, the input of [`crate::geometry::Geometry::build`].
pub struct Placed {
    /// Triangles, in object space.
    pub mesh: Arc<Mesh>,
    /// Index of its material.
    pub material: u32,
    /// Position and motion.
    pub motion: Motion,
    /// Whether it keeps a tree of its own.
    pub instanced: bool,
    /// Whether its material emits light.
    pub gives_light: bool,
    /// Whether its material needs tangents.
    pub has_tangents: bool,
    /// Whether it has filtered textures.
    pub is_filtered: bool,
    /// Which rays see it. One that none sees has no triangles.
    pub visibility: Visibility,
}

impl Placed {
    /// True for an object outside of the common tree.
    pub(crate) fn in_own_tree(&self) -> bool {
        self.instanced || !self.motion.is_still()
    }
}
