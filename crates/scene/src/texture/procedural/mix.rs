//! A mixture of two textures.

use super::{Pattern, TextureEntry, tone};
use crate::texture::{ColourMap, NumberMap};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec2};
use std::sync::Arc;

/// The row of `mix`.
pub(super) const ENTRY: TextureEntry = TextureEntry {
    entry: Entry {
        name: "mix",
        summary: "mixture of two colours or textures",
        source: "",
        parameters: &[
            tone("a", "the first colour or texture", "0 0 0"),
            tone("b", "the second colour or texture", "1 1 1"),
            Parameter {
                name: "amount",
                summary: "weight of `b`",
                unit: "",
                kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
                default: "0.5",
            },
        ],
    },
    build: |reader, parts| {
        let [a, b] = ["a", "b"].map(|key| parts.colour(reader, key));
        Ok(Arc::new(Mix { a, b, amount: parts.number(reader, "amount") }))
    },
};

#[derive(Debug)]
struct Mix {
    a: ColourMap,
    b: ColourMap,
    amount: NumberMap,
}

impl Pattern for Mix {
    fn at(&self, uv: Vec2) -> Rgb {
        self.a.at(uv).lerp(self.b.at(uv), self.amount.at(uv))
    }
}
