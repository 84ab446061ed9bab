//! Attributes that a material adds to its shapes: its name, interior medium, emission and opacity mask.

use super::document::{Document, float, rgb};
use super::lights::area_light;
use super::textures::{AS_IT_IS, TexelMeaning};
use bilux_import::FormatError;
use bilux_import::output::values::{colour, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::texture::Wrap;
use bilux_scene::{Spec, Value};
use std::fmt::Write;

/// The text before a shape and its last parameter.
#[derive(Clone, Debug, Default)]
pub(super) struct ShapeAttributes {
    /// The directives before the shape.
    pub(super) begin: String,
    /// The alpha parameter of the shape.
    pub(super) alpha: String,
    pub(super) glows: bool,
}

impl Document<'_> {
    /// Writes a material; returns what it adds to its shapes.
    pub(super) fn look(
        &mut self,
        spec: &Spec,
        writing: &mut Writing,
    ) -> Result<ShapeAttributes, FormatError> {
        let (name, inside) = self.material(spec, writing)?;
        let mut look =
            ShapeAttributes { begin: format!("NamedMaterial \"{name}\"\n"), ..ShapeAttributes::default() };
        if !inside.is_clear() {
            let medium = self.name(&spec.name, "medium");
            let mut given = rgb("sigma_a", inside.absorption) + &rgb("sigma_s", inside.scattering);
            if inside.anisotropy != 0.0 {
                given += &float("g", inside.anisotropy);
            }
            self.line(&format!("MakeNamedMedium \"{medium}\" \"string type\" \"homogeneous\"{given}"));
            let _ = writeln!(look.begin, "MediumInterface \"{medium}\" \"\"");
        }
        if let Some(radiance) = self.radiance(spec, writing)? {
            let is_in_front =
                matches!(spec.parameters.find("emission_sides"), Some((Value::Text(t), _)) if t == "front");
            let _ = writeln!(look.begin, "{}", area_light(&radiance, !is_in_front));
            look.glows = true;
        }
        if let Some(index) = texture(spec, "opacity") {
            let threshold = self.scene.textures.get(index).and_then(|texture| texture.threshold);
            if threshold.is_some() {
                writing.warn("cut-outs get the hard edges of their texels");
            }
            if let Some(name) = self.texture(index, TexelMeaning::Numbers, AS_IT_IS, writing)? {
                look.alpha = format!(" \"texture alpha\" \"{name}\"");
            }
        } else if let Some(opacity) = number(spec, "opacity").filter(|opacity| *opacity < 1.0) {
            look.alpha = float("alpha", opacity);
        }
        Ok(look)
    }

    /// The parameters of a surface's emission, if any.
    fn radiance(&mut self, spec: &Spec, writing: &mut Writing) -> Result<Option<String>, FormatError> {
        let scale = colour(spec, "emission_scale").unwrap_or(Rgb::WHITE);
        let Some(index) = texture(spec, "emission") else {
            let light = colour(spec, "emission").map(|light| light * scale).filter(|light| !light.is_black());
            return Ok(light.map(|light| rgb("L", light)));
        };
        let Some(texture) = self.scene.textures.get(index).cloned() else { return Ok(None) };
        let greatest = scale.max_channel();
        if scale != Rgb::grey(scale.r) {
            writing.warn("pbrt scales an emission texture by one number: the maximum channel is used");
        }
        let plain = (None, false, [Wrap::Repeat; 2]);
        if (texture.transform, texture.second_uv, texture.wrap) != plain {
            writing.warn(
                "pbrt places emission textures by the first texture coordinates of the mesh, and repeats them: how this one is \
                 placed is left out",
            );
        }
        let file = self.picture(&texture, false, AS_IT_IS, writing)?;
        Ok(Some(format!(" \"string filename\" \"{file}\"{}", float("scale", greatest))))
    }
}
