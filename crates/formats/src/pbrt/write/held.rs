//! What pbrt's materials say of ours, and what they cannot.

use crate::values::{Held, tell_left_out, tell_pictures_left_out};
use crate::writing::Writing;
use bilux_scene::Spec;

/// What is said there of each kind, or told where it is looked at.
const HELD: [Held; 7] = [
    ("diffuse", &["reflectance"]),
    ("mirror", &["reflectance"]),
    ("conductor", &["metal", "eta", "k", "reflectance", "roughness", "anisotropy", "rotation"]),
    ("dielectric", &["glass", "eta", "absorption", "thin", "roughness", "anisotropy", "rotation"]),
    (
        "principled",
        &[
            "base_color",
            "base_metalness",
            "specular_weight",
            "specular_ior",
            "specular_roughness",
            "specular_roughness_anisotropy",
            "anisotropy_rotation",
            "transmission_weight",
            "transmission_color",
            "transmission_depth",
            "thin_walled",
            "coat_weight",
            "coat_roughness",
            "coat_ior",
            "diffuse_transmission_weight",
            "diffuse_transmission_color",
        ],
    ),
    ("phong", &["kd", "ks", "kt", "exponent", "eta", "thin"]),
    ("mix", &["a", "b", "amount"]),
];

/// What it holds of all.
const OF_ANY: [&str; 5] = ["emission", "emission_scale", "emission_sides", "opacity", "normal"];

/// What it holds pictures of.
const PICTURED: [&str; 14] = [
    "reflectance",
    "roughness",
    "base_color",
    "base_metalness",
    "specular_roughness",
    "transmission_weight",
    "coat_roughness",
    "diffuse_transmission_color",
    "kd",
    "ks",
    "amount",
    "emission",
    "opacity",
    "normal",
];

/// Tells of what a material says that is not written.
pub(super) fn tell_not_held(spec: &Spec, writing: &mut Writing) {
    tell_left_out(spec, "pbrt", &HELD, &OF_ANY, writing);
    tell_pictures_left_out(spec, "pbrt", &PICTURED, writing);
}
