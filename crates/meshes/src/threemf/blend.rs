//! Properties in layers, and mixtures of materials. [3MF Materials 1.2, 4 and 5]

use super::colour::Colour;
use super::groups::{GroupKind, Layers, Method};
use super::model::Model;
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

/// A layer or the blend of several: one colour or a picture.
pub(super) enum Ink {
    Flat(Rgb),
    Picture(Arc<Texture>),
}

/// The mixture of materials in these proportions; equal ones if all are 0.
pub(super) fn mixture(parts: &[Colour], values: &[f32]) -> Colour {
    let share = |i: usize| values.get(i).copied().unwrap_or(0.0).max(0.0);
    let total: f32 = (0..parts.len()).map(share).sum();
    let even = 1.0 / parts.len().max(1) as f32;
    let weight = |i: usize| if total > 0.0 { share(i) / total } else { even };
    let rgb = parts.iter().enumerate().map(|(i, part)| part.rgb * weight(i)).sum();
    Colour { rgb, alpha: 1.0 }
}

impl Layers {
    /// Blend of a layer with those below. On a material, one that multiplies hides it: nobody knows its colour.
    fn method(&self, model: &Model, layer: usize) -> Option<Method> {
        let method = *self.methods.get(layer.checked_sub(1)?)?;
        let hides = layer == 1 && method == Method::Multiply && model.groups[self.groups[0]].is_material();
        (!hides).then_some(method)
    }

    /// The colour of an entry all of whose layers are colours.
    pub(super) fn colour(&self, model: &Model, index: u32) -> Rgb {
        let mut below = Rgb::WHITE;
        for (layer, (&group, &entry)) in self.groups.iter().zip(self.entry(index)).enumerate() {
            let over = model.groups[group].colour(entry).unwrap_or(Colour::WHITE);
            below = match self.method(model, layer) {
                None => over.rgb,
                Some(Method::Mix) => below.lerp(over.rgb, over.alpha),
                Some(Method::Multiply) => below * over.rgb,
            };
        }
        below
    }

    /// The first layer with texture coordinates.
    pub(super) fn textured(&self, model: &Model) -> Option<usize> {
        let is_textured = |&group: &usize| matches!(model.groups[group].kind, GroupKind::Coordinates { .. });
        self.groups.iter().position(is_textured)
    }

    /// All layers, with those that are colours as an entry has them. `picture` gives the picture of a group, and its
    /// alpha where it has some.
    pub(super) fn painted(
        &self,
        model: &Model,
        index: u32,
        mut picture: impl FnMut(usize) -> Result<(Arc<Texture>, Option<Arc<Texture>>), FormatError>,
    ) -> Result<Ink, FormatError> {
        let mut below = Ink::Flat(Rgb::WHITE);
        for (layer, (&group, &entry)) in self.groups.iter().zip(self.entry(index)).enumerate() {
            let (over, alpha) = match model.groups[group].kind {
                GroupKind::Coordinates { picture: index, .. } => {
                    let (colours, alpha) = picture(index)?;
                    (Ink::Picture(colours), alpha.map_or(Amount::Number(1.0), Amount::Picture))
                }
                _ => {
                    let colour = model.groups[group].colour(entry).unwrap_or(Colour::WHITE);
                    (Ink::Flat(colour.rgb), Amount::Number(colour.alpha))
                }
            };
            below = match self.method(model, layer) {
                None => over,
                Some(Method::Mix) => mixed(below, over, alpha)?,
                Some(Method::Multiply) => multiplied(below, over)?,
            };
        }
        Ok(below)
    }
}

/// The opacity of a layer.
enum Amount {
    Number(f32),
    Picture(Arc<Texture>),
}

fn mixed(below: Ink, over: Ink, amount: Amount) -> Result<Ink, FormatError> {
    match (&below, &over, &amount) {
        (_, _, Amount::Number(1.0)) => return Ok(over),
        (Ink::Flat(a), Ink::Flat(b), Amount::Number(amount)) => return Ok(Ink::Flat(a.lerp(*b, *amount))),
        _ => {}
    }
    let mut parts = Vec::new();
    let (a, b) = (below.into_value(&mut parts), over.into_value(&mut parts));
    let amount = match amount {
        Amount::Number(amount) => amount.into(),
        Amount::Picture(picture) => Ink::Picture(picture).into_value(&mut parts),
    };
    formula(Spec::new("", "mix").with("a", a).with("b", b).with("amount", amount), parts)
}

fn multiplied(below: Ink, over: Ink) -> Result<Ink, FormatError> {
    if let (Ink::Flat(a), Ink::Flat(b)) = (&below, &over) {
        return Ok(Ink::Flat(*a * *b));
    }
    let mut parts = Vec::new();
    let (a, b) = (below.into_value(&mut parts), over.into_value(&mut parts));
    formula(Spec::new("", "scale").with("a", a).with("b", b), parts)
}

fn formula(spec: Spec, parts: Vec<Arc<Texture>>) -> Result<Ink, FormatError> {
    Ok(Ink::Picture(Arc::new(Texture::by_formula(spec, parts, false)?)))
}

impl Ink {
    /// The ink as a parameter's value; pictures are indices into `parts`.
    fn into_value(self, parts: &mut Vec<Arc<Texture>>) -> Value {
        match self {
            Ink::Flat(colour) => colour.into(),
            Ink::Picture(picture) => {
                parts.push(picture);
                Value::Texture(parts.len() - 1)
            }
        }
    }
}
