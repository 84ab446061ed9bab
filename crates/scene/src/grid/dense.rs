//! Grids with a value for each voxel, made on all threads.

use super::blocks::{BLOCK, BLOCK_VOXELS, GridError, blocks_of};
use super::faults::Faults;
use super::grid::{EMPTY, Grid};
use super::half::{half, scale_of};
use bilux_math::Transform;
use bilux_math::parallel::{self, for_each_with, map_with};

/// Rows of voxels in a row of blocks.
const ROWS: usize = BLOCK * BLOCK;

impl Grid {
    /// A grid of rows: `fill` writes the values of that row along x which lies at y and z, and is asked twice for each. Numbers that
    /// cannot be densities become 0, and are counted.
    ///
    /// # Errors
    /// When a side has no voxel or too many.
    pub fn of_rows(
        name: &str,
        size: [usize; 3],
        to_object: &Transform,
        fill: impl Fn(usize, usize, &mut [f32]) + Sync,
    ) -> Result<(Grid, Faults), GridError> {
        let [across, deep, high] = blocks_of(size)?;
        let width = across * BLOCK;
        // The values of a row of blocks, with zeros beyond the last voxels.
        let values_of = |strip: usize, values: &mut [f32]| {
            let mut faults = Faults::default();
            for (row, values) in values.chunks_exact_mut(width).enumerate() {
                let (y, z) = (strip % deep * BLOCK + row % BLOCK, strip / deep * BLOCK + row / BLOCK);
                if y < size[1] && z < size[2] {
                    fill(y, z, &mut values[..size[0]]);
                    faults.densities(&mut values[..size[0]]);
                } else {
                    values.fill(0.0);
                }
            }
            faults
        };
        let buffer = || vec![0.0; width * ROWS];
        let found: Vec<(Faults, Vec<f32>)> = map_with(0..deep * high, buffer, |values, strip| {
            let faults = values_of(strip, values);
            (faults, largest_of_blocks(values, width))
        });
        let largest = found.iter().flat_map(|(_, blocks)| blocks).copied().fold(0.0, f32::max);
        let faults = found.iter().fold(Faults::default(), |all, (faults, _)| all.and(*faults));
        let scale = scale_of(largest);

        let (mut places, mut count) = (Vec::with_capacity(across * deep * high), 0);
        for largest in found.iter().flat_map(|(_, blocks)| blocks) {
            places.push(if *largest > 0.0 { count } else { EMPTY });
            count += u32::from(*largest > 0.0);
        }
        let mut voxels = vec![0; count as usize * BLOCK_VOXELS];
        let (mut rest, mut stored) = (&mut voxels[..], Vec::with_capacity(deep * high));
        for places in places.chunks_exact(across) {
            let count = places.iter().filter(|place| **place != EMPTY).count();
            let (own, others) = rest.split_at_mut(count * BLOCK_VOXELS);
            stored.push((places, own));
            rest = others;
        }
        // A power of two: products with its inverse are exact.
        let inverse = 1.0 / scale;
        for_each_with(stored.into_iter().enumerate(), buffer, |values, (strip, (places, voxels))| {
            if voxels.is_empty() {
                return;
            }
            values_of(strip, values);
            let stored = (0..across).filter(|block| places[*block] != EMPTY);
            for (block, voxels) in stored.zip(voxels.as_chunks_mut::<BLOCK_VOXELS>().0) {
                let rows = values.chunks_exact(width).map(|row| &row[block * BLOCK..][..BLOCK]);
                for (voxels, values) in voxels.as_chunks_mut::<BLOCK>().0.iter_mut().zip(rows) {
                    for (voxel, value) in voxels.iter_mut().zip(values) {
                        *voxel = half(value * inverse);
                    }
                }
            }
        });
        Ok((Grid::of_blocks(name, size, to_object, places, voxels, scale), faults))
    }

    /// Bytes that [`Grid::of_rows`] takes at most: halves of all voxels, three numbers for each block, and a row of blocks for
    /// each thread.
    pub fn bytes_to_make(size: [usize; 3]) -> u64 {
        let [nx, ny, nz] = size.map(|side| side.next_multiple_of(BLOCK) as u64);
        let halves = nx.saturating_mul(ny).saturating_mul(nz).saturating_mul(2);
        let threads = parallel::threads() as u64;
        halves.saturating_add(halves / 64).saturating_add(threads * nx * 4 * ROWS as u64)
    }

    /// A grid from one value for each voxel, x varying fastest, then y.
    ///
    /// # Errors
    /// As [`Grid::new`], and when there are more or fewer values.
    pub fn dense(
        name: &str,
        size: [usize; 3],
        to_object: &Transform,
        values: &[f32],
    ) -> Result<Grid, GridError> {
        blocks_of(size)?;
        let [nx, ny, nz] = size;
        let wanted = nx * ny * nz;
        if values.len() != wanted {
            return Err(GridError::Count { wanted, found: values.len() });
        }
        let row = |y: usize, z: usize, row: &mut [f32]| {
            row.copy_from_slice(&values[(z * ny + y) * nx..][..nx]);
        };
        let (grid, faults) = Grid::of_rows(name, size, to_object, row)?;
        let is_fault = |value: &f32| !(value.is_finite() && *value >= 0.0);
        match values.iter().position(is_fault) {
            Some(i) if faults != Faults::default() => {
                Err(GridError::Value(i % nx, i / nx % ny, i / (nx * ny)))
            }
            _ => Ok(grid),
        }
    }
}

/// The largest value of each block of a row of blocks.
fn largest_of_blocks(values: &[f32], width: usize) -> Vec<f32> {
    // Without a sign, numbers are in the order of their bits.
    let mut largest = vec![0u32; width / BLOCK];
    for row in values.chunks_exact(width) {
        for (largest, values) in largest.iter_mut().zip(row.as_chunks::<BLOCK>().0) {
            *largest = values.iter().fold(*largest, |largest, value| largest.max(value.to_bits()));
        }
    }
    largest.into_iter().map(f32::from_bits).collect()
}
