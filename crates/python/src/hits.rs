//! Hits of many rays, found on all cores.

use crate::output::Output;
use crate::rays::{BATCH, NotFinite, Rays};
use bilux::accel::{Accelerator, Hit, Query, Ray};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use std::ops::Range;

/// Arrays for hits, one for each property.
pub(crate) struct HitArrays<'py> {
    t: Output<'py, f32>,
    primitive: Output<'py, i64>,
    u: Output<'py, f32>,
    v: Output<'py, f32>,
    point: Output<'py, f32>,
    normal: Output<'py, f32>,
}

/// Columns of [`HitArrays`].
pub(crate) struct Columns<'a> {
    pub(crate) t: &'a mut [f32],
    pub(crate) primitive: &'a mut [i64],
    pub(crate) u: &'a mut [f32],
    pub(crate) v: &'a mut [f32],
    pub(crate) point: &'a mut [[f32; 3]],
    pub(crate) normal: &'a mut [[f32; 3]],
}

impl<'py> HitArrays<'py> {
    pub(crate) fn new(py: Python<'py>, count: usize) -> PyResult<HitArrays<'py>> {
        Ok(HitArrays {
            t: Output::column(py, count)?,
            primitive: Output::column(py, count)?,
            u: Output::column(py, count)?,
            v: Output::column(py, count)?,
            point: Output::rows(py, count)?,
            normal: Output::rows(py, count)?,
        })
    }

    pub(crate) fn columns(&mut self) -> Columns<'_> {
        Columns {
            t: self.t.numbers(),
            primitive: self.primitive.numbers(),
            u: self.u.numbers(),
            v: self.v.numbers(),
            point: self.point.triples(),
            normal: self.normal.triples(),
        }
    }

    pub(crate) fn into_python(self) -> Vec<Bound<'py, PyAny>> {
        let HitArrays { t, primitive, u, v, point, normal } = self;
        let [t, u, v, point, normal] = [t, u, v, point, normal].map(Output::into_python);
        vec![t, primitive.into_python(), u, v, point, normal]
    }
}

/// An array (n, 3).
pub(crate) fn rows<T: numpy::Element>(py: Python<'_>, rows: Vec<[T; 3]>) -> PyResult<Bound<'_, PyAny>> {
    let count = rows.len();
    Ok(PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])?.into_any())
}

/// Buffers that a thread uses again for each batch of rays.
#[derive(Default)]
pub(crate) struct Buffers {
    pub(crate) rays: Vec<Ray>,
    pub(crate) hits: Vec<Option<Hit>>,
}

impl Buffers {
    /// Finds the nearest hits of the rays.
    pub(crate) fn closest(&mut self, structure: &dyn Accelerator, query: &Query<'_>) {
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        structure.closest_hits(&self.rays, query, &mut self.hits);
    }
}

/// Finds the nearest hit of each ray. `normals` are those of the triangles.
pub(crate) fn closest(
    structure: &dyn Accelerator,
    normals: &[[f32; 3]],
    rays: &Rays<'_>,
    query: &Query<'_>,
    columns: Columns<'_>,
) -> Result<(), NotFinite> {
    let Columns { t, primitive, u, v, point, normal } = columns;
    let batches = (
        t.par_chunks_mut(BATCH),
        primitive.par_chunks_mut(BATCH),
        u.par_chunks_mut(BATCH),
        v.par_chunks_mut(BATCH),
        point.par_chunks_mut(BATCH),
        normal.par_chunks_mut(BATCH),
    );
    batches.into_par_iter().enumerate().try_for_each_init(
        Buffers::default,
        |buffers, (batch, (t, primitive, u, v, point, normal))| {
            rays.batch(batch * BATCH..batch * BATCH + t.len(), &mut buffers.rays)?;
            buffers.closest(structure, query);
            for (i, (ray, hit)) in buffers.rays.iter().zip(&buffers.hits).enumerate() {
                match hit {
                    Some(hit) => {
                        (t[i], primitive[i], u[i], v[i]) = (hit.t, i64::from(hit.primitive), hit.u, hit.v);
                        (point[i], normal[i]) = (hit.point(ray), normals[hit.primitive as usize]);
                    }
                    None => {
                        (t[i], primitive[i], u[i], v[i]) = (f32::INFINITY, -1, 0.0, 0.0);
                        (point[i], normal[i]) = ([f32::NAN; 3], [f32::NAN; 3]);
                    }
                }
            }
            Ok(())
        },
    )
}

/// Finds the triangle that each ray hits first; -1 where it hits none.
pub(crate) fn first(
    structure: &dyn Accelerator,
    rays: &Rays<'_>,
    first: &mut [i64],
) -> Result<(), NotFinite> {
    first.par_chunks_mut(BATCH).enumerate().try_for_each_init(Buffers::default, |buffers, (batch, first)| {
        rays.batch(batch * BATCH..batch * BATCH + first.len(), &mut buffers.rays)?;
        buffers.closest(structure, &Query::default());
        for (first, hit) in first.iter_mut().zip(&buffers.hits) {
            *first = hit.map_or(-1, |hit| i64::from(hit.primitive));
        }
        Ok(())
    })
}

/// Finds whether each ray hits anything.
pub(crate) fn any(
    structure: &dyn Accelerator,
    rays: &Rays<'_>,
    query: &Query<'_>,
    hits: &mut [bool],
) -> Result<(), NotFinite> {
    hits.par_chunks_mut(BATCH).enumerate().try_for_each_init(Vec::new, |buffer, (batch, hits)| {
        rays.batch(batch * BATCH..batch * BATCH + hits.len(), buffer)?;
        structure.any_hits(buffer, query, hits);
        Ok(())
    })
}

/// All hits of a batch of rays: the numbers of the rays, and the hits, with their points.
#[derive(Default)]
pub(crate) struct AllHits {
    numbers: Vec<i64>,
    hits: Vec<(Hit, [f32; 3])>,
}

/// Finds all hits of each ray.
pub(crate) fn all(
    structure: &dyn Accelerator,
    rays: &Rays<'_>,
    query: &Query<'_>,
) -> Result<Vec<AllHits>, NotFinite> {
    in_batches(rays.count, |which, (batch, hits): &mut (Vec<Ray>, Vec<Hit>)| {
        rays.batch(which.clone(), batch)?;
        let mut all = AllHits::default();
        for (number, ray) in which.zip(batch) {
            structure.all_hits_into(ray, query, hits);
            all.numbers.extend(hits.iter().map(|_| number as i64));
            all.hits.extend(hits.iter().map(|hit| (*hit, hit.point(ray))));
        }
        Ok(all)
    })
}

impl AllHits {
    /// Number of hits in all parts.
    pub(crate) fn count(parts: &[AllHits]) -> usize {
        parts.iter().map(|part| part.hits.len()).sum()
    }

    /// Writes them into arrays.
    pub(crate) fn write(
        parts: &[AllHits],
        normals: &[[f32; 3]],
        numbers: &mut [i64],
        columns: &mut Columns<'_>,
    ) {
        let hits = |part: &AllHits| part.hits.len();
        fill(parts, numbers, hits, |part, i| part.numbers[i]);
        fill(parts, columns.t, hits, |part, i| part.hits[i].0.t);
        fill(parts, columns.primitive, hits, |part, i| i64::from(part.hits[i].0.primitive));
        fill(parts, columns.u, hits, |part, i| part.hits[i].0.u);
        fill(parts, columns.v, hits, |part, i| part.hits[i].0.v);
        fill(parts, columns.point, hits, |part, i| part.hits[i].1);
        fill(parts, columns.normal, hits, |part, i| normals[part.hits[i].0.primitive as usize]);
    }
}

/// Results of all threads for batches of rays, in the order of the batches.
pub(crate) fn in_batches<B: Default, T: Send>(
    count: usize,
    find: impl Fn(Range<usize>, &mut B) -> Result<T, NotFinite> + Sync,
) -> Result<Vec<T>, NotFinite> {
    let which = |batch: usize| batch * BATCH..count.min((batch + 1) * BATCH);
    let batches = (0..count.div_ceil(BATCH)).into_par_iter();
    batches.map_init(B::default, |buffers, batch| find(which(batch), buffers)).collect()
}

/// Fills a column with what all parts have, one after the other: `count` elements of each, by their number.
pub(crate) fn fill<P: Sync, T: Send>(
    parts: &[P],
    column: &mut [T],
    count: impl Fn(&P) -> usize,
    element: impl Fn(&P, usize) -> T + Sync,
) {
    let mut places = Vec::with_capacity(parts.len());
    let mut rest = column;
    for part in parts {
        let (place, after) = rest.split_at_mut(count(part));
        places.push((place, part));
        rest = after;
    }
    places.into_par_iter().for_each(|(place, part)| {
        for (i, into) in place.iter_mut().enumerate() {
            *into = element(part, i);
        }
    });
}
