//! Folding of a network of nodes to a constant, or to what one node gives, times a constant and plus a constant.

use super::draft::Draft;
use super::network::{Input, constant, input, kind};
use bilux_import::FormatError;
use bilux_scene::texture::Channel;

/// Folded output of a node.
#[derive(Clone, Debug)]
pub(super) enum Folded {
    Constant([f32; 3]),
    Linear(Linear),
}

/// The output of a node that is not folded further, changed.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    pub(super) node: u32,
    pub(super) output: String,
    /// The channel that counts.
    pub(super) channel: Option<Channel>,
    pub(super) scale: [f32; 3],
    pub(super) offset: [f32; 3],
}

/// Nodes that are looked at for one input.
const MAX_NODES: usize = 64;

/// Folded output of a node; `None`, with a note, if it is nothing that can be shown.
pub(super) fn folded(draft: &mut Draft, node: u32, output: &str) -> Result<Option<Folded>, FormatError> {
    fold(draft, node, output, &mut MAX_NODES.clone())
}

fn fold(draft: &mut Draft, node: u32, output: &str, left: &mut usize) -> Result<Option<Folded>, FormatError> {
    if *left == 0 {
        draft.not_shown("networks of very many nodes");
        return Ok(None);
    }
    *left -= 1;
    let id = kind(draft.stage, node, &mut draft.reading.budget)?;
    let name = id.strip_prefix("ND_").unwrap_or(&id).to_owned();
    let is = |starts: &[&str]| starts.iter().any(|start| name.starts_with(start));
    if is(&["UsdUVTexture", "image_", "tiledimage_", "UsdPrimvarReader", "geompropvalue", "geomcolor"]) {
        let (scale, offset) = ([1.0; 3], [0.0; 3]);
        let whole = Linear { node, output: output.to_owned(), channel: None, scale, offset };
        return Ok(Some(Folded::Linear(whole)));
    }
    let mut of =
        |key: &str, unstated: Option<f32>, draft: &mut Draft| operand(draft, node, key, unstated, left);
    if is(&["constant_"]) {
        return of("value", Some(0.0), draft);
    }
    if is(&["normalmap", "convert", "dot_", "clamp"]) {
        return of("in", None, draft);
    }
    if is(&["multiply_", "divide_", "add_", "subtract_"]) {
        let neutral = if is(&["multiply_", "divide_"]) { 1.0 } else { 0.0 };
        let (a, b) = (of("in1", Some(neutral), draft)?, of("in2", Some(neutral), draft)?);
        return Ok(joined(draft, &name, a, b));
    }
    if is(&["invert_"]) {
        let (amount, found) = (of("amount", Some(1.0), draft)?, of("in", Some(0.0), draft)?);
        return Ok(joined(draft, "subtract_", amount, found));
    }
    if is(&["mix_"]) {
        let (front, back) = (of("fg", Some(0.0), draft)?, of("bg", Some(0.0), draft)?);
        let Some(Folded::Constant(part)) = of("mix", Some(0.0), draft)? else {
            draft.not_shown("mixtures by pictures");
            return Ok(front.or(back));
        };
        let front = front.map(|front| front.scaled(part));
        let back = back.map(|back| back.scaled(part.map(|part| 1.0 - part)));
        return Ok(joined(draft, "add_", front, back));
    }
    if is(&["extract_", "separate", "swizzle_"]) {
        let channel = channel(draft, node, &name, output)?;
        let found = of("in", None, draft)?;
        return Ok(found.map(|found| channel.map_or(found.clone(), |channel| found.only(channel))));
    }
    // These change colours in a way that a texture cannot.
    if is(&["colorcorrect", "power", "contrast", "saturate", "hsvadjust", "range", "remap", "luminance"]) {
        draft.not_shown(&format!("what nodes {name} do to textures"));
        return of("in", None, draft);
    }
    draft.not_shown(&format!("shaders {}", if id.is_empty() { "without an identifier" } else { &id }));
    Ok(None)
}

/// Folded input of a node.
fn operand(
    draft: &mut Draft,
    node: u32,
    key: &str,
    unstated: Option<f32>,
    left: &mut usize,
) -> Result<Option<Folded>, FormatError> {
    Ok(match input(draft.stage, node, key, &mut draft.reading.budget)? {
        Input::Node(node, output) => fold(draft, node, &output, left)?,
        Input::Value(found) => {
            let number = found.value.number();
            let three = || found.value.array().filter(|list| list.width >= 2).map(|list| list.floats::<4>(0));
            let all = number.map(|x| [x as f32; 3]).or_else(|| three().map(|[x, y, z, _]| [x, y, z]));
            all.filter(|all| all.iter().all(|x| x.is_finite())).map(Folded::Constant)
        }
        Input::Nothing => unstated.map(|x| Folded::Constant([x; 3])),
    })
}

/// Two operands, by the name of an operation.
fn joined(draft: &mut Draft, name: &str, a: Option<Folded>, b: Option<Folded>) -> Option<Folded> {
    let (a, b) = match (a, b) {
        (Some(a), Some(b)) => (a, b),
        (a, b) => return a.or(b),
    };
    let each = |a: [f32; 3], b: [f32; 3], f: fn(f32, f32) -> f32| std::array::from_fn(|i| f(a[i], b[i]));
    let inverse = |b: [f32; 3]| b.map(|b| if b == 0.0 { 0.0 } else { 1.0 / b });
    let operation = name.split('_').next().unwrap_or_default();
    Some(match (operation, a, b) {
        ("multiply", Folded::Constant(c), other) | ("multiply", other, Folded::Constant(c)) => {
            other.scaled(c)
        }
        ("divide", other, Folded::Constant(c)) => other.scaled(inverse(c)),
        ("add", Folded::Constant(c), other) | ("add", other, Folded::Constant(c)) => other.moved(c),
        ("subtract", other, Folded::Constant(c)) => other.moved(each([0.0; 3], c, |a, b| a - b)),
        ("subtract", Folded::Constant(c), other) => other.scaled([-1.0; 3]).moved(c),
        (_, first, _) => {
            draft.not_shown(&format!("nodes {operation} of two pictures"));
            first
        }
    })
}

/// The channel that a node takes of its input.
fn channel(draft: &mut Draft, node: u32, name: &str, output: &str) -> Result<Option<Channel>, FormatError> {
    let budget = &mut draft.reading.budget;
    let letter = if name.starts_with("extract_") {
        let index = constant(draft.stage, node, "index", budget)?.and_then(|found| found.value.number());
        ["r", "g", "b", "a"][(index.unwrap_or(0.0).max(0.0) as usize).min(3)].to_owned()
    } else if name.starts_with("separate") {
        output.trim_start_matches("out").to_owned()
    } else {
        let found = constant(draft.stage, node, "channels", budget)?;
        found.and_then(|found| found.value.text().map(|text| text.to_string())).unwrap_or_default()
    };
    let mut letters = letter.chars();
    let first = letters.next();
    // Several letters are an order of channels.
    if letters.any(|other| Some(other) != first) {
        let usual = ["rgb", "xyz", "rgba", "rg", "xy"].contains(&&*letter);
        if !usual {
            draft.not_shown("other orders of channels of textures");
        }
        return Ok(None);
    }
    Ok(match first {
        Some('r' | 'x') => Some(Channel::R),
        Some('g' | 'y') => Some(Channel::G),
        Some('b' | 'z') => Some(Channel::B),
        Some('a' | 'w') => Some(Channel::A),
        _ => None,
    })
}

impl Folded {
    fn scaled(self, by: [f32; 3]) -> Folded {
        let times = |all: [f32; 3]| std::array::from_fn(|i| all[i] * by[i]);
        match self {
            Folded::Constant(c) => Folded::Constant(times(c)),
            Folded::Linear(l) => {
                Folded::Linear(Linear { scale: times(l.scale), offset: times(l.offset), ..l })
            }
        }
    }

    fn moved(self, by: [f32; 3]) -> Folded {
        let plus = |all: [f32; 3]| std::array::from_fn(|i| all[i] + by[i]);
        match self {
            Folded::Constant(c) => Folded::Constant(plus(c)),
            Folded::Linear(l) => Folded::Linear(Linear { offset: plus(l.offset), ..l }),
        }
    }

    fn only(self, channel: Channel) -> Folded {
        let at = (channel as usize).min(2);
        match self {
            Folded::Constant(c) => Folded::Constant([c[at]; 3]),
            Folded::Linear(l) if l.channel.is_none() => Folded::Linear(Linear {
                channel: Some(channel),
                scale: [l.scale[at]; 3],
                offset: [l.offset[at]; 3],
                ..l
            }),
            linear => linear,
        }
    }
}
