//! Materials; the table is [`MATERIALS`].

mod coated;
mod maker;
mod plain;
mod roughness;
mod version_3;

pub(super) use maker::MaterialMaker;

use super::entity::Entity;
use super::parameters::ParameterList;
use super::state::MaterialKey;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::input::names::unknown;
use bilux_import::input::reading::Texels;
use bilux_math::Rgb;
use bilux_scene::{Span, Spec};
use std::sync::Arc;

/// Builds a material; `None` for an interface, which is invisible.
type Make = fn(&mut MaterialMaker, &ParameterList) -> Result<Option<Spec>, FormatError>;

/// Every material; those of version 3 come last.
const MATERIALS: &[(&str, Make)] = &[
    ("coatedconductor", coated::conductor),
    ("coateddiffuse", coated::diffuse),
    ("conductor", plain::conductor),
    ("dielectric", plain::dielectric),
    ("diffuse", plain::diffuse),
    ("diffusetransmission", plain::diffuse_transmission),
    ("hair", plain::hair),
    ("interface", plain::interface),
    ("measured", plain::measured),
    ("mix", mix),
    ("subsurface", coated::subsurface),
    ("thindielectric", plain::thin_dielectric),
    ("", plain::interface),
    ("none", plain::interface),
    ("matte", version_3::matte),
    ("plastic", version_3::plastic),
    ("substrate", version_3::plastic),
    ("uber", version_3::plastic),
    ("metal", version_3::metal),
    ("mirror", version_3::mirror),
    ("glass", version_3::glass),
    ("translucent", version_3::translucent),
    ("disney", version_3::disney),
    ("kdsubsurface", version_3::plastic),
    ("fourier", plain::measured),
];

/// The material of a key; `None` for an interface, which is invisible.
pub(super) fn material(
    key: &MaterialKey,
    user: &Span,
    maker: &mut MaterialMaker,
) -> Result<Option<Spec>, FormatError> {
    let document = maker.document;
    let index = match key {
        MaterialKey::Default => {
            return Ok(Some(Spec::new("default", "diffuse").with("reflectance", 0.5f32)));
        }
        MaterialKey::Index(index) => *index,
        MaterialKey::Named(name) => match document.named_materials.get(name) {
            Some((index, _)) => *index,
            None => {
                let names = document.named_materials.keys().map(|name| &**name);
                return Err(unknown("material", name, names, user));
            }
        },
    };
    let Some(entity) = document.materials.get(index) else { return Ok(None) };
    let spec = material_of(entity, maker)?;
    Ok(spec.map(|mut spec| {
        if let MaterialKey::Named(name) = key {
            spec.name = name.to_string();
        }
        spec
    }))
}

fn material_of(entity: &Entity, maker: &mut MaterialMaker) -> Result<Option<Spec>, FormatError> {
    let Some((_, make)) = MATERIALS.iter().find(|(name, _)| *name == entity.kind) else {
        let names = MATERIALS.iter().map(|(name, _)| *name).filter(|name| !name.is_empty());
        return Err(unknown("material", &entity.kind, names, &entity.at));
    };
    let list = &entity.parameters;
    let Some(mut spec) = make(maker, list)? else { return Ok(None) };
    spec.span = entity.at.clone();
    for name in ["type", "bumpmap"] {
        list.has(name);
    }
    if let Some(name) = ["displacement", "bumpmap"].into_iter().find(|name| list.has(name)) {
        maker.note("displacement of a material is not supported", || list.place(name));
    }
    if let Some(name) = list.text("normalmap")? {
        let at = list.place("normalmap");
        let map = TextureOrValue::Picture(Arc::new(maker.loader().file(name, Texels::Numbers(None), &at)?));
        spec.parameters.set_at("normal", maker.textures.value(map), at);
    }
    list.report_unused(&mut maker.loader().diagnostics);
    Ok(Some(spec))
}

/// Deeper nesting of mixes is refused.
const MAX_DEPTH: usize = 8;

fn mix(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let amount =
        maker.float_texture_or_colour(list, "amount")?.unwrap_or(TextureOrValue::Colour(Rgb::grey(0.5)));
    let (names, is_old): (Vec<String>, bool) = match list.texts("materials")? {
        [] => {
            let name = |key| Ok::<_, FormatError>(list.text(key)?.map(str::to_owned));
            ([name("namedmaterial1")?, name("namedmaterial2")?].into_iter().flatten().collect(), true)
        }
        names => (names.to_vec(), false),
    };
    let [a, b] = names.as_slice() else {
        let message = format!("a mix takes two materials, not {}", names.len());
        return Err(FormatError::malformed(message, list.at.clone()));
    };
    maker.mix_depth += 1;
    if maker.mix_depth > MAX_DEPTH {
        let message = format!("mixes are nested more than {MAX_DEPTH} levels deep, or contain themselves");
        return Err(FormatError::malformed(message, list.at.clone()));
    }
    let mut part = |name: &str| material(&MaterialKey::Named(name.into()), &list.place("materials"), maker);
    // In version 3 the amount is the weight of the first material.
    let (first, second) = if is_old { (part(b)?, part(a)?) } else { (part(a)?, part(b)?) };
    maker.mix_depth -= 1;
    let (Some(first), Some(second)) = (first, second) else {
        let what = "an interface cannot be mixed with a material: only the material is used";
        maker.note(what, || list.at.clone());
        return Ok(None);
    };
    let amount = maker.textures.number_value(amount, [0.0, 1.0]);
    Ok(Some(maker.mixed(first, second, amount, "a part")))
}
