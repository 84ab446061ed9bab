//! Pictures on surfaces.

use bilux_math::{Rgb, Vec2};

/// A picture wrapped around a surface, linear light or plain numbers, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The file that it came from, relative to the scene.
    pub name: String,
    /// Texels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` texels.
    pub texels: Vec<Rgb>,
    /// They are numbers, such as roughness, and not colours: files hold them as they are.
    pub is_data: bool,
}

impl Texture {
    /// The colour at texture coordinates: repeated, bilinear, v upwards.
    pub fn at(&self, uv: Vec2) -> Rgb {
        if self.texels.is_empty() || !uv.is_finite() {
            return Rgb::WHITE;
        }
        let x = uv.x * self.width as f32 - 0.5;
        let y = (1.0 - uv.y) * self.height as f32 - 0.5;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let wrap = |c: f32, n: usize| (c.floor() as i64).rem_euclid(n as i64) as usize;
        let (x0, y0) = (wrap(x, self.width), wrap(y, self.height));
        let (x1, y1) = ((x0 + 1) % self.width, (y0 + 1) % self.height);
        let texel = |x: usize, y: usize| self.texels[y * self.width + x];
        texel(x0, y0).lerp(texel(x1, y0), fx).lerp(texel(x0, y1).lerp(texel(x1, y1), fx), fy)
    }
}

/// A number that may vary over a surface.
#[derive(Clone, Debug)]
pub struct NumberMap {
    /// The number, where there is no texture.
    pub number: f32,
    /// The least and the greatest that a texture can say.
    pub range: [f32; 2],
    /// The texture, if there is one; of colours their luminance counts.
    pub texture: Option<std::sync::Arc<Texture>>,
}

impl NumberMap {
    /// The number at texture coordinates.
    #[inline]
    pub fn at(&self, uv: Vec2) -> f32 {
        match &self.texture {
            // What is not a number becomes the least one.
            Some(texture) => texture.at(uv).luminance().max(self.range[0]).min(self.range[1]),
            None => self.number,
        }
    }
}

/// A colour that may vary over a surface.
#[derive(Clone, Debug)]
pub struct ColourMap {
    /// The colour, or what the texture is multiplied by.
    pub colour: Rgb,
    /// The texture, if there is one.
    pub texture: Option<std::sync::Arc<Texture>>,
}

impl ColourMap {
    /// The colour at texture coordinates.
    pub fn at(&self, uv: Vec2) -> Rgb {
        match &self.texture {
            Some(texture) => self.colour * texture.at(uv),
            None => self.colour,
        }
    }
}
