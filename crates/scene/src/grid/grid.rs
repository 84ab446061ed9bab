//! The storage of a grid, and its values.

use super::blocks::{BLOCK, BLOCK_VOXELS, Block, GridError, all, blocks_of, check, within};
use super::half::{from_half, half, scale_of};
use super::line::{GridLine, for_each_block};
use super::origin::Origin;
use bilux_math::parallel::fill;
use bilux_math::{Transform, Vec3};
use std::fmt;

/// Marks a block of zeros.
pub(super) const EMPTY: u32 = u32::MAX;

/// Numbers, none of them negative, at the centres of voxels, linear in between, and 0 outside.
#[derive(Clone, PartialEq)]
pub struct Grid {
    name: String,
    size: [usize; 3],
    to_voxels: Transform,
    /// For each block, x varying fastest, then y: its place among the stored ones, or [`EMPTY`].
    places: Box<[u32]>,
    /// The values of stored blocks over `scale`, as halves.
    voxels: Box<[u16]>,
    /// Upper bounds of all values inside a block, and of what lies within a voxel around.
    majorants: Box<[f32]>,
    scale: f32,
    origin: Option<Origin>,
}

/// Contents of a grid, as they are stored.
#[derive(Clone, Copy, Debug)]
pub struct Stored<'a> {
    /// For each block, x varying fastest, then y: its place among the stored ones, or `u32::MAX` for zeros.
    pub places: &'a [u32],
    /// The halves of the stored blocks, 512 for each.
    pub voxels: &'a [u16],
    /// The factor on them.
    pub scale: f32,
}

impl Grid {
    /// A grid of this many voxels, of which `fill` gives the blocks, in order, x varying fastest: true if it has written any
    /// value but zeros into the block at these block coordinates. `to_object` maps voxel coordinates, in which the first voxel
    /// reaches from 0 to 1, to the object whose inside it fills. Values beyond the last voxel are ignored.
    ///
    /// # Errors
    /// When a side has no voxel or too many, or a value is negative or not finite.
    pub fn new(
        name: &str,
        size: [usize; 3],
        to_object: &Transform,
        mut fill: impl FnMut([usize; 3], &mut Block) -> bool,
    ) -> Result<Grid, GridError> {
        let blocks = blocks_of(size)?;
        let (mut places, mut stored) = (Vec::new(), Vec::new());
        let (mut block, mut largest) = ([0.0; BLOCK_VOXELS], 0.0f32);
        for at in all(blocks) {
            block.fill(0.0);
            if !fill(at, &mut block) {
                places.push(EMPTY);
                continue;
            }
            largest = largest.max(check(&mut block, at, size)?);
            places.push((stored.len() / BLOCK_VOXELS) as u32);
            stored.extend_from_slice(&block);
        }
        let scale = scale_of(largest);
        let voxels = stored.iter().map(|value| half(value / scale)).collect();
        Ok(Grid::of_blocks(name, size, to_object, places, voxels, scale))
    }

    /// One of these blocks, which are those of its size.
    pub(super) fn of_blocks(
        name: &str,
        size: [usize; 3],
        to_object: &Transform,
        places: Vec<u32>,
        voxels: Vec<u16>,
        scale: f32,
    ) -> Grid {
        let (places, voxels, majorants) = (places.into(), voxels.into(), Box::default());
        let (name, to_voxels) = (name.to_owned(), to_object.inverted());
        let mut grid = Grid { name, size, to_voxels, places, voxels, majorants, scale, origin: None };
        grid.majorants = grid.bounds_of_blocks();
        grid
    }

    /// A grid from what another one [stored](Grid::stored).
    ///
    /// # Errors
    /// When these are not the blocks of a grid of this size.
    pub fn of_stored(size: [usize; 3], to_object: &Transform, stored: Stored) -> Result<Grid, GridError> {
        let blocks = blocks_of(size)?;
        let Stored { places, voxels, scale } = stored;
        let count = places.iter().filter(|place| **place != EMPTY).count();
        let are_theirs = places.iter().all(|place| *place == EMPTY || (*place as usize) < count);
        let is_whole =
            places.len() == blocks.iter().product::<usize>() && voxels.len() == count * BLOCK_VOXELS;
        // The exponent of halves that are infinite or no numbers; a sign is beyond it.
        let are_numbers = voxels.iter().all(|half| *half < 0x7c00) && scale.is_finite() && scale > 0.0;
        if !(is_whole && are_theirs && are_numbers) {
            return Err(GridError::Stored);
        }
        Ok(Grid::of_blocks("", size, to_object, places.to_vec(), voxels.to_vec(), scale))
    }

    /// Contents of the grid, as they are stored.
    pub fn stored(&self) -> Stored<'_> {
        Stored { places: &self.places, voxels: &self.voxels, scale: self.scale }
    }

    /// Moves the voxels elsewhere: `to_object` maps their coordinates.
    pub fn placed(self, to_object: &Transform) -> Grid {
        Grid { to_voxels: to_object.inverted(), ..self }
    }

    /// Renames the grid.
    pub fn named(self, name: &str) -> Grid {
        Grid { name: name.to_owned(), ..self }
    }

    /// Records what the grid was made from.
    pub fn with_origin(self, origin: Origin) -> Grid {
        Grid { origin: Some(origin), ..self }
    }

    /// Origin of the grid, if that is known.
    pub fn origin(&self) -> Option<&Origin> {
        self.origin.as_ref()
    }

    /// The file that it came from, and the name there.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Voxels along x, y and z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// From voxel coordinates to the object that it fills.
    pub fn to_object(&self) -> Transform {
        self.to_voxels.inverted()
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.places) + size_of_val(&*self.voxels) + size_of_val(&*self.majorants)) as u64
    }

    /// Blocks that are stored.
    pub fn stored_blocks(&self) -> usize {
        self.voxels.len() / BLOCK_VOXELS
    }

    /// The largest value.
    pub fn maximum(&self) -> f32 {
        self.majorants.iter().copied().fold(0.0, f32::max)
    }

    /// The value of a voxel.
    #[inline]
    pub fn voxel(&self, [x, y, z]: [usize; 3]) -> f32 {
        let place = self.places[self.block_index([x / BLOCK, y / BLOCK, z / BLOCK])];
        if place == EMPTY { 0.0 } else { self.number(place, within(x, y, z)) }
    }

    /// The values of a block; `None` for zeros.
    pub fn block(&self, at: [usize; 3]) -> Option<Block> {
        let place = self.places[self.block_index(at)];
        (place != EMPTY).then(|| std::array::from_fn(|i| self.number(place, i)))
    }

    /// The line of a ray in an object, whose directions are per metre of the ray.
    pub fn line(&self, origin: Vec3, direction: Vec3) -> GridLine {
        GridLine { origin: self.to_voxels.point(origin), direction: self.to_voxels.vector(direction) }
    }

    /// The value after this distance along a line, in metres.
    #[inline]
    pub fn at(&self, line: &GridLine, distance: f32) -> f32 {
        self.look_up(line.origin + line.direction * distance)
    }

    /// The value at a point of the object.
    pub fn value(&self, p: Vec3) -> f32 {
        self.look_up(self.to_voxels.point(p))
    }

    /// The value at voxel coordinates: linear between the centres of voxels, as the outermost ones between these and the
    /// border, and 0 beyond.
    #[inline]
    fn look_up(&self, p: Vec3) -> f32 {
        // In here loops take the place of `array::map`, whose closures are called and not inlined.
        let [x, y, z] = self.size;
        let size = [x as f32, y as f32, z as f32];
        if !(p.cmpge(Vec3::ZERO).all() && p.cmple(Vec3::from(size)).all()) {
            return 0.0;
        }
        let (mut low, mut high, mut part) = ([0; 3], [0; 3], [0.0; 3]);
        for axis in 0..3 {
            let centred = (p[axis] - 0.5).clamp(0.0, size[axis] - 1.0);
            // Not negative, and below the number of voxels.
            low[axis] = centred as usize;
            high[axis] = (low[axis] + 1).min(self.size[axis] - 1);
            part[axis] = centred - low[axis] as f32;
        }
        let corners = self.corners(low, high);
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let along_x = |i: usize| lerp(corners[i], corners[i + 1], part[0]);
        let front = lerp(along_x(0), along_x(2), part[1]);
        let back = lerp(along_x(4), along_x(6), part[1]);
        lerp(front, back, part[2])
    }

    /// The voxels between `low` and `high`, x varying fastest.
    #[inline]
    fn corners(&self, low: [usize; 3], high: [usize; 3]) -> [f32; 8] {
        let block = |[x, y, z]: [usize; 3]| [x / BLOCK, y / BLOCK, z / BLOCK];
        let mut corners = [0.0; 8];
        if block(low) != block(high) {
            for (i, corner) in corners.iter_mut().enumerate() {
                let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
                *corner = self.voxel([pick(0), pick(1), pick(2)]);
            }
            return corners;
        }
        let place = self.places[self.block_index(block(low))];
        if place == EMPTY {
            return corners;
        }
        let first = within(low[0], low[1], low[2]);
        let step = [high[0] - low[0], (high[1] - low[1]) * BLOCK, (high[2] - low[2]) * BLOCK * BLOCK];
        for (i, corner) in corners.iter_mut().enumerate() {
            let [along_x, along_y, along_z] = [i & 1, i >> 1 & 1, i >> 2];
            *corner = self.number(place, first + along_x * step[0] + along_y * step[1] + along_z * step[2]);
        }
        corners
    }

    #[inline]
    fn number(&self, place: u32, index: usize) -> f32 {
        from_half(self.voxels[place as usize * BLOCK_VOXELS + index]) * self.scale
    }

    #[inline]
    fn block_index(&self, [x, y, z]: [usize; 3]) -> usize {
        let [nx, ny] = [self.size[0].div_ceil(BLOCK), self.size[1].div_ceil(BLOCK)];
        (z * ny + y) * nx + x
    }

    /// The majorant of each block: what lies between voxels is a mean of those on both sides, also of the neighbours.
    fn bounds_of_blocks(&self) -> Box<[f32]> {
        let blocks = self.size.map(|n| n.div_ceil(BLOCK));
        let [nx, ny, _] = blocks;
        let bound = |index: usize| {
            let at = [index % nx, index / nx % ny, index / (nx * ny)];
            from_half(self.largest_around(at, blocks)) * self.scale
        };
        let mut bounds = vec![0.0; self.places.len()];
        fill(&mut bounds, 1 << 8, bound);
        bounds.into()
    }

    /// The largest half of a block and of the voxels beside it. Halves without a sign are in the order of their bits.
    fn largest_around(&self, at: [usize; 3], blocks: [usize; 3]) -> u16 {
        let mut largest = 0;
        for step in all([3; 3]) {
            // One step back, none, or one ahead along each axis.
            let there = [0, 1, 2].map(|axis: usize| (at[axis] + step[axis]).wrapping_sub(1));
            if (0..3).any(|axis| there[axis] >= blocks[axis]) {
                continue;
            }
            let place = self.places[self.block_index(there)];
            if place == EMPTY {
                continue;
            }
            let block = &self.voxels[place as usize * BLOCK_VOXELS..][..BLOCK_VOXELS];
            let [xs, ys, zs] = step.map(|step| [BLOCK - 1..BLOCK, 0..BLOCK, 0..1][step].clone());
            for row in zs.flat_map(|z| ys.clone().map(move |y| within(0, y, z))) {
                largest = block[row..][xs.clone()].iter().copied().fold(largest, u16::max);
            }
        }
        largest
    }

    /// Copy with other majorants: larger ones, or wrong ones.
    #[cfg(test)]
    pub(crate) fn with_majorants_scaled(&self, factor: f32) -> Grid {
        Grid { majorants: self.majorants.iter().map(|bound| bound * factor).collect(), ..self.clone() }
    }

    /// Visits the blocks along a line, up to a length in metres: where it enters and leaves each of them, and their majorants, until
    /// `visit` returns false. Beyond the border the value is 0.
    #[inline]
    pub fn for_each_block(&self, line: &GridLine, length: f32, mut visit: impl FnMut(f32, f32, f32) -> bool) {
        for_each_block(self.size, line, length, |begin, end, block| {
            visit(begin, end, self.majorants[self.block_index(block)])
        });
    }
}

impl fmt::Debug for Grid {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Grid { name, size, .. } = self;
        let stored = self.stored_blocks();
        f.debug_struct("Grid").field("name", name).field("size", size).field("stored", &stored).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any values from 0 to 1, with a third of them zeros.
    fn noise(size: [usize; 3]) -> Vec<f32> {
        let count = size[0] * size[1] * size[2];
        let word = |i: usize| bilux_math::hash::mix64(i as u64);
        (0..count)
            .map(|i| if word(i).is_multiple_of(3) { 0.0 } else { (word(i) >> 40) as f32 / 16_777_216.0 })
            .collect()
    }

    fn grid(size: [usize; 3], values: &[f32]) -> Grid {
        Grid::dense("", size, &Transform::IDENTITY, values).unwrap()
    }

    #[test]
    fn voxels_are_what_was_given() {
        let size = [19, 8, 11];
        let values = noise(size);
        let grid = grid(size, &values);
        for (i, at) in all(size).enumerate() {
            assert!((grid.voxel(at) - values[i]).abs() <= values[i] / 2048.0, "{at:?}");
        }
        let huge: Vec<f32> = values.iter().map(|x| x * 1e20).collect();
        let grid = Grid::dense("", size, &Transform::IDENTITY, &huge).unwrap();
        assert!((grid.voxel([3, 1, 2]) - huge[2 * 8 * 19 + 19 + 3]).abs() <= 1e17);
    }

    /// All voxels at once give what block after block does, with the same bounds, whatever the factor on halves.
    #[test]
    fn all_voxels_at_once_are_blocks_in_turn() {
        let size = [19, 8, 10];
        for factor in [1.0, 1e6, 1e-6] {
            let numbers: Vec<f32> =
                noise(size).into_iter().map(|x| if x < 0.5 { 0.0 } else { x * factor }).collect();
            let empty = |x: usize, z: usize| x < 8 && z < 8;
            let value = |[x, y, z]: [usize; 3]| match numbers.get((z * size[1] + y) * size[0] + x) {
                Some(value) if x < size[0] && !empty(x, z) => *value,
                _ => 0.0,
            };
            let in_turn = Grid::new("", size, &Transform::IDENTITY, |at, block| {
                for (i, voxel) in block.iter_mut().enumerate() {
                    *voxel = value(
                        [0, 1, 2].map(|axis: usize| at[axis] * BLOCK + i / BLOCK.pow(axis as u32) % BLOCK),
                    );
                }
                block.iter().any(|value| *value != 0.0)
            });
            let places = (0..numbers.len()).map(|i| [i % 19, i / 19 % 8, i / (19 * 8)]);
            let at_once: Vec<f32> = places.map(value).collect();
            let in_turn = in_turn.unwrap();
            assert!(in_turn == Grid::dense("", size, &Transform::IDENTITY, &at_once).unwrap());
            assert!(in_turn.stored_blocks() < 6);
        }
    }

    #[test]
    fn between_voxels_values_are_linear_and_outside_zero() {
        let size = [17, 10, 9];
        // Trilinear interpolation repeats a function that is linear in each coordinate.
        let f = |p: Vec3| 1.0 + 0.25 * p.x + 0.5 * p.y * p.z;
        let values: Vec<f32> = all(size).map(|at| f(Vec3::from(at.map(|x| x as f32 + 0.5)))).collect();
        let place = Transform::scale(Vec3::splat(2.0)).unwrap();
        let grid = Grid::dense("", size, &place, &values).unwrap();
        for i in 0..1000 {
            let unit = |axis: u64| bilux_math::hash::unit_f32(bilux_math::hash::mix64(i * 3 + axis) as u32);
            let p = Vec3::new(unit(0), unit(1), unit(2)) * Vec3::new(16., 9., 8.) + 0.5;
            let value = grid.value(p * 2.0);
            assert!((value - f(p)).abs() < 2e-3 * f(p), "{value} at {p}");
        }
        assert_eq!(grid.value(Vec3::new(-0.01, 4.0, 4.0)), 0.0);
        assert_eq!(grid.value(Vec3::new(34.1, 4.0, 4.0)), 0.0);
        assert_eq!(grid.value(Vec3::new(0.0, 1.0, 1.0)), grid.voxel([0, 0, 0]));
        assert_eq!(grid.value(Vec3::splat(f32::NAN)), 0.0);
    }

    #[test]
    fn no_value_is_above_its_majorant_and_blocks_cover_the_line() {
        let size = [21, 30, 9];
        let grid = grid(size, &noise(size));
        for i in 0..300u64 {
            let unit = |axis: u64| bilux_math::hash::unit_f32(bilux_math::hash::mix64(i * 6 + axis) as u32);
            let from = Vec3::new(unit(0), unit(1), unit(2)) * 40.0 - 5.0;
            let mut to = Vec3::new(unit(3), unit(4), unit(5)) * 40.0 - 5.0;
            if i % 4 == 0 {
                to.x = from.x;
            }
            let line = grid.line(from, (to - from) * 0.1);
            let (mut last, mut length) = (None, 0.0);
            grid.for_each_block(&line, 10.0, |begin, end, majorant| {
                assert!(last.is_none_or(|last| last == begin) && begin <= end, "no gaps");
                last = Some(end);
                length += end - begin;
                for part in 0..=20 {
                    let value = grid.at(&line, begin + (end - begin) * part as f32 / 20.0);
                    assert!(value <= majorant * 1.000_001, "{value} above {majorant}");
                }
                true
            });
            let inside = (0..4000).filter(|k| {
                let p = from + (to - from) * (*k as f32 + 0.5) / 4000.0;
                p.cmpge(Vec3::ZERO).all() && p.cmple(Vec3::new(21., 30., 9.)).all()
            });
            assert!((length - inside.count() as f32 / 400.0).abs() < 0.01, "{length}");
        }
    }

    /// A single voxel, at each kind of corner of blocks: what is around it reaches into all blocks that meet there.
    #[test]
    fn the_majorants_of_blocks_know_the_voxels_at_their_corners() {
        let side = 3 * BLOCK;
        let places = [0, BLOCK - 1, BLOCK, 2 * BLOCK - 1, 2 * BLOCK, side - 1];
        for at in all([places.len(); 3]).map(|at| at.map(|i| places[i])) {
            let values: Vec<f32> = all([side; 3]).map(|here| if here == at { 0.7 } else { 0.0 }).collect();
            let grid = grid([side; 3], &values);
            let middle = Vec3::from(at.map(|i| i as f32 + 0.5));
            let mut seen = 0.0;
            for away in
                all([3; 3]).map(|away| Vec3::from(away.map(|i| i as f32 - 1.0)) + Vec3::new(0.1, 0.2, -0.15))
            {
                // Past the voxel, at less than its side.
                let from = middle + away * 9.0 + Vec3::new(0.3, -0.4, 0.2);
                let line = grid.line(from, -away * 2.0);
                grid.for_each_block(&line, 9.0, |begin, end, majorant| {
                    for part in 0..=40 {
                        let value = grid.at(&line, begin + (end - begin) * part as f32 / 40.0);
                        assert!(value <= majorant * 1.000_001, "{at:?}, {away}: {value} above {majorant}");
                        seen += value;
                    }
                    true
                });
            }
            assert!(seen > 0.1, "{at:?}: {seen}");
        }
    }

    #[test]
    fn zeros_take_no_space() {
        let at = |[x, y, z]: [usize; 3]| [x, y, z] == [3, 4, 5];
        let grid = Grid::new("", [1000; 3], &Transform::IDENTITY, |block, values| {
            values[0] = f32::from(u8::from(at(block)));
            at(block)
        });
        let grid = grid.unwrap();
        assert_eq!((grid.stored_blocks(), grid.maximum()), (1, 1.0));
        assert_eq!((grid.voxel([24, 32, 40]), grid.voxel([25, 32, 40])), (1.0, 0.0));
        assert!(grid.bytes() < 17_000_000);
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        let none = |size| Grid::dense("", size, &Transform::IDENTITY, &[]).unwrap_err();
        assert_eq!(none([0, 1, 1]), GridError::Size(0, 1, 1));
        assert!(matches!(none([1 << 16, 1 << 16, 1 << 16]), GridError::Size(..)));
        assert!(matches!(none([usize::MAX; 3]), GridError::Size(..)));
        assert_eq!(none([2, 1, 1]), GridError::Count { wanted: 2, found: 0 });
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            let grid = Grid::dense("", [2, 1, 1], &Transform::IDENTITY, &[0.0, bad]);
            assert_eq!(grid.unwrap_err(), GridError::Value(1, 0, 0));
        }
    }
}
