//! Rectangles of pixels, and which samples of them a film holds.

use std::fmt;
use std::ops::Range;

/// Side of a tile, in pixels.
pub(crate) const TILE: u32 = 16;

/// Distances between the pixels of the lattices of a [`Tiling::Spread`], the coarsest first.
pub(crate) const SPACINGS: [u32; 4] = [8, 4, 2, 1];

/// Division of a window for a pass over its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tiling {
    /// Square tiles with this side, row by row.
    Squares(u32),
    /// Lattices of pixels, each between those of the one before, so that those so far are spread evenly wherever the pass ends. A square of so many
    /// pixels of a lattice by so many is a tile.
    Spread(u32),
}

/// Some pixels of a window that are taken together: those whose column and row are multiples of `step`, but not both of `coarser`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    pub(crate) window: Window,
    pub(crate) step: u32,
    /// 0 where there is no coarser lattice.
    pub(crate) coarser: u32,
}

impl Tile {
    /// Columns and rows of its pixels, row by row.
    pub(crate) fn positions(self) -> impl Iterator<Item = (u32, u32)> {
        let Tile { window, step, coarser } = self;
        let multiples = move |from: u32, to: u64| {
            (from.next_multiple_of(step)..to.min(u64::from(u32::MAX)) as u32).step_by(step as usize)
        };
        let is_taken =
            move |x: u32, y: u32| coarser > 0 && x.is_multiple_of(coarser) && y.is_multiple_of(coarser);
        multiples(window.y, window.bottom())
            .flat_map(move |y| multiples(window.x, window.right()).map(move |x| (x, y)))
            .filter(move |&(x, y)| !is_taken(x, y))
    }

    /// Number of its pixels.
    pub(crate) fn pixels(self) -> usize {
        if self.step == 1 && self.coarser == 0 { self.window.pixels() } else { self.positions().count() }
    }
}

/// The finest lattice that is complete, where these tiles of a [`Tiling::Spread`] are done: its spacing.
pub(crate) fn finest_complete(tiles: &[Tile], done: &[bool]) -> Option<u32> {
    let is_complete = |step: &u32| tiles.iter().zip(done).all(|(tile, done)| tile.step < *step || *done);
    SPACINGS.into_iter().rev().find(is_complete)
}

/// A rectangle of pixels, in the coordinates of the whole film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Window {
    /// First column.
    pub x: u32,
    /// First row, counted downwards.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.x, self.y, self.width, self.height)
    }
}

impl Window {
    /// The window of a whole film.
    pub const fn whole(width: u32, height: u32) -> Window {
        Window { x: 0, y: 0, width, height }
    }

    /// The window of one pixel, at a column and row.
    pub const fn pixel((x, y): (u32, u32)) -> Window {
        Window { x, y, width: 1, height: 1 }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// True when it has no pixel.
    pub fn is_empty(&self) -> bool {
        self.width == 0 || self.height == 0
    }

    fn right(&self) -> u64 {
        u64::from(self.x) + u64::from(self.width)
    }

    fn bottom(&self) -> u64 {
        u64::from(self.y) + u64::from(self.height)
    }

    /// True when all of `other` lies within it.
    pub fn contains(&self, other: &Window) -> bool {
        let starts = other.x >= self.x && other.y >= self.y;
        starts && other.right() <= self.right() && other.bottom() <= self.bottom()
    }

    /// The common part; empty where they do not overlap.
    pub fn intersection(&self, other: &Window) -> Window {
        let (x, y) = (self.x.max(other.x), self.y.max(other.y));
        let width = self.right().min(other.right()).saturating_sub(u64::from(x)) as u32;
        let height = self.bottom().min(other.bottom()).saturating_sub(u64::from(y)) as u32;
        Window { x, y, width, height }
    }

    /// The smallest rectangle that contains both.
    pub fn union(&self, other: &Window) -> Window {
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        let width = (self.right().max(other.right()) - u64::from(x)) as u32;
        let height = (self.bottom().max(other.bottom()) - u64::from(y)) as u32;
        Window { x, y, width, height }
    }

    /// The index of a pixel, row by row; `None` where it lies outside.
    #[inline]
    pub fn index(&self, x: u32, y: u32) -> Option<usize> {
        let (column, row) = (x.wrapping_sub(self.x), y.wrapping_sub(self.y));
        (column < self.width && row < self.height)
            .then(|| row as usize * self.width as usize + column as usize)
    }

    /// The pixel at an index: column and row.
    pub fn position(&self, index: usize) -> (u32, u32) {
        let width = self.width as usize;
        (self.x + (index % width) as u32, self.y + (index / width) as u32)
    }

    /// The tiles of a pass over the window, in their order.
    pub(crate) fn divided(&self, tiling: Tiling) -> Vec<Tile> {
        let of_lattice = |(side, step, coarser): (u32, u32, u32)| {
            let tile = move |window| Tile { window, step, coarser };
            // A narrow window has no pixels of some lattices.
            let has_pixels = |tile: &Tile| tile.positions().next().is_some();
            self.tiles(side.saturating_mul(step)).into_iter().map(tile).filter(has_pixels)
        };
        match tiling {
            Tiling::Squares(side) => of_lattice((side, 1, 0)).collect(),
            Tiling::Spread(side) => {
                let coarser = std::iter::once(0).chain(SPACINGS);
                SPACINGS.into_iter().zip(coarser).flat_map(|(step, c)| of_lattice((side, step, c))).collect()
            }
        }
    }

    /// Square tiles with this side length that cover the window, row by row.
    pub fn tiles(&self, side: u32) -> Vec<Window> {
        let steps = |length: u32| (0..length.div_ceil(side)).map(move |i| i * side);
        let tile = |dx: u32, dy: u32| Window {
            x: self.x + dx,
            y: self.y + dy,
            width: side.min(self.width - dx),
            height: side.min(self.height - dy),
        };
        steps(self.height).flat_map(|dy| steps(self.width).map(move |dx| tile(dx, dy))).collect()
    }
}

/// Which samples of which pixels a film holds: windows with ranges, none of which overlap.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    pieces: Vec<(Window, Range<u32>)>,
}

impl Coverage {
    /// The pieces, in no particular order.
    pub fn pieces(&self) -> &[(Window, Range<u32>)] {
        &self.pieces
    }

    /// Adds a piece, merged with those that it continues.
    pub fn insert(&mut self, window: Window, samples: Range<u32>) {
        if window.is_empty() || samples.is_empty() {
            return;
        }
        let mut piece = (window, samples);
        while let Some(at) = self.pieces.iter().position(|other| united(other, &piece).is_some()) {
            let other = self.pieces.swap_remove(at);
            if let Some(both) = united(&other, &piece) {
                piece = both;
            }
        }
        self.pieces.push(piece);
    }

    /// Adds all pieces of another coverage.
    pub fn extend(&mut self, other: &Coverage) {
        for (window, samples) in &other.pieces {
            self.insert(*window, samples.clone());
        }
    }

    /// Part that this coverage lacks of these samples of a window.
    pub fn missing(&self, window: Window, samples: Range<u32>) -> Coverage {
        let mut left = vec![(window, samples)];
        for held in &self.pieces {
            left = left.into_iter().flat_map(|piece| without(piece, held)).collect();
        }
        let mut missing = Coverage::default();
        left.into_iter().for_each(|(window, samples)| missing.insert(window, samples));
        missing.pieces.sort_by_key(|(window, samples)| (samples.start, window.y, window.x));
        missing
    }

    /// Samples that both hold, if there are any.
    pub fn overlap(&self, other: &Coverage) -> Option<(Window, Range<u32>)> {
        self.pieces.iter().find_map(|a| other.pieces.iter().find_map(|b| shared(a, b)))
    }
}

type Piece = (Window, Range<u32>);

fn shared(a: &Piece, b: &Piece) -> Option<Piece> {
    let window = a.0.intersection(&b.0);
    let samples = a.1.start.max(b.1.start)..a.1.end.min(b.1.end);
    (!window.is_empty() && !samples.is_empty()).then_some((window, samples))
}

/// A piece without another: the samples before and after it, and the windows above, below and beside it.
fn without(piece: Piece, held: &Piece) -> Vec<Piece> {
    let Some((hole, taken)) = shared(&piece, held) else { return vec![piece] };
    let (window, samples) = piece;
    let side = |from: u32, to: u64| to.saturating_sub(u64::from(from)) as u32;
    let (below, right) = (hole.bottom() as u32, hole.right() as u32);
    let around = [
        Window { height: hole.y - window.y, ..window },
        Window { y: below, height: side(below, window.bottom()), ..window },
        Window { width: hole.x - window.x, ..Window { y: hole.y, height: hole.height, ..window } },
        Window { x: right, width: side(right, window.right()), y: hole.y, height: hole.height },
    ];
    let aside = [samples.start..taken.start, taken.end..samples.end].map(|range| (window, range));
    let beside = around.map(|window| (window, taken.clone()));
    let is_some = |(window, samples): &Piece| !window.is_empty() && !samples.is_empty();
    aside.into_iter().chain(beside).filter(is_some).collect()
}

/// Both pieces as one, where they fit together.
fn united(a: &Piece, b: &Piece) -> Option<Piece> {
    if a.0 == b.0 && (a.1.end == b.1.start || b.1.end == a.1.start) {
        return Some((a.0, a.1.start.min(b.1.start)..a.1.end.max(b.1.end)));
    }
    let beside = |a: &Window, b: &Window| {
        let same_rows = (a.y, a.height) == (b.y, b.height);
        let same_columns = (a.x, a.width) == (b.x, b.width);
        same_rows && a.right() == u64::from(b.x) || same_columns && a.bottom() == u64::from(b.y)
    };
    (a.1 == b.1 && (beside(&a.0, &b.0) || beside(&b.0, &a.0))).then(|| (a.0.union(&b.0), a.1.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        let window = Window { x: 3, y: 5, width: 37, height: 18 };
        let mut seen = vec![0; window.pixels()];
        for tile in window.tiles(16) {
            for i in 0..tile.pixels() {
                let (x, y) = tile.position(i);
                seen[window.index(x, y).unwrap()] += 1;
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
    }

    /// Every pixel once, and of each lattice those in between that the coarser ones left out.
    #[test]
    fn lattices_take_every_pixel_once_and_are_spread_evenly() {
        let window = Window { x: 3, y: 5, width: 37, height: 18 };
        let tiles = window.divided(Tiling::Spread(2));
        let mut seen = vec![0; window.pixels()];
        for tile in &tiles {
            assert_eq!(tile.positions().count(), tile.pixels());
            for (x, y) in tile.positions() {
                seen[window.index(x, y).unwrap()] += 1;
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
        assert!(tiles.is_sorted_by_key(|tile| std::cmp::Reverse(tile.step)));
        // With all tiles of 8 and of 4 done, and one of 2.
        let first = tiles.iter().position(|tile| tile.step == 2).unwrap();
        let done: Vec<bool> = (0..tiles.len()).map(|i| i <= first).collect();
        assert_eq!(finest_complete(&tiles, &done), Some(4));
        assert_eq!(finest_complete(&tiles, &vec![true; tiles.len()]), Some(1));
        assert_eq!(finest_complete(&tiles, &vec![false; tiles.len()]), None);
        let of_four = tiles[..first].iter().flat_map(|tile| tile.positions());
        let mut of_four: Vec<(u32, u32)> = of_four.collect();
        of_four.sort_unstable();
        let wanted = (4..40).step_by(4).flat_map(|x| (8..23).step_by(4).map(move |y| (x, y)));
        assert_eq!(of_four, wanted.collect::<Vec<_>>());
    }

    #[test]
    fn pieces_that_fit_become_one() {
        let whole = Window::whole(40, 33);
        let mut coverage = Coverage::default();
        for tile in whole.tiles(8) {
            coverage.insert(tile, 0..2);
        }
        coverage.insert(whole, 5..9);
        coverage.insert(whole, 2..5);
        assert_eq!(coverage.pieces(), &[(whole, 0..9)]);
    }

    #[test]
    fn overlaps_are_found() {
        let [mut a, mut b] = [Coverage::default(), Coverage::default()];
        a.insert(Window { x: 0, y: 0, width: 5, height: 5 }, 0..4);
        b.insert(Window { x: 5, y: 0, width: 5, height: 5 }, 0..4);
        b.insert(Window { x: 0, y: 0, width: 5, height: 5 }, 4..8);
        assert_eq!(a.overlap(&b), None);
        b.insert(Window { x: 4, y: 4, width: 1, height: 3 }, 3..9);
        assert_eq!(a.overlap(&b), Some((Window { x: 4, y: 4, width: 1, height: 1 }, 3..4)));
    }

    /// Against a count of each sample of each pixel: what a coverage lacks and what it holds are together everything, once.
    #[test]
    fn what_is_missing_is_all_that_is_not_there() {
        let (whole, samples) = (Window::whole(7, 5), 0..6);
        let mut held = Coverage::default();
        for (x, y, width, height, from, to) in
            [(0, 0, 7, 5, 0, 1), (2, 1, 3, 2, 1, 4), (0, 4, 7, 1, 2, 9), (6, 0, 1, 1, 5, 6)]
        {
            held.insert(Window { x, y, width, height }, from..to);
        }
        let missing = held.missing(whole, samples.clone());
        let count = |coverage: &Coverage, x, y, sample| {
            let has = |(window, range): &&Piece| window.index(x, y).is_some() && range.contains(&sample);
            coverage.pieces().iter().filter(has).count()
        };
        for (x, y) in (0..whole.pixels()).map(|i| whole.position(i)) {
            for sample in samples.clone() {
                let counts = [&held, &missing].map(|coverage| count(coverage, x, y, sample));
                assert_eq!(counts[0] + counts[1], 1, "sample {sample} of {x},{y}");
            }
        }
        assert!(missing.overlap(&held).is_none());
        held.extend(&missing);
        assert!(held.missing(whole, samples).pieces().is_empty());
    }
}
