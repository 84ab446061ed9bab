//! A material of `principled` under construction.

use crate::FormatError;
use crate::appearance::heights::{holds_normals, normals_of_heights};
use crate::input::reading::Reading;
use crate::input::sink::Sink;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

/// Parameters of `principled`, and the textures that they refer to.
pub struct PrincipledDraft<'a, 'o> {
    pub spec: Spec,
    pub reading: &'a mut Reading<'o>,
    pub sink: &'a mut Sink,
    file: &'a str,
}

impl<'a, 'o> PrincipledDraft<'a, 'o> {
    pub fn new(
        spec: Spec,
        reading: &'a mut Reading<'o>,
        sink: &'a mut Sink,
        file: &'a str,
    ) -> PrincipledDraft<'a, 'o> {
        PrincipledDraft { spec, reading, sink, file }
    }

    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        self.spec.parameters.set_at(key, value.into(), self.spec.span.clone());
    }

    /// Adds a texture to the scene, and refers to it.
    pub fn put(&mut self, key: &str, texture: Texture) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(size_of::<[Texture; 2]>() as u64, self.file)?;
        self.sink.scene.textures.push(Arc::new(texture));
        self.set(key, Value::Texture(self.sink.scene.textures.len() - 1));
        Ok(())
    }

    /// Sets a colour, or a factor on that of a texture.
    pub fn colour(&mut self, key: &str, factor: Rgb, map: Option<Texture>) -> Result<(), FormatError> {
        match map {
            Some(texture) => self.put(key, Texture { factor, ..texture }),
            None => {
                self.set(key, factor);
                Ok(())
            }
        }
    }

    /// Sets a number, or a factor on that of a channel of a texture.
    pub fn number(
        &mut self,
        key: &str,
        factor: f64,
        map: Option<Texture>,
        channel: Channel,
    ) -> Result<(), FormatError> {
        match map {
            Some(texture) => {
                let factor = Rgb::grey(factor as f32);
                self.put(key, Texture { factor, channel: Some(channel), ..texture })
            }
            None => {
                self.set(key, factor as f32);
                Ok(())
            }
        }
    }

    /// Sets the normal from a map of normals, or from one of heights.
    pub fn normals(&mut self, map: Option<Texture>, scale: f64) -> Result<(), FormatError> {
        let Some(texture) = map else { return Ok(()) };
        if !holds_normals(&texture) {
            self.reading.budget.take::<[u8; 4]>(texture.width() * texture.height(), self.file)?;
            let normals = normals_of_heights(&texture, scale as f32);
            return self.put("normal", Texture { image: normals.image, ..texture });
        }
        self.put("normal", texture)?;
        self.set("normal_scale", scale.clamp(0.0, 10.0) as f32);
        Ok(())
    }

    /// Names something that the picture does not show.
    pub fn not_shown(&mut self, what: &str) {
        let at = self.spec.span.clone();
        self.sink.diagnostics.not_shown(what, || at);
    }
}
