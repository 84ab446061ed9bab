//! The part of a film that has the samples of a pass, complete or not.

use crate::film::window::{Coverage, Tile, Tiling, Window, finest_complete};
use std::ops::Range;

/// A pass over a window, of whose tiles some are done.
#[derive(Clone, Copy)]
pub(super) struct Ending<'a> {
    pub(super) tiling: Tiling,
    pub(super) tiles: &'a [Tile],
    pub(super) done: &'a [bool],
}

impl Ending<'_> {
    /// The windows of which all pixels have the samples of the pass.
    pub(super) fn covered(self, window: Window, samples: &Range<u32>) -> Coverage {
        let mut covered = Coverage::default();
        if !self.done.contains(&false) {
            covered.insert(window, samples.clone());
            return covered;
        }
        // While coarser lattices are taken, no window has all of its pixels.
        let is_of_finest = !self.is_spread() || self.spacing() == Some(2);
        let whole = self.tiles.iter().zip(self.done).filter(|(tile, done)| **done && tile.step == 1);
        for (tile, _) in whole.filter(|_| is_of_finest) {
            covered.insert(tile.window.intersection(&window), samples.clone());
        }
        covered
    }

    /// The spacing of the finest complete lattice, if the pixels are spread and not all have their samples.
    pub(super) fn spacing(self) -> Option<u32> {
        finest_complete(self.tiles, self.done).filter(|spacing| self.is_spread() && *spacing > 1)
    }

    /// The light subpaths that have arrived, and all of them, where each pixel has one.
    pub(super) fn arrived(self) -> [usize; 2] {
        let all = self.tiles.iter().map(|tile| tile.pixels());
        let arrived = all.clone().zip(self.done).filter(|(_, done)| **done).map(|(pixels, _)| pixels).sum();
        [arrived, all.sum()]
    }

    /// True where pixels are spread, and none is sure to have its samples.
    pub(super) fn is_too_short(self) -> bool {
        self.is_spread() && self.done.contains(&false) && self.spacing().is_none()
    }

    fn is_spread(self) -> bool {
        matches!(self.tiling, Tiling::Spread(_))
    }
}
