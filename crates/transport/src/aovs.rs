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
    /// [`crate::Features::push_guides`].
    Guides,
    /// [`crate::push_variance`].
    Variance,
    /// [`crate::Visible::position`].
    Position,
    /// [`crate::Visible::uv`].
    Uv,
    /// [`crate::Visible::motion`].
    Motion,
    /// [`crate::Visible::mattes`] of objects.
    CryptoObject,
    /// The same of materials.
    CryptoMaterial,
    /// The same of instances.
    CryptoInstance,
    /// [`crate::LightParts::by_events`]: light that scatters at most once.
    Direct,
    /// The rest of it.
    Indirect,
    /// [`crate::LightParts::groups`].
    Groups,
    /// [`crate::Film::samples`].
    Samples,
    /// [`crate::Work::rays`].
    Rays,
    /// [`crate::Work::path_length`].
    PathLength,
    /// [`crate::Work::nodes`].
    Nodes,
    /// [`crate::Work::tests`].
    Tests,
}

impl Aov {
    /// The AOVs that are layers of the picture.
    pub const ALL_LAYERS: [Aov; 20] = [
        Aov::Albedo,
        Aov::Normal,
        Aov::Depth,
        Aov::Ids,
        Aov::Guides,
        Aov::Variance,
        Aov::Position,
        Aov::Uv,
        Aov::Motion,
        Aov::CryptoObject,
        Aov::CryptoMaterial,
        Aov::CryptoInstance,
        Aov::Direct,
        Aov::Indirect,
        Aov::Groups,
        Aov::Samples,
        Aov::Rays,
        Aov::PathLength,
        Aov::Nodes,
        Aov::Tests,
    ];

    /// The name of its layer, if it is one.
    pub fn layer(self) -> Option<&'static str> {
        match self {
            Aov::Strategies | Aov::Interval => None,
            Aov::Albedo => Some("albedo"),
            Aov::Normal => Some("normal"),
            Aov::Depth => Some("depth"),
            Aov::Ids => Some("id"),
            Aov::Guides => Some("guides"),
            Aov::Variance => Some("variance"),
            Aov::Position => Some("position"),
            Aov::Uv => Some("uv"),
            Aov::Motion => Some("motion"),
            Aov::CryptoObject => Some("CryptoObject"),
            Aov::CryptoMaterial => Some("CryptoMaterial"),
            Aov::CryptoInstance => Some("CryptoInstance"),
            Aov::Direct => Some("direct"),
            Aov::Indirect => Some("indirect"),
            Aov::Groups => Some("group"),
            Aov::Samples => Some("samples"),
            Aov::Rays => Some("rays"),
            Aov::PathLength => Some("path_length"),
            Aov::Nodes => Some("nodes"),
            Aov::Tests => Some("tests"),
        }
    }

    /// True for properties of surfaces, whatever their lighting, as [`crate::Features`] has them.
    pub fn is_feature(self) -> bool {
        matches!(self, Aov::Albedo | Aov::Normal | Aov::Depth | Aov::Ids)
    }

    /// True for what [`crate::Visible`] has.
    pub fn is_visible(self) -> bool {
        matches!(self, Aov::Position | Aov::Uv | Aov::Motion) || self.is_matte()
    }

    /// True for Cryptomatte.
    pub fn is_matte(self) -> bool {
        matches!(self, Aov::CryptoObject | Aov::CryptoMaterial | Aov::CryptoInstance)
    }

    /// True for layers that are made once the picture is there.
    pub fn is_extra(self) -> bool {
        self.is_visible() || self.is_light() || self.is_work() || self == Aov::Samples
    }

    /// True for parts of the picture's light, for which its samples are taken once more.
    pub fn is_light(self) -> bool {
        matches!(self, Aov::Direct | Aov::Indirect | Aov::Groups)
    }

    /// True for what [`crate::Work`] has: costs, for which the picture's samples are taken once more, too.
    pub fn is_work(self) -> bool {
        matches!(self, Aov::Rays | Aov::PathLength) || self.is_accel_work()
    }

    /// True for layers of all samples of the picture, which ranges of them cannot be merged to.
    pub fn needs_all_samples(self) -> bool {
        self.is_light() || self.is_work()
    }

    /// The names of those layers, for messages.
    pub fn names_that_need_all_samples() -> String {
        let rows = AOVS.iter().filter(|row| row.aov.needs_all_samples());
        rows.map(|row| row.entry.name).collect::<Vec<_>>().join(", ")
    }

    /// True for the work of the accelerator.
    pub fn is_accel_work(self) -> bool {
        matches!(self, Aov::Nodes | Aov::Tests)
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
    layer(
        Aov::Normal,
        "normal",
        "shading normals in world space, on the visible side, at the pixels' centres: normal.X, .Y, .Z",
    ),
    layer(
        Aov::Depth,
        "depth",
        "distance from the camera along the rays through the pixels' centres, in metres, infinite for the background: \
         depth.Z",
    ),
    layer(
        Aov::Ids,
        "ids",
        "object and material indices at the pixels' centres: id.object, id.material, counted from 1; 0 for none",
    ),
    layer(
        Aov::Guides,
        "guides",
        "what guides a later `bilux denoise`, as means of the pixels: guides.R, .G, .B, \
         .X, .Y, .Z, .depth, and .haze where media scatter",
    ),
    layer(
        Aov::Variance,
        "variance",
        "variance of each pixel's mean, estimated from two halves of the samples: variance.R, .G, .B; light-traced \
         samples separately, as light and light_variance",
    ),
    layer(
        Aov::Position,
        "position",
        "the points at the pixels' centres in world space, in metres, 0 where nothing is visible: position.X, .Y, .Z",
    ),
    layer(Aov::Uv, "uv", "texture coordinates at the pixels' centres: uv.U, uv.V"),
    layer(
        Aov::Motion,
        "motion",
        "motion vectors of the pixels' centres to the next frame, in pixels, to the right and upwards: motion.X, .Y",
    ),
    matte(Aov::CryptoObject, "crypto_object", "Cryptomatte of objects by name: CryptoObject00.red, …"),
    matte(
        Aov::CryptoMaterial,
        "crypto_material",
        "Cryptomatte of materials by name: CryptoMaterial00.red, …",
    ),
    matte(
        Aov::CryptoInstance,
        "crypto_instance",
        "Cryptomatte of each instance, by name and number: CryptoInstance00.red, …",
    ),
    layer(
        Aov::Direct,
        "direct",
        "direct light, scattered at most once, and visible emitters: direct.R, .G, .B",
    ),
    layer(
        Aov::Indirect,
        "indirect",
        "indirect light; direct and indirect add up to the picture: indirect.R, .G, .B",
    ),
    layer(
        Aov::Groups,
        "groups",
        "the contribution of each light group; they add up to the picture: group_NAME.R, .G, .B",
    ),
    layer(Aov::Samples, "samples", "the number of samples of each pixel: samples.count"),
    layer(
        Aov::Rays,
        "rays",
        "rays that a sample of the pixel traces on average, shadow rays included: rays.mean; its cost, counted and not \
         clocked, so that it is the same on every machine",
    ),
    layer(
        Aov::PathLength,
        "path_length",
        "surfaces that the paths of a sample reach on average, from the camera and from lights: path_length.mean",
    ),
    layer(
        Aov::Nodes,
        "nodes",
        "nodes of the accelerator that the rays of a sample visit on average: nodes.mean; depends on --accel",
    ),
    layer(
        Aov::Tests,
        "tests",
        "primitives that the rays of a sample are tested with on average: tests.mean; depends on --accel",
    ),
];

const fn layer(aov: Aov, name: &'static str, summary: &'static str) -> AovEntry {
    AovEntry { entry: Entry { name, summary, source: "", parameters: &[] }, aov }
}

const fn matte(aov: Aov, name: &'static str, summary: &'static str) -> AovEntry {
    AovEntry { entry: Entry { name, summary, source: "Friedman 2015", parameters: &[] }, aov }
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
