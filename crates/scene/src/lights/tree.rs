//! A tree of lights: chooses one for a point by how near, strong and turned towards it the lights of each branch are.
//! [Conty Estevez & Kulla 2018]

use super::extent::LightExtent;
use bilux_math::Vec3;
use bilux_math::transcendental::{cos, sin_cos};

/// A binary tree over lights, one in each leaf.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    /// The root is the first; the left child of a branch follows it.
    nodes: Vec<Node>,
    /// The leaf of each light.
    leaves: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    centre: Vec3,
    /// Of the sphere around its bounds, in metres.
    radius: f32,
    axis: Vec3,
    /// The sine and cosine of the angle of its cone.
    facing: [f32; 2],
    cos_spread: f32,
    both_sides: bool,
    power: f32,
    /// The branch above it; the root's is the root.
    parent: u32,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Leaf { light: u32 },
    Branch { right: u32 },
}

/// Intervals along each axis between which a branch may be split.
const BINS: usize = 12;
/// Branches further down have as many lights on either side.
const MAX_UNEVEN: u32 = 48;

/// A light with its power, on the way into the tree.
type Member = (u32, LightExtent, f32);

impl LightTree {
    /// A tree over lights with their power, which must be positive and finite.
    pub fn new(lights: &[(LightExtent, f32)]) -> LightTree {
        let mut members: Vec<Member> =
            lights.iter().enumerate().map(|(i, &(extent, power))| (i as u32, extent, power)).collect();
        let mut tree = LightTree { nodes: Vec::new(), leaves: vec![0; lights.len()] };
        // Ranges of members, each with the branch whose right child it is, and its depth.
        let mut open = vec![(0..members.len(), 0u32, 0u32)];
        while let Some((range, parent, depth)) = open.pop().filter(|(range, ..)| !range.is_empty()) {
            let index = tree.nodes.len() as u32;
            if let Some(Node { kind: Kind::Branch { right }, .. }) = tree.nodes.get_mut(parent as usize)
                && index > parent + 1
            {
                *right = index;
            }
            let own = &mut members[range.clone()];
            let node = |kind| Node::new(own, parent, kind);
            if let [(light, ..)] = *own {
                tree.leaves[light as usize] = index;
                tree.nodes.push(node(Kind::Leaf { light }));
                continue;
            }
            tree.nodes.push(node(Kind::Branch { right: 0 }));
            let middle = range.start + split(own, depth);
            open.push((middle..range.end, index, depth + 1));
            open.push((range.start..middle, index, depth + 1));
        }
        tree
    }

    /// A light for a point, by a random number, and its probability there; `None` where no light shines.
    #[inline]
    pub fn sample(&self, p: Vec3, mut u: f32) -> Option<(usize, f32)> {
        let (mut index, mut probability) = (0, 1.0);
        loop {
            let node = self.nodes.get(index)?;
            let right = match node.kind {
                Kind::Leaf { light } => return Some((light as usize, probability)),
                Kind::Branch { right } => right as usize,
            };
            let left = self.share_of_left(index, right, p)?;
            if u < left {
                (index, probability) = (index + 1, probability * left);
                u /= left;
            } else {
                (index, probability) = (right, probability * (1.0 - left));
                u = (u - left) / (1.0 - left);
            }
            u = u.min(1.0f32.next_down());
        }
    }

    /// The probability that [`LightTree::sample`] returns a light for a point.
    #[inline]
    pub fn probability(&self, p: Vec3, light: usize) -> f32 {
        let (mut index, mut probability) = (self.leaves[light] as usize, 1.0);
        while index > 0 {
            let parent = self.nodes[index].parent as usize;
            let Kind::Branch { right } = self.nodes[parent].kind else { return 0.0 };
            let Some(left) = self.share_of_left(parent, right as usize, p) else { return 0.0 };
            probability *= if index == right as usize { 1.0 - left } else { left };
            index = parent;
        }
        probability
    }

    /// How often the left child of a branch is chosen; `None` where neither shines.
    #[inline]
    fn share_of_left(&self, parent: usize, right: usize, p: Vec3) -> Option<f32> {
        let [left, right] = [parent + 1, right].map(|child| self.nodes[child].importance(p));
        let sum = left + right;
        // Two that overflow are as good as each other.
        let share = if sum.is_finite() { left / sum } else { 0.5 };
        (sum > 0.0).then_some(share)
    }
}

impl Node {
    fn new(members: &[Member], parent: u32, kind: Kind) -> Node {
        let (extent, power) = together(members);
        let (sin, cosine) = sin_cos(extent.facing.angle);
        Node {
            centre: extent.bounds.centre(),
            radius: extent.bounds.radius(),
            axis: extent.facing.axis,
            facing: [sin, cosine],
            cos_spread: cos(extent.spread),
            both_sides: extent.both_sides,
            power,
            parent,
            kind,
        }
    }

    /// About how much light it may bring to a point; 0 only where it brings none. [Conty Estevez & Kulla 2018, eq. 3, without the receiver's
    /// cosine]
    #[inline]
    fn importance(&self, p: Vec3) -> f32 {
        let from = p - self.centre;
        let distance2 = from.length_squared();
        let radius2 = self.radius * self.radius;
        // Within its sphere it may be anywhere, and is as strong as from the sphere's surface.
        let strength = self.power / distance2.max(radius2).max(f32::MIN_POSITIVE);
        if distance2 <= radius2 {
            return strength;
        }
        let cosine = self.axis.dot(from) / distance2.sqrt();
        let cosine = if self.both_sides { cosine.abs() } else { cosine }.min(1.0);
        let angle = [(1.0 - cosine * cosine).max(0.0).sqrt(), cosine];
        let sin_size2 = radius2 / distance2;
        let size = [sin_size2.sqrt(), (1.0 - sin_size2).sqrt()];
        let least = minus(minus(angle, self.facing), size);
        // Rounding must not lose what is just within.
        if least[1] <= self.cos_spread - 1e-4 { 0.0 } else { strength * least[1].max(1e-3) }
    }
}

/// The difference of two angles between 0 and π, at least 0, by their sines and cosines.
#[inline(always)]
fn minus([sin_a, cos_a]: [f32; 2], [sin_b, cos_b]: [f32; 2]) -> [f32; 2] {
    if cos_a >= cos_b { [0.0, 1.0] } else { [sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b] }
}

fn together(members: &[Member]) -> (LightExtent, f32) {
    let [(_, first, power), rest @ ..] = members else { unreachable!("a node has lights") };
    rest.iter().fold((*first, *power), |(all, sum), (_, extent, power)| (all.union(*extent), sum + power))
}

/// Sorts lights to two sides, and returns how many are on the first: at least one, and not all.
fn split(members: &mut [Member], depth: u32) -> usize {
    let middle = |member: &Member| member.1.bounds.centre();
    let centres = bilux_math::Aabb::of_points(members.iter().map(middle));
    let longest = centres.extent().max_element();
    let even = members.len() / 2;
    // Also where a number is not finite.
    if depth >= MAX_UNEVEN || !(longest > 0.0 && longest.is_finite()) {
        let axis = centres.extent().max_position();
        members.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        return even;
    }
    let bin = |axis: usize, member: &Member| {
        let place = (middle(member)[axis] - centres.min[axis]) / centres.extent()[axis];
        ((place * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| centres.extent()[axis] > 0.0) {
        let mut bins = [None::<(LightExtent, f32)>; BINS];
        for member in members.iter() {
            join(&mut bins[bin(axis, member)], Some((member.1, member.2)));
        }
        // Thin boxes are not cut further. [Conty Estevez & Kulla 2018, eq. 2]
        let stretch = longest / centres.extent()[axis];
        for (cut, cost) in costs(&bins) {
            let cost = cost * stretch;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, cut));
            }
        }
    }
    let Some((_, axis, cut)) = best else { return even };
    let mut sorted: Vec<Member> = members.iter().filter(|m| bin(axis, m) < cut).copied().collect();
    let first = sorted.len();
    sorted.extend(members.iter().filter(|m| bin(axis, m) >= cut));
    members.copy_from_slice(&sorted);
    first
}

fn join(all: &mut Option<(LightExtent, f32)>, other: Option<(LightExtent, f32)>) {
    *all = match (*all, other) {
        (Some((a, p)), Some((b, q))) => Some((a.union(b), p + q)),
        (a, b) => a.or(b),
    };
}

/// The cost of cutting before each bin, where both sides have lights: power times area times the measure of directions.
fn costs(bins: &[Option<(LightExtent, f32)>; BINS]) -> impl Iterator<Item = (usize, f32)> {
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
        join(&mut sum, *bin);
    }
    let mut behind = [None; BINS];
    let mut sum = None;
    for (cut, bin) in bins.iter().enumerate().rev() {
        join(&mut sum, *bin);
        behind[cut] = cost(sum);
    }
    (1..BINS).filter_map(move |cut| Some((cut, before[cut]? + behind[cut]?)))
}

#[cfg(test)]
mod tests;
