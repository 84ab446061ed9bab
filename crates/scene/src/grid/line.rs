//! Straight lines through the blocks of a grid. [Amanatides 1987]

use super::blocks::BLOCK;
use bilux_math::Vec3;

/// A straight line through the voxels of a grid.
#[derive(Clone, Copy, Debug)]
pub struct GridLine {
    /// Start of the line, in voxels.
    pub(super) origin: Vec3,
    /// Voxels per metre along each axis.
    pub(super) direction: Vec3,
}

impl GridLine {
    /// Voxels that a metre of it is long.
    pub fn voxels_per_metre(&self) -> f32 {
        self.direction.length()
    }
}

/// Visits the blocks of a grid of this many voxels along a line, up to a length in metres: where it enters and leaves each of them, and
/// their coordinates in blocks, until `visit` returns false.
#[inline]
pub(super) fn for_each_block(
    voxels: [usize; 3],
    line: &GridLine,
    length: f32,
    mut visit: impl FnMut(f32, f32, [usize; 3]) -> bool,
) {
    let size = Vec3::from(voxels.map(|n| n as f32));
    let Some([begin, end]) = inside(line, size, length) else { return };
    let start = line.origin + line.direction * begin;
    let blocks = voxels.map(|n| n.div_ceil(BLOCK));
    let (mut at, mut next, mut step) = ([0; 3], [f32::INFINITY; 3], [0.0; 3]);
    for axis in 0..3 {
        let block = (start[axis].max(0.0) / BLOCK as f32) as usize;
        at[axis] = block.min(blocks[axis] - 1);
        let towards = line.direction[axis];
        if towards != 0.0 {
            let border = (at[axis] + usize::from(towards > 0.0)) * BLOCK;
            next[axis] = (border as f32 - line.origin[axis]) / towards;
            step[axis] = BLOCK as f32 / towards.abs();
        }
    }
    let mut t = begin;
    loop {
        let axis = if next[0] <= next[1] && next[0] <= next[2] {
            0
        } else if next[1] <= next[2] {
            1
        } else {
            2
        };
        let leave = next[axis].min(end).max(t);
        if !visit(t, leave, at) || next[axis] >= end {
            return;
        }
        t = leave;
        next[axis] += step[axis];
        let beyond = if line.direction[axis] > 0.0 { at[axis] + 1 } else { at[axis].wrapping_sub(1) };
        if beyond >= blocks[axis] {
            return;
        }
        at[axis] = beyond;
    }
}

/// The part of a line, up to this length, inside a box from zero; `None` where it passes by.
#[inline]
fn inside(line: &GridLine, size: Vec3, length: f32) -> Option<[f32; 2]> {
    let (mut begin, mut end) = (0.0f32, length);
    for axis in 0..3 {
        let (origin, towards) = (line.origin[axis], line.direction[axis]);
        if towards == 0.0 {
            if !(0.0..=size[axis]).contains(&origin) {
                return None;
            }
            continue;
        }
        let [a, b] = [-origin / towards, (size[axis] - origin) / towards];
        begin = begin.max(a.min(b));
        end = end.min(a.max(b));
    }
    (begin < end).then_some([begin, end])
}
