//! The product of two textures.

use super::{Pattern, TextureEntry, tone};
use crate::texture::ColourMap;
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2};
use std::sync::Arc;

/// The row of `scale`.
pub(super) const ENTRY: TextureEntry = TextureEntry {
    entry: Entry {
        name: "scale",
        summary: "product of two colours or textures",
        source: "",
        parameters: &[tone("a", "the first factor", "1 1 1"), tone("b", "the second factor", "1 1 1")],
    },
    build: |reader, parts| {
        let [a, b] = ["a", "b"].map(|key| parts.colour(reader, key));
        Ok(Arc::new(Scale { a, b }))
    },
};

#[derive(Debug)]
struct Scale {
    a: ColourMap,
    b: ColourMap,
}

impl Pattern for Scale {
    fn at(&self, uv: Vec2) -> Rgb {
        self.a.at(uv) * self.b.at(uv)
    }
}
