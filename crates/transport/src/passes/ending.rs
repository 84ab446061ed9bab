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

#[cfg(test)]
mod tests {
    use super::*;

    /// The pieces that are stated, the spacing, and whether the time was too short.
    type Ended = (Vec<(Window, Range<u32>)>, Option<u32>, bool);

    /// Ended after so many tiles of 32 x 16 pixels in squares of two by two pixels of each lattice.
    fn ended(tiling: Tiling, after: impl Fn(&[Tile]) -> usize) -> Ended {
        let window = Window::whole(32, 16);
        let tiles = window.divided(tiling);
        let count = after(&tiles);
        let done: Vec<bool> = (0..tiles.len()).map(|i| i < count).collect();
        let ending = Ending { tiling, tiles: &tiles, done: &done };
        (ending.covered(window, &(2..5)).pieces().to_vec(), ending.spacing(), ending.is_too_short())
    }

    #[test]
    fn a_film_states_windows_of_which_all_pixels_are_taken() {
        let spread = Tiling::Spread(2);
        let first_of =
            |step: u32| move |tiles: &[Tile]| tiles.iter().position(|tile| tile.step == step).unwrap();
        assert_eq!(ended(spread, |_| 1), (Vec::new(), None, true));
        assert_eq!(ended(spread, first_of(4)), (Vec::new(), Some(8), false));
        assert_eq!(ended(spread, |tiles| first_of(1)(tiles) - 1), (Vec::new(), Some(4), false));
        let three = Window { x: 0, y: 0, width: 6, height: 2 };
        assert_eq!(ended(spread, |tiles| first_of(1)(tiles) + 3), (vec![(three, 2..5)], Some(2), false));
        let whole = vec![(Window::whole(32, 16), 2..5)];
        assert_eq!(ended(spread, <[Tile]>::len), (whole.clone(), None, false));
        assert_eq!(ended(Tiling::Squares(2), |_| 3), (vec![(three, 2..5)], None, false));
        assert_eq!(ended(Tiling::Squares(2), <[Tile]>::len), (whole, None, false));
    }

    #[test]
    fn light_subpaths_are_counted_by_pixels() {
        let (tiling, window) = (Tiling::Spread(2), Window::whole(32, 16));
        let tiles = window.divided(tiling);
        // All of the coarsest lattice, 4 x 2 pixels, and one tile of the next, whose four pixels lack one that was taken.
        let coarsest = tiles.iter().filter(|tile| tile.step == 8).count();
        let done: Vec<bool> = (0..tiles.len()).map(|i| i <= coarsest).collect();
        assert_eq!(Ending { tiling, tiles: &tiles, done: &done }.arrived(), [11, 512]);
    }
}
