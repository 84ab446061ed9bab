//! Trees of voxels, as OpenVDB and NanoVDB have them, become grids: leaves of 8³ values, and larger cubes of one value.
//! [Museth 2013]

use super::Volume;
use super::surface::{Distances, LeafValues};
use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::bytes::text::whole_file;
use crate::input::reading::Source;
use bilux_math::{Aabb, DMat4, DVec3, Transform, Vec3};
use bilux_scene::Mesh;
use bilux_scene::media::{BLOCK, BLOCK_VOXELS, Block, Faults, Grid, MAX_SIDE};
use std::collections::BTreeMap;

/// Voxels along the side of a leaf: that of a block.
const SIDE: i64 = BLOCK as i64;

/// Which voxels of a leaf are active, one bit each, x varying slowest.
pub type LeafMask = [u8; BLOCK_VOXELS / 8];

/// Reads the values of a leaf that is at some byte of the file.
pub type ReadLeaf<'a> = dyn FnMut(usize, &mut LeafValues) -> Result<(), FormatError> + 'a;

/// Parts of a tree that have been found.
#[derive(Debug)]
pub struct Sparse {
    parts: Vec<Part>,
    /// The blocks that they will fill.
    blocks: u64,
    /// The first voxel with a value, and the last.
    low: [i64; 3],
    high: [i64; 3],
}

#[derive(Clone, Copy, Debug)]
struct Part {
    origin: [i64; 3],
    content: Content,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    /// Place of the leaf in the file.
    Leaf(usize),
    /// As many voxels along each side as the first number, and their value.
    Tile(i64, f32),
}

/// Name and map of a grid, which a whole grid needs beside its tree.
#[derive(Debug)]
pub struct Placed<'a> {
    pub name: &'a str,
    /// From the indices of voxels, which are at their centres, to the space of the file.
    pub map: DMat4,
}

/// Bytes of a vertex of a surface while it is made, with the table in which its neighbours find it.
const SURFACE_BYTES: usize = 128;

/// A tree with fewer blocks in all is not refused for its extent: 1290 voxels along each side.
const FEW_BLOCKS: u64 = 1 << 22;
/// One of so many blocks has values, or they are too scattered for a table of all blocks.
const SCATTERED: u64 = 1000;

impl Default for Sparse {
    /// The tree without values.
    fn default() -> Sparse {
        Sparse { parts: Vec::new(), blocks: 0, low: [i64::MAX; 3], high: [i64::MIN; 3] }
    }
}

impl Sparse {
    /// Adds a leaf; `at` is where its values are.
    pub fn leaf(
        &mut self,
        origin: [i32; 3],
        mask: &LeafMask,
        at: usize,
        file: &Source,
        budget: &mut Budget,
    ) -> Result<(), FormatError> {
        let Some([low, high]) = extent(mask) else { return Ok(()) };
        let origin = self.origin(origin, SIDE, file)?;
        let place = |at: [i64; 3]| [0, 1, 2].map(|axis: usize| origin[axis] + at[axis]);
        self.reach(place(low), place(high));
        self.add(Part { origin, content: Content::Leaf(at) }, 1, file, budget)
    }

    /// Adds a cube of one value.
    pub fn tile(
        &mut self,
        origin: [i32; 3],
        side: i64,
        value: f32,
        file: &Source,
        budget: &mut Budget,
    ) -> Result<(), FormatError> {
        let origin = self.origin(origin, side, file)?;
        self.reach(origin, origin.map(|begin| begin + side - 1));
        let blocks = (side / SIDE) as u64;
        self.add(Part { origin, content: Content::Tile(side, value) }, blocks * blocks * blocks, file, budget)
    }

    /// Counts voxels as having values.
    fn reach(&mut self, low: [i64; 3], high: [i64; 3]) {
        self.low = [0, 1, 2].map(|axis: usize| self.low[axis].min(low[axis]));
        self.high = [0, 1, 2].map(|axis: usize| self.high[axis].max(high[axis]));
    }

    fn origin(&self, origin: [i32; 3], side: i64, file: &Source) -> Result<[i64; 3], FormatError> {
        let origin = origin.map(i64::from);
        if origin.iter().all(|x| x.rem_euclid(side) == 0) {
            return Ok(origin);
        }
        let message = format!("a node of {side} voxels a side begins at {origin:?}: the file is damaged");
        Err(FormatError::malformed(message, whole_file(file.name)))
    }

    fn add(
        &mut self,
        part: Part,
        blocks: u64,
        file: &Source,
        budget: &mut Budget,
    ) -> Result<(), FormatError> {
        // The blocks as floats, in a list that grows by doubling, and the halves that they become.
        const BYTES: u64 = (2 * size_of::<Block>() + BLOCK_VOXELS * size_of::<u16>()) as u64;
        budget.take::<Part>(1, file.name)?;
        budget.take_bytes(blocks * (BYTES + size_of::<(u64, Content)>() as u64), file.name)?;
        self.blocks += blocks;
        self.parts.push(part);
        Ok(())
    }

    /// The grid of all that was added; `read` gives the values of a leaf. `None` if nothing was.
    pub fn into_volume(
        self,
        placed: &Placed,
        file: &Source,
        budget: &mut Budget,
        read: &mut ReadLeaf,
    ) -> Result<Option<Volume>, FormatError> {
        if self.parts.is_empty() {
            return Ok(None);
        }
        let fail = |message: String| FormatError::malformed(message, whole_file(file.name));
        let (first, size) = self.lattice(placed.name, file, budget)?;
        let Some(to_file) = place(placed.map, first) else {
            return Err(fail(format!("the place of the grid '{}' is not an invertible map", placed.name)));
        };
        // Where the outermost values have faded to zero: a voxel beyond them.
        let corner = |at: [i64; 3], beyond: f32| {
            Vec3::from([0, 1, 2].map(|axis: usize| (at[axis] - first[axis]) as f32 + 0.5 + beyond))
        };
        let bounds = Aabb { min: corner(self.low, -1.0), max: corner(self.high, 1.0) };
        let contents = self.contents(first, size);
        let (mut next, mut failed, mut faults) = (0, None, Faults::default());
        let mut values = [0.0; BLOCK_VOXELS];
        let fill = |at: [usize; 3], block: &mut Block| {
            let key = key(at, size);
            while contents.get(next).is_some_and(|(before, _)| *before < key) {
                next += 1;
            }
            let Some((_, content)) = contents.get(next).filter(|(found, _)| *found == key) else {
                return false;
            };
            match content {
                _ if failed.is_some() => return false,
                Content::Tile(_, value) => values.fill(*value),
                Content::Leaf(place) => {
                    if let Err(error) = read(*place, &mut values) {
                        failed = Some(error);
                        return false;
                    }
                }
            }
            for (i, voxel) in block.iter_mut().enumerate() {
                let [x, y, z] = [i % BLOCK, i / BLOCK % BLOCK, i / (BLOCK * BLOCK)];
                *voxel = faults.density(values[(x * BLOCK + y) * BLOCK + z]);
            }
            block.iter().any(|value| *value != 0.0)
        };
        let grid = Grid::new(placed.name, size, &to_file, fill).map_err(|error| fail(error.to_string()))?;
        match failed {
            Some(error) => Err(error),
            None => Ok(Some(Volume { grid, bounds, faults, background: 0.0, is_mean: false })),
        }
    }

    /// The surface where the values are 0, of a level set; `read` gives the values of a leaf. `None` if there is none.
    pub fn into_surface(
        self,
        placed: &Placed,
        file: &Source,
        budget: &mut Budget,
        read: &mut ReadLeaf,
    ) -> Result<Option<Mesh>, FormatError> {
        let mut blocks = BTreeMap::new();
        for Part { origin, content } in self.parts {
            // Larger cubes of one value are far from the surface.
            let Content::Leaf(at) = content else { continue };
            budget.take_bytes(2 * size_of::<LeafValues>() as u64, file.name)?;
            let mut values = Box::new([0.0; BLOCK_VOXELS]);
            read(at, &mut values)?;
            blocks.insert(origin.map(|x| x.div_euclid(SIDE)), values);
        }
        // The surface passes through a block about as a plane does.
        budget.take_bytes((blocks.len() * BLOCK * BLOCK * SURFACE_BYTES) as u64, file.name)?;
        let mesh = Distances { blocks }.surface(&placed.map);
        budget.take_bytes(mesh.size(), file.name)?;
        Ok((!mesh.triangles.is_empty()).then(|| Mesh { name: placed.name.to_owned(), ..mesh }))
    }

    /// The first voxel of the lattice of blocks, and how many voxels it has: all with values and one around them.
    fn lattice(
        &self,
        name: &str,
        file: &Source,
        budget: &mut Budget,
    ) -> Result<([i64; 3], [usize; 3]), FormatError> {
        let fail = |message: String| Err(FormatError::malformed(message, whole_file(file.name)));
        let first = self.low.map(|low| (low - 1).div_euclid(SIDE) * SIDE);
        let size = [0, 1, 2].map(|axis: usize| self.high[axis] + 2 - first[axis]);
        if size.iter().any(|side| *side > MAX_SIDE as i64) {
            let [x, y, z] = size;
            return fail(format!(
                "the voxels of the grid '{name}' are in a box of {x} x {y} x {z}, but a side has at most {MAX_SIDE}"
            ));
        }
        let all: u64 = size.iter().map(|side| side.div_euclid(SIDE) as u64 + 1).product();
        if all > FEW_BLOCKS.max(SCATTERED * self.blocks) {
            return fail(format!(
                "the voxels of the grid '{name}' are scattered: {} of {all} blocks of 8 x 8 x 8 have values; split it",
                self.blocks
            ));
        }
        // Places, majorants, and the lists that these grow in.
        budget.take_bytes(all * 16, file.name)?;
        Ok((first, size.map(|side| side as usize)))
    }

    /// Contents of the blocks, in the order of grids.
    fn contents(&self, first: [i64; 3], size: [usize; 3]) -> Vec<(u64, Content)> {
        let mut contents = Vec::with_capacity(self.blocks as usize);
        for part in &self.parts {
            let side = if let Content::Tile(side, _) = part.content { side } else { SIDE };
            let begin = [0, 1, 2].map(|axis: usize| ((part.origin[axis] - first[axis]) / SIDE) as usize);
            let blocks = (side / SIDE) as usize;
            for i in 0..blocks * blocks * blocks {
                let [x, y, z] = [i % blocks, i / blocks % blocks, i / (blocks * blocks)];
                contents.push((key([begin[0] + x, begin[1] + y, begin[2] + z], size), part.content));
            }
        }
        contents.sort_by_key(|(key, _)| *key);
        contents
    }
}

/// The place of a block in the order of grids.
fn key([x, y, z]: [usize; 3], size: [usize; 3]) -> u64 {
    let [nx, ny, _] = size.map(|side| side.div_ceil(BLOCK) as u64);
    (z as u64 * ny + y as u64) * nx + x as u64
}

/// From the voxels of a grid, which begin at whole numbers, to the file.
fn place(map: DMat4, first: [i64; 3]) -> Option<Transform> {
    let centre = DVec3::from(first.map(|x| x as f64 - 0.5));
    Transform::from_matrix(map * DMat4::from_translation(centre))
}

/// The first and the last active voxel along each axis.
fn extent(mask: &LeafMask) -> Option<[[i64; 3]; 2]> {
    let [mut x, mut y, mut z] = [0u8; 3];
    for (i, bits) in mask.iter().enumerate().filter(|(_, bits)| **bits != 0) {
        x |= 1 << (i / BLOCK);
        y |= 1 << (i % BLOCK);
        z |= bits;
    }
    let axes = [x, y, z];
    (x != 0).then(|| {
        [
            axes.map(|bits| i64::from(bits.trailing_zeros())),
            axes.map(|bits| 7 - i64::from(bits.leading_zeros())),
        ]
    })
}
