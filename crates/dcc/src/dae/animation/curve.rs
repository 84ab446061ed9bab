//! Curves: keys in time, each with as many values as its target has numbers.

use crate::dae::data::{Input, Table, input, names};
use crate::dae::document::Document;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::world::between_keys::{bezier, slerp};
use bilux_math::glam::DQuat;
use bilux_math::{DMat4, DVec3};

/// Interpolation from a key to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    Bezier,
    Hermite,
}

/// A curve with its keys in order.
pub(super) struct Curve {
    times: Vec<f64>,
    values: Table<f64>,
    /// For each key; of all keys the same if there is one.
    kinds: Vec<Interpolation>,
    tangents: [Option<Table<f64>>; 2],
}

impl Curve {
    /// The curve of a sampler; `None` without keys.
    pub(super) fn read<'d>(
        sampler: Element<'d>,
        inputs: &[Input<'d>],
        document: &Document<'d>,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<Curve>, FormatError> {
        let mut table = |semantic: &str| {
            input(inputs, semantic).map(|source| Table::<f64>::read(source, document, budget)).transpose()
        };
        let (Some(times), Some(values)) = (table("INPUT")?, table("OUTPUT")?) else { return Ok(None) };
        let tangents = [table("OUT_TANGENT")?, table("IN_TANGENT")?];
        let mut last = f64::NEG_INFINITY;
        let mut in_order = Vec::new();
        for row in times.rows().take(values.len) {
            if row[0].is_nan() || row[0] < last {
                return Err(sampler.error("the times of the keys do not increase"));
            }
            last = row[0];
            in_order.push(last);
        }
        if in_order.is_empty() {
            return Ok(None);
        }
        let kinds = match input(inputs, "INTERPOLATION") {
            Some(source) => names(source, document, budget)?.0,
            None => Vec::new(),
        };
        let mut kind = |name: &&str| match *name {
            "STEP" => Interpolation::Step,
            "BEZIER" if tangents.iter().all(Option::is_some) => Interpolation::Bezier,
            "HERMITE" if tangents.iter().all(Option::is_some) => Interpolation::Hermite,
            "LINEAR" => Interpolation::Linear,
            _ => {
                let what = "keys with other curves than Bézier's and Hermite's, or without tangents, are joined by lines";
                diagnostics.note(what, || sampler.at());
                Interpolation::Linear
            }
        };
        let kinds = kinds.iter().map(&mut kind).collect();
        Ok(Some(Curve { times: in_order, values, kinds, tangents }))
    }

    /// When its last key is.
    pub(super) fn end(&self) -> Option<f64> {
        self.times.last().copied()
    }

    /// The values at a time; constant before the first key and after the last.
    pub(super) fn at(&self, time: f64) -> Vec<f64> {
        let next = self.times.partition_point(|&key| key <= time);
        let row = |key: usize| self.values.row(key).unwrap_or_default().to_vec();
        let Some(key) = next.checked_sub(1) else { return row(0) };
        if next == self.times.len() {
            return row(key);
        }
        let kind = self.kinds.get(key).or(self.kinds.first()).copied().unwrap_or(Interpolation::Linear);
        let span = [self.times[key], self.times[next]];
        let part = (time - span[0]) / (span[1] - span[0]);
        let (from, to) = (row(key), row(next));
        match kind {
            Interpolation::Step => from,
            Interpolation::Linear => between(&from, &to, part),
            Interpolation::Bezier | Interpolation::Hermite => {
                let column = |i: usize| self.cubic(kind, [key, next], span, i, time);
                (0..self.values.width).map(column).collect()
            }
        }
    }

    /// One of the values between two keys, by the control points of a column.
    fn cubic(&self, kind: Interpolation, keys: [usize; 2], span: [f64; 2], column: usize, time: f64) -> f64 {
        let value = |key: usize| self.values.row(key).and_then(|row| row.get(column).copied()).unwrap_or(0.0);
        let ends = keys.map(value);
        let length = span[1] - span[0];
        let thirds = [span[0] + length / 3.0, span[1] - length / 3.0];
        // Out of the first key, and into the second: a time and a value for each column, or values alone.
        let tangent = |end: usize| {
            let table = self.tangents[end].as_ref()?;
            let row = table.row(keys[end])?;
            match table.width == self.values.width {
                true => Some([thirds[end], *row.get(column)?]),
                false => Some([*row.get(2 * column)?, *row.get(2 * column + 1)?]),
            }
        };
        let mut points = [0, 1].map(|end| tangent(end).unwrap_or([thirds[end], ends[end]]));
        if kind == Interpolation::Hermite {
            let sides = [1.0, -1.0];
            for end in 0..2 {
                let by = points[end][1] * sides[end] / 3.0;
                points[end] = [thirds[end], ends[end] + by];
            }
        }
        let times =
            [span[0], points[0][0].clamp(span[0], span[1]), points[1][0].clamp(span[0], span[1]), span[1]];
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if bezier(times, middle) < time { low = middle } else { high = middle }
        }
        bezier([ends[0], points[0][1], points[1][1], ends[1]], 0.5 * (low + high))
    }
}

/// Values between two keys; matrices turn and grow.
fn between(from: &[f64], to: &[f64], part: f64) -> Vec<f64> {
    let matrices = from.first_chunk::<16>().zip(to.first_chunk::<16>()).filter(|_| from.len() == 16);
    let turned = matrices.and_then(|(from, to)| {
        let [a, b] = [from, to].map(|rows| DMat4::from_cols_array(rows).transpose());
        let parts = |m: DMat4| (m.determinant().abs() > 1e-30).then(|| m.to_scale_rotation_translation());
        let ((scale_a, turn_a, at_a), (scale_b, turn_b, at_b)) = (parts(a)?, parts(b)?);
        let turn = slerp(&turn_a.to_array(), &turn_b.to_array(), part);
        let turn = DQuat::from_slice(&turn);
        let mix = |a: DVec3, b: DVec3| a + (b - a) * part;
        let mixed = DMat4::from_scale_rotation_translation(mix(scale_a, scale_b), turn, mix(at_a, at_b));
        // Only what such parts describe: not a matrix with shear.
        let again = DMat4::from_scale_rotation_translation(scale_a, turn_a, at_a);
        let size = a.to_cols_array().into_iter().fold(0.0f64, |most, x| most.max(x.abs()));
        again.abs_diff_eq(a, 1e-4 * size).then(|| mixed.transpose().to_cols_array().to_vec())
    });
    turned.unwrap_or_else(|| from.iter().zip(to).map(|(a, b)| a + (b - a) * part).collect())
}
