//! Tracks which pixels are still open, by tiles.

use crate::screen::Rect;

/// Pixels along a tile's side.
const TILE: usize = 16;

/// Counts the open pixels of each tile.
#[derive(Debug)]
pub(crate) struct Coverage {
    columns: usize,
    width: usize,
    open_in_tile: Vec<u16>,
    covered: Vec<bool>,
    open: usize,
}

impl Coverage {
    pub(crate) fn new(width: usize, height: usize) -> Coverage {
        let columns = width.div_ceil(TILE);
        let mut coverage = Coverage {
            columns,
            width,
            open_in_tile: vec![0; columns * height.div_ceil(TILE)],
            covered: vec![false; width * height],
            open: width * height,
        };
        for pixel in 0..width * height {
            let tile = coverage.tile(pixel);
            coverage.open_in_tile[tile] += 1;
        }
        coverage
    }

    fn tile(&self, pixel: usize) -> usize {
        (pixel / self.width / TILE) * self.columns + pixel % self.width / TILE
    }

    /// Closes a pixel; closing it again changes nothing.
    #[inline]
    pub(crate) fn cover(&mut self, pixel: usize) {
        if !std::mem::replace(&mut self.covered[pixel], true) {
            let tile = self.tile(pixel);
            self.open_in_tile[tile] -= 1;
            self.open -= 1;
        }
    }

    /// True when no pixel is open.
    pub(crate) fn is_full(&self) -> bool {
        self.open == 0
    }

    /// True when no pixel of a rectangle is open.
    pub(crate) fn covers(&self, rect: Rect) -> bool {
        if rect.is_empty() || self.is_full() {
            return true;
        }
        let tiles = |(first, end): (usize, usize)| first / TILE..end.div_ceil(TILE);
        tiles(rect.y).all(|row| {
            tiles(rect.x).all(|column| {
                self.open_in_tile[row * self.columns + column] == 0
                    || self.covers_within(rect, column * TILE, row * TILE)
            })
        })
    }

    fn covers_within(&self, rect: Rect, x: usize, y: usize) -> bool {
        (y.max(rect.y.0)..(y + TILE).min(rect.y.1)).all(|y| {
            let row = y * self.width;
            self.covered[row + x.max(rect.x.0)..row + (x + TILE).min(rect.x.1)].iter().all(|&c| c)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_covered_when_each_of_its_pixels_is() {
        let mut coverage = Coverage::new(40, 20);
        let rect = Rect { x: (3, 35), y: (2, 18) };
        for y in 2..18 {
            for x in 3..35 {
                assert!(!coverage.covers(rect));
                coverage.cover(y * 40 + x);
                coverage.cover(y * 40 + x);
            }
        }
        assert!(coverage.covers(rect));
        assert!(!coverage.covers(Rect { x: (2, 35), y: (2, 18) }));
        assert!(!coverage.covers(Rect { x: (3, 35), y: (2, 19) }));
        assert!(coverage.covers(Rect { x: (5, 5), y: (0, 20) }));
        assert!(!coverage.is_full());
    }
}
