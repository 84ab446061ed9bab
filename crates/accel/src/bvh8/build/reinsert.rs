//! Improves an existing tree: subtrees are removed and reinserted where they increase the area least [Meister 2018].
//!
//! The searches of a round run in parallel on an unchanging tree; their results are then applied one after the other,
//! largest gain first, so that the outcome does not depend on the number of threads.

use super::binary::{Binary, BinaryNode, MAX_DEPTH};
use super::costs::{Costs, costs_of_inner, costs_of_leaf};
use super::item::Bounds;
use bilux_math::glam::Vec4;
use bilux_math::parallel::map;

/// Number of rounds, and the fraction of all subtrees that are tried: those with the largest boxes, which have the
/// most to gain.
const ROUNDS: usize = 3;
const TRIED: usize = 5;
/// A search visits at most this many nodes.
const MAX_STEPS: usize = 256;
/// No children below.
const LEAF: u32 = 0;

/// Boxes with links up and down. Siblings are adjacent, the first at an even index; the root is at index 0.
struct Tree {
    bounds: Vec<Bounds>,
    /// The index of the first child, or [`LEAF`].
    below: Vec<u32>,
    /// For each pair of siblings, the index of their parent.
    above: Vec<u32>,
    /// The first item of a leaf, and its number of items.
    items: Vec<[u32; 2]>,
}

/// A node of the tree without its place.
struct Node {
    bounds: Bounds,
    below: u32,
    items: [u32; 2],
}

/// A subtree, where to put it, and by how much the areas shrink.
#[derive(Clone, Copy)]
struct Move {
    from: u32,
    to: u32,
    gain: f32,
}

/// Moves subtrees of a tree until it is better. If the tree would become too deep, it stays as it is.
pub(super) fn improve(binary: Binary) -> Binary {
    let mut tree = Tree::of(&binary);
    for _ in 0..ROUNDS {
        let candidates = tree.largest(tree.below.len() / TRIED);
        let of = |some: &[u32]| {
            let mut stack = Vec::new();
            some.iter().filter_map(|&from| tree.search(from, &mut stack)).collect::<Vec<Move>>()
        };
        let mut moves = map(candidates.chunks(256), of).concat();
        if moves.is_empty() {
            break;
        }
        moves.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.from.cmp(&b.from)));
        let mut touched = vec![false; tree.below.len()];
        moves.iter().for_each(|step| tree.apply(step, &mut touched));
    }
    tree.finish(binary)
}

impl Tree {
    fn of(binary: &Binary) -> Tree {
        let mut tree = Tree {
            bounds: vec![Bounds::EMPTY; 2],
            below: vec![LEAF; 2],
            above: vec![0],
            items: vec![[0; 2]; 2],
        };
        let mut stack = vec![(binary.root, 0)];
        while let Some((node, place)) = stack.pop() {
            let [low, high] = node.planes().map(|[x, y, z]| Vec4::new(x, y, z, 0.0));
            tree.bounds[place] = Bounds { low, high };
            if node.is_leaf() {
                tree.items[place] = [node.items().start as u32, node.count() as u32];
                continue;
            }
            let first = tree.below.len();
            tree.below[place] = first as u32;
            tree.above.push(place as u32);
            tree.bounds.extend([Bounds::EMPTY; 2]);
            tree.below.extend([LEAF; 2]);
            tree.items.extend([[0; 2]; 2]);
            let [left, right] = binary.children(&node);
            stack.extend([(right, first + 1), (left, first)]);
        }
        tree
    }

    fn parent(&self, place: u32) -> u32 {
        self.above[place as usize >> 1]
    }

    fn half_area(&self, place: u32) -> f32 {
        self.bounds[place as usize].half_area()
    }

    /// The indices of the largest boxes, except for the root's.
    fn largest(&self, count: usize) -> Vec<u32> {
        let mut places: Vec<(f32, u32)> =
            (2..self.below.len() as u32).map(|place| (self.half_area(place), place)).collect();
        let order = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        if count < places.len() {
            places.select_nth_unstable_by(count, order);
            places.truncate(count);
        }
        places.into_iter().map(|(_, place)| place).collect()
    }

    /// The best position for a subtree: searches from its parent up to the root, and down into each sibling on the
    /// way, as long as that can still win.
    fn search(&self, from: u32, stack: &mut Vec<(f32, u32)>) -> Option<Move> {
        let (own, own_area) = (self.bounds[from as usize], self.half_area(from));
        let parent = self.parent(from);
        let mut best = Move { from, to: 0, gain: 0.0 };
        // The gain up to the common ancestor, without the cost of the new parent.
        let mut gained = self.half_area(parent);
        let (mut pivot, mut sibling) = (parent, from ^ 1);
        let mut shrunk = self.bounds[sibling as usize];
        let mut steps = 0;
        loop {
            stack.clear();
            stack.push((gained, sibling));
            while let Some((gained, place)) = stack.pop() {
                steps += 1;
                if steps > MAX_STEPS {
                    break;
                }
                if gained - own_area <= best.gain {
                    continue;
                }
                let (bounds, below) = (self.bounds[place as usize], self.below[place as usize]);
                let gain = gained - bounds.union(own).half_area();
                if gain > best.gain && place != from ^ 1 {
                    (best.to, best.gain) = (place, gain);
                }
                if below != LEAF {
                    let gained = gain + bounds.half_area();
                    stack.extend([(gained, below), (gained, below + 1)]);
                }
            }
            if pivot == 0 || steps > MAX_STEPS {
                break;
            }
            // The pivot without the subtree is smaller; so may be its ancestors.
            if pivot != parent {
                shrunk = shrunk.union(self.bounds[sibling as usize]);
                gained += self.half_area(pivot) - shrunk.half_area();
            }
            sibling = pivot ^ 1;
            pivot = self.parent(pivot);
        }
        (best.gain > 0.0 && best.to != parent).then_some(best)
    }

    /// Applies the result of a search, unless something nearby has moved since.
    fn apply(&mut self, step: &Move, touched: &mut [bool]) {
        let Move { from, to, .. } = *step;
        let (sibling, parent) = (from ^ 1, self.parent(from));
        let near = [from, sibling, parent, to, self.parent(to)];
        if near.iter().any(|&place| touched[place as usize]) || self.is_within(to, from) {
            return;
        }
        near.iter().for_each(|&place| touched[place as usize] = true);
        // The sibling takes the parent's slot, and the pair becomes free.
        let moving = self.take(from);
        let staying = self.take(sibling);
        self.put(parent, staying);
        let first = from & !1;
        let target = self.take(to);
        self.put(first, target);
        self.put(first + 1, moving);
        self.below[to as usize] = first;
        self.above[first as usize >> 1] = to;
        self.fit_from(to);
        if parent != 0 {
            self.fit_from(self.parent(parent));
        }
    }

    fn take(&self, place: u32) -> Node {
        let place = place as usize;
        Node { bounds: self.bounds[place], below: self.below[place], items: self.items[place] }
    }

    fn put(&mut self, place: u32, Node { bounds, below, items }: Node) {
        let at = place as usize;
        (self.bounds[at], self.below[at], self.items[at]) = (bounds, below, items);
        if below != LEAF {
            self.above[below as usize >> 1] = place;
        }
    }

    /// Whether a node is a subtree's root or below it.
    fn is_within(&self, mut place: u32, subtree: u32) -> bool {
        while place != 0 && place != subtree {
            place = self.parent(place);
        }
        place == subtree
    }

    /// Recomputes the boxes, from an inner node upwards.
    fn fit_from(&mut self, mut place: u32) {
        loop {
            let below = self.below[place as usize] as usize;
            self.bounds[place as usize] = self.bounds[below].union(self.bounds[below + 1]);
            if place == 0 {
                return;
            }
            place = self.parent(place);
        }
    }

    fn finish(&self, before: Binary) -> Binary {
        // Parents before their children, each with the number of nodes on the path to it.
        let mut order = vec![(0u32, 1)];
        let mut next = 0;
        while let Some(&(place, depth)) = order.get(next) {
            next += 1;
            let below = self.below[place as usize];
            if below != LEAF {
                order.extend([(below, depth + 1), (below + 1, depth + 1)]);
            }
        }
        if order.last().is_some_and(|&(_, depth)| depth > MAX_DEPTH) {
            return before;
        }
        let mut known: Vec<(u32, Costs)> = vec![(0, [0.0; 7]); self.below.len()];
        let mut nodes = vec![[0.0; 16]; self.below.len()];
        for &(place, _) in order.iter().rev() {
            let at = place as usize;
            let (bounds, below) = (self.bounds[at], self.below[at] as usize);
            let [first, mut count] = self.items[at];
            let mut costs = costs_of_leaf(&bounds);
            if below != 0 {
                let [a, b] = [&known[below], &known[below + 1]];
                count = a.0 + b.0;
                costs = costs_of_inner(&bounds, count as usize, &a.1, &b.1);
            }
            known[at] = (count, costs);
            let pair = (below != 0).then_some(below as u32 / 2);
            nodes[at] = BinaryNode::new(&bounds, first..first + count, pair, costs).0;
        }
        Binary { root: BinaryNode(nodes[0]), nodes, has_pieces: before.has_pieces, in_order: false }
    }
}
