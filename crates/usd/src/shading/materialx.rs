//! Surfaces of MaterialX, whose parameters are nearly those of `principled`.

use super::draft::Draft;
use super::preview::normal;
use bilux_import::FormatError;
use bilux_math::Rgb;

/// An input and the parameter that it is, what it is where it is not stated, and whether it is a colour.
type Row = (&'static str, &'static str, Option<f32>, bool);

/// Autodesk's standard surface. [MaterialX: standard_surface]
const STANDARD: &[Row] = &[
    ("diffuse_roughness", "base_diffuse_roughness", None, false),
    ("metalness", "base_metalness", None, false),
    ("specular", "specular_weight", None, false),
    ("specular_color", "specular_color", None, true),
    ("specular_roughness", "specular_roughness", Some(0.2), false),
    ("specular_IOR", "specular_ior", Some(1.5), false),
    ("specular_anisotropy", "specular_roughness_anisotropy", None, false),
    ("transmission", "transmission_weight", None, false),
    ("transmission_color", "transmission_color", None, true),
    ("transmission_depth", "transmission_depth", None, false),
    ("subsurface", "subsurface_weight", None, false),
    ("subsurface_color", "subsurface_color", Some(1.0), true),
    ("subsurface_scale", "subsurface_radius", None, false),
    ("sheen", "fuzz_weight", None, false),
    ("sheen_color", "fuzz_color", None, true),
    ("sheen_roughness", "fuzz_roughness", Some(0.3), false),
    ("coat", "coat_weight", None, false),
    ("coat_color", "coat_color", None, true),
    ("coat_roughness", "coat_roughness", Some(0.1), false),
    ("coat_IOR", "coat_ior", Some(1.5), false),
    ("opacity", "opacity", None, false),
];

/// OpenPBR. [OpenPBR 1.1]
const OPEN_PBR: &[Row] = &[
    ("base_diffuse_roughness", "base_diffuse_roughness", None, false),
    ("base_metalness", "base_metalness", None, false),
    ("specular_weight", "specular_weight", None, false),
    ("specular_color", "specular_color", None, true),
    ("specular_roughness", "specular_roughness", Some(0.3), false),
    ("specular_ior", "specular_ior", Some(1.5), false),
    ("specular_roughness_anisotropy", "specular_roughness_anisotropy", None, false),
    ("transmission_weight", "transmission_weight", None, false),
    ("transmission_color", "transmission_color", None, true),
    ("transmission_depth", "transmission_depth", None, false),
    ("transmission_scatter", "transmission_scatter", None, true),
    ("subsurface_weight", "subsurface_weight", None, false),
    ("subsurface_color", "subsurface_color", Some(0.8), true),
    ("subsurface_radius", "subsurface_radius", None, false),
    ("fuzz_weight", "fuzz_weight", None, false),
    ("fuzz_color", "fuzz_color", None, true),
    ("fuzz_roughness", "fuzz_roughness", Some(0.5), false),
    ("coat_weight", "coat_weight", None, false),
    ("coat_color", "coat_color", None, true),
    ("coat_roughness", "coat_roughness", None, false),
    ("coat_ior", "coat_ior", Some(1.6), false),
    ("thin_film_weight", "thin_film_weight", None, false),
    ("thin_film_thickness", "thin_film_thickness", None, false),
    ("thin_film_ior", "thin_film_ior", None, false),
    ("geometry_opacity", "opacity", None, false),
];

/// The inputs of a surface that have a part each.
struct Names {
    rows: &'static [Row],
    weight: &'static str,
    emission: &'static str,
    thin: &'static str,
    normal: &'static str,
}

const OF_STANDARD: Names =
    Names { rows: STANDARD, weight: "base", emission: "emission", thin: "thin_walled", normal: "normal" };
const OF_OPEN_PBR: Names = Names {
    rows: OPEN_PBR,
    weight: "base_weight",
    emission: "emission_luminance",
    thin: "geometry_thin_walled",
    normal: "geometry_normal",
};

pub(super) fn standard(draft: &mut Draft) -> Result<(), FormatError> {
    surface(draft, &OF_STANDARD)
}

pub(super) fn open_pbr(draft: &mut Draft) -> Result<(), FormatError> {
    surface(draft, &OF_OPEN_PBR)
}

fn surface(draft: &mut Draft, names: &Names) -> Result<(), FormatError> {
    let weight = draft.number(names.weight)?.unwrap_or(1.0).max(0.0) as f32;
    if !draft.set_colour("base_color", "base_color", weight)? {
        let unstated = if draft.shaded.uses_colours { 1.0 } else { 0.8 };
        draft.set("base_color", unstated * weight);
    }
    for &(input, key, unstated, is_colour) in names.rows {
        let is_set = match is_colour {
            true => draft.set_colour(key, input, 1.0)?,
            false => draft.set_number(key, input, 1.0)?,
        };
        if !is_set
            && input == "opacity"
            && let Some(colour) = draft.colour(input)?
        {
            // A colour in a standard surface.
            draft.set(key, colour.luminance().clamp(0.0, 1.0));
        }
        if !is_set && let Some(unstated) = unstated {
            draft.set(key, unstated);
        }
    }
    let strength = draft.number(names.emission)?.unwrap_or(0.0) as f32;
    if strength > 0.0 && !draft.set_colour("emission", "emission_color", strength)? {
        draft.set("emission", Rgb::grey(strength));
    }
    if draft.number(names.thin)? == Some(1.0) {
        draft.set("thin_walled", true);
    }
    normal(draft, names.normal)
}
