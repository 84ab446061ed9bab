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

/// Kind of an AOV: what makes it, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AovKind {
    /// Pictures of their own, which are no layers.
    Picture,
    /// Means over samples, which [`crate::Features`] has.
    Feature,
    /// [Labels](mod@crate::labels): each is of the one surface that the ray through a pixel's centre meets.
    Label,
    /// Variance of the picture, which [`crate::push_variance`] adds.
    Variance,
    /// Cryptomatte.
    Matte,
    /// Parts of the picture's light, for which its samples are taken once more.
    Light,
    /// Counts of samples, which [`crate::Film`] has.
    Samples,
    /// Costs, which [`crate::Work`] has: the picture's samples are taken once more for these, too.
    Work {
        /// Whether it is the accelerator's work.
        of_accel: bool,
    },
}

impl Aov {
    /// Row of the table that describes it: the rows have the order of the variants, as a test checks.
    pub fn row(self) -> &'static AovEntry {
        &AOVS[self as usize]
    }

    /// The AOVs that are layers of the picture, in the order of the table.
    pub fn layers() -> impl Iterator<Item = Aov> {
        AOVS.iter().filter(|row| row.layer.is_some()).map(|row| row.aov)
    }

    /// All labels, in the order of the table.
    pub fn labels() -> impl Iterator<Item = Aov> {
        Aov::layers().filter(|aov| aov.is_label())
    }

    /// The name of its layer, if it is one.
    pub fn layer(self) -> Option<&'static str> {
        self.row().layer
    }

    /// Names of its layer's channels in files, such as `depth.Z`.
    pub fn channel_names(self) -> impl Iterator<Item = String> {
        let AovEntry { layer, channels, .. } = self.row();
        layer.iter().flat_map(|layer| channels.iter().map(move |channel| format!("{layer}.{channel}")))
    }

    /// True for [`AovKind::Feature`].
    pub fn is_feature(self) -> bool {
        self.row().kind == AovKind::Feature
    }

    /// True for [`AovKind::Label`].
    pub fn is_label(self) -> bool {
        self.row().kind == AovKind::Label
    }

    /// True for labels of where points are in the next frame.
    pub fn needs_next(self) -> bool {
        self.row().needs_next
    }

    /// True for labels of where points were in the previous frame.
    pub fn needs_previous(self) -> bool {
        self.row().needs_previous
    }

    /// True for [`AovKind::Matte`].
    pub fn is_matte(self) -> bool {
        self.row().kind == AovKind::Matte
    }

    /// True for [`AovKind::Light`].
    pub fn is_light(self) -> bool {
        self.row().kind == AovKind::Light
    }

    /// True for [`AovKind::Work`].
    pub fn is_work(self) -> bool {
        matches!(self.row().kind, AovKind::Work { .. })
    }

    /// True for the work of the accelerator.
    pub fn is_accel_work(self) -> bool {
        self.row().kind == AovKind::Work { of_accel: true }
    }

    /// True for layers that are made once the picture is there.
    pub fn is_extra(self) -> bool {
        use AovKind::{Light, Matte, Samples, Work};
        matches!(self.row().kind, Matte | Light | Samples | Work { .. })
    }

    /// True for layers of all samples of the picture, which ranges of them cannot be merged to.
    pub fn needs_all_samples(self) -> bool {
        self.is_light() || self.is_work()
    }

    /// The names of those layers, for messages.
    pub fn names_that_need_all_samples() -> String {
        let aovs = Aov::layers().filter(|aov| aov.needs_all_samples());
        aovs.map(|aov| aov.row().entry.name).collect::<Vec<_>>().join(", ")
    }
}

/// A row of [`AOVS`].
#[derive(Clone, Copy, Debug)]
pub struct AovEntry {
    /// Name, summary, source.
    pub entry: Entry,
    /// The AOV itself.
    pub aov: Aov,
    /// Kind of AOV.
    pub kind: AovKind,
    /// The name of its layer in files, if it is one; Cryptomatte and groups of lights have several, whose names begin so.
    pub layer: Option<&'static str>,
    /// The layer's channels that every picture has, in their usual order; empty where it is no single layer.
    pub channels: &'static [&'static str],
    /// Whether it looks at the scene in the next frame.
    pub needs_next: bool,
    /// Whether it looks at the scene in the previous frame.
    pub needs_previous: bool,
}

const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];

/// All AOVs, in the order in which they are listed and layers are written.
pub static AOVS: &[AovEntry] = &[
    picture(Aov::Strategies, "strategies")
        .about("the contribution of each bidirectional technique, weighted and unweighted (bdpt, vcm)")
        .source("Veach 1997"),
    picture(Aov::Interval, "interval")
        .about("half-width of each pixel's 95% confidence interval")
        .source("Owen 1997"),
    layer(Aov::Albedo, AovKind::Feature, "albedo", RGB)
        .about("the fraction of light that surfaces scatter, from 0 to 1: albedo.R, .G, .B"),
    label(Aov::Normal, "normal", XYZ).about(
        "shading normals in world space, on the visible side, at the pixels' centres: normal.X, .Y, .Z",
    ),
    label(Aov::CameraNormal, "camera_normal", XYZ).about(
        "the same normals in the camera's space (x to the right, y upwards, z towards the camera): \
         camera_normal.X, .Y, .Z",
    ),
    label(Aov::Depth, "depth", &["Z"]).about(
        "distance from the camera along the rays through the pixels' centres, in metres, infinite for the background: \
         depth.Z",
    ),
    label(Aov::ZDepth, "z_depth", &["Z"]).about(
        "z-depth: distance of the same points along the camera's axis, in metres, infinite for the background: \
         z_depth.Z",
    ),
    label(Aov::Ids, "ids", &["object", "material"]).layer("id").about(
        "object and material indices at the pixels' centres: id.object, id.material, counted from 1; 0 for none",
    ),
    label(Aov::Instance, "instance", &["id"]).about(
        "numbers of instances at the pixels' centres, among the objects of the same name, counted from 1; 0 for none: \
         instance.id",
    ),
    label(Aov::Category, "category", &["id"]).about(
        "categories of objects at the pixels' centres, by their place in the sorted list of the scene's categories \
         (metadata bilux.category.1, …); 0 for none: category.id",
    ),
    layer(Aov::Guides, AovKind::Feature, "guides", &["R", "G", "B", "X", "Y", "Z", "depth"]).about(
        "what guides a later `bilux denoise`, as means of the pixels: guides.R, .G, .B, \
         .X, .Y, .Z, .depth, and .haze where media scatter",
    ),
    layer(Aov::Variance, AovKind::Variance, "variance", RGB).about(
        "variance of each pixel's mean, estimated from two halves of the samples: variance.R, .G, .B; light-traced \
         samples separately, as light and light_variance",
    ),
    label(Aov::Position, "position", XYZ).about(
        "the points at the pixels' centres in world space, in metres, 0 where nothing is visible: position.X, .Y, .Z",
    ),
    label(Aov::Uv, "uv", &["U", "V"]).about("texture coordinates at the pixels' centres: uv.U, uv.V"),
    label(Aov::Primitive, "primitive", &["id"]).about(
        "triangles at the pixels' centres, by their place in the mesh, counted from 1; 0 for none, and for points, \
         lines and spheres: primitive.id",
    ),
    label(Aov::Barycentric, "barycentric", &["U", "V"])
        .about("barycentric weights of these triangles' second and third vertices: barycentric.U, .V"),
    label(Aov::Motion, "motion", &["X", "Y"]).needs_next().about(
        "motion vectors of the pixels' centres to the next frame (forward optical flow), in pixels, to the right and \
         upwards: motion.X, .Y",
    ),
    label(Aov::BackwardMotion, "backward_motion", &["X", "Y"]).needs_previous().about(
        "motion vectors of the pixels' centres to the previous frame (backward optical flow), in pixels, to the right \
         and upwards: backward_motion.X, .Y",
    ),
    label(Aov::Occluded, "occluded", &["next", "previous"]).needs_next().needs_previous().about(
        "1 where the point at the pixel's centre is hidden, or outside of the picture, in the next frame \
         (occluded.next) and in the previous one (occluded.previous); 0 where it is visible there",
    ),
    matte(Aov::CryptoObject, "crypto_object", "CryptoObject")
        .about("Cryptomatte of objects by name: CryptoObject00.red, …"),
    matte(Aov::CryptoMaterial, "crypto_material", "CryptoMaterial")
        .about("Cryptomatte of materials by name: CryptoMaterial00.red, …"),
    matte(Aov::CryptoInstance, "crypto_instance", "CryptoInstance")
        .about("Cryptomatte of each instance, by name and number: CryptoInstance00.red, …"),
    layer(Aov::Direct, AovKind::Light, "direct", RGB)
        .about("direct light, scattered at most once, and visible emitters: direct.R, .G, .B"),
    layer(Aov::Indirect, AovKind::Light, "indirect", RGB)
        .about("indirect light; direct and indirect add up to the picture: indirect.R, .G, .B"),
    layer(Aov::Groups, AovKind::Light, "groups", &[])
        .layer("group")
        .about("the contribution of each light group; they add up to the picture: group_NAME.R, .G, .B"),
    layer(Aov::Samples, AovKind::Samples, "samples", &["count"])
        .about("the number of samples of each pixel: samples.count"),
    layer(Aov::Rays, AovKind::Work { of_accel: false }, "rays", &["mean"]).about(
        "rays that a sample of the pixel traces on average, shadow rays included: rays.mean; its cost, counted and not \
         clocked, so that it is the same on every machine",
    ),
    layer(Aov::PathLength, AovKind::Work { of_accel: false }, "path_length", &["mean"]).about(
        "surfaces that the paths of a sample reach on average, from the camera and from lights: path_length.mean",
    ),
    layer(Aov::Nodes, AovKind::Work { of_accel: true }, "nodes", &["mean"]).about(
        "nodes of the accelerator that the rays of a sample visit on average: nodes.mean; depends on --accel",
    ),
    layer(Aov::Tests, AovKind::Work { of_accel: true }, "tests", &["mean"])
        .about("primitives that the rays of a sample are tested with on average: tests.mean; depends on --accel"),
];

/// A row of pictures of their own.
const fn picture(aov: Aov, name: &'static str) -> AovEntry {
    AovEntry { layer: None, ..layer(aov, AovKind::Picture, name, &[]) }
}

/// A row of a layer that files call by the name of the AOV.
const fn layer(aov: Aov, kind: AovKind, name: &'static str, channels: &'static [&'static str]) -> AovEntry {
    let entry = Entry { name, summary: "", source: "", parameters: &[] };
    AovEntry { entry, aov, kind, layer: Some(name), channels, needs_next: false, needs_previous: false }
}

const fn label(aov: Aov, name: &'static str, channels: &'static [&'static str]) -> AovEntry {
    layer(aov, AovKind::Label, name, channels)
}

const fn matte(aov: Aov, name: &'static str, layers: &'static str) -> AovEntry {
    layer(aov, AovKind::Matte, name, &[]).layer(layers).source("Friedman 2015")
}

/// Columns of a row that are set by name.
impl AovEntry {
    const fn about(mut self, summary: &'static str) -> AovEntry {
        self.entry.summary = summary;
        self
    }

    const fn source(mut self, source: &'static str) -> AovEntry {
        self.entry.source = source;
        self
    }

    const fn layer(mut self, layer: &'static str) -> AovEntry {
        self.layer = Some(layer);
        self
    }

    const fn needs_next(mut self) -> AovEntry {
        self.needs_next = true;
        self
    }

    const fn needs_previous(mut self) -> AovEntry {
        self.needs_previous = true;
        self
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The variants of [`Aov`], read from this file: nothing else lists them, and a variant without a row would have no test.
    fn variants() -> Vec<&'static str> {
        let (_, body) = include_str!("aovs.rs").split_once("pub enum Aov {").unwrap();
        let lines = body.split_once("\n}").unwrap().0.lines().map(str::trim);
        lines.filter(|line| !line.starts_with("///")).filter_map(|line| line.strip_suffix(',')).collect()
    }

    #[test]
    fn every_variant_has_one_row() {
        let of_rows: Vec<String> = AOVS.iter().map(|row| format!("{:?}", row.aov)).collect();
        assert_eq!(of_rows, variants());
        for row in AOVS {
            assert_eq!(row.aov.row().aov, row.aov);
            assert!(!row.entry.summary.is_empty(), "{:?} is not described", row.aov);
        }
    }

    #[test]
    fn rows_agree_with_themselves() {
        let layers: BTreeSet<&str> = Aov::layers().filter_map(Aov::layer).collect();
        assert_eq!(layers.len(), Aov::layers().count(), "two layers have the same name");
        let names: BTreeSet<&str> = AOVS.iter().map(|row| row.entry.name).collect();
        assert_eq!(names.len(), AOVS.len(), "two AOVs have the same name");
        for row in AOVS {
            assert_eq!(row.layer.is_none(), row.kind == AovKind::Picture, "{:?}", row.aov);
            let is_moving = row.needs_next || row.needs_previous;
            assert!(!is_moving || row.kind == AovKind::Label, "{:?} looks at other frames", row.aov);
        }
    }
}
