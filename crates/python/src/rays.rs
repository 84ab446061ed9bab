//! Rays from arrays, read where they are.

use crate::arrays::{self, Points, Rows};
use bilux::accel::Ray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::ops::Range;

/// The number of rays that one thread takes at a time.
pub(crate) const BATCH: usize = 1024;

/// Arrays of rays, checked for their shapes.
pub(crate) struct RayArrays<'py> {
    arrays: [Points<'py>; 2],
    names: [&'static str; 2],
    count: usize,
}

impl<'py> RayArrays<'py> {
    /// # Errors
    /// If one of them is no array (n, 3) of numbers, or they do not have as many rows, and neither has one for all.
    pub(crate) fn new(
        first: &Bound<'py, PyAny>,
        second: &Bound<'py, PyAny>,
        names: [&'static str; 2],
    ) -> PyResult<RayArrays<'py>> {
        let arrays = [arrays::points(names[0], first)?, arrays::points(names[1], second)?];
        let count = match (arrays[0].rows().len(), arrays[1].rows().len()) {
            (a, b) if a == b => a,
            (1, n) | (n, 1) => n,
            (a, b) => {
                return Err(PyValueError::new_err(format!(
                    "{}: there are {b} rows for {a} of {}: give as many, or one for all",
                    names[1], names[0]
                )));
            }
        };
        Ok(RayArrays { arrays, names, count })
    }

    /// The rays.
    pub(crate) fn rays(&self, range: [f32; 2], meaning: Meaning) -> Rays<'_> {
        let [first, second] = [self.arrays[0].rows(), self.arrays[1].rows()];
        Rays { first, second, count: self.count, range, meaning }
    }

    /// The exception for the first row that is not finite.
    pub(crate) fn not_finite(&self, rays: &Rays<'_>) -> PyErr {
        let bad = (0..rays.count).find(|&i| rays.ray(i).is_none()).unwrap_or_default();
        let numbers = [rays.first, rays.second].map(|rows| rows.shared(bad));
        let finite = |row: [f64; 3]| row.iter().all(|&x| (x as f32).is_finite());
        let which = usize::from(finite(numbers[0]));
        let row = if self.arrays[which].rows().len() == 1 { 0 } else { bad };
        arrays::not_finite(self.names[which], row, numbers[which])
    }
}

/// Meaning of the arrays of rays.
#[derive(Clone, Copy)]
pub(crate) enum Meaning {
    /// Origins and directions.
    Rays,
    /// Points that rays lead from, and to.
    Segments,
    /// Origins and directions, in the space of a mesh that was moved and scaled into a box.
    Placed(Placement),
}

/// Placement of a mesh in its box.
#[derive(Clone, Copy)]
pub(crate) struct Placement {
    /// Position that is subtracted from others.
    pub(crate) origin: [f64; 3],
    /// By what they are then multiplied.
    pub(crate) scale: f64,
}

impl Placement {
    /// A position in the box.
    pub(crate) fn place(&self, position: [f64; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| ((position[axis] - self.origin[axis]) * self.scale) as f32)
    }
}

/// A direction in 32-bit floats, of a length that they can hold.
fn in_singles(direction: [f64; 3]) -> [f32; 3] {
    let longest = direction.iter().fold(0.0, |longest: f64, x| longest.max(x.abs()));
    let ordinary = longest == 0.0 || (1e-6..1e6).contains(&longest);
    direction.map(|x| if ordinary { x as f32 } else { (x / longest) as f32 })
}

/// Not all numbers of a batch are finite.
pub(crate) struct NotFinite;

/// Rays.
#[derive(Clone, Copy)]
pub(crate) struct Rays<'a> {
    first: Rows<'a>,
    second: Rows<'a>,
    pub(crate) count: usize,
    range: [f32; 2],
    meaning: Meaning,
}

impl Rays<'_> {
    /// A ray; none if it is not finite.
    #[inline]
    fn ray(&self, i: usize) -> Option<Ray> {
        let (first, second) = (self.first.shared(i), self.second.shared(i));
        let single = |numbers: [f64; 3]| numbers.map(|x| x as f32);
        let (origin, direction) = match self.meaning {
            Meaning::Rays => (single(first), single(second)),
            Meaning::Segments => {
                (single(first), std::array::from_fn(|axis| (second[axis] - first[axis]) as f32))
            }
            Meaning::Placed(placement) => (placement.place(first), in_singles(second)),
        };
        let finite = origin.iter().chain(&direction).all(|x| x.is_finite());
        let [t_min, t_max] = self.range;
        finite.then_some(Ray { t_min, t_max, ..Ray::new(origin, direction) })
    }

    /// The origin and the direction as they were given.
    pub(crate) fn given(&self, i: usize) -> [[f64; 3]; 2] {
        [self.first.shared(i), self.second.shared(i)]
    }

    /// Fills a vector with some of the rays.
    pub(crate) fn batch(&self, which: Range<usize>, batch: &mut Vec<Ray>) -> Result<(), NotFinite> {
        batch.clear();
        for i in which {
            batch.push(self.ray(i).ok_or(NotFinite)?);
        }
        Ok(())
    }
}
