//! Curves: keys in time with values and slopes.

use super::key::{Interpolation, Key, Rule, Tangent};
use super::tangents;
use crate::fbx::tree::{Node, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::world::between_keys::{THIRD, bezier, parameter};

/// Bits of a key's flags.
const CONSTANT: i64 = 0x2;
const CUBIC: i64 = 0x8;
const CONSTANT_NEXT: i64 = 0x100;
const SHAPED: i64 = 0x200;
const STATED: i64 = 0x400;
const CLAMPED: i64 = 0x1000;
const STRAIGHT: i64 = 0x2000;
const BETWEEN: i64 = 0x4000;
const WEIGHTED_RIGHT: u32 = 0x100_0000;
const WEIGHTED_NEXT_LEFT: u32 = 0x200_0000;

/// Extrapolation of a curve before its first key or after its last.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Extrapolation {
    Constant,
    Slope,
    Repeat { is_mirrored: bool, is_relative: bool, times: Option<i64> },
}

impl Extrapolation {
    fn of(curve: Node, name: &str) -> Extrapolation {
        let Some(node) = curve.child(name) else { return Extrapolation::Constant };
        let letter = match node.child_value("Type") {
            Some(Value::Text(text) | Value::Word(text)) => text.first().copied(),
            Some(Value::Integer(code)) => u8::try_from(code).ok(),
            _ => None,
        };
        let stated = node.child_value("Repetition").and_then(Value::integer);
        let times = stated.filter(|times| *times >= 0);
        match letter {
            Some(b'K') => Extrapolation::Slope,
            Some(b'R') => Extrapolation::Repeat { is_mirrored: false, is_relative: false, times },
            Some(b'M') => Extrapolation::Repeat { is_mirrored: true, is_relative: false, times },
            Some(b'A') => Extrapolation::Repeat { is_mirrored: false, is_relative: true, times },
            _ => Extrapolation::Constant,
        }
    }
}

/// A curve with its keys in order.
pub(super) struct Curve {
    keys: Vec<Key>,
    before: Extrapolation,
    after: Extrapolation,
    /// Units of time per second.
    ticks: f64,
}

impl Curve {
    /// A curve of these keys, of which times that do not increase are left out.
    pub(super) fn new(node: Node, mut keys: Vec<Key>, ticks: f64) -> Curve {
        let mut last = f64::NEG_INFINITY;
        keys.retain(|key| {
            let is_later = key.time > last && key.value.is_finite();
            last = if is_later { key.time } else { last };
            is_later
        });
        tangents::solve(&mut keys, ticks);
        let [before, after] =
            ["Pre-Extrapolation", "Post-Extrapolation"].map(|name| Extrapolation::of(node, name));
        Curve { keys, before, after, ticks }
    }

    /// The curve at a node of version 7.
    pub(super) fn read(node: Node, ticks: f64, budget: &mut Budget) -> Result<Curve, FormatError> {
        let mut list =
            |name: &str| node.child(name).map_or(Ok(Vec::new()), |list| list.numbers::<f64>(budget));
        let (times, values) = (list("KeyTime")?, list("KeyValueFloat")?);
        let (flags, counts) = (list("KeyAttrFlags")?, list("KeyAttrRefCount")?);
        let data =
            list("KeyAttrDataFloat")?.into_iter().map(|number| from_bits(number, node)).collect::<Vec<f32>>();
        budget.take_bytes((times.len() * size_of::<Key>()) as u64, node.file())?;
        let mut keys = Vec::with_capacity(times.len());
        // Flags and data are written once for each run of keys that share them.
        let (mut run, mut left) = (0, counts.first().copied().unwrap_or(0.0));
        for (&time, &value) in times.iter().zip(&values) {
            while left < 1.0 && run + 1 < counts.len() {
                run += 1;
                left = counts[run];
            }
            left -= 1.0;
            let flags = flags.get(run).copied().unwrap_or(0.0) as i64;
            let data = data.get(4 * run..4 * run + 4).unwrap_or(&[0.0; 4]);
            keys.push(Key { time, value, interpolation: interpolation(flags, data) });
        }
        Ok(Curve::new(node, keys, ticks))
    }

    /// The value at a time in units of the file; `None` without keys.
    pub(super) fn at(&self, time: f64) -> Option<f64> {
        let (first, last) = (self.keys.first()?, self.keys.last()?);
        if time < first.time {
            return Some(self.outside(time, self.before, true));
        }
        if time > last.time {
            return Some(self.outside(time, self.after, false));
        }
        Some(self.inside(time))
    }

    /// The value at a time between the first key and the last.
    fn inside(&self, time: f64) -> f64 {
        let next = self.keys.partition_point(|key| key.time <= time);
        let key = &self.keys[next.saturating_sub(1)];
        let Some(after) = self.keys.get(next) else { return key.value };
        let span = after.time - key.time;
        let part = ((time - key.time) / span).clamp(0.0, 1.0);
        match key.interpolation {
            Interpolation::Constant { is_next: false } => key.value,
            Interpolation::Constant { is_next: true } => after.value,
            Interpolation::Linear => key.value + (after.value - key.value) * part,
            Interpolation::Cubic { slopes, weights, .. } => {
                let reach = |i: usize| weights[i] * span / self.ticks * slopes[i];
                let points = [key.value, key.value + reach(0), after.value - reach(1), after.value];
                bezier(points, parameter(weights, part))
            }
        }
    }

    /// The value before the first key or after the last.
    fn outside(&self, time: f64, by: Extrapolation, is_before: bool) -> f64 {
        let (first, last) = (self.keys[0], self.keys[self.keys.len() - 1]);
        let end = if is_before { first } else { last };
        let length = last.time - first.time;
        match by {
            Extrapolation::Repeat { is_mirrored, is_relative, times }
                if length >= 1.0 && times != Some(0) =>
            {
                let beyond = if is_before { first.time - time } else { time - last.time };
                let (mut whole, mut part) = ((beyond / length).floor(), beyond % length);
                if let Some(times) = times.map(|times| times as f64).filter(|times| whole >= *times) {
                    (whole, part) = (times - 1.0, length);
                }
                let goes_back = is_mirrored && whole % 2.0 == 0.0;
                // From the end that is left, towards the other one if mirrored.
                let from_first = if goes_back != is_before { length - part } else { part };
                let step = (last.value - first.value) * if is_before { -1.0 } else { 1.0 };
                let offset = if is_relative { step * (whole + 1.0) } else { 0.0 };
                self.inside(first.time + from_first) + offset
            }
            Extrapolation::Slope => {
                let slope = self.slope_at_end(is_before);
                end.value + slope * (time - end.time) / self.ticks
            }
            _ => end.value,
        }
    }

    /// The slope per second with which the curve begins or ends.
    fn slope_at_end(&self, is_first: bool) -> f64 {
        let count = self.keys.len();
        if count < 2 {
            return 0.0;
        }
        let [key, next] = if is_first {
            [self.keys[0], self.keys[1]]
        } else {
            [self.keys[count - 2], self.keys[count - 1]]
        };
        match key.interpolation {
            Interpolation::Constant { .. } => 0.0,
            Interpolation::Linear => (next.value - key.value) / (next.time - key.time) * self.ticks,
            Interpolation::Cubic { slopes, .. } => slopes[usize::from(!is_first)],
        }
    }
}

/// A float of a key's data. In text it is written as the integer that has its bits.
fn from_bits(number: f64, node: Node) -> f32 {
    let is_bits = !node.is_binary() && number.fract() == 0.0 && number.abs() > 1e6;
    if is_bits { f32::from_bits(number as i64 as i32 as u32) } else { number as f32 }
}

/// Interpolation to the next key, from the flags and the data of a key.
fn interpolation(flags: i64, data: &[f32]) -> Interpolation {
    if flags & CONSTANT != 0 {
        return Interpolation::Constant { is_next: flags & CONSTANT_NEXT != 0 };
    }
    if flags & CUBIC == 0 {
        return Interpolation::Linear;
    }
    let [first, second, third] = [data[0], data[1], data[2]].map(f64::from);
    let is_shaped = flags & SHAPED != 0;
    let rule = Rule {
        is_clamped: flags & CLAMPED != 0,
        stays_between: flags & BETWEEN != 0,
        is_straight: flags & STRAIGHT != 0,
    };
    let tangent = match () {
        () if is_shaped => Tangent::Shaped([first, second, third]),
        () if flags & STATED != 0 => Tangent::Stated,
        () => Tangent::Automatic(rule),
    };
    // Weights are two decimal fractions in the bits of a float.
    let (bits, flags) = (data[2].to_bits(), flags as u32);
    let weight = |is_given: bool, part: u32| if is_given { f64::from(part & 0xffff) / 1e4 } else { THIRD };
    let weights =
        [weight(flags & WEIGHTED_RIGHT != 0, bits), weight(flags & WEIGHTED_NEXT_LEFT != 0, bits >> 16)];
    let slopes = if is_shaped { [0.0; 2] } else { [first, second] };
    Interpolation::Cubic { slopes, weights, tangent }
}
