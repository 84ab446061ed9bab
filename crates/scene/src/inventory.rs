//! What a file has beside what is shown: what could be chosen from it, and what a reader has chosen.

use crate::builder::SceneBuilder;
use std::sync::Arc;

/// What could be chosen from a file. Empty for formats that leave no choice.
#[derive(Clone, Debug, Default)]
pub struct Inventory {
    /// Movements that are part of the file.
    pub animations: Vec<Animation>,
    /// Sets of materials to choose from.
    pub variants: Vec<String>,
    /// Skeletons that bend meshes.
    pub skins: Vec<String>,
    /// All objects at several moments of their movement, where that was asked for: cameras that are made up see these, so
    /// that they rest while things move.
    pub movement: Option<Arc<SceneBuilder>>,
}

/// A movement that is part of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// Its name; may be empty.
    pub name: String,
    /// When it ends, in seconds.
    pub seconds: f32,
    /// Whether it is one of those that the scene follows.
    pub plays: bool,
}

impl Inventory {
    /// True when reading the file at another time gives another scene.
    pub fn moves(&self) -> bool {
        self.animations.iter().any(|animation| animation.plays)
    }

    /// When the last of what it follows ends, in seconds.
    pub fn seconds(&self) -> f32 {
        self.animations.iter().filter(|animation| animation.plays).map(|a| a.seconds).fold(0.0, f32::max)
    }
}
