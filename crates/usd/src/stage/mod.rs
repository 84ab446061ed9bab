//! The composed prims and their values at a time.

pub(crate) mod context;
pub(crate) mod transforms;

use crate::composition::{Clipped, Opinion, Prim};
use crate::layers::layer::{Layer, PrimSpec, Property};
use crate::layers::list_op::ListOp;
use crate::layers::value::{Array, Numbers, Text, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_math::glam::DQuat;
use bilux_scene::Span;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Everything that the layers say, composed.
pub(crate) struct Stage<'a> {
    pub(crate) layers: Vec<Layer<'a>>,
    pub(crate) prims: Vec<Prim>,
    by_path: HashMap<Text, u32>,
    /// The time code that is shown.
    pub(crate) time: f64,
    /// The animation that every skeleton plays in place of its own.
    pub(crate) animation: Option<u32>,
}

/// A value, and the layer that it comes from.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) value: Value,
    pub(crate) layer: u32,
}

impl<'a> Stage<'a> {
    pub(crate) fn new(layers: Vec<Layer<'a>>, prims: Vec<Prim>) -> Stage<'a> {
        let by_path = prims.iter().enumerate().map(|(i, prim)| (prim.path.clone(), i as u32)).collect();
        Stage { layers, prims, by_path, time: 0.0, animation: None }
    }

    pub(crate) fn prim(&self, index: u32) -> &Prim {
        &self.prims[index as usize]
    }

    /// The prim with a path.
    pub(crate) fn named(&self, path: &str) -> Option<u32> {
        self.by_path.get(path).copied()
    }

    /// The prim above another one.
    pub(crate) fn above(&self, prim: u32) -> Option<u32> {
        self.named(self.prim(prim).path.rsplit_once('/')?.0)
    }

    /// Key of all that layers say about a prim: equal for prims that are alike.
    pub(crate) fn said(&self, prim: u32) -> impl Iterator<Item = [u64; 4]> {
        let Prim { opinions, clips, .. } = self.prim(prim);
        let own = opinions.iter().map(|o| {
            [u64::from(o.layer), u64::from(o.prim), o.offset.offset.to_bits(), o.offset.scale.to_bits()]
        });
        own.chain(clips.iter().map(|clipped| [u64::MAX, u64::from(clipped.set.number), 0, 0]))
    }

    /// True if some layer says something about a property.
    pub(crate) fn states(&self, prim: u32, name: &str) -> bool {
        let says = |p: &Property| p.value.is_some() || p.samples.is_some() || p.targets.is_some();
        self.properties(prim, name).any(|(_, property)| says(property))
    }

    fn spec(&self, opinion: &Opinion) -> &PrimSpec {
        &self.layers[opinion.layer as usize].prims[opinion.prim as usize]
    }

    /// Place of a prim in its file.
    pub(crate) fn at(&self, prim: u32) -> Span {
        let first = self.prim(prim).opinions.first();
        first.map_or_else(|| self.layers[0].at(0), |o| self.layers[o.layer as usize].at(o.prim))
    }

    /// Opinions of all layers about a property, the strongest first.
    fn properties<'s>(
        &'s self,
        prim: u32,
        name: &'s str,
    ) -> impl DoubleEndedIterator<Item = (&'s Opinion, &'s Property)> {
        self.prim(prim).opinions.iter().filter_map(move |opinion| {
            let found = self.spec(opinion).properties.iter().find(|property| &*property.name == name)?;
            Some((opinion, found))
        })
    }

    /// The names of a prim's properties that begin with a prefix.
    pub(crate) fn names(&self, prim: u32, prefix: &str) -> Vec<Text> {
        let mut all: Vec<Text> = Vec::new();
        for opinion in &self.prim(prim).opinions {
            for property in &self.spec(opinion).properties {
                if property.name.starts_with(prefix) && !all.contains(&property.name) {
                    all.push(property.name.clone());
                }
            }
        }
        all
    }

    /// The value of an attribute at the time of the stage.
    pub(crate) fn found(
        &self,
        prim: u32,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Option<Found>, FormatError> {
        let Prim { opinions, clips, .. } = self.prim(prim);
        let mut clips = clips.iter().peekable();
        for (i, opinion) in opinions.iter().enumerate() {
            while let Some(clipped) = clips.next_if(|clipped| clipped.stronger <= i) {
                if let Some(found) = self.in_clip(clipped, name, budget)? {
                    return Ok((found.value != Value::Blocked).then_some(found));
                }
            }
            let layer = opinion.layer;
            let named = |property: &&Property| &*property.name == name;
            let Some(property) = self.spec(opinion).properties.iter().find(named) else { continue };
            if let Some(samples) = &property.samples {
                let time = opinion.offset.inverse(self.time);
                if let Some(value) = self.sampled(layer, samples, time, holds_turns(name), budget)? {
                    return Ok((value != Value::Blocked).then_some(Found { value, layer }));
                }
            }
            if let Some(value) = &property.value {
                let value = self.unpacked(layer, value, budget)?;
                return Ok((value != Value::Blocked).then_some(Found { value, layer }));
            }
        }
        for clipped in clips {
            if let Some(found) = self.in_clip(clipped, name, budget)? {
                return Ok((found.value != Value::Blocked).then_some(found));
            }
        }
        Ok(None)
    }

    /// The value of an attribute in the clip of the time; where it has none, what the manifest says, if that has the attribute.
    fn in_clip(
        &self,
        clipped: &Clipped,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Option<Found>, FormatError> {
        let property = |layer: u32| self.layers[layer as usize].property(&clipped.path, name);
        let stated = match clipped.set.manifest.map(|layer| (layer, property(layer))) {
            Some((_, None)) => return Ok(None),
            Some((layer, Some(property))) => Some((layer, property)),
            None => None,
        };
        let samples = |layer: u32| property(layer).and_then(|property| property.samples.as_ref());
        let has = |layer: u32| samples(layer).is_some();
        // A value of the manifest is that of all clips without samples.
        let manifest_value = stated.and_then(|(layer, property)| Some((layer, property.value.as_ref()?)));
        let manifest_value = manifest_value.filter(|(_, value)| **value != Value::Blocked);
        let bridges = clipped.set.bridges && manifest_value.is_none();
        if let Some(turn) = clipped.set.at(self.time, bridges.then_some(&has)) {
            let value = |layer: u32, time: f64, budget: &mut Budget| match samples(layer) {
                Some(samples) => self.sampled(layer, samples, time, holds_turns(name), budget),
                None => manifest_value.map(|(layer, value)| self.unpacked(layer, value, budget)).transpose(),
            };
            let [before, after] = match samples(turn.layer) {
                Some(samples) => self.around(turn.layer, samples, turn.time, budget)?,
                None => [None; 2],
            };
            let layer = turn.layer;
            let across = turn.next.zip(turn.across(before, after));
            if let Some(((next, start), (from, part))) = across
                && let Some(first) = value(layer, from, budget)?
                && let Some(last) = value(next, start, budget)?
            {
                let file = &self.layers[layer as usize].name;
                let value = mixed(first, &last, part, (holds_turns(name), budget), file)?;
                return Ok(Some(Found { value, layer }));
            }
            if let Some(value) = value(layer, turn.time, budget)? {
                return Ok(Some(Found { value, layer }));
            }
        }
        let Some((layer, property)) = stated else { return Ok(None) };
        let value = match &property.value {
            Some(value) => self.unpacked(layer, value, budget)?,
            None => Value::Blocked,
        };
        Ok(Some(Found { value, layer }))
    }

    pub(crate) fn value(
        &self,
        prim: u32,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Option<Value>, FormatError> {
        Ok(self.found(prim, name, budget)?.map(|found| found.value))
    }

    pub(crate) fn number(
        &self,
        prim: u32,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Option<f64>, FormatError> {
        Ok(self.value(prim, name, budget)?.and_then(|value| value.number()).filter(|x| x.is_finite()))
    }

    pub(crate) fn text(
        &self,
        prim: u32,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Option<Text>, FormatError> {
        Ok(self.value(prim, name, budget)?.and_then(|value| value.text().cloned()))
    }

    pub(crate) fn array(
        &self,
        prim: u32,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Option<Arc<Array>>, FormatError> {
        Ok(self.value(prim, name, budget)?.and_then(|value| value.array()))
    }

    fn unpacked(&self, layer: u32, value: &Value, budget: &mut Budget) -> Result<Value, FormatError> {
        match (value, &self.layers[layer as usize].packed) {
            (Value::Packed(packed), Some(file)) => file.unpack(*packed, budget),
            _ => Ok(value.clone()),
        }
    }

    /// The value of samples at a time code: linear between two of them where it can be.
    fn sampled(
        &self,
        layer: u32,
        samples: &Value,
        time: f64,
        are_turns: bool,
        budget: &mut Budget,
    ) -> Result<Option<Value>, FormatError> {
        let Value::Samples(list) = self.unpacked(layer, samples, budget)? else { return Ok(None) };
        let next = list.partition_point(|(at, _)| *at <= time);
        let Some((first, before)) = list.get(next.saturating_sub(1)) else { return Ok(None) };
        let before = self.unpacked(layer, before, budget)?;
        let after = list.get(next).filter(|_| next > 0);
        let Some((last, after)) = after.filter(|_| time > *first) else { return Ok(Some(before)) };
        let after = self.unpacked(layer, after, budget)?;
        let part = (time - first) / (last - first);
        mixed(before, &after, part, (are_turns, budget), &self.layers[layer as usize].name).map(Some)
    }

    /// The times of the samples before and after one, or at it.
    fn around(
        &self,
        layer: u32,
        samples: &Value,
        time: f64,
        budget: &mut Budget,
    ) -> Result<[Option<f64>; 2], FormatError> {
        let Value::Samples(list) = self.unpacked(layer, samples, budget)? else { return Ok([None; 2]) };
        let next = list.partition_point(|(at, _)| *at <= time);
        Ok([next.checked_sub(1), Some(next)].map(|i| i.and_then(|i| list.get(i)).map(|(at, _)| *at)))
    }

    /// The targets of a relationship, or the connections of an attribute, as paths on the stage.
    pub(crate) fn targets(&self, prim: u32, name: &str) -> Vec<Text> {
        let mut list = Vec::new();
        for (opinion, property) in self.properties(prim, name).rev() {
            let Some(targets) = &property.targets else { continue };
            let targets: ListOp<Text> = targets.map(|path| opinion.on_stage(path));
            targets.apply(&mut list);
        }
        list
    }

    /// Set of numbers that all layers make of a list in the metadata of a prim.
    pub(crate) fn numbers(
        &self,
        prim: u32,
        key: &str,
        budget: &mut Budget,
    ) -> Result<HashSet<i64>, FormatError> {
        let mut all = HashSet::new();
        for opinion in self.prim(prim).opinions.iter().rev() {
            let Some(stated) = self.spec(opinion).fields.find(key) else { continue };
            let Value::Integers(change) = self.unpacked(opinion.layer, stated, budget)? else { continue };
            let explicit = change.explicit.as_ref().map_or(0, Vec::len);
            let count = explicit + change.prepended.len() + change.appended.len();
            budget.take::<[i64; 4]>(count, &self.layers[0].name)?;
            if let Some(list) = change.explicit {
                all = list.into_iter().collect();
            }
            change.deleted.iter().for_each(|number| {
                all.remove(number);
            });
            all.extend(change.prepended.iter().chain(&change.appended));
        }
        Ok(all)
    }

    /// Metadata of a property.
    pub(crate) fn metadata(&self, prim: u32, property: &str, key: &str) -> Option<Value> {
        self.properties(prim, property).find_map(|(_, property)| property.fields.find(key).cloned())
    }

    /// True if z is up.
    pub(crate) fn is_z_up(&self) -> bool {
        let axis = self.layers[0].root().fields.text("upAxis");
        axis.is_some_and(|axis| axis.eq_ignore_ascii_case("z"))
    }

    /// True if an attribute of a prim has samples.
    pub(crate) fn varies(&self, prim: u32) -> bool {
        let Prim { opinions, clips, .. } = self.prim(prim);
        let has_samples = |property: &Property| property.samples.is_some();
        !clips.is_empty() || opinions.iter().flat_map(|o| &self.spec(o).properties).any(has_samples)
    }
}

/// True for attributes whose values are quaternions.
fn holds_turns(name: &str) -> bool {
    matches!(name, "rotations" | "orientations" | "orientationsf") || name.starts_with("xformOp:orient")
}

/// The quaternions between two values, on the shortest way, in place of those that are linear between them.
fn turned(a: &Value, b: &Value, part: f64, linear: Value) -> Value {
    let unit = |q: [f64; 4]| Some(DQuat::from_array(q)).filter(|q| q.length_squared() > 0.0);
    let turn = |a: [f64; 4], b: [f64; 4]| {
        let (a, b) = (unit(a)?.normalize(), unit(b)?.normalize());
        Some(a.slerp(b, part).to_array())
    };
    let tuple = |value: &Value| value.tuple::<4>();
    if let (Some(a), Some(b)) = (tuple(a), tuple(b)) {
        return turn(a, b).map_or(linear, |q| Value::Tuple(q.to_vec()));
    }
    match (a, b, linear) {
        (Value::Array(a), Value::Array(b), Value::Array(mut linear)) if linear.width == 4 => {
            if let Numbers::Floats(numbers) = &mut Arc::make_mut(&mut linear).numbers {
                for (i, q) in numbers.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                    *q = turn(a.tuple(i), b.tuple(i)).map_or(*q, |q| q.map(|x| x as f32));
                }
            }
            Value::Array(linear)
        }
        (_, _, linear) => linear,
    }
}

/// The value between two; the first one where there is none.
fn mixed(
    before: Value,
    after: &Value,
    part: f64,
    (are_turns, budget): (bool, &mut Budget),
    file: &str,
) -> Result<Value, FormatError> {
    Ok(match between(&before, after, part, budget, file)? {
        Some(value) if are_turns => turned(&before, after, part, value),
        value => value.unwrap_or(before),
    })
}

/// The value between two: `None` where the first one holds until the next.
fn between(
    a: &Value,
    b: &Value,
    part: f64,
    budget: &mut Budget,
    name: &str,
) -> Result<Option<Value>, FormatError> {
    let mix = |a: f64, b: f64| a + (b - a) * part;
    Ok(match (a, b) {
        (Value::Number(a), Value::Number(b)) => Some(Value::Number(mix(*a, *b))),
        (Value::Tuple(a), Value::Tuple(b)) if a.len() == b.len() => {
            Some(Value::Tuple(a.iter().zip(b).map(|(a, b)| mix(*a, *b)).collect()))
        }
        (Value::Array(a), Value::Array(b)) if a.numbers.len() == b.numbers.len() => {
            budget.take_bytes(a.numbers.bytes(), name)?;
            let numbers = match (&a.numbers, &b.numbers) {
                (Numbers::Floats(a), Numbers::Floats(b)) => {
                    let mix = |(a, b): (&f32, &f32)| a + (b - a) * part as f32;
                    Numbers::Floats(a.iter().zip(b).map(mix).collect())
                }
                (Numbers::Doubles(a), Numbers::Doubles(b)) => {
                    Numbers::Doubles(a.iter().zip(b).map(|(a, b)| mix(*a, *b)).collect())
                }
                _ => return Ok(None),
            };
            Some(Value::Array(Arc::new(Array { numbers, width: a.width })))
        }
        _ => None,
    })
}
