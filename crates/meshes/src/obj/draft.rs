//! A material of MTL while its lines are read.

use bilux_math::Rgb;
use bilux_scene::texture::{Channel, UvTransform, Wrap};
use bilux_scene::{Span, Texture};
use std::collections::HashMap;

/// A material while its lines are read; `None` stands for what no line states.
#[derive(Default)]
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) span: Span,
    /// Offset in the file at which the material begins.
    pub(super) start: usize,
    pub(super) colours: HashMap<&'static str, (Rgb, usize)>,
    pub(super) numbers: HashMap<&'static str, (f32, usize)>,
    pub(super) maps: HashMap<&'static str, Map>,
    /// The opacity, from 0 to 1, once the whole library is known.
    pub(super) opacity: f32,
    /// Whether light enters the surface and is refracted, once the whole library is known.
    pub(super) is_glass: bool,
}

impl Draft {
    pub(super) fn new(name: String, span: Span, start: usize) -> Draft {
        Draft { name, span, start, opacity: 1.0, ..Draft::default() }
    }

    pub(super) fn colour(&self, key: &str) -> Option<Rgb> {
        self.colours.get(key).map(|(colour, _)| *colour)
    }

    pub(super) fn number(&self, key: &str) -> Option<f32> {
        self.numbers.get(key).map(|(number, _)| *number)
    }

    /// True if a line gives this number or colour.
    pub(super) fn states(&self, key: &str) -> bool {
        self.numbers.contains_key(key) || self.colours.contains_key(key)
    }

    /// Offset at which the line of a number or a colour begins; that of the material, if there is none.
    pub(super) fn offset(&self, key: &str) -> usize {
        let number = self.numbers.get(key).map(|(_, at)| *at);
        number.or(self.colours.get(key).map(|(_, at)| *at)).unwrap_or(self.start)
    }

    pub(super) fn illum(&self) -> i32 {
        self.number("illum").map_or(2, |n| n as i32)
    }

    /// True if nothing is specular: by the illumination model, or by an exponent of 0. By Phong's formula that would be a
    /// highlight as wide as the whole surface, which nobody means, unless the surface mirrors, or says how much.
    pub(super) fn lacks_highlight(&self) -> bool {
        let mirrors = matches!(self.illum(), 3 | 5 | 8) || self.colour("Kr").is_some();
        self.illum() < 2 || (self.has_exponent_of_zero() && !mirrors)
    }

    pub(super) fn has_exponent_of_zero(&self) -> bool {
        self.number("Ns").is_some_and(|exponent| exponent <= 0.0)
    }

    /// The index of refraction, if a valid one is given.
    pub(super) fn eta(&self) -> Option<f32> {
        self.number("Ni").filter(|&n| n > 0.0).map(|n| n.clamp(0.1, 10.0))
    }

    /// The diffuse colour; white if there is only a texture.
    pub(super) fn diffuse(&self) -> Option<Rgb> {
        self.colour("Kd").map(unit).or(self.maps.contains_key("map_Kd").then_some(Rgb::WHITE))
    }
}

/// A texture as a line describes it.
pub(super) struct Map {
    pub(super) file: String,
    pub(super) at: Span,
    pub(super) offset: [f32; 2],
    pub(super) scale: [f32; 2],
    pub(super) is_clamped: bool,
    /// The bump multiplier.
    pub(super) bump: f32,
    /// An addition to values, and a factor on them.
    pub(super) range: [f32; 2],
    /// The selected channel.
    pub(super) channel: Option<Channel>,
}

impl Map {
    /// Places the texture: scales texture coordinates, with v upwards, then shifts them.
    pub(super) fn placed(&self, texture: Texture) -> Texture {
        let ([x, y], [u, v]) = (self.scale, self.offset);
        let lies = (self.scale, self.offset) != ([1.0; 2], [0.0; 2]);
        let transform = lies.then(|| UvTransform::new([u, 1.0 - y - v], 0.0, [x, y]));
        let wrap = if self.is_clamped { [Wrap::Clamp; 2] } else { texture.wrap };
        Texture { transform, wrap, ..texture }
    }
}

pub(super) fn unit(c: Rgb) -> Rgb {
    c.clamp(0.0, 1.0)
}
