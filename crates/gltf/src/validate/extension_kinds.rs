//! Extensions: the objects that each extends, and its properties.

use super::core_kinds::{BUFFER, BUFFER_VIEW, NODE, PRIMITIVE, ROOT, TARGET, TEXTURE};
use super::material_kinds::{self as material, MATERIAL, TEXTURE_INFO};
use super::schema::Shape::{Any, Choice, Flag, Index, List, Number, Numbers, Object, Text, Whole};
use super::schema::{Kind, NAME, Range, kind, may, must};

/// An extension, a kind of object that it extends, and its properties there.
pub(super) struct ExtensionEntry {
    pub(super) name: &'static str,
    pub(super) extends: &'static Kind,
    pub(super) kind: Kind,
}

const fn row(name: &'static str, extends: &'static Kind, kind: Kind) -> ExtensionEntry {
    ExtensionEntry { name, extends, kind }
}

/// An extension whose properties the reader checks itself.
const fn open(name: &'static str, extends: &'static Kind) -> ExtensionEntry {
    ExtensionEntry { name, extends, kind: Kind { plural: name, properties: &[], is_open: true } }
}

/// Every extension that is checked, once for each kind of object that it extends.
pub(super) static EXTENSIONS: &[ExtensionEntry] = &[
    open("EXT_lights_area", &ROOT),
    open("EXT_lights_area", &NODE),
    open("EXT_mesh_gpu_instancing", &NODE),
    open("EXT_meshopt_compression", &BUFFER),
    open("EXT_meshopt_compression", &BUFFER_VIEW),
    row("EXT_texture_webp", &TEXTURE, SOURCE),
    row("KHR_animation_pointer", &TARGET, POINTER),
    open("KHR_draco_mesh_compression", &PRIMITIVE),
    row("KHR_lights_punctual", &ROOT, LIGHTS),
    row("KHR_lights_punctual", &NODE, LIGHT_OF_NODE),
    row("KHR_materials_anisotropy", &MATERIAL, material::ANISOTROPY),
    row("KHR_materials_clearcoat", &MATERIAL, material::CLEARCOAT),
    row("KHR_materials_diffuse_transmission", &MATERIAL, material::DIFFUSE_TRANSMISSION),
    row("KHR_materials_dispersion", &MATERIAL, material::DISPERSION),
    row("KHR_materials_emissive_strength", &MATERIAL, material::EMISSIVE_STRENGTH),
    row("KHR_materials_ior", &MATERIAL, material::IOR),
    row("KHR_materials_iridescence", &MATERIAL, material::IRIDESCENCE),
    row("KHR_materials_pbrSpecularGlossiness", &MATERIAL, material::SPECULAR_GLOSSINESS),
    row("KHR_materials_scatter", &MATERIAL, material::SCATTER),
    row("KHR_materials_sheen", &MATERIAL, material::SHEEN),
    row("KHR_materials_specular", &MATERIAL, material::SPECULAR),
    row("KHR_materials_transmission", &MATERIAL, material::TRANSMISSION),
    row("KHR_materials_unlit", &MATERIAL, material::UNLIT),
    row("KHR_materials_variants", &ROOT, VARIANTS),
    row("KHR_materials_variants", &PRIMITIVE, MAPPINGS),
    row("KHR_materials_volume", &MATERIAL, material::VOLUME),
    row("KHR_materials_volume_scatter", &MATERIAL, material::VOLUME_SCATTER),
    row("KHR_node_visibility", &NODE, VISIBILITY),
    row("KHR_texture_basisu", &TEXTURE, SOURCE),
    row("KHR_texture_transform", &TEXTURE_INFO, TRANSFORM),
];

/// Extensions that relax the rules and add no object.
pub(super) const WITHOUT_OBJECT: &[&str] = &["KHR_mesh_quantization"];

/// Extensions that are allowed on any object and have no visible effect.
pub(super) const ANYWHERE: &[&str] = &["KHR_xmp", "KHR_xmp_json_ld"];

const SOURCE: Kind = kind("texture extensions", &[must("source", Index("images"))]);

const POINTER: Kind = kind("animation pointers", &[must("pointer", Text)]);

const LIGHTS: Kind = kind("extensions with lights", &[must("lights", List(&LIGHT))]);

pub(super) const LIGHT: Kind = kind(
    "lights",
    &[
        NAME,
        may("color", Numbers(3, 3, Range::UNIT)),
        may("intensity", Number(Range::at_least(0.0))),
        must("type", Choice(&["directional", "point", "spot"])),
        may("spot", Object(&SPOT)),
        may("range", Number(Range::POSITIVE)),
    ],
);

const SPOT: Kind = kind(
    "spot lights",
    &[
        may("innerConeAngle", Number(Range::between(0.0, std::f64::consts::FRAC_PI_2))),
        may("outerConeAngle", Number(Range::between(0.0, std::f64::consts::FRAC_PI_2))),
    ],
);

const LIGHT_OF_NODE: Kind = kind("lights of nodes", &[must("light", Any)]);

const VARIANTS: Kind = kind("extensions with variants", &[must("variants", List(&VARIANT))]);
const VARIANT: Kind = kind("variants", &[must("name", Text)]);
pub(super) const MAPPINGS: Kind =
    kind("extensions with mappings of variants", &[must("mappings", List(&MAPPING))]);
const MAPPING: Kind =
    kind("mappings of variants", &[must("variants", Any), must("material", Index("materials")), NAME]);

const VISIBILITY: Kind = kind("visibility extensions", &[may("visible", Flag)]);

const TRANSFORM: Kind = kind(
    "texture transforms",
    &[
        may("offset", Numbers(2, 2, Range::ANY)),
        may("rotation", Number(Range::ANY)),
        may("scale", Numbers(2, 2, Range::ANY)),
        may("texCoord", Whole(0, 1 << 16)),
    ],
);
