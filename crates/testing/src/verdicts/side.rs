//! One side of a comparison of means: pictures that differ in their seeds.

use super::hash::{Bits, Hash};
use std::cell::OnceCell;
use std::ops::Range;

/// One picture: the hash of its bits, and the sums of its cells that are compared.
#[derive(Clone, Debug)]
pub struct Picture {
    first: Hash,
    cells: Vec<f64>,
}

impl Picture {
    /// From all of its pixels, and its cells.
    pub fn new(pixels: &impl Bits, cells: Vec<f64>) -> Picture {
        Picture { first: Hash::of(pixels), cells }
    }
}

/// Pictures with these seeds, of which the first is rendered, and the others when somebody asks for them.
pub struct Side<'a> {
    render: Box<dyn Fn(u64) -> Picture + 'a>,
    seeds: Range<u64>,
    first: Picture,
    cells: OnceCell<Vec<Vec<f64>>>,
}

impl<'a> Side<'a> {
    /// Renders the first picture.
    pub fn new(seeds: Range<u64>, render: impl Fn(u64) -> Picture + 'a) -> Side<'a> {
        let first = render(seeds.start);
        Side { render: Box::new(render), seeds, first, cells: OnceCell::new() }
    }

    /// The hash of the first picture.
    pub(super) fn first(&self) -> Hash {
        self.first.first
    }

    /// The number of pictures.
    pub(super) fn count(&self) -> u64 {
        self.seeds.end.saturating_sub(self.seeds.start)
    }

    /// All pictures, `[cell][picture]`.
    pub fn cells(&self) -> &[Vec<f64>] {
        self.cells.get_or_init(|| {
            let mut cells: Vec<Vec<f64>> = self.first.cells.iter().map(|sum| vec![*sum]).collect();
            for seed in self.seeds.clone().skip(1) {
                let picture = (self.render)(seed);
                cells.iter_mut().zip(picture.cells).for_each(|(cell, sum)| cell.push(sum));
            }
            cells
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_rendered_when_somebody_asks_for_them() {
        let rendered = OnceCell::new();
        let side = Side::new(5..8, |seed| {
            if seed > 5 {
                let _ = rendered.set(seed);
            }
            Picture::new(&vec![seed as f32], vec![seed as f64, 2.0 * seed as f64])
        });
        assert_eq!((side.first(), side.count()), (Hash::of(&5.0f32), 3));
        assert_eq!(rendered.get(), None);
        assert_eq!(side.cells(), [[5.0, 6.0, 7.0], [10.0, 12.0, 14.0]]);
        assert_eq!(rendered.get(), Some(&6));
    }
}
