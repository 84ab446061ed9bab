//! Arbitrary output variables (AOVs): what a render can produce besides its picture.

use bilux_math::registry::Entry;
use bilux_scene::{SceneError, Span};

/// One AOV.
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
    /// The AOVs that are layers of the picture.
    pub const ALL_LAYERS: [Aov; 5] = [Aov::Albedo, Aov::Normal, Aov::Depth, Aov::Ids, Aov::Variance];

    /// The name of its layer, if it is one.
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

    /// True for properties of surfaces, whatever their lighting.
    pub fn is_feature(self) -> bool {
        self.layer().is_some() && self != Aov::Variance
    }
}

/// A row of [`AOVS`].
#[derive(Clone, Copy, Debug)]
pub struct AovEntry {
    /// Name, summary, source.
    pub entry: Entry,
    /// The AOV itself.
    pub aov: Aov,
}

/// All AOVs.
pub const AOVS: &[AovEntry] = &[
    AovEntry {
        entry: Entry {
            name: "strategies",
            summary: "the contribution of each bidirectional technique, weighted and unweighted (bdpt, vcm)",
            source: "Veach 1997",
            parameters: &[],
        },
        aov: Aov::Strategies,
    },
    AovEntry {
        entry: Entry {
            name: "interval",
            summary: "half-width of each pixel's 95% confidence interval",
            source: "Owen 1997",
            parameters: &[],
        },
        aov: Aov::Interval,
    },
    layer(
        Aov::Albedo,
        "albedo",
        "the fraction of light that surfaces scatter, from 0 to 1: albedo.R, .G, .B",
    ),
    layer(Aov::Normal, "normal", "shading normals in world space, on the visible side: normal.X, .Y, .Z"),
    layer(
        Aov::Depth,
        "depth",
        "distance from the camera along its rays in metres, infinite for the background: \
                       depth.Z",
    ),
    layer(Aov::Ids, "ids", "object and material indices: id.object, id.material, counted from 1; 0 for none"),
    layer(
        Aov::Variance,
        "variance",
        "variance of each pixel's mean, estimated from two halves of the samples: variance.R, .G, .B; light-traced \
         samples separately, as light and light_variance",
    ),
];

const fn layer(aov: Aov, name: &'static str, summary: &'static str) -> AovEntry {
    AovEntry { entry: Entry { name, summary, source: "", parameters: &[] }, aov }
}

/// The row with this name, requested at `at`.
///
/// # Errors
/// When there is none.
pub fn find(name: &str, at: &Span) -> Result<&'static AovEntry, SceneError> {
    let names = AOVS.iter().map(|row| row.entry.name);
    let row = AOVS.iter().find(|row| row.entry.name == name);
    row.ok_or_else(|| SceneError::unknown("AOV", name, names, at))
}
