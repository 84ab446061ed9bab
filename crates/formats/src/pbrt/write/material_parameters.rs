//! The parameters of Bilux materials that pbrt's materials can express.

use crate::values::MaterialSupport;

pub(super) const HOLDS: MaterialSupport = MaterialSupport {
    format: "pbrt",
    of_kinds: &[
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
    ],
    of_any: &["emission", "emission_scale", "emission_sides", "opacity", "normal"],
    textured: Some(&[
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
    ]),
};
