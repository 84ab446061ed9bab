//! The corners of polygons. In the file the last corner of each is stored as its complement.

use crate::fbx::tree::Node;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::{Polygons, Workshop};

pub(super) fn read(node: Node, positions: usize, workshop: &mut Workshop) -> Result<Polygons, FormatError> {
    let indices: Vec<i32> = node.numbers(workshop.budget)?;
    let ends = indices.iter().filter(|&&index| index < 0).count();
    workshop.budget.take_bytes(4 * (ends + 1 + indices.len()) as u64, node.file())?;
    let mut polygons = Polygons::with_capacity(indices.len(), ends + 1);
    let (mut start, mut is_whole) = (0, true);
    let last = indices.len().saturating_sub(1);
    for (corner, &index) in indices.iter().enumerate() {
        let is_end = index < 0 || corner == last;
        let position = if index < 0 { !index } else { index } as u32;
        is_whole &= (position as usize) < positions;
        polygons.corners.push(if (position as usize) < positions { position } else { 0 });
        if is_end {
            polygons.end(start, is_whole, || node.at(), workshop, node.file())?;
            (start, is_whole) = (corner + 1, true);
        }
    }
    workshop.budget.release(4 * indices.len() as u64);
    if positions == 0 {
        return Ok(Polygons::default());
    }
    Ok(polygons)
}
