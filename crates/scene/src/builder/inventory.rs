//! The other contents of a file: what the user could choose from it, and what was chosen.

/// The choices that a file offers. Empty for formats that offer none.
#[derive(Clone, Debug, Default)]
pub struct Inventory {
    /// Animations in the file.
    pub animations: Vec<Animation>,
    /// Sets of materials to choose from.
    pub variants: Vec<String>,
    /// Skeletons that deform meshes.
    pub skins: Vec<String>,
}

/// An animation in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// Name of the animation; may be empty.
    pub name: String,
    /// When it ends, in seconds.
    pub seconds: f32,
    /// Whether the scene plays it.
    pub plays: bool,
}

impl Inventory {
    /// True when the file gives a different scene at another time.
    pub fn moves(&self) -> bool {
        self.animations.iter().any(|animation| animation.plays)
    }

    /// When the last playing animation ends, in seconds.
    pub fn seconds(&self) -> f32 {
        self.animations.iter().filter(|animation| animation.plays).map(|a| a.seconds).fold(0.0, f32::max)
    }
}
