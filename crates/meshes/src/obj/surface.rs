//! Converts MTL materials to those of Bilux, as `docs/formats/obj.md` describes.

use super::draft::{Draft, unit};
use super::habits::Habit;
use bilux_math::Rgb;
use bilux_scene::{Spec, Value};

/// Keywords of the PBR extension; any one of them makes a material `principled`.
const PBR: [&str; 6] = ["Pr", "Pm", "Ps", "Pc", "Pcr", "aniso"];
const PBR_MAPS: [&str; 5] = ["map_Pr", "map_Pm", "map_Ps", "map_Pc", "map_Pcr"];

/// Parameters of `principled` that come from a number or a texture: keyword, texture keyword, parameter.
pub(super) const NUMBERS: [(&str, &str, &str); 5] = [
    ("Pm", "map_Pm", "base_metalness"),
    ("Pr", "map_Pr", "specular_roughness"),
    ("Ps", "map_Ps", "fuzz_weight"),
    ("Pc", "map_Pc", "coat_weight"),
    ("Pcr", "map_Pcr", "coat_roughness"),
];

/// True if any keyword of the PBR extension is given.
pub(super) fn is_of_pbr_extension(draft: &Draft) -> bool {
    PBR.iter().any(|word| draft.number(word).is_some())
        || PBR_MAPS.iter().any(|word| draft.maps.contains_key(word))
}

/// The material without its textures, as a program with this habit means it.
pub(super) fn material(draft: &Draft, habit: Option<Habit>) -> Spec {
    let ks = draft.colour("Ks").map_or(Rgb::BLACK, unit);
    let is_mirror = matches!(draft.illum(), 3 | 5 | 8)
        && draft.colour("Kr").is_none()
        && draft.colour("Kd").is_none_or(|c| unit(c).is_black())
        && !draft.maps.contains_key("map_Kd")
        && !ks.is_black();
    let mut spec = if is_of_pbr_extension(draft) {
        principled(draft)
    } else if draft.is_glass {
        dielectric(draft)
    } else if let Some(habit) = habit {
        habitual(draft, habit)
    } else if is_mirror {
        Spec::new(&draft.name, "mirror").with("reflectance", ks)
    } else {
        phong(draft, ks)
    };
    spec.span = draft.span.clone();
    let emission = draft.colour("Ke").map_or(Rgb::BLACK, |c| c.clamp(0.0, 1e12));
    if spec.kind != "dielectric" && !emission.is_black() {
        spec.parameters.set("emission", emission);
    }
    for (_, _, at) in &mut spec.parameters.0 {
        *at = draft.span.clone();
    }
    spec
}

/// A material of a program that writes a specular level and a roughness.
fn habitual(draft: &Draft, habit: Habit) -> Spec {
    let mut spec = Spec::new(&draft.name, "principled");
    let mut set = |key: &str, value: Value| spec.parameters.set(key, value);
    if let Some(kd) = draft.diffuse() {
        set("base_color", kd.into());
    }
    let smoothness = (draft.number("Ns").unwrap_or(0.0).max(0.0) / habit.smooth).sqrt();
    set("specular_roughness", (1.0 - smoothness).clamp(0.0, 1.0).into());
    // A level of 1 reflects 8%. [Burley 2012]
    let level = draft.colour("Ks").map_or(0.0, |ks| unit(ks).max_channel());
    let amplitude = (0.08 * level).sqrt();
    set("specular_ior", ((1.0 + amplitude) / (1.0 - amplitude)).into());
    if matches!(draft.illum(), 3 | 6) {
        set("base_metalness", draft.colour("Ka").map_or(1.0, |ka| unit(ka).max_channel()).into());
    }
    if draft.opacity < 1.0 {
        set("opacity", draft.opacity.into());
    }
    spec
}

fn dielectric(draft: &Draft) -> Spec {
    let spec = Spec::new(&draft.name, "dielectric").with("eta", draft.eta().unwrap_or(1.5));
    match filter_colour(draft) {
        Some(tint) => spec.with("tint", unit(tint)),
        None => spec,
    }
}

/// The colour of what passes through glass, unless it is black, which many exporters write for everything.
fn filter_colour(draft: &Draft) -> Option<Rgb> {
    draft.colour("Tf").filter(|tf| !tf.is_black())
}

fn phong(draft: &Draft, ks: Rgb) -> Spec {
    let mut spec = Spec::new(&draft.name, "phong");
    let mut set = |key: &str, value: Value| spec.parameters.set(key, value);
    if let Some(kd) = draft.diffuse() {
        set("kd", kd.into());
    }
    set("ks", if draft.lacks_highlight() { Rgb::BLACK } else { ks }.into());
    if let Some(exponent) = draft.number("Ns") {
        set("exponent", exponent.clamp(0.0, 1e5).into());
    }
    let reflects = if matches!(draft.illum(), 3 | 5 | 8) { 1.0 } else { 0.0 };
    set("reflectivity", draft.colour("Kr").map_or(reflects, |c| unit(c).max_channel()).into());
    if let Some(kt) = draft.colour("Kt").map(unit).filter(|kt| !kt.is_black()) {
        set("kt", kt.into());
        // Glass without refraction.
        set("thin", (draft.illum() == 4).into());
    }
    if draft.opacity < 1.0 {
        set("opacity", draft.opacity.into());
    }
    if let Some(eta) = draft.eta() {
        set("eta", eta.into());
    }
    spec
}

fn principled(draft: &Draft) -> Spec {
    let mut spec = Spec::new(&draft.name, "principled");
    let mut set = |key: &str, value: Value| spec.parameters.set(key, value);
    if let Some(kd) = draft.diffuse() {
        set("base_color", kd.into());
    }
    // From Blinn's exponent, if no roughness is given. [Walter 2007]
    let of_exponent = || Some((2.0 / (draft.number("Ns")?.max(0.0) + 2.0)).sqrt().sqrt());
    for (word, _, key) in NUMBERS {
        let number = draft.number(word).or_else(|| if word == "Pr" { of_exponent() } else { None });
        if let Some(number) = number {
            set(key, number.clamp(0.0, 1.0).into());
        }
    }
    if let Some(aniso) = draft.number("aniso") {
        set("specular_roughness_anisotropy", aniso.clamp(0.0, 1.0).into());
        set("anisotropy_rotation", draft.number("anisor").unwrap_or(0.0).rem_euclid(1.0).into());
    }
    // Exporters write 1 for materials without an index of refraction.
    if let Some(eta) = draft.eta().filter(|eta| *eta > 1.0) {
        set("specular_ior", eta.into());
    }
    if draft.opacity < 1.0 {
        set("opacity", draft.opacity.into());
    } else if draft.is_glass {
        set("transmission_weight", 1.0f32.into());
        if let Some(tint) = filter_colour(draft) {
            set("transmission_color", unit(tint).into());
        }
    }
    spec
}
