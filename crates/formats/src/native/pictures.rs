//! Image textures: their placement, wrapping and filtering.

use super::document::Table;
use super::plain::plain_value;
use bilux_import::FormatError;
use bilux_math::Vec2;
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice, integer};
use bilux_math::transcendental::{cos, sin};
use bilux_scene::texture::{Filter, UvTransform, Wrap};
use bilux_scene::{Reader, Spec, Texture};

const fn number(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Number { min: -1e6, max: 1e6 }, default }
}

const WRAPS: [(&str, Wrap); 3] = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];
const WRAP_WORDS: &[&str] = &[WRAPS[0].0, WRAPS[1].0, WRAPS[2].0];
const FILTERS: [(&str, Filter); 2] = [("linear", Filter::Linear), ("nearest", Filter::Nearest)];
const FILTER_WORDS: &[&str] = &[FILTERS[0].0, FILTERS[1].0];

/// The keys of an image texture besides its file and its channel.
pub(super) const PICTURE: Entry = Entry {
    name: "texture",
    summary: "an image texture from a file",
    source: "",
    parameters: &[
        number("u_scale", "factor on u: how often the picture repeats", "1"),
        number("v_scale", "factor on v: how often it repeats upwards", "1"),
        Parameter { unit: "degrees", ..number("turn", "rotation of u and v afterwards", "0") },
        number("u_offset", "offset added to u afterwards", "0"),
        number("v_offset", "offset added to v afterwards", "0"),
        choice("wrap_u", "how the texture continues beyond its left and right edges", WRAP_WORDS, "repeat"),
        choice("wrap_v", "how the texture continues beyond its lower and upper edges", WRAP_WORDS, "repeat"),
        choice("filter", "interpolation between texels", FILTER_WORDS, "linear"),
        integer("uv_set", "the mesh's set of texture coordinates to use", 1, 2, "1"),
        Parameter {
            kind: ParameterKind::Number { min: 0.0, max: 1.0 },
            ..number("threshold", "threshold: lower values become 0, all others 1; 0 for no threshold", "0")
        },
    ],
};

/// A texture placed as its table states.
pub(super) fn placed(texture: &Texture, table: &Table) -> Result<Texture, FormatError> {
    let mut spec = Spec { span: table.at.clone(), ..Spec::new("", PICTURE.name) };
    for (key, at, item) in &table.entries {
        if PICTURE.parameters.iter().any(|p| p.name == key) {
            spec.parameters.set_at(key, plain_value(key, item)?, at.clone());
        }
    }
    let said = Reader::new(&spec, &PICTURE)?;
    let word = |key: &str| said.text(key);
    let wrap =
        |key: &str| WRAPS.iter().find(|(name, _)| *name == word(key)).map_or(Wrap::Repeat, |found| found.1);
    let filter =
        FILTERS.iter().find(|(name, _)| *name == word("filter")).map_or(Filter::Linear, |found| found.1);
    let places = ["u_scale", "v_scale", "turn", "u_offset", "v_offset"];
    let [u_scale, v_scale, turn, u, v] = places.map(|key| said.number(key));
    let placement = Placement { scale: [u_scale, v_scale], turn: turn.to_radians(), offset: [u, v] };
    Ok(Texture {
        transform: places.iter().any(|key| said.is_given(key)).then(|| placement.transform()),
        wrap: ["wrap_u", "wrap_v"].map(wrap),
        filter,
        second_uv: said.integer("uv_set") == 2,
        threshold: Some(said.number("threshold")).filter(|&least| least > 0.0),
        ..texture.clone()
    })
}

/// The keys that make [`placed`] turn the plain file into this texture, with their values as TOML.
pub(super) fn placement_keys(texture: &Texture) -> Vec<(&'static str, String)> {
    let mut said = Vec::new();
    if let Some(transform) = &texture.transform {
        let placement = Placement::of(transform);
        let keys = ["u_scale", "v_scale", "turn", "u_offset", "v_offset"];
        let [[u_scale, v_scale], [u, v]] = [placement.scale, placement.offset];
        let numbers = [u_scale, v_scale, placement.turn.to_degrees(), u, v];
        said.extend(keys.into_iter().zip(numbers.map(|x| format!("{x:?}"))));
    }
    let quoted = |word: &str| format!("\"{word}\"");
    for (key, wrap) in ["wrap_u", "wrap_v"].into_iter().zip(texture.wrap) {
        let word = WRAPS.iter().find(|(_, known)| *known == wrap).map_or("repeat", |found| found.0);
        if wrap != Wrap::default() {
            said.push((key, quoted(word)));
        }
    }
    if texture.filter != Filter::default() {
        said.push(("filter", quoted("nearest")));
    }
    if texture.second_uv {
        said.push(("uv_set", "2".to_owned()));
    }
    if let Some(least) = texture.threshold {
        said.push(("threshold", format!("{least:?}")));
    }
    said
}

/// Scales, rotates (in radians) and shifts texture coordinates, with v upwards.
///
/// [`UvTransform`] has v downwards; both rotate the same way, but about different corners.
struct Placement {
    scale: [f32; 2],
    turn: f32,
    offset: [f32; 2],
}

impl Placement {
    /// The position of the upper left corner relative to the lower left one.
    fn corner(&self) -> Vec2 {
        Vec2::new(-sin(self.turn), cos(self.turn)) * self.scale[1]
    }

    fn transform(&self) -> UvTransform {
        let corner = self.corner() + Vec2::from(self.offset);
        UvTransform::new([corner.x, 1.0 - corner.y], self.turn, self.scale)
    }

    fn of(transform: &UvTransform) -> Placement {
        let ([x, y], turn, scale) = transform.parts();
        let placement = Placement { scale, turn, offset: [0.0; 2] };
        let offset = Vec2::new(x, 1.0 - y) - placement.corner();
        Placement { offset: offset.to_array(), ..placement }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_placed_as_stated_with_v_upwards() {
        let placement = Placement { scale: [2.0, -3.0], turn: 0.5, offset: [0.25, -0.5] };
        let (transform, uv) = (placement.transform(), Vec2::new(0.3, 0.8));
        let (s, c) = (sin(0.5), cos(0.5));
        let scaled = uv * Vec2::from(placement.scale);
        let wanted = Vec2::new(c * scaled.x - s * scaled.y, s * scaled.x + c * scaled.y)
            + Vec2::from(placement.offset);
        let found = transform.apply(Vec2::new(uv.x, 1.0 - uv.y));
        assert!((Vec2::new(found.x, 1.0 - found.y) - wanted).length() < 1e-5, "{found}");
        let back = Placement::of(&transform);
        let same = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(
            same(&back.scale, &placement.scale) && same(&back.offset, &placement.offset),
            "{:?}",
            back.offset
        );
        assert!(same(&[back.turn], &[0.5]));
    }
}
