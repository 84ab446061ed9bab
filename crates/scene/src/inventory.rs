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
    /// The scene at time 0, where it was read as it is at another and something moves: cameras that are made up look
    /// at this one, so that they rest while it moves.
    pub rest: Option<Arc<SceneBuilder>>,
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
}
