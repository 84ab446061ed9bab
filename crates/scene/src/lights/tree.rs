//! A tree of lights: chooses one for a point by how near, strong and turned towards it the lights of each branch are.
//! [Conty Estevez & Kulla 2018]

mod branch;
mod split;

use super::extent::LightExtent;
use bilux_math::Vec3;
use branch::{Branch, Child, WIDTH};
use split::{Member, sort, split};
use std::ops::Range;

/// A tree over lights, one in each leaf, with up to four children in each branch.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    /// The root is the first.
    branches: Vec<Branch>,
    /// The branch and the place in it of each light.
    leaves: Vec<[u32; 2]>,
}

impl LightTree {
    /// A tree over lights with their power, which must be positive and finite.
    pub fn new(lights: &[(LightExtent, f32)]) -> LightTree {
        let mut members: Vec<Member> =
            lights.iter().enumerate().map(|(i, &(extent, power))| (i as u32, extent, power)).collect();
        let mut tree = LightTree { branches: Vec::new(), leaves: vec![[0; 2]; lights.len()] };
        // Ranges of members, each with the branch and the place that it belongs to, and its depth in splits.
        let mut open = vec![(0..members.len(), [0, 0], 0)];
        while let Some((range, above, depth)) = open.pop().filter(|(range, ..)| !range.is_empty()) {
            let index = tree.branches.len() as u32;
            if let Some(branch) = tree.branches.get_mut(above[0] as usize) {
                branch.children[above[1] as usize] = Child::Branch(index);
            }
            let mut branch = Branch::below(above);
            let is_last = range.len() <= WIDTH;
            let parts = parts(&mut members, range, depth);
            if is_last || is_uneven(&members, &parts) {
                branch.choose_alike(parts.len());
            }
            for (place, (part, depth)) in parts.into_iter().enumerate() {
                let place = place as u32;
                branch.put(place as usize, &members[part.clone()]);
                if let [(light, ..)] = members[part.clone()] {
                    branch.children[place as usize] = Child::Light(light);
                    tree.leaves[light as usize] = [index, place];
                } else {
                    open.push((part, [index, place], depth));
                }
            }
            tree.branches.push(branch);
        }
        tree
    }

    /// A light for a point, by a random number, and its probability there; `None` where no light shines.
    #[inline]
    pub fn sample(&self, p: Vec3, u: f32) -> Option<(usize, f32)> {
        let (light, probability, _) = self.sample_with_rest(p, u)?;
        Some((light, probability))
    }

    /// [`LightTree::sample`], and what is left of the random number, from 0 to 1.
    #[inline]
    pub(super) fn sample_with_rest(&self, p: Vec3, u: f32) -> Option<(usize, f32, f32)> {
        let mut walk = Walk { branch: 0, p, u, probability: 1.0 };
        loop {
            if let Some(end) = walk.step(self) {
                return end;
            }
        }
    }

    /// [`LightTree::sample`] for each point with its number, and what is left of the number, from 0 to 1. Many walks side by side wait for
    /// memory together.
    pub fn sample_each(
        &self,
        points: impl Iterator<Item = (Vec3, f32)>,
        mut found: impl FnMut(usize, Option<(usize, f32, f32)>),
    ) {
        let walk = |(i, (p, u))| (i, Walk { branch: 0, p, u, probability: 1.0 });
        let mut walks: Vec<(usize, Walk)> = points.enumerate().map(walk).collect();
        while !walks.is_empty() {
            walks.retain_mut(|(i, walk)| match walk.step(self) {
                Some(end) => {
                    found(*i, end);
                    false
                }
                None => true,
            });
        }
    }

    /// The probability that [`LightTree::sample`] returns a light for a point.
    #[inline]
    pub fn probability(&self, p: Vec3, light: usize) -> f32 {
        let mut probability = 1.0;
        let [mut index, mut place] = self.leaves[light];
        loop {
            let branch = &self.branches[index as usize];
            probability *= branch.share(p, place as usize);
            if index == 0 {
                return probability;
            }
            [index, place] = branch.above;
        }
    }
}

/// On the way from the root to a light.
struct Walk {
    branch: u32,
    p: Vec3,
    u: f32,
    probability: f32,
}

impl Walk {
    /// Goes on to a child. Returns what is found at the end.
    #[inline(always)]
    fn step(&mut self, tree: &LightTree) -> Option<Option<(usize, f32, f32)>> {
        let Some(branch) = tree.branches.get(self.branch as usize) else { return Some(None) };
        let Some((place, share, left)) = branch.choose(self.p, self.u) else { return Some(None) };
        self.probability *= share;
        self.u = left;
        match branch.children[place] {
            Child::Nothing => Some(None),
            Child::Light(light) => Some(Some((light as usize, self.probability, left))),
            Child::Branch(index) => {
                self.branch = index;
                None
            }
        }
    }
}

/// A part may be so many times as strong for each of its lights as another before the other is chosen now and then.
const UNEVEN: f32 = 64.0;

/// Whether lights of some part are so strong that those of another would hardly ever be chosen: they may be behind a wall.
fn is_uneven(members: &[Member], parts: &[(Range<usize>, u32)]) -> bool {
    let mean = |(range, _): &(Range<usize>, u32)| {
        members[range.clone()].iter().map(|(_, _, power)| power / range.len() as f32).sum::<f32>()
    };
    let means = || parts.iter().map(mean);
    means().fold(0.0, f32::max) > UNEVEN * means().fold(f32::INFINITY, f32::min)
}

/// Up to four parts of a range of lights, each with its depth: the one with most lights is split first.
fn parts(members: &mut [Member], range: Range<usize>, depth: u32) -> Vec<(Range<usize>, u32)> {
    if range.len() <= WIDTH {
        sort(&mut members[range.clone()]);
        return range.map(|i| (i..i + 1, depth)).collect();
    }
    let mut parts = vec![(range, depth)];
    while parts.len() < WIDTH {
        let most = (0..parts.len()).rev().max_by_key(|&i| parts[i].0.len()).unwrap_or(0);
        let (Range { start, end }, depth) = parts[most].clone();
        let middle = start + split(&mut members[start..end], depth);
        parts[most] = (start..middle, depth + 1);
        parts.insert(most + 1, (middle..end, depth + 1));
    }
    parts
}

#[cfg(test)]
mod tests;
