//! The slopes of keys whose tangents the program chooses by the keys around them, instead of stating them.
//!
//! The format's documentation names the choices and not their formulas; these are the ones that ufbx found by experiments with
//! Maya and MotionBuilder (`ufbxi_solve_auto_tangent`).

use super::key::{Interpolation, Key, Rule, Tangent};
use bilux_import::world::between_keys::THIRD;
use bilux_math::DVec2;

/// Values that differ by less are the same to a clamped key.
const SAME: f64 = 1e-3;

/// Sets the slopes of all keys that do not state theirs. Times are in `ticks` a second.
pub(super) fn solve(keys: &mut [Key], ticks: f64) {
    // Where the slopes are chosen, they are those of the file until then: what comes before is read before it is set.
    let point = |key: &Key| DVec2::new(key.time / ticks, key.value);
    let (mut before, mut lean, mut weight) = (None, 0.0, THIRD);
    for i in 0..keys.len() {
        let here = point(&keys[i]);
        let after = keys.get(i + 1).map(point);
        let Interpolation::Cubic { slopes, weights, tangent } = keys[i].interpolation else {
            (before, lean, weight) = (Some(here), 0.0, THIRD);
            continue;
        };
        let around = Around { before, here, after, weights: [weight, weights[0]] };
        let chosen = match tangent {
            Tangent::Stated => None,
            Tangent::Automatic(rule) => Some(around.automatic(rule, [lean, slopes[0]])),
            Tangent::Shaped(shape) => Some(around.shaped(shape)),
        };
        if let Some([left, right]) = chosen {
            set(&mut keys[i], 0, right);
            if let Some(last) = i.checked_sub(1) {
                set(&mut keys[last], 1, left);
            }
        }
        (before, lean, weight) = (Some(here), slopes[1], weights[1]);
    }
}

/// Sets the slope at the beginning or the end of what follows a key.
fn set(key: &mut Key, end: usize, slope: f64) {
    if let Interpolation::Cubic { slopes, .. } = &mut key.interpolation {
        slopes[end] = slope;
    }
}

/// A key among its neighbours: seconds and values.
struct Around {
    before: Option<DVec2>,
    here: DVec2,
    after: Option<DVec2>,
    /// Reach of the tangents to both sides, as parts of the intervals.
    weights: [f64; 2],
}

impl Around {
    /// The slopes at the left and at the right, given how much they lean.
    fn automatic(&self, rule: Rule, lean: [f64; 2]) -> [f64; 2] {
        let (Some(before), Some(after)) = (self.before, self.after) else {
            let slope = self.at_end(rule, if self.before.is_some() { -lean[0] } else { lean[1] });
            return [slope; 2];
        };
        if (lean[0] + lean[1]).abs() <= 1e-4 {
            return [self.between(before, after, rule, lean[1]); 2];
        }
        [-lean[0], lean[1]].map(|lean| self.between(before, after, rule, lean))
    }

    /// The slope of a key with two neighbours.
    fn between(&self, before: DVec2, after: DVec2, rule: Rule, lean: f64) -> f64 {
        let (left, right) = (self.here - before, after - self.here);
        if rule.is_clamped && left.y.abs().min(right.y.abs()) <= SAME {
            return 0.0;
        }
        let mut slope = (after.y - before.y) / (after.x - before.x);
        if !rule.is_straight {
            let part = left.x / (after.x - before.x);
            slope = 0.5 * (slope + slope_of(left) * (1.0 - part) + slope_of(right) * part);
            let share = lean.abs() / 100.0;
            let towards = if lean > 0.0 { slope_of(right) } else { slope_of(left) };
            let more = towards - slope;
            slope += more * share;
            slope += steeper(share) * if more.abs() > 1e-5 { more.signum() } else { lean.signum() };
        }
        if rule.stays_between {
            let limit = |step: DVec2, weight: f64| {
                let reach = weight * step.x;
                if reach > 0.0 { (slope.signum() * step.y / reach).max(0.0) } else { 0.0 }
            };
            let most = limit(left, self.weights[0]).min(limit(right, self.weights[1]));
            slope = slope.signum() * slope.abs().min(most);
        }
        slope
    }

    /// The slope of the first key or the last: flat, or along the line to its only neighbour.
    fn at_end(&self, rule: Rule, lean: f64) -> f64 {
        let step = match (self.before, self.after) {
            (Some(before), _) => self.here - before,
            (None, Some(after)) => after - self.here,
            (None, None) => return 0.0,
        };
        if rule.stays_between || rule.is_clamped && step.y.abs() <= SAME {
            return 0.0;
        }
        slope_of(step) + if rule.is_straight { 0.0 } else { steeper(lean.abs() / 100.0) * lean.signum() }
    }

    fn shaped(&self, [tension, continuity, bias]: [f64; 3]) -> [f64; 2] {
        let left = self.before.map_or(0.0, |before| slope_of(self.here - before));
        let right = self.after.map_or(0.0, |after| slope_of(after - self.here));
        let half = if self.before.is_some() && self.after.is_some() { 0.5 } else { 1.0 };
        let side = |continuity: f64| {
            let whole = half * (1.0 - tension);
            whole * ((1.0 + bias) * (1.0 + continuity) * left + (1.0 - bias) * (1.0 - continuity) * right)
        };
        [side(-continuity), side(continuity)]
    }
}

fn slope_of(step: DVec2) -> f64 {
    step.y / step.x
}

/// A lean of more than 500 percent is a slope of its own.
fn steeper(share: f64) -> f64 {
    let more = (share - 5.0).max(0.0);
    40.0 * more * more
}
