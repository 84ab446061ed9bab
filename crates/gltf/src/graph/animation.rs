//! Animation: node transforms and morph target weights at a given time. [glTF 2.0, 3.11 and appendix C]

use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use bilux_import::FormatError;
use bilux_import::input::choice::named_or_numbered;
use bilux_import::world::between_keys::slerp;
use bilux_scene::Animation;
use std::collections::{HashMap, HashSet};

/// The animated values of nodes, which replace those of the rest pose.
#[derive(Default)]
pub(crate) struct Pose {
    moved: HashMap<Target, Vec<f64>>,
    /// All animations of the file, and which of them play.
    pub(crate) animations: Vec<Animation>,
}

/// Values, and what they are of.
type Moved = Vec<(Target, Vec<f64>)>;

/// Target of a channel.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Target {
    /// The index of the node.
    node: usize,
    property: AnimatedProperty,
}

/// The property of a node that a channel animates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AnimatedProperty {
    Translation,
    Rotation,
    Scale,
    Weights,
    Visible,
}

/// Interpolation of a sampler between keys.
#[derive(Clone, Copy, PartialEq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

impl Pose {
    /// Reads every animation of the file, and poses the nodes at a time in seconds by those that play: the one that
    /// `wanted` names, or else the first and all that animate other targets.
    pub(crate) fn read(
        time: f32,
        wanted: Option<&str>,
        data: &mut DataReader<'_, '_>,
    ) -> Result<Pose, FormatError> {
        let list = data.document.root.list("animations")?;
        let chosen = wanted.map(|wanted| chosen(wanted, &list, data.document.root)).transpose()?;
        let (mut pose, mut taken) = (Pose::default(), HashSet::new());
        for (i, node) in list.into_iter().enumerate() {
            let targets: Vec<_> = node.list("channels")?.iter().filter_map(target).collect();
            let plays = match chosen {
                Some(chosen) => i == chosen,
                None => !targets.is_empty() && targets.iter().all(|target| !taken.contains(target)),
            };
            let (values, seconds) = play(node, time, data)?;
            if plays {
                pose.moved.extend(values);
                taken.extend(targets);
            } else if chosen.is_none() {
                let what = "an animation is not played because an earlier one moves the same nodes; choose it by its name";
                data.diagnostics.remark(what, || node.at());
            }
            let name = node.name().to_owned();
            pose.animations.push(Animation { name, seconds, plays });
        }
        Ok(pose)
    }

    /// Three or four numbers of a node, if they are animated.
    pub(crate) fn numbers<const N: usize>(
        &self,
        node: usize,
        property: AnimatedProperty,
    ) -> Option<[f64; N]> {
        self.moved.get(&Target { node, property })?.as_slice().try_into().ok()
    }

    /// The weights of a node's morph targets, if they are animated.
    pub(crate) fn weights(&self, node: usize) -> Option<&[f64]> {
        self.moved.get(&Target { node, property: AnimatedProperty::Weights }).map(Vec::as_slice)
    }

    /// Whether a node is visible, if that is animated.
    pub(crate) fn is_visible(&self, node: usize) -> Option<bool> {
        self.moved
            .get(&Target { node, property: AnimatedProperty::Visible })
            .map(|values| values.first() != Some(&0.0))
    }
}

/// The index of the animation that `wanted` names.
fn chosen(wanted: &str, list: &[JsonNode], root: JsonNode) -> Result<usize, FormatError> {
    let names: Vec<String> = list.iter().map(|node| node.name().to_owned()).collect();
    named_or_numbered("animation", wanted, &names, &root.at_key("animations"))
}

/// The values of an animation at a time, and the time of its last key.
fn play<'d>(
    animation: JsonNode<'d>,
    time: f32,
    data: &mut DataReader<'d, '_>,
) -> Result<(Moved, f32), FormatError> {
    let samplers = animation.list("samplers")?;
    let (mut values, mut end) = (Vec::new(), 0f32);
    for channel in animation.list("channels")? {
        let Some(target) = target(&channel) else {
            if channel.get("target").is_some_and(|target| {
                target.get("node").is_some() || target.extension("KHR_animation_pointer").is_some()
            }) {
                let what = "an animation moves something other than nodes and weights, which is ignored";
                data.note(what, || channel.at());
            }
            continue;
        };
        let index = channel.need("sampler")?;
        let Some(&sampler) = samplers.get(index.as_count()?) else {
            return Err(index.error(format!("there are {} samplers in this animation", samplers.len())));
        };
        match sample(sampler, target, time, data) {
            Ok((value, last)) => {
                end = end.max(last);
                values.push((target, value));
            }
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let what = format!("part of an animation is left out: {}", error.without_place());
                data.note(&what, || sampler.at());
            }
        }
    }
    Ok((values, end))
}

/// A sampler's value at a time, and the time of its last key.
fn sample<'d>(
    sampler: JsonNode<'d>,
    Target { node, property }: Target,
    time: f32,
    data: &mut DataReader<'d, '_>,
) -> Result<(Vec<f64>, f32), FormatError> {
    let spent = data.budget.spent();
    let input = data.accessor(sampler.need("input")?)?;
    let times = input.numbers(data.budget)?;
    let output = data.accessor(sampler.need("output")?)?;
    let values = output.numbers(data.budget)?;
    let interpolation = match sampler.text("interpolation")?.unwrap_or("LINEAR") {
        // What is true or false has no value in between.
        "LINEAR" if property == AnimatedProperty::Visible => Interpolation::Step,
        "STEP" => Interpolation::Step,
        "LINEAR" => Interpolation::Linear,
        "CUBICSPLINE" => Interpolation::Cubic,
        other => {
            return Err(
                sampler.error(format!("'{other}' is not an interpolation: use STEP, LINEAR or CUBICSPLINE"))
            );
        }
    };
    let rises = times.windows(2).all(|pair| pair[0] < pair[1]) && times.iter().all(|t| t.is_finite());
    let Some(&last) = times.last().filter(|_| input.width() == 1 && rises) else {
        return Err(input.node.error("the times of an animation must be numbers that increase"));
    };
    let parts = if interpolation == Interpolation::Cubic { 3 } else { 1 };
    let width = match property {
        AnimatedProperty::Rotation => 4,
        AnimatedProperty::Translation | AnimatedProperty::Scale => 3,
        AnimatedProperty::Visible => 1,
        AnimatedProperty::Weights => values.len() / (parts * times.len()),
    };
    if width == 0 || values.len() != width * parts * times.len() {
        let message =
            format!("there are {} numbers for {} times, which do not match", values.len(), times.len());
        return Err(output.node.error(message));
    }
    if !values.iter().all(|x| x.is_finite()) {
        return Err(output.node.error("an animation has numbers that are infinite or not numbers (NaN)"));
    }
    let keys = Keys {
        times: &times,
        values: &values,
        width,
        interpolation,
        turns: property == AnimatedProperty::Rotation,
    };
    let value = keys.at(f64::from(time));
    data.budget.release(data.budget.spent() - spent);
    if property == AnimatedProperty::Rotation && value.iter().all(|x| *x == 0.0) {
        return Err(output.node.error(format!("the rotation of node {node} is zero and has no effect")));
    }
    Ok((value, last))
}

/// The target of a channel; `None` if this reader does not animate it.
fn target(channel: &JsonNode) -> Option<Target> {
    let target = channel.get("target")?;
    if let Some(pointer) = target.extension("KHR_animation_pointer") {
        return pointed(pointer.get("pointer")?.as_text().ok()?);
    }
    let property = property_named(target.get("path")?.as_text().ok()?)?;
    Some(Target { node: target.get("node")?.as_count().ok()?, property })
}

fn property_named(name: &str) -> Option<AnimatedProperty> {
    Some(match name {
        "translation" => AnimatedProperty::Translation,
        "rotation" => AnimatedProperty::Rotation,
        "scale" => AnimatedProperty::Scale,
        "weights" => AnimatedProperty::Weights,
        _ => return None,
    })
}

/// The node and its property that a JSON pointer names, such as `/nodes/3/translation`. [KHR_animation_pointer]
fn pointed(pointer: &str) -> Option<Target> {
    let (node, property) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
    let property = match property {
        "extensions/KHR_node_visibility/visible" => AnimatedProperty::Visible,
        name => property_named(name)?,
    };
    Some(Target { node: node.parse().ok()?, property })
}

/// Keys in order of time: `width` numbers each; cubic keys also have an in-tangent and an out-tangent.
struct Keys<'a> {
    times: &'a [f32],
    values: &'a [f32],
    width: usize,
    interpolation: Interpolation,
    /// True if the values are quaternions.
    turns: bool,
}

impl Keys<'_> {
    /// The value at a time; constant before the first key and after the last.
    fn at(&self, time: f64) -> Vec<f64> {
        let next = self.times.partition_point(|&t| f64::from(t) <= time);
        let Some(key) = next.checked_sub(1) else { return self.value(0) };
        if next == self.times.len() || self.interpolation == Interpolation::Step {
            return self.value(key);
        }
        let (from, to) = (f64::from(self.times[key]), f64::from(self.times[next]));
        let (span, t) = (to - from, (time - from) / (to - from));
        if self.interpolation == Interpolation::Cubic {
            return self.hermite(key, span, t);
        }
        let (a, b) = (self.value(key), self.value(next));
        if self.turns { slerp(&a, &b, t) } else { a.iter().zip(b).map(|(a, b)| a + (b - a) * t).collect() }
    }

    /// Cubic Hermite interpolation between a key and the next. [glTF 2.0, C.5]
    fn hermite(&self, key: usize, span: f64, t: f64) -> Vec<f64> {
        let (t2, t3) = (t * t, t * t * t);
        let weights =
            [2.0 * t3 - 3.0 * t2 + 1.0, span * (t3 - 2.0 * t2 + t), -2.0 * t3 + 3.0 * t2, span * (t3 - t2)];
        let parts = [self.part(key, 1), self.part(key, 2), self.part(key + 1, 1), self.part(key + 1, 0)];
        let sum =
            |i: usize| parts.iter().zip(weights).map(|(part, weight)| f64::from(part[i]) * weight).sum();
        (0..self.width).map(sum).collect()
    }

    fn value(&self, key: usize) -> Vec<f64> {
        self.part(key, 1).iter().map(|&x| f64::from(x)).collect()
    }

    /// For a cubic key, its in-tangent (0), value (1) or out-tangent (2); for others, the value.
    fn part(&self, key: usize, part: usize) -> &[f32] {
        let index = if self.interpolation == Interpolation::Cubic { 3 * key + part } else { key };
        &self.values[index * self.width..][..self.width]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys<'a>(times: &'a [f32], values: &'a [f32], width: usize, interpolation: Interpolation) -> Keys<'a> {
        Keys { times, values, width, interpolation, turns: false }
    }

    #[test]
    fn steps_lines_and_splines_are_what_the_formulas_say() {
        let times = [1.0, 3.0];
        let step = keys(&times, &[5.0, 9.0], 1, Interpolation::Step);
        assert_eq!([0.0, 1.0, 2.9, 3.0, 7.0].map(|t| step.at(t)[0]), [5.0, 5.0, 5.0, 9.0, 9.0]);
        let line = keys(&times, &[5.0, 9.0], 1, Interpolation::Linear);
        assert_eq!([0.0, 1.5, 2.0, 3.0].map(|t| line.at(t)[0]), [5.0, 6.0, 7.0, 9.0]);
        // Each key is in-tangent, value, out-tangent; the keys are two seconds apart, and midway (5 + 9) / 2 + 2
        // (1/8 · 3 - 1/8 · (-1)) = 8.
        let cubic = keys(&times, &[0.0, 5.0, 3.0, -1.0, 9.0, 0.0], 1, Interpolation::Cubic);
        assert_eq!([0.0, 1.0, 2.0, 3.0].map(|t| cubic.at(t)[0]), [5.0, 5.0, 8.0, 9.0]);
    }
}
