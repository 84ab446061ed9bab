//! A branch of a tree of lights, and how much light each of its children may bring to a point.

use super::super::extent::LightExtent;
use super::split::Member;
use bilux_math::Vec3;
use bilux_math::glam::Vec4;
use bilux_math::transcendental::{cos, sin_cos};

/// The maximum number of children.
pub(super) const WIDTH: usize = 4;

/// Probability of choosing a child without looking at importance, over that of choosing one by importance: the most important child
/// may be hidden. Both are used in a last branch, and where some lights are far stronger than others.
const CHOSEN_ALIKE: f32 = 0.2;

/// From here on sums of importances may overflow.
const GREATEST: f32 = f32::MAX / 16.0;

/// A number for each child.
type Lanes = Vec4;

/// Child of a branch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Child {
    #[default]
    Nothing,
    Light(u32),
    Branch(u32),
}

/// Empty places have no power.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))] // As many cache lines as it fills.
pub(super) struct Branch {
    /// Of the sphere around the bounds, in metres.
    centre: [Lanes; 3],
    radius2: Lanes,
    axis: [Lanes; 3],
    /// The sine and cosine of the angle of the cone.
    facing: [Lanes; 2],
    cos_spread: Lanes,
    power: Lanes,
    /// 1 where it shines to both sides, otherwise -1.
    other_side: Lanes,
    /// Addition to the importance of each child that shines, over the sum of all importances.
    alike: f32,
    pub(super) children: [Child; WIDTH],
    /// The branch above, and its place there; the root's is the root.
    pub(super) above: [u32; 2],
}

impl Branch {
    /// A branch without children, in this place of that branch.
    pub(super) fn below(above: [u32; 2]) -> Branch {
        Branch { above, ..Branch::default() }
    }

    /// Each of its `count` children is chosen now and then, however unimportant.
    pub(super) fn choose_alike(&mut self, count: usize) {
        self.alike = CHOSEN_ALIKE / count as f32;
    }

    /// Describes the lights of a child, at least one.
    pub(super) fn put(&mut self, place: usize, members: &[Member]) {
        let [(_, first, power), rest @ ..] = members else { unreachable!("a child has lights") };
        let add =
            |(all, sum): (LightExtent, f32), (_, extent, power): &Member| (all.union(*extent), sum + power);
        let (extent, power) = rest.iter().fold((*first, *power), add);
        let (centre, radius) = (extent.bounds.centre(), extent.bounds.radius());
        let (sin, cosine) = sin_cos(extent.facing.angle);
        for axis in 0..3 {
            self.centre[axis][place] = centre[axis];
            self.axis[axis][place] = extent.facing.axis[axis];
        }
        (self.facing[0][place], self.facing[1][place]) = (sin, cosine);
        self.radius2[place] = radius * radius;
        self.cos_spread[place] = cos(extent.spread);
        self.power[place] = power;
        self.other_side[place] = if extent.both_sides { 1.0 } else { -1.0 };
    }

    /// A child for a point by a random number, its probability, and what is left of the number; `None` where none shines.
    #[inline(always)]
    pub(super) fn choose(&self, p: Vec3, u: f32) -> Option<(usize, f32, f32)> {
        let (importances, sum) = self.comparable(p);
        let [x, y, z, w] = importances.to_array();
        let wanted = u * sum;
        let ends = [0.0, x, x + y, x + y + z];
        // Without branches, which would be unpredictable.
        let mut place = ends[1..].iter().map(|&end| usize::from(wanted >= end)).sum::<usize>();
        let all = [x, y, z, w];
        if all[place] <= 0.0 {
            // Where rounding goes beyond the last that shines.
            place = all.iter().rposition(|&importance| importance > 0.0)?;
        }
        let left = (wanted - ends[place]) / all[place];
        Some((place, all[place] / sum, left.clamp(0.0, 1.0f32.next_down())))
    }

    /// Probability that a child is chosen for a point; 0 where none shines.
    #[inline]
    pub(super) fn share(&self, p: Vec3, place: usize) -> f32 {
        let (importances, sum) = self.comparable(p);
        if sum > 0.0 { importances[place] / sum } else { 0.0 }
    }

    /// The importance of each child relative to each other, and their finite sum.
    #[inline(always)]
    fn comparable(&self, p: Vec3) -> (Lanes, f32) {
        let mut all = self.importances(p);
        let mut sum = sum(all);
        if sum >= GREATEST {
            // Those that overflow are as good as each other.
            all = (all * (1.0 / GREATEST)).min(Vec4::ONE);
            sum = self::sum(all);
        }
        let all = all + Vec4::select(all.cmpgt(Vec4::ZERO), Vec4::splat(sum * self.alike), Vec4::ZERO);
        (all, self::sum(all))
    }

    /// About how much light each child may bring to a point; 0 only where it brings none. [Conty Estevez & Kulla 2018, eq. 3, without the
    /// receiver's cosine]
    #[inline(always)]
    fn importances(&self, p: Vec3) -> Lanes {
        let [x, y, z] = self.centre;
        let from = [Vec4::splat(p.x) - x, Vec4::splat(p.y) - y, Vec4::splat(p.z) - z];
        let distance2 = dot(from, from);
        // Within its sphere it may be anywhere, and is as strong as from the sphere's surface.
        let strength = self.power / distance2.max(self.radius2).max(Vec4::splat(f32::MIN_POSITIVE));
        // Infinity times darkness would be no number.
        let strength = strength.min(Vec4::splat(f32::MAX));
        let cosine = dot(self.axis, from) / root(distance2);
        let cosine = cosine.max(-cosine * self.other_side).min(Vec4::ONE);
        let sin_size2 = self.radius2 / distance2;
        let least =
            minus(minus([sine(cosine), cosine], self.facing), [root(sin_size2), root(Vec4::ONE - sin_size2)]);
        // Rounding must not lose what is just within.
        let is_dark = least[1].cmple(self.cos_spread - Vec4::splat(1e-4));
        let faded = Vec4::select(is_dark, Vec4::ZERO, least[1].max(Vec4::splat(1e-3)));
        strength * Vec4::select(distance2.cmple(self.radius2), Vec4::ONE, faded)
    }
}

/// In a fixed order.
#[inline(always)]
fn sum(lanes: Lanes) -> f32 {
    lanes.x + lanes.y + lanes.z + lanes.w
}

#[inline(always)]
fn dot(a: [Lanes; 3], b: [Lanes; 3]) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The sine of an angle between 0 and π by its cosine.
#[inline(always)]
fn sine(cosine: Lanes) -> Lanes {
    root(Vec4::ONE - cosine * cosine)
}

/// The square root, 0 below 0. Lane by lane it becomes one instruction; `Vec4::sqrt` calls a library for each.
#[inline(always)]
fn root(x: Lanes) -> Lanes {
    let [x, y, z, w] = x.max(Vec4::ZERO).to_array();
    Vec4::new(x.sqrt(), y.sqrt(), z.sqrt(), w.sqrt())
}

/// The difference of two angles between 0 and π, at least 0, by their sines and cosines.
#[inline(always)]
fn minus([sin_a, cos_a]: [Lanes; 2], [sin_b, cos_b]: [Lanes; 2]) -> [Lanes; 2] {
    let is_within = cos_a.cmpge(cos_b);
    let (sin, cos) = (sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b);
    [Vec4::select(is_within, Vec4::ZERO, sin), Vec4::select(is_within, Vec4::ONE, cos)]
}
