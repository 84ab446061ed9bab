//! A checkerboard of two colours.

use super::place::{U_OFFSET, UvPlacement, V_OFFSET, u_scale, v_scale};
use super::{Pattern, TextureEntry, tone};
use crate::texture::{ColourMap, Filter, Texture, UvTransform};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2};
use std::sync::Arc;

/// The row of `checker`.
pub(super) const ENTRY: TextureEntry = TextureEntry {
    entry: Entry {
        name: "checker",
        summary: "checkerboard of two colours",
        source: "",
        parameters: &[
            tone("a", "colour of the lower left square and of every other square from there", "1 1 1"),
            tone("b", "colour of the other squares", "0 0 0"),
            u_scale("factor on u: the number of squares across", "8"),
            v_scale("factor on v: the number of squares upwards", "8"),
            U_OFFSET,
            V_OFFSET,
        ],
    },
    build: |reader, parts| {
        let [a, b] = ["a", "b"].map(|key| parts.colour(reader, key));
        Ok(Arc::new(Checker { a, b, place: UvPlacement::read(reader) }))
    },
};

#[derive(Debug)]
struct Checker {
    a: ColourMap,
    b: ColourMap,
    place: UvPlacement,
}

impl Pattern for Checker {
    fn at(&self, uv: Vec2) -> Rgb {
        let at = self.place.of(uv).floor();
        let is_even = (at.x as i64).wrapping_add(at.y as i64) & 1 == 0;
        if is_even { self.a.at(uv) } else { self.b.at(uv) }
    }

    /// Two by two squares, repeated.
    fn picture(&self) -> Option<Texture> {
        if self.a.texture.is_some() || self.b.texture.is_some() {
            return None;
        }
        let (a, b) = (self.a.colour, self.b.colour);
        let UvPlacement { scale, shift } = self.place;
        // Rows go downwards, but v goes upwards.
        let offset = [0.5 * shift.x, 0.5 * (scale.y + shift.y)];
        let transform = Some(UvTransform::new(offset, 0.0, [0.5 * scale.x, -0.5 * scale.y]));
        let squares = Texture::new("", 2, 2, vec![a, b, b, a], true);
        Some(Texture { transform, filter: Filter::Nearest, ..squares })
    }
}
