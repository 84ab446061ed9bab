//! Hits of many rays, found on all cores.

use crate::rays::{BATCH, NotFinite, Rays};
use bilux::accel::{Accelerator, Hit, Query, Ray};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

/// The hits of some rays, one column for each property.
#[derive(Default)]
pub(crate) struct Columns {
    pub(crate) t: Vec<f32>,
    pub(crate) primitive: Vec<i64>,
    pub(crate) u: Vec<f32>,
    pub(crate) v: Vec<f32>,
    pub(crate) point: Vec<[f32; 3]>,
    pub(crate) normal: Vec<[f32; 3]>,
}

impl Columns {
    /// Columns of zeros, which the system gives out when they are first written to: by all threads, therefore.
    pub(crate) fn zeros(count: usize) -> Columns {
        Columns {
            t: vec![0.0; count],
            primitive: vec![0; count],
            u: vec![0.0; count],
            v: vec![0.0; count],
            point: vec![[0.0; 3]; count],
            normal: vec![[0.0; 3]; count],
        }
    }

    pub(crate) fn into_python(self, py: Python<'_>) -> PyResult<Vec<Bound<'_, PyAny>>> {
        let Columns { t, primitive, u, v, point, normal } = self;
        Ok(vec![
            PyArray1::from_vec(py, t).into_any(),
            PyArray1::from_vec(py, primitive).into_any(),
            PyArray1::from_vec(py, u).into_any(),
            PyArray1::from_vec(py, v).into_any(),
            rows(py, point)?,
            rows(py, normal)?,
        ])
    }
}

/// An array (n, 3).
pub(crate) fn rows<T: numpy::Element>(py: Python<'_>, rows: Vec<[T; 3]>) -> PyResult<Bound<'_, PyAny>> {
    let count = rows.len();
    Ok(PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])?.into_any())
}

/// What a thread uses again for each batch of rays.
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

/// The nearest hit of each ray. `normals` are those of the triangles.
pub(crate) fn closest(
    structure: &dyn Accelerator,
    normals: &[[f32; 3]],
    rays: &Rays<'_>,
    query: &Query<'_>,
) -> Result<Columns, NotFinite> {
    let mut columns = Columns::zeros(rays.count);
    let Columns { t, primitive, u, v, point, normal } = &mut columns;
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
                        (t[i], primitive[i]) = (f32::INFINITY, -1);
                        (point[i], normal[i]) = ([f32::NAN; 3], [f32::NAN; 3]);
                    }
                }
            }
            Ok(())
        },
    )?;
    Ok(columns)
}

/// The triangle that each ray hits first; -1 where it hits none.
pub(crate) fn first(structure: &dyn Accelerator, rays: &Rays<'_>) -> Result<Vec<i64>, NotFinite> {
    let mut first = vec![0; rays.count];
    first.par_chunks_mut(BATCH).enumerate().try_for_each_init(
        Buffers::default,
        |buffers, (batch, first)| {
            rays.batch(batch * BATCH..batch * BATCH + first.len(), &mut buffers.rays)?;
            buffers.closest(structure, &Query::default());
            for (first, hit) in first.iter_mut().zip(&buffers.hits) {
                *first = hit.map_or(-1, |hit| i64::from(hit.primitive));
            }
            Ok(())
        },
    )?;
    Ok(first)
}

/// Whether each ray hits anything.
pub(crate) fn any(
    structure: &dyn Accelerator,
    rays: &Rays<'_>,
    query: &Query<'_>,
) -> Result<Vec<bool>, NotFinite> {
    let mut hits = vec![false; rays.count];
    hits.par_chunks_mut(BATCH).enumerate().try_for_each_init(Vec::new, |buffer, (batch, hits)| {
        rays.batch(batch * BATCH..batch * BATCH + hits.len(), buffer)?;
        structure.any_hits(buffer, query, hits);
        Ok(())
    })?;
    Ok(hits)
}

/// All hits of each ray: the numbers of the rays, and the hits.
pub(crate) fn all(
    structure: &dyn Accelerator,
    normals: &[[f32; 3]],
    rays: &Rays<'_>,
    query: &Query<'_>,
) -> Result<(Vec<i64>, Columns), NotFinite> {
    let parts = in_batches(rays.count, |which, (batch, hits): &mut (Vec<Ray>, Vec<Hit>)| {
        rays.batch(which.clone(), batch)?;
        let (mut numbers, mut columns) = (Vec::new(), Columns::default());
        for (number, ray) in which.zip(batch) {
            structure.all_hits_into(ray, query, hits);
            for hit in hits.iter() {
                numbers.push(number as i64);
                columns.t.push(hit.t);
                columns.primitive.push(i64::from(hit.primitive));
                columns.u.push(hit.u);
                columns.v.push(hit.v);
                columns.point.push(hit.point(ray));
                columns.normal.push(normals[hit.primitive as usize]);
            }
        }
        Ok((numbers, columns))
    })?;
    let columns = Columns {
        t: joined(&parts, |(_, part)| &part.t),
        primitive: joined(&parts, |(_, part)| &part.primitive),
        u: joined(&parts, |(_, part)| &part.u),
        v: joined(&parts, |(_, part)| &part.v),
        point: joined(&parts, |(_, part)| &part.point),
        normal: joined(&parts, |(_, part)| &part.normal),
    };
    Ok((joined(&parts, |(numbers, _)| numbers), columns))
}

/// What all threads find for batches of rays, in their order.
pub(crate) fn in_batches<B: Default, T: Send>(
    count: usize,
    find: impl Fn(std::ops::Range<usize>, &mut B) -> Result<T, NotFinite> + Sync,
) -> Result<Vec<T>, NotFinite> {
    let which = |batch: usize| batch * BATCH..count.min((batch + 1) * BATCH);
    let batches = (0..count.div_ceil(BATCH)).into_par_iter();
    batches.map_init(B::default, |buffers, batch| find(which(batch), buffers)).collect()
}

/// One column of all parts, one after the other.
pub(crate) fn joined<P: Sync, T: Copy + Default + Send + Sync>(
    parts: &[P],
    column: impl Fn(&P) -> &Vec<T> + Sync,
) -> Vec<T> {
    let mut all = vec![T::default(); parts.iter().map(|part| column(part).len()).sum()];
    let mut places = Vec::with_capacity(parts.len());
    let mut rest = &mut all[..];
    for part in parts {
        let (place, after) = rest.split_at_mut(column(part).len());
        places.push((place, part));
        rest = after;
    }
    places.into_par_iter().for_each(|(place, part)| place.copy_from_slice(column(part)));
    all
}
