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
    /// Shading normals in world space.
    Normal,
    /// Shading normals in the space of the camera.
    CameraNormal,
    /// Distances along rays.
    Depth,
    /// Distances along the camera's axis.
    ZDepth,
    /// Numbers of objects and materials.
    Ids,
    /// Numbers among objects of the same name.
    Instance,
    /// Numbers of categories.
    Category,
    /// [`crate::Features::push_guides`].
    Guides,
    /// [`crate::push_variance`].
    Variance,
    /// Points in world space.
    Position,
    /// Texture coordinates.
    Uv,
    /// Triangles of meshes.
    Primitive,
    /// Barycentric coordinates in these.
    Barycentric,
    /// Forward optical flow.
    Motion,
    /// Backward optical flow.
    BackwardMotion,
    /// Whether points are hidden at the other end of either.
    Occluded,
    /// [`crate::mattes()`] of objects.
    CryptoObject,
    /// [`crate::mattes()`] of materials.
    CryptoMaterial,
    /// [`crate::mattes()`] of instances.
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
    pub const ALL_LAYERS: [Aov; 28] = [
        Aov::Albedo,
        Aov::Normal,
        Aov::CameraNormal,
        Aov::Depth,
        Aov::ZDepth,
        Aov::Ids,
        Aov::Instance,
        Aov::Category,
        Aov::Guides,
        Aov::Variance,
        Aov::Position,
        Aov::Uv,
        Aov::Primitive,
        Aov::Barycentric,
        Aov::Motion,
        Aov::BackwardMotion,
        Aov::Occluded,
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
            Aov::CameraNormal => Some("camera_normal"),
            Aov::Depth => Some("depth"),
            Aov::ZDepth => Some("z_depth"),
            Aov::Ids => Some("id"),
            Aov::Instance => Some("instance"),
            Aov::Category => Some("category"),
            Aov::Guides => Some("guides"),
            Aov::Variance => Some("variance"),
            Aov::Position => Some("position"),
            Aov::Uv => Some("uv"),
            Aov::Primitive => Some("primitive"),
            Aov::Barycentric => Some("barycentric"),
            Aov::Motion => Some("motion"),
            Aov::BackwardMotion => Some("backward_motion"),
            Aov::Occluded => Some("occluded"),
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

    /// True for what [`crate::Features`] has: means over samples.
    pub fn is_feature(self) -> bool {
        matches!(self, Aov::Albedo | Aov::Guides)
    }

    /// True for [labels](mod@crate::labels): each is of the one surface that the ray through a pixel's centre meets.
    pub fn is_label(self) -> bool {
        self.is_flow()
            || matches!(self, Aov::Normal | Aov::CameraNormal | Aov::Depth | Aov::ZDepth | Aov::Position)
            || matches!(self, Aov::Ids | Aov::Instance | Aov::Category)
            || matches!(self, Aov::Uv | Aov::Primitive | Aov::Barycentric)
    }

    /// True for labels that another moment is needed for.
    pub fn is_flow(self) -> bool {
        self.needs_next() || self.needs_previous()
    }

    /// True for labels of where points are in the next frame.
    pub fn needs_next(self) -> bool {
        matches!(self, Aov::Motion | Aov::Occluded)
    }

    /// True for labels of where points were in the previous frame.
    pub fn needs_previous(self) -> bool {
        matches!(self, Aov::BackwardMotion | Aov::Occluded)
    }

    /// All labels, in the order of the table.
    pub fn labels() -> impl Iterator<Item = &'static AovEntry> {
        AOVS.iter().filter(|row| row.aov.is_label())
    }

    /// True for Cryptomatte.
    pub fn is_matte(self) -> bool {
        matches!(self, Aov::CryptoObject | Aov::CryptoMaterial | Aov::CryptoInstance)
    }

    /// True for layers that are made once the picture is there.
    pub fn is_extra(self) -> bool {
        self.is_matte() || self.is_light() || self.is_work() || self == Aov::Samples
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
pub static AOVS: &[AovEntry] = &[
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
        Aov::CameraNormal,
        "camera_normal",
        "the same normals in the camera's space (x to the right, y upwards, z towards the camera): camera_normal.X, .Y, .Z",
    ),
    layer(
        Aov::Depth,
        "depth",
        "distance from the camera along the rays through the pixels' centres, in metres, infinite for the background: \
         depth.Z",
    ),
    layer(
        Aov::ZDepth,
        "z_depth",
        "z-depth: distance of the same points along the camera's axis, in metres, infinite for the background: z_depth.Z",
    ),
    layer(
        Aov::Ids,
        "ids",
        "object and material indices at the pixels' centres: id.object, id.material, counted from 1; 0 for none",
    ),
    layer(
        Aov::Instance,
        "instance",
        "numbers of instances at the pixels' centres, among the objects of the same name, counted from 1; 0 for none: \
         instance.id",
    ),
    layer(
        Aov::Category,
        "category",
        "categories of objects at the pixels' centres, by their place in the sorted list of the scene's categories (metadata \
         bilux.category.1, …); 0 for none: category.id",
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
        Aov::Primitive,
        "primitive",
        "triangles at the pixels' centres, by their place in the mesh, counted from 1; 0 for none, and for points, lines and \
         spheres: primitive.id",
    ),
    layer(
        Aov::Barycentric,
        "barycentric",
        "barycentric weights of these triangles' second and third vertices: barycentric.U, .V",
    ),
    layer(
        Aov::Motion,
        "motion",
        "motion vectors of the pixels' centres to the next frame (forward optical flow), in pixels, to the right and upwards: \
         motion.X, .Y",
    ),
    layer(
        Aov::BackwardMotion,
        "backward_motion",
        "motion vectors of the pixels' centres to the previous frame (backward optical flow), in pixels, to the right and \
         upwards: backward_motion.X, .Y",
    ),
    layer(
        Aov::Occluded,
        "occluded",
        "1 where the point at the pixel's centre is hidden, or outside of the picture, in the next frame (occluded.next) and \
         in the previous one (occluded.previous); 0 where it is visible there",
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
