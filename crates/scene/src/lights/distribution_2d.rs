//! A piecewise-constant distribution over the cells of a grid: first a row, then a cell of it. [pbrt 2023, A.5]

use super::guide;
use bilux_math::Vec2;

/// The probability of each cell; empty if there are no rows. Rows and columns are at most `u16::MAX`.
#[derive(Default)]
pub(super) struct Distribution2d {
    rows: Sums,
    /// The cells of each row, one row after the other.
    cells: Sums,
    columns: usize,
}

/// Sums of probabilities, each over an item and those before it, with a guide to search them.
#[derive(Default)]
struct Sums {
    sums: Vec<f64>,
    guide: Vec<u16>,
}

/// Number of points that are chosen at a time.
pub(super) const MANY: usize = 64;

/// A cell, and a position within it, 0..=1 from the left and from the top.
#[derive(Clone, Copy, Default)]
pub(super) struct Cell {
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) right: f64,
    pub(super) down: f64,
}

impl Distribution2d {
    /// Probabilities in proportion to the cells' values; empty if all of them are zero.
    pub(super) fn new(cells: &[f64], columns: usize) -> Distribution2d {
        let (mut rows, mut inner) = (Vec::new(), Sums::default());
        let mut row_sum = 0.0;
        for cells in cells.chunks_exact(columns) {
            let begin = inner.sums.len();
            let mut sum = 0.0;
            for cell in cells {
                sum += cell;
                inner.sums.push(sum);
            }
            if sum > 0.0 {
                inner.sums[begin..].iter_mut().for_each(|c| *c /= sum);
            }
            inner.guide.extend(guide::guide(&inner.sums[begin..]).map(|i| i as u16));
            row_sum += sum;
            rows.push(row_sum);
        }
        if row_sum <= 0.0 {
            return Distribution2d::default();
        }
        rows.iter_mut().for_each(|r| *r /= row_sum);
        let guide = guide::guide(&rows).map(|i| i as u16).collect();
        Distribution2d { rows: Sums { sums: rows, guide }, cells: inner, columns }
    }

    /// True when it can pick no cell.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.rows.sums.is_empty()
    }

    /// The probability of a cell.
    #[inline]
    pub(super) fn probability(&self, row: usize, column: usize) -> f64 {
        let of_cell = share(&self.cells.sums[row * self.columns..][..self.columns], column);
        share(&self.rows.sums, row) * of_cell
    }

    /// The cell that a point of the unit square picks.
    #[inline]
    pub(super) fn choose(&self, u: Vec2) -> Cell {
        let (row, down) = choose(&self.rows.sums, &self.rows.guide, u.y);
        let of_row = row * self.columns..(row + 1) * self.columns;
        let (column, right) = choose(&self.cells.sums[of_row.clone()], &self.cells.guide[of_row], u.x);
        Cell { row, column, right, down }
    }

    /// [`Distribution2d::choose`] for up to [`MANY`] points. What all of them read comes first, and then the searches, whose
    /// branches nobody can predict: so reads that miss the caches overlap.
    pub(super) fn choose_each(&self, points: &[Vec2], cells: &mut [Cell; MANY]) {
        let mut begins = [0; MANY];
        for (cell, u) in cells.iter_mut().zip(points) {
            (cell.row, cell.down) = choose(&self.rows.sums, &self.rows.guide, u.y);
        }
        let of_row = |cell: &Cell| cell.row * self.columns..(cell.row + 1) * self.columns;
        for ((begin, cell), u) in begins.iter_mut().zip(&*cells).zip(points) {
            *begin = guide::begin(&self.cells.guide[of_row(cell)], u.x);
        }
        for ((begin, cell), _) in begins.iter().zip(&*cells).zip(points) {
            std::hint::black_box(self.cells.sums[of_row(cell)].get(*begin).copied());
        }
        for ((begin, cell), u) in begins.iter().zip(cells).zip(points) {
            (cell.column, cell.right) = choose_from(&self.cells.sums[of_row(cell)], *begin, u.x);
        }
    }
}

#[inline]
fn share(sums: &[f64], i: usize) -> f64 {
    sums[i] - if i == 0 { 0.0 } else { sums[i - 1] }
}

/// The interval that a number picks, and the number's position within it.
#[inline]
fn choose(sums: &[f64], guide: &[u16], u: f32) -> (usize, f64) {
    choose_from(sums, guide::begin(guide, u), u)
}

/// [`choose`] from where the search begins.
#[inline]
fn choose_from(sums: &[f64], begin: usize, u: f32) -> (usize, f64) {
    let u = f64::from(u);
    let i = guide::find_from(sums, begin, u);
    let (share, end) = (share(sums, i), sums[i]);
    (i, if share > 0.0 { (1.0 - (end - u) / share).clamp(0.0, 1.0) } else { 0.5 })
}
