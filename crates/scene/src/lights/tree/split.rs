//! Splits of the branches of a tree of lights.

use super::super::extent::LightExtent;
use bilux_math::Aabb;

/// A light with its power, on the way into the tree.
pub(super) type Member = (u32, LightExtent, f32);

/// The maximum number of intervals along each axis between which a branch may be split.
const BINS: usize = 12;
/// A cut is chosen by about as many lights.
const MAX_COMPARED: usize = 1024;
/// Parts further down have as many lights on either side.
const MAX_UNEVEN: u32 = 48;

/// Sorts lights along the longest axis, so that it does not matter in which order a file lists them.
pub(super) fn sort(members: &mut [Member]) {
    let middle = |member: &Member| member.1.bounds.centre();
    let axis = Aabb::of_points(members.iter().map(middle)).extent().max_position();
    members.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
}

/// Sorts lights to two sides, and returns how many are on the first: at least one, and not all.
pub(super) fn split(members: &mut [Member], depth: u32) -> usize {
    let middle = |member: &Member| member.1.bounds.centre();
    let centres = Aabb::of_points(members.iter().map(middle));
    let longest = centres.extent().max_element();
    let even = members.len() / 2;
    // Also where a number is not finite.
    if depth >= MAX_UNEVEN || !(longest > 0.0 && longest.is_finite()) {
        sort(members);
        return even;
    }
    let count = members.len().min(BINS);
    let bin = |axis: usize, member: &Member| {
        let place = (middle(member)[axis] - centres.min[axis]) / centres.extent()[axis];
        ((place * count as f32) as usize).min(count - 1)
    };
    let axes = || (0..3).filter(|&axis| centres.extent()[axis] > 0.0);
    let mut bins = [[None::<(LightExtent, f32)>; BINS]; 3];
    for member in members.iter().step_by((members.len() / MAX_COMPARED).max(1)) {
        for axis in axes() {
            join(&mut bins[axis][bin(axis, member)], member.1, member.2);
        }
    }
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in axes() {
        // Thin boxes are not cut further. [Conty Estevez & Kulla 2018, eq. 2]
        let stretch = longest / centres.extent()[axis];
        for (cut, cost) in costs(&bins[axis][..count]) {
            let cost = cost * stretch;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, cut));
            }
        }
    }
    let Some((_, axis, cut)) = best else { return even };
    let mut first = 0;
    for i in 0..members.len() {
        if bin(axis, &members[i]) < cut {
            members.swap(first, i);
            first += 1;
        }
    }
    first
}

fn join(all: &mut Option<(LightExtent, f32)>, extent: LightExtent, power: f32) {
    match all {
        Some((before, sum)) => (*before, *sum) = (before.union(extent), *sum + power),
        None => *all = Some((extent, power)),
    }
}

/// The cost of cutting before each bin, where both sides have lights: power times area times the measure of directions.
fn costs(bins: &[Option<(LightExtent, f32)>]) -> impl Iterator<Item = (usize, f32)> {
    let cost = |side: Option<(LightExtent, f32)>| {
        side.map(|(extent, power)| {
            // Points in a row have no area.
            let area = extent.bounds.half_area() + extent.bounds.extent().length_squared() * 1e-3;
            power * area * extent.measure()
        })
    };
    let mut before = [None; BINS];
    let mut sum = None;
    for (cut, bin) in bins.iter().enumerate() {
        before[cut] = cost(sum);
        if let Some((extent, power)) = *bin {
            join(&mut sum, extent, power);
        }
    }
    let mut behind = [None; BINS];
    let mut sum = None;
    for (cut, bin) in bins.iter().enumerate().rev() {
        if let Some((extent, power)) = *bin {
            join(&mut sum, extent, power);
        }
        behind[cut] = cost(sum);
    }
    (1..bins.len()).filter_map(move |cut| Some((cut, before[cut]? + behind[cut]?)))
}
