//! Opacity, which files state in four modes; exporters use these in ways that contradict each other. See
//! `docs/formats/collada.md`.

use super::common::Filling;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::appearance::phong::{has_alpha, opacity};
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels};
use std::sync::Arc;

/// The modes: whether the alpha or the colour counts, and whether 1 or 0 is opaque.
#[derive(Clone, Copy)]
struct Mode {
    is_of_alpha: bool,
    one_is_opaque: bool,
}

impl Mode {
    fn of(transparent: Option<Element>) -> Mode {
        let name = transparent.and_then(|element| element.attribute("opaque")).unwrap_or("A_ONE");
        Mode { is_of_alpha: !name.starts_with("RGB"), one_is_opaque: !name.ends_with("ZERO") }
    }
}

impl Filling<'_, '_, '_, '_> {
    /// Sets the opacity.
    pub(super) fn transparency(&mut self) -> Result<(), FormatError> {
        let shader = self.effect.shader;
        let transparent = shader.child("transparent");
        let mode = Mode::of(transparent);
        let factor = self.number("transparency");
        if transparent.is_none() && factor.is_none() {
            return Ok(());
        }
        let value = self.effect.value("transparent");
        if let Some(map) = value.filter(|value| value.name() == "texture") {
            return self.opacity_of_picture(map, mode, factor.unwrap_or(1.0).clamp(0.0, 1.0) as f32);
        }
        let [r, g, b, a] = value.map(|value| self.rgba(value)).transpose()?.flatten().unwrap_or([1.0; 4]);
        let stated = if mode.is_of_alpha { f64::from(a) } else { f64::from(r + g + b) / 3.0 };
        let product = (stated * factor.unwrap_or(1.0)).clamp(0.0, 1.0);
        let opacity = if mode.one_is_opaque { product } else { 1.0 - product };
        let is_inverted = self.is_of_old_sketchup() || self.posed.document.settings.has_inverted_opacity;
        let opacity = if is_inverted { 1.0 - opacity } else { opacity };
        if opacity <= 0.0 {
            let at = self.draft.spec.span.clone();
            let what = "a material that is wholly transparent is read as opaque, as the programs mean it that write this";
            self.draft.sink.diagnostics.note(what, || at);
        } else if opacity < 1.0 {
            self.draft.set("opacity", opacity as f32);
        }
        Ok(())
    }

    /// True for files of programs that write transparency where the format has opacity: SketchUp before 7.1.
    fn is_of_old_sketchup(&self) -> bool {
        let Some(version) = self.posed.document.settings.tool.strip_prefix("Google SketchUp ") else {
            return false;
        };
        let mut numbers = version.split(['.', ' ']).map_while(|part| part.parse::<u32>().ok());
        numbers.next().is_some_and(|major| (major, numbers.next().unwrap_or(0)) < (7, 1))
    }

    /// Sets the opacity from a picture: its alpha if it has one, whatever the mode says, or else its brightness.
    ///
    /// The picture counts times `<transparency>`. [Collada 1.4.1, transparent]
    fn opacity_of_picture(&mut self, map: Element<'_>, mode: Mode, factor: f32) -> Result<(), FormatError> {
        let map = self.effect.value("transparent").filter(|value| value.key() == map.key());
        let Some(texture) = map.map(|map| self.texture(map, true)).transpose()?.flatten() else {
            return Ok(());
        };
        let diffuse = self.effect.value("diffuse").and_then(|value| value.attribute("texture"));
        let is_of_colours = diffuse.is_some() && diffuse == map.and_then(|map| map.attribute("texture"));
        let is_plain = mode.is_of_alpha && !has_alpha(&texture);
        let Some(texture) = opacity(texture, is_of_colours || is_plain) else {
            let rest = if mode.one_is_opaque { factor } else { 1.0 - factor };
            if is_plain && !is_of_colours && rest > 0.0 && rest < 1.0 {
                self.draft.set("opacity", rest);
            }
            return Ok(());
        };
        let is_inverted = !mode.one_is_opaque && (texture.channel != Some(Channel::A) || mode.is_of_alpha);
        if !is_inverted {
            // 0 is what programs write that do not mean it.
            let factor = if factor > 0.0 { texture.factor * factor } else { texture.factor };
            return self.draft.put("opacity", Texture { factor, ..texture });
        }
        let file = self.draft.spec.span.file.clone();
        self.draft.reading.budget.take::<[u8; 4]>(texture.width() * texture.height(), &file)?;
        self.draft
            .put("opacity", Texture { image: Arc::new(inverted(&texture, factor)), channel: None, ..texture })
    }
}

/// Complement to 1 of a texture's channel times a factor.
fn inverted(texture: &Texture, factor: f32) -> Image {
    let (width, height) = (texture.width(), texture.height());
    let rest = |texel: [u8; 4]| {
        let level = if texture.channel == Some(Channel::A) { texel[3] } else { texel[1] };
        let rest = 255 - (f32::from(level) * factor).round() as u8;
        [rest, rest, rest, 255]
    };
    let bytes = match &texture.image.texels {
        Texels::Bytes(bytes) => bytes.iter().map(|texel| rest(*texel)).collect(),
        _ => {
            texture.texels().map(|c| rest([0, (c.g.clamp(0.0, 1.0) * 255.0).round() as u8, 0, 255])).collect()
        }
    };
    Image { width, height, texels: Texels::Bytes(bytes) }
}
