//! Blocks of voxels: how coordinates become places.

/// Voxels along each side of a block.
pub const BLOCK: usize = 8;
/// Voxels of a block.
pub const BLOCK_VOXELS: usize = BLOCK * BLOCK * BLOCK;

/// The values of a block, x varying fastest, then y.
pub type Block = [f32; BLOCK_VOXELS];

/// The maximum number of voxels along a side: positions in voxels need digits for fractions.
pub const MAX_SIDE: usize = 1 << 16;
/// The maximum number of blocks, stored or not: 32 bytes for 8 GiB.
const MAX_BLOCKS: usize = 1 << 30;

/// Why there is no such grid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    /// A side of no voxels, or of too many.
    #[error(
        "a grid of {0} x {1} x {2} voxels: a side has 1 to {MAX_SIDE}, and all together {MAX_BLOCKS} blocks of 8 x 8 x 8"
    )]
    Size(usize, usize, usize),
    /// Stored values that no grid has.
    #[error("a grid whose blocks are not those of its size, or hold no numbers")]
    Stored,
    /// The wrong number of values.
    #[error("a grid of {wanted} voxels has {found} values")]
    Count {
        /// Voxels.
        wanted: usize,
        /// Values.
        found: usize,
    },
    /// A value that is negative or not finite.
    #[error("the voxel ({0}, {1}, {2}) is negative or not finite")]
    Value(usize, usize, usize),
}

/// The number of blocks along each side.
pub(super) fn blocks_of(size: [usize; 3]) -> Result<[usize; 3], GridError> {
    let [x, y, z] = size;
    let blocks = size.map(|n| n.div_ceil(BLOCK));
    // At most 2¹³ blocks along each side, so that their product fits.
    if size.iter().any(|n| !(1..=MAX_SIDE).contains(n)) || blocks.iter().product::<usize>() > MAX_BLOCKS {
        return Err(GridError::Size(x, y, z));
    }
    Ok(blocks)
}

/// All coordinates below these, x varying fastest.
pub(super) fn all([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

/// The place of a voxel in its block.
#[inline]
pub(super) fn within(x: usize, y: usize, z: usize) -> usize {
    (z % BLOCK * BLOCK + y % BLOCK) * BLOCK + x % BLOCK
}

/// The voxel at a place in a block.
pub(super) fn voxel_of(block: [usize; 3], index: usize) -> [usize; 3] {
    let at = [index % BLOCK, index / BLOCK % BLOCK, index / (BLOCK * BLOCK)];
    [0, 1, 2].map(|axis: usize| block[axis] * BLOCK + at[axis])
}

/// The largest value of a block; what lies outside of the grid becomes 0.
pub(super) fn check(block: &mut Block, at: [usize; 3], size: [usize; 3]) -> Result<f32, GridError> {
    let mut largest = 0.0f32;
    for (i, value) in block.iter_mut().enumerate() {
        let [x, y, z] = voxel_of(at, i);
        if x >= size[0] || y >= size[1] || z >= size[2] {
            *value = 0.0;
        } else if !(value.is_finite() && *value >= 0.0) {
            return Err(GridError::Value(x, y, z));
        }
        largest = largest.max(*value);
    }
    Ok(largest)
}
