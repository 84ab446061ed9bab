//! Shapes that emit light.

use crate::mitsuba::maker::{MAX_LIGHT, Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::Rgb;
use bilux_scene::{MATERIALS, Spec, Texture};
use std::rc::Rc;
use std::sync::Arc;

/// Emission of a shape to its front.
#[derive(Clone, Debug)]
pub(in crate::mitsuba) struct Emission(pub(in crate::mitsuba) TextureOrValue);

/// The emission of a shape; `None` if it is of another kind.
pub(in crate::mitsuba) fn emission(
    maker: &mut Maker,
    plugin: &Rc<Plugin>,
) -> Result<Option<Emission>, FormatError> {
    if plugin.kind != "area" {
        maker.not_shown(plugin);
        plugin.properties.iter().for_each(|property| property.used.set(true));
        return Ok(None);
    }
    let radiance = maker.source_or(plugin, "radiance", Meaning::Light, 1.0)?;
    let radiance = radiance.scaled(Rgb::grey(plugin.number_or("scale", 1.0)?.max(0.0) as f32));
    plugin.ignore(&["sampling_weight"]);
    plugin.report_unused(&mut maker.diagnostics);
    Ok(Some(Emission(radiance)))
}

impl Emission {
    /// A material that also emits this.
    pub(in crate::mitsuba) fn on(&self, spec: Spec, maker: &mut Maker, plugin: &Plugin) -> Spec {
        let row = MATERIALS.iter().find(|row| row.entry.name == spec.kind);
        let can = row.is_some_and(|row| row.entry.parameters.iter().any(|p| p.name == "emission"));
        let mut spec = if can {
            spec
        } else {
            let what = format!("a {} that emits light reflects none", spec.kind);
            maker.note(&what, &plugin.at);
            Spec { span: spec.span, name: spec.name, ..super::super::bsdfs::black() }
        };
        match &self.0 {
            TextureOrValue::Colour(colour) => spec.parameters.set("emission", colour.clamp(0.0, MAX_LIGHT)),
            TextureOrValue::Picture(picture) => {
                let scale = picture.factor;
                let plain = Texture { factor: Rgb::WHITE, ..(**picture).clone() };
                let value = maker.value(TextureOrValue::Picture(Arc::new(plain)));
                spec.parameters.set("emission", value);
                spec.parameters.set("emission_scale", scale.clamp(0.0, MAX_LIGHT));
            }
        }
        spec.parameters.set("emission_sides", "front");
        spec
    }
}
