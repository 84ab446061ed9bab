//! Writes grids beside scenes.

use super::npy;
use crate::output::writing::Writing;
use bilux_scene::media::Grid;
use std::sync::Arc;

/// The largest number of voxels of a grid that is written: 1 GiB of halves.
const MAX_VOXELS: usize = 1 << 29;

/// The file name of a grid next to the scene, written on first use; `None` for one of so many voxels, most of them empty, that
/// nobody would want the file.
pub fn file_of(grid: &Arc<Grid>, writing: &mut Writing) -> Option<String> {
    if let Some((_, name)) = writing.grids.iter().find(|(known, _)| Arc::ptr_eq(known, grid)) {
        return Some(name.clone());
    }
    let voxels: usize = grid.size().iter().product();
    if voxels > MAX_VOXELS {
        writing.warn(format!(
            "the grid '{}' has {voxels} voxels, and at most {MAX_VOXELS} are written: it is left out",
            grid.name()
        ));
        return None;
    }
    let name = writing.add_numbered("grid", writing.grids.len() + 1, "npy", npy::write(grid));
    writing.grids.push((grid.clone(), name.clone()));
    Some(name)
}
