//! The objects of core glTF. [glTF 2.0, 5]

use super::material_kinds::MATERIAL;
use super::schema::Shape::{
    Any, Choice, Code, Flag, Index, Indices, List, Named, Number, Numbers, Object, Text, Texts, Whole,
};
use super::schema::{Kind, NAME, Range, kind, may, must};

const SIZE: u64 = 1 << 53;
const UNSIGNED: &[u64] = &[5121, 5123, 5125];

pub(super) const ROOT: Kind = kind(
    "glTF files",
    &[
        may("extensionsUsed", Texts),
        may("extensionsRequired", Texts),
        may("accessors", List(&ACCESSOR)),
        may("animations", List(&ANIMATION)),
        must("asset", Object(&ASSET)),
        may("buffers", List(&BUFFER)),
        may("bufferViews", List(&BUFFER_VIEW)),
        may("cameras", List(&CAMERA)),
        may("images", List(&IMAGE)),
        may("materials", List(&MATERIAL)),
        may("meshes", List(&MESH)),
        may("nodes", List(&NODE)),
        may("samplers", List(&SAMPLER)),
        may("scene", Index("scenes")),
        may("scenes", List(&SCENE)),
        may("skins", List(&SKIN)),
        may("textures", List(&TEXTURE)),
    ],
);

const ASSET: Kind = kind(
    "assets",
    &[must("version", Text), may("minVersion", Text), may("copyright", Text), may("generator", Text)],
);

pub(super) const ACCESSOR: Kind = kind(
    "accessors",
    &[
        may("bufferView", Index("bufferViews")),
        may("byteOffset", Whole(0, SIZE)),
        must("componentType", Code(&[5120, 5121, 5122, 5123, 5125, 5126])),
        may("normalized", Flag),
        must("count", Whole(1, SIZE)),
        must("type", Choice(&["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"])),
        may("max", Numbers(1, 16, Range::ANY)),
        may("min", Numbers(1, 16, Range::ANY)),
        may("sparse", Object(&SPARSE)),
        NAME,
    ],
);

const SPARSE: Kind = kind(
    "sparse accessors",
    &[
        must("count", Whole(1, SIZE)),
        must("indices", Object(&SPARSE_INDICES)),
        must("values", Object(&SPARSE_VALUES)),
    ],
);

pub(super) const SPARSE_INDICES: Kind = kind(
    "sparse indices",
    &[
        must("bufferView", Index("bufferViews")),
        may("byteOffset", Whole(0, SIZE)),
        must("componentType", Code(UNSIGNED)),
    ],
);

pub(super) const SPARSE_VALUES: Kind =
    kind("sparse values", &[must("bufferView", Index("bufferViews")), may("byteOffset", Whole(0, SIZE))]);

const ANIMATION: Kind =
    kind("animations", &[must("channels", List(&CHANNEL)), must("samplers", List(&ANIMATION_SAMPLER)), NAME]);

const CHANNEL: Kind =
    kind("animation channels", &[must("sampler", Whole(0, SIZE)), must("target", Object(&TARGET))]);

pub(super) const TARGET: Kind = kind(
    "animation targets",
    &[
        may("node", Index("nodes")),
        must("path", Choice(&["translation", "rotation", "scale", "weights", "pointer"])),
    ],
);

const ANIMATION_SAMPLER: Kind = kind(
    "animation samplers",
    &[
        must("input", Index("accessors")),
        may("interpolation", Choice(&["LINEAR", "STEP", "CUBICSPLINE"])),
        must("output", Index("accessors")),
    ],
);

pub(super) const BUFFER: Kind =
    kind("buffers", &[may("uri", Text), must("byteLength", Whole(1, SIZE)), NAME]);

pub(super) const BUFFER_VIEW: Kind = kind(
    "buffer views",
    &[
        must("buffer", Index("buffers")),
        may("byteOffset", Whole(0, SIZE)),
        must("byteLength", Whole(1, SIZE)),
        may("byteStride", Whole(4, 252)),
        may("target", Code(&[34962, 34963])),
        NAME,
    ],
);

pub(super) const CAMERA: Kind = kind(
    "cameras",
    &[
        may("orthographic", Object(&ORTHOGRAPHIC)),
        may("perspective", Object(&PERSPECTIVE)),
        must("type", Choice(&["perspective", "orthographic"])),
        NAME,
    ],
);

pub(super) const ORTHOGRAPHIC: Kind = kind(
    "orthographic cameras",
    &[
        must("xmag", Number(Range::ANY)),
        must("ymag", Number(Range::ANY)),
        must("zfar", Number(Range::POSITIVE)),
        must("znear", Number(Range::at_least(0.0))),
    ],
);

pub(super) const PERSPECTIVE: Kind = kind(
    "perspective cameras",
    &[
        may("aspectRatio", Number(Range::POSITIVE)),
        must("yfov", Number(Range::POSITIVE)),
        may("zfar", Number(Range::POSITIVE)),
        must("znear", Number(Range::POSITIVE)),
    ],
);

pub(super) const IMAGE: Kind = kind(
    "images",
    &[
        may("uri", Text),
        may("mimeType", Choice(&["image/jpeg", "image/png", "image/webp", "image/ktx2"])),
        may("bufferView", Index("bufferViews")),
        NAME,
    ],
);

pub(super) const MESH: Kind = kind(
    "meshes",
    &[must("primitives", List(&PRIMITIVE)), may("weights", Numbers(1, usize::MAX, Range::ANY)), NAME],
);

pub(super) const PRIMITIVE: Kind = kind(
    "mesh primitives",
    &[
        must("attributes", Named("accessors")),
        may("indices", Index("accessors")),
        may("material", Index("materials")),
        may("mode", Whole(0, 6)),
        may("targets", Any),
    ],
);

pub(super) const NODE: Kind = kind(
    "nodes",
    &[
        may("camera", Index("cameras")),
        may("children", Indices("nodes")),
        may("skin", Index("skins")),
        may("matrix", Numbers(16, 16, Range::ANY)),
        may("mesh", Index("meshes")),
        may("rotation", Numbers(4, 4, Range::SIGNED_UNIT)),
        may("scale", Numbers(3, 3, Range::ANY)),
        may("translation", Numbers(3, 3, Range::ANY)),
        may("weights", Numbers(1, usize::MAX, Range::ANY)),
        NAME,
    ],
);

const WRAP: &[u64] = &[10497, 33071, 33648];

const SAMPLER: Kind = kind(
    "samplers",
    &[
        may("magFilter", Code(&[9728, 9729])),
        may("minFilter", Code(&[9728, 9729, 9984, 9985, 9986, 9987])),
        may("wrapS", Code(WRAP)),
        may("wrapT", Code(WRAP)),
        NAME,
    ],
);

pub(super) const SCENE: Kind = kind("scenes", &[may("nodes", Indices("nodes")), NAME]);

pub(super) const SKIN: Kind = kind(
    "skins",
    &[
        may("inverseBindMatrices", Index("accessors")),
        may("skeleton", Index("nodes")),
        must("joints", Indices("nodes")),
        NAME,
    ],
);

pub(super) const TEXTURE: Kind =
    kind("textures", &[may("sampler", Index("samplers")), may("source", Index("images")), NAME]);
