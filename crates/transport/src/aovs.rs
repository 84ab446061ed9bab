//! What else a render can give beside its picture.

use bilux_math::registry::Entry;
use bilux_scene::{SceneError, Span};

/// What it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// [`crate::strategies()`].
    Strategies,
    /// [`crate::Interval`].
    Interval,
    /// [`crate::Features::albedo`].
    Albedo,
    /// [`crate::Features::normal`].
    Normal,
    /// [`crate::Features::depth`].
    Depth,
    /// [`crate::Features::object`] and [`crate::Features::material`].
    Ids,
    /// [`crate::push_variance`].
    Variance,
}

impl Aov {
    /// Those that are layers of the picture.
    pub const ALL_LAYERS: [Aov; 5] = [Aov::Albedo, Aov::Normal, Aov::Depth, Aov::Ids, Aov::Variance];

    /// The name of its layer, where it is one.
    pub fn layer(self) -> Option<&'static str> {
        match self {
            Aov::Strategies | Aov::Interval => None,
            Aov::Albedo => Some("albedo"),
            Aov::Normal => Some("normal"),
            Aov::Depth => Some("depth"),
            Aov::Ids => Some("id"),
            Aov::Variance => Some("variance"),
        }
    }

    /// True for what is told of surfaces, whatever light is on them.
    pub fn is_feature(self) -> bool {
        self.layer().is_some() && self != Aov::Variance
    }
}

/// A row of [`AOVS`].
#[derive(Clone, Copy, Debug)]
pub struct AovEntry {
    /// Name, summary, source.
    pub entry: Entry,
    /// Which one.
    pub aov: Aov,
}

/// Every one that there is.
pub const AOVS: &[AovEntry] = &[
    AovEntry {
        entry: Entry {
            name: "strategies",
            summary: "each technique of joining paths from both ends on its own, weighted and not (bdpt, vcm)",
            source: "Veach 1997",
            parameters: &[],
        },
        aov: Aov::Strategies,
    },
    AovEntry {
        entry: Entry {
            name: "interval",
            summary: "how far to both sides of a pixel its true light may lie: half of the 95% interval",
            source: "Owen 1997",
            parameters: &[],
        },
        aov: Aov::Interval,
    },
    layer(Aov::Albedo, "albedo", "the part of the light that surfaces send on, 0..=1: albedo.R, .G, .B"),
    layer(Aov::Normal, "normal", "shading normals in the world, on the side that is seen: normal.X, .Y, .Z"),
    layer(Aov::Depth, "depth", "metres from the camera along its rays, infinite where nothing is: depth.Z"),
    layer(Aov::Ids, "ids", "which object and material: id.object, id.material, from 1 on; 0 for none"),
    layer(
        Aov::Variance,
        "variance",
        "of each pixel's mean, one estimate from two halves of the samples: variance.R, .G, .B; what light paths have left \
         apart, as light and light_variance",
    ),
];

const fn layer(aov: Aov, name: &'static str, summary: &'static str) -> AovEntry {
    AovEntry { entry: Entry { name, summary, source: "", parameters: &[] }, aov }
}

/// The row of this name, wanted at `at`.
///
/// # Errors
/// When there is none.
pub fn find(name: &str, at: &Span) -> Result<&'static AovEntry, SceneError> {
    let names = AOVS.iter().map(|row| row.entry.name);
    let row = AOVS.iter().find(|row| row.entry.name == name);
    row.ok_or_else(|| SceneError::unknown("aov", name, names, at))
}
