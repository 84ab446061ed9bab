//! Maker of lights and of the emission of surfaces, with what they share.

use super::entity::Entity;
use super::loader::SpectrumType;
use super::parameters::{Kind, ParameterList};
use super::textures::Textures;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::input::names::unknown;
use bilux_math::Rgb;
use std::f64::consts::PI;
use std::sync::Arc;

/// The maximum value of a light.
const MAX_LIGHT: f32 = 1e11;

/// Makes lights.
pub(super) struct LightMaker<'m, 'd, 'o, 'r> {
    pub(super) textures: &'m mut Textures<'d, 'o, 'r>,
    /// The factor by which the film scales light.
    pub(super) gain: f32,
}

/// The emission of a surface.
#[derive(Clone, Debug)]
pub(super) struct AreaEmission {
    pub(super) radiance: TextureOrValue,
    pub(super) both_sides: bool,
    /// The total power, per shape.
    pub(super) power: Option<f32>,
}

impl LightMaker<'_, '_, '_, '_> {
    /// The colour of a parameter, white by default, times the scales of the light and of the film.
    pub(super) fn scaled_spectrum(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Rgb, FormatError> {
        let colour = self.textures.loader.spectrum(list, name, SpectrumType::Light)?.unwrap_or(Rgb::WHITE);
        let shone = colour * self.light_scale(list)?;
        if shone.max_channel() > MAX_LIGHT {
            self.textures.loader.note("the brightness of a light overflows", || list.at.clone());
        }
        Ok(shone.clamp(0.0, MAX_LIGHT))
    }

    /// The scales of a light and of the film.
    pub(super) fn light_scale(&mut self, list: &ParameterList) -> Result<Rgb, FormatError> {
        // A colour in version 3.
        let is_number = list.find("scale").is_none_or(|p| p.kind == Kind::Float);
        let scale = if is_number {
            Rgb::grey(list.finite("scale", 1.0)?)
        } else {
            self.textures.loader.spectrum(list, "scale", SpectrumType::Number)?.unwrap_or(Rgb::WHITE)
        };
        Ok(scale.map(|c| c.max(0.0)) * self.gain)
    }

    /// The emission of a surface.
    pub(super) fn area_emission(&mut self, entity: &Entity) -> Result<AreaEmission, FormatError> {
        let list = &entity.parameters;
        if entity.kind != "diffuse" && entity.kind != "area" {
            return Err(unknown("area light", &entity.kind, ["diffuse"], &entity.at));
        }
        let radiance = match list.text("filename")? {
            Some(name) => {
                if list.has("L") {
                    let message = "'L' and 'filename' both define this light's radiance: remove one of them";
                    return Err(FormatError::malformed(message, list.place("L")));
                }
                let at = list.place("filename");
                let picture = self.textures.loader.light_file(name, &at)?;
                TextureOrValue::Picture(Arc::new(picture)).scaled(self.light_scale(list)?)
            }
            None => TextureOrValue::Colour(self.scaled_spectrum(list, "L")?),
        };
        for name in ["samples", "nsamples"] {
            list.has(name);
        }
        let power = list.number("power")?.filter(|power| *power > 0.0);
        let both_sides = list.flag("twosided", false)?;
        list.report_unused(&mut self.textures.loader.diagnostics);
        Ok(AreaEmission { radiance, both_sides, power })
    }
}

impl AreaEmission {
    /// The radiance of a shape with this area.
    pub(super) fn radiance_of(&self, area: f64) -> TextureOrValue {
        let Some(power) = self.power else { return self.radiance.clone() };
        let mean = match &self.radiance {
            TextureOrValue::Colour(_) => 1.0,
            picture => f64::from(picture.mean().luminance()),
        };
        let sides = if self.both_sides { 2.0 } else { 1.0 };
        let given = mean * sides * area * PI;
        let factor = if given > 0.0 { f64::from(power) / given } else { 0.0 };
        self.radiance.clone().scaled(Rgb::grey(factor as f32))
    }
}

/// The name of a light's image, which version 3 stores under another key.
pub(super) fn picture_name(list: &ParameterList) -> Result<Option<(String, bool)>, FormatError> {
    for (name, is_old) in [("filename", false), ("mapname", true)] {
        if let Some(file) = list.text(name)? {
            return Ok(Some((file.to_owned(), is_old)));
        }
    }
    Ok(None)
}
