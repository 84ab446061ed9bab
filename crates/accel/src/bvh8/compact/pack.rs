//! A compact tree from a wide one: the same nodes and leaves, in the same order, with pools in between.

use crate::bvh8::compact_layout::{CORNER_WORDS, NODE_UNITS, POOL, block, link, put, write_node};
use crate::bvh8::layout::{self, LANES, MAX_UNITS, NO_TRIANGLE, Planes, Ref, Unit, WIDTH};
use crate::registry::BuildError;

/// The units, and the root among them.
pub(super) fn pack(wide: &[Unit], root: Ref) -> Result<(Vec<Unit>, Ref), BuildError> {
    // Half the size of the wide tree; unused capacity is released.
    let units = Vec::with_capacity(wide.len() / 2);
    let mut packer = Packer { wide, units, pool: Pool::default(), blocks: Vec::new() };
    let root = if wide.is_empty() { root } else { packer.subtree(root) };
    packer.close();
    // References to more units would have been truncated, and are not used.
    if packer.units.len() > MAX_UNITS {
        return Err(BuildError::TooManyNodes);
    }
    packer.units.shrink_to_fit();
    Ok((packer.units, root))
}

struct Packer<'a> {
    wide: &'a [Unit],
    units: Vec<Unit>,
    /// Corners that are not yet written.
    pool: Pool,
    /// The blocks that refer to them.
    blocks: Vec<usize>,
}

impl Packer<'_> {
    /// Writes the subtree of a reference, and returns the new reference. No path down is longer than `MAX_DEPTH`.
    fn subtree(&mut self, reference: Ref) -> Ref {
        if !reference.is_node() {
            return self.leaf(&self.wide[reference.leaf_units()]);
        }
        let at = self.units.len();
        self.units.resize(at + NODE_UNITS, Unit::default());
        let mut children: [(Planes, Ref); WIDTH] = [(layout::EMPTY, Ref::EMPTY); WIDTH];
        let mut count = 0;
        for (planes, child) in layout::children(&self.wide[reference.unit()..]) {
            children[count] = (planes, self.subtree(child));
            count += 1;
        }
        write_node(&mut self.units[at..], &children[..count]);
        Ref::node(at)
    }

    fn leaf(&mut self, leaf: &[Unit]) -> Ref {
        let most = leaf.len() / layout::BLOCK_UNITS * LANES * 3;
        if self.pool.corners.len() + most > POOL && self.pool.corners.len() + self.new_corners(leaf) > POOL {
            self.close();
        }
        let at = self.units.len();
        for from in leaf.chunks_exact(layout::BLOCK_UNITS) {
            let mut numbers = [[0; 3]; LANES];
            let mut primitives = [NO_TRIANGLE; LANES];
            for (lane, (corners, primitive)) in layout::triangles(from).enumerate() {
                numbers[lane] = corners.map(|p| self.pool.number(&p));
                primitives[lane] = primitive;
            }
            self.blocks.push(self.units.len());
            self.units.push(block(numbers, primitives));
        }
        Ref::leaf(at, self.units.len() - at)
    }

    /// Number of corners of a leaf that the pool lacks; a corner that occurs twice in the leaf counts twice.
    fn new_corners(&self, leaf: &[Unit]) -> usize {
        let corners = leaf.chunks_exact(layout::BLOCK_UNITS).flat_map(layout::triangles);
        corners.flat_map(|(corners, _)| corners).filter(|corner| self.pool.find(corner).is_err()).count()
    }

    /// Writes the pool after all existing units, and starts a new one.
    fn close(&mut self) {
        let pool = self.units.len();
        for block in self.blocks.drain(..) {
            link(&mut self.units, block, pool);
        }
        // Corners are read four numbers at a time, so one more number follows the last.
        let words = self.pool.corners.len() * CORNER_WORDS + 1;
        if words > 1 {
            self.units.resize(pool + words.div_ceil(8), Unit::default());
        }
        for (k, bits) in self.pool.corners.iter().flatten().enumerate() {
            put(&mut self.units[pool..], k, *bits);
        }
        self.pool = Pool::default();
    }
}

/// Corners by their bits, each once, in order of first occurrence.
struct Pool {
    corners: Vec<[u32; 3]>,
    /// One more than the number of a corner, at the first free slot from its hash on; 0 in empty slots.
    places: [u16; 4 * POOL],
}

impl Default for Pool {
    fn default() -> Pool {
        Pool { corners: Vec::with_capacity(POOL), places: [0; 4 * POOL] }
    }
}

impl Pool {
    /// The number of a corner, or the slot where it would be.
    fn find(&self, corner: &[f32; 3]) -> Result<usize, usize> {
        let bits = corner.map(f32::to_bits);
        let mixed =
            bits.iter().fold(0u32, |all, &word| (all.rotate_left(11) ^ word).wrapping_mul(0x9e37_79b1));
        let mut place = (mixed >> 16) as usize % self.places.len();
        loop {
            match self.places[place] {
                0 => return Err(place),
                number if self.corners[usize::from(number) - 1] == bits => return Ok(usize::from(number) - 1),
                _ => place = (place + 1) % self.places.len(),
            }
        }
    }

    /// The number of a corner, which is added if it is new. There must be space.
    fn number(&mut self, corner: &[f32; 3]) -> u8 {
        let number = self.find(corner).unwrap_or_else(|place| {
            self.corners.push(corner.map(f32::to_bits));
            self.places[place] = self.corners.len() as u16;
            self.corners.len() - 1
        });
        number as u8
    }
}
