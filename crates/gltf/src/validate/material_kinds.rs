//! Materials and their extensions. [glTF 2.0, 5.19]

use super::schema::Shape::{Choice, Flag, Index, Number, Numbers, Object, Whole};
use super::schema::{Kind, NAME, Property, Range, kind, may, must};

const COLOUR: super::schema::Shape = Numbers(3, 3, Range::UNIT);
const RGBA: super::schema::Shape = Numbers(4, 4, Range::UNIT);
const UNIT: super::schema::Shape = Number(Range::UNIT);
const FROM_ZERO: super::schema::Shape = Number(Range::at_least(0.0));
const INDEX: Property = must("index", Index("textures"));
const TEXCOORD: Property = may("texCoord", Whole(0, 1 << 16));

pub(super) const TEXTURE_INFO: Kind = kind("texture references", &[INDEX, TEXCOORD]);
const NORMAL_INFO: Kind = kind("texture references", &[INDEX, TEXCOORD, may("scale", Number(Range::ANY))]);
const OCCLUSION_INFO: Kind = kind("texture references", &[INDEX, TEXCOORD, may("strength", UNIT)]);

const fn texture(key: &'static str) -> Property {
    may(key, Object(&TEXTURE_INFO))
}

pub(super) const MATERIAL: Kind = kind(
    "materials",
    &[
        NAME,
        may("pbrMetallicRoughness", Object(&METALLIC_ROUGHNESS)),
        may("normalTexture", Object(&NORMAL_INFO)),
        may("occlusionTexture", Object(&OCCLUSION_INFO)),
        texture("emissiveTexture"),
        may("emissiveFactor", COLOUR),
        may("alphaMode", Choice(&["OPAQUE", "MASK", "BLEND"])),
        may("alphaCutoff", FROM_ZERO),
        may("doubleSided", Flag),
    ],
);

const METALLIC_ROUGHNESS: Kind = kind(
    "metallic-roughness materials",
    &[
        may("baseColorFactor", RGBA),
        texture("baseColorTexture"),
        may("metallicFactor", UNIT),
        may("roughnessFactor", UNIT),
        texture("metallicRoughnessTexture"),
    ],
);

pub(super) const ANISOTROPY: Kind = kind(
    "anisotropy extensions",
    &[
        may("anisotropyStrength", UNIT),
        may("anisotropyRotation", Number(Range::ANY)),
        texture("anisotropyTexture"),
    ],
);

pub(super) const CLEARCOAT: Kind = kind(
    "clearcoat extensions",
    &[
        may("clearcoatFactor", UNIT),
        texture("clearcoatTexture"),
        may("clearcoatRoughnessFactor", UNIT),
        texture("clearcoatRoughnessTexture"),
        may("clearcoatNormalTexture", Object(&NORMAL_INFO)),
    ],
);

pub(super) const DIFFUSE_TRANSMISSION: Kind = kind(
    "diffuse transmission extensions",
    &[
        may("diffuseTransmissionFactor", UNIT),
        texture("diffuseTransmissionTexture"),
        may("diffuseTransmissionColorFactor", Numbers(3, 3, Range::UNIT)),
        texture("diffuseTransmissionColorTexture"),
    ],
);

pub(super) const DISPERSION: Kind = kind("dispersion extensions", &[may("dispersion", FROM_ZERO)]);

pub(super) const EMISSIVE_STRENGTH: Kind =
    kind("emissive strength extensions", &[may("emissiveStrength", FROM_ZERO)]);

/// An index of refraction of 0 stands for a mirror that reflects all light; all others are at least that of
/// vacuum, 1.
pub(super) const IOR: Kind = kind("ior extensions", &[may("ior", FROM_ZERO)]);

pub(super) const IRIDESCENCE: Kind = kind(
    "iridescence extensions",
    &[
        may("iridescenceFactor", UNIT),
        texture("iridescenceTexture"),
        may("iridescenceIor", Number(Range::at_least(1.0))),
        may("iridescenceThicknessMinimum", FROM_ZERO),
        may("iridescenceThicknessMaximum", FROM_ZERO),
        texture("iridescenceThicknessTexture"),
    ],
);

pub(super) const SPECULAR_GLOSSINESS: Kind = kind(
    "specular-glossiness extensions",
    &[
        may("diffuseFactor", RGBA),
        texture("diffuseTexture"),
        may("specularFactor", COLOUR),
        may("glossinessFactor", UNIT),
        texture("specularGlossinessTexture"),
    ],
);

pub(super) const SHEEN: Kind = kind(
    "sheen extensions",
    &[
        may("sheenColorFactor", COLOUR),
        texture("sheenColorTexture"),
        may("sheenRoughnessFactor", UNIT),
        texture("sheenRoughnessTexture"),
    ],
);

pub(super) const SPECULAR: Kind = kind(
    "specular extensions",
    &[
        may("specularFactor", UNIT),
        texture("specularTexture"),
        may("specularColorFactor", Numbers(3, 3, Range::at_least(0.0))),
        texture("specularColorTexture"),
    ],
);

pub(super) const TRANSMISSION: Kind =
    kind("transmission extensions", &[may("transmissionFactor", UNIT), texture("transmissionTexture")]);

pub(super) const UNLIT: Kind = kind("unlit extensions", &[]);

pub(super) const VOLUME: Kind = kind(
    "volume extensions",
    &[
        may("thicknessFactor", FROM_ZERO),
        texture("thicknessTexture"),
        may("attenuationDistance", Number(Range::POSITIVE)),
        may("attenuationColor", COLOUR),
    ],
);

pub(super) const SCATTER: Kind = kind(
    "scattering extensions",
    &[
        may("scatterStrengthFactor", UNIT),
        texture("scatterStrengthTexture"),
        may("multiscatterColorFactor", COLOUR),
        texture("multiscatterColorTexture"),
        may("scatterAnisotropy", Number(Range::SIGNED_UNIT)),
    ],
);

/// The name of the colour changed while it was a draft.
pub(super) const VOLUME_SCATTER: Kind = kind(
    "volume scattering extensions",
    &[
        may("multiscatterColor", COLOUR),
        may("multiscatterColorFactor", COLOUR),
        texture("multiscatterColorTexture"),
        may("scatterAnisotropy", Number(Range::SIGNED_UNIT)),
    ],
);
