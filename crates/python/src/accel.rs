//! Ray queries on arrays.

use crate::arrays;
use crate::ending::{returning_from, without_gil};
use crate::errors::Error;
use crate::hits::{self, AllHits, Columns, HitArrays, rows};
use crate::output::Output;
use crate::rays::{Meaning, NotFinite, RayArrays};
use bilux::accel::registry::Quality;
use bilux::accel::{Accelerator, BuildError, BuildOptions, Bvh8, Culling, Hit, Query, TriangleMesh, build};
use bilux::scene::{SceneError, Span};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Triangles, ready for ray queries.
///
/// Rays are arrays of origins and of directions, (n, 3) each; a single origin or direction (1, 3) goes with all of the
/// other. Distances `t` are measured in lengths of the direction, which need not be 1. Numbers are 32-bit floats. All
/// cores work on a query, without the GIL; every answer is the same as that of a loop over all triangles, to the bit.
///
/// Args:
///     vertices: an array (n, 3), in any unit of length.
///     triangles: an array (n, 3) of indices of vertices. Their front is where the vertices run counter-clockwise.
///     kind: the structure (`bilux.accels`); "auto" is the fastest.
///     quality: "fast" builds sooner, "best" answers sooner, "balanced" is between them.
///
/// Raises:
///     ValueError: if an array has a wrong shape, a vertex is not finite, or an index is out of range.
///     TypeError: if an array holds no numbers.
///
/// Example:
///     >>> accel = bilux.Accel([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
///     >>> hits = accel.closest([[0.25, 0.25, 1], [5, 5, 1]], [[0, 0, -1]])
///     >>> hits.t, hits.primitive
///     (array([ 1., inf], dtype=float32), array([ 0, -1]))
#[pyclass(frozen, module = "bilux")]
pub(crate) struct Accel {
    mesh: Arc<TriangleMesh>,
    /// The normal of each triangle: to look it up takes a fraction of what computing it for each hit would.
    normals: Vec<[f32; 3]>,
    structure: Box<dyn Accelerator>,
    quality: Quality,
    /// For nearest points, which only this structure finds.
    wide: OnceLock<Result<Bvh8, BuildError>>,
    kind: String,
}

#[pymethods]
impl Accel {
    #[new]
    #[pyo3(signature = (vertices, triangles, *, kind = "auto", quality = "balanced"))]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        kind: &str,
        quality: &str,
    ) -> PyResult<Accel> {
        crate::forks::check()?;
        let vertices = arrays::rows::<3>("vertices", vertices)?;
        let triangles = arrays::triangles("triangles", triangles, vertices.len())?;
        let quality = Quality::from_name(quality).ok_or_else(|| {
            PyValueError::new_err(format!(
                "quality: there is no '{quality}': write 'fast', 'balanced' or 'best'"
            ))
        })?;
        let options = BuildOptions { quality, ..BuildOptions::default() };
        let (mesh, normals, structure) = without_gil(py, || {
            let (mesh, structure) = structure_of(vertices, triangles, kind, &options)?;
            PyResult::Ok((mesh.clone(), normals_of(&mesh), structure))
        })?;
        Ok(Accel { mesh, normals, structure, quality, wide: OnceLock::new(), kind: kind.to_owned() })
    }

    /// The first hit of each ray.
    ///
    /// Args:
    ///     origins: an array (n, 3).
    ///     directions: an array (n, 3), of any length but 0.
    ///     t_min, t_max: hits nearer or farther than this do not count, in lengths of the direction.
    ///     cull_back: hits from behind do not count.
    ///
    /// Returns:
    ///     Hits, a named tuple of arrays of length n: `t` (float32, infinite where nothing is hit), `primitive` (int64,
    ///     the row of the triangle, -1 where nothing is hit), `u` and `v` (float32, the barycentric weights of the
    ///     second and the third vertex), `point` and `normal` (float32, (n, 3), NaN where nothing is hit; the normal
    ///     has length 1 and is on the triangle's front).
    #[pyo3(signature = (origins, directions, *, t_min = 0.0, t_max = f32::INFINITY, cull_back = false))]
    fn closest<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        t_min: f32,
        t_max: f32,
        cull_back: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        let arrays = RayArrays::new(origins, directions, ["origins", "directions"])?;
        let rays = arrays.rays(interval(t_min, t_max)?, Meaning::Rays);
        let (structure, query) = (&*self.structure, query(cull_back));
        let mut found = HitArrays::new(py, rays.count)?;
        let columns = found.columns();
        let (done, _returning) =
            returning_from(py, || hits::closest(structure, &self.normals, &rays, &query, columns));
        done.map_err(|_| arrays.not_finite(&rays))?;
        py.import("bilux._types")?.getattr("Hits")?.call1(PyTuple::new(py, found.into_python())?)
    }

    /// Whether each ray hits anything.
    ///
    /// Args:
    ///     origins, directions, t_min, t_max, cull_back: as for `closest`.
    ///
    /// Returns:
    ///     an array (n,) of bool.
    #[pyo3(signature = (origins, directions, *, t_min = 0.0, t_max = f32::INFINITY, cull_back = false))]
    fn any<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        t_min: f32,
        t_max: f32,
        cull_back: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        let arrays = RayArrays::new(origins, directions, ["origins", "directions"])?;
        let rays = arrays.rays(interval(t_min, t_max)?, Meaning::Rays);
        let mut hits = Output::column(py, rays.count)?;
        let column = hits.numbers();
        without_gil(py, || hits::any(&*self.structure, &rays, &query(cull_back), column))
            .map_err(|_| arrays.not_finite(&rays))?;
        Ok(hits.into_python())
    }

    /// Whether nothing lies between points, so that each of `a` sees its counterpart in `b`.
    ///
    /// Args:
    ///     a, b: arrays (n, 3).
    ///     margin: the part of the segment at either end in which hits do not count, since the points usually lie on
    ///         triangles themselves.
    ///
    /// Returns:
    ///     an array (n,) of bool.
    #[pyo3(signature = (a, b, *, margin = 1e-4))]
    fn visible<'py>(
        &self,
        py: Python<'py>,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
        margin: f32,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        if !(0.0..0.5).contains(&margin) {
            return Err(PyValueError::new_err(format!("margin: {margin} is not from 0 to below 0.5")));
        }
        let arrays = RayArrays::new(a, b, ["a", "b"])?;
        let rays = arrays.rays([margin, 1.0 - margin], Meaning::Segments);
        let mut visible = Output::column(py, rays.count)?;
        let column = visible.numbers();
        let done = without_gil(py, || {
            hits::any(&*self.structure, &rays, &query(false), column)?;
            column.iter_mut().for_each(|blocked| *blocked = !*blocked);
            Ok(())
        });
        done.map_err(|_: NotFinite| arrays.not_finite(&rays))?;
        Ok(visible.into_python())
    }

    /// Every hit of each ray.
    ///
    /// Args:
    ///     origins, directions, t_min, t_max, cull_back: as for `closest`.
    ///
    /// Returns:
    ///     AllHits, a named tuple of arrays with a row for each hit, sorted by ray and then by distance: `ray` (int64,
    ///     the row of the ray), and `t`, `primitive`, `u`, `v`, `point` and `normal` as in Hits.
    #[pyo3(signature = (origins, directions, *, t_min = 0.0, t_max = f32::INFINITY, cull_back = false))]
    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        t_min: f32,
        t_max: f32,
        cull_back: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        let arrays = RayArrays::new(origins, directions, ["origins", "directions"])?;
        let rays = arrays.rays(interval(t_min, t_max)?, Meaning::Rays);
        let (structure, query) = (&*self.structure, query(cull_back));
        let parts = without_gil(py, || hits::all(structure, &rays, &query));
        let parts = parts.map_err(|_| arrays.not_finite(&rays))?;
        let count = AllHits::count(&parts);
        let (mut numbers, mut found) = (Output::column(py, count)?, HitArrays::new(py, count)?);
        let (numbers_of_rays, mut columns) = (numbers.numbers(), found.columns());
        let ((), _returning) = returning_from(py, || {
            AllHits::write(&parts, &self.normals, numbers_of_rays, &mut columns);
        });
        let mut all = vec![numbers.into_python()];
        all.extend(found.into_python());
        py.import("bilux._types")?.getattr("AllHits")?.call1(PyTuple::new(py, all)?)
    }

    /// The point of the triangles that is nearest to each point.
    ///
    /// Args:
    ///     points: an array (n, 3).
    ///     within: nothing farther away than this is found.
    ///
    /// Returns:
    ///     NearestPoints, a named tuple of arrays of length n: `distance` (float32, infinite where nothing is found),
    ///     `primitive` (int64, -1 where nothing is found), `u`, `v` and `point` as in Hits.
    #[pyo3(signature = (points, *, within = f32::INFINITY))]
    fn nearest_point<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'_, PyAny>,
        within: f32,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        let points = arrays::rows::<3>("points", points)?;
        if within.is_nan() {
            return Err(PyValueError::new_err("within: NaN is no distance: infinity is the default"));
        }
        let mut found = HitArrays::new(py, points.len())?;
        let Columns { t, primitive, u, v, point, .. } = found.columns();
        let (done, _returning) = returning_from(py, || {
            let options = BuildOptions { quality: self.quality, ..BuildOptions::default() };
            let wide = self.wide.get_or_init(|| Bvh8::new(&self.mesh, &options));
            let wide = wide.as_ref().map_err(ToString::to_string)?;
            (&points, t, primitive, u, v, point).into_par_iter().for_each(
                |(from, t, primitive, u, v, point)| match wide.nearest_point(*from, within) {
                    Some(near) => {
                        (*t, *primitive, *u, *v) = (near.distance, i64::from(near.primitive), near.u, near.v);
                        *point = near.point;
                    }
                    None => {
                        (*t, *primitive, *u, *v) = (f32::INFINITY, -1, 0.0, 0.0);
                        *point = [f32::NAN; 3];
                    }
                },
            );
            Ok(())
        });
        done.map_err(|error: String| Error::new_err(error))?;
        let found = found.into_python().into_iter().take(5);
        py.import("bilux._types")?
            .getattr("NearestPoints")?
            .call1(PyTuple::new(py, found.collect::<Vec<_>>())?)
    }

    /// The corners of the bounding box: an array (2, 3).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bounds = self.structure.bounds();
        rows(py, vec![bounds.min.to_array(), bounds.max.to_array()])
    }

    /// The name of the structure.
    #[getter]
    fn kind(&self) -> &str {
        &self.kind
    }

    /// The number of triangles.
    fn __len__(&self) -> usize {
        self.mesh.len()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, accel) = (slf.py(), slf.get());
        let corners = rows(py, accel.mesh.triangles().as_flattened().to_vec())?;
        let indices = PyArray1::from_vec(py, (0..3 * accel.mesh.len() as i64).collect());
        let indices = indices.call_method1("reshape", ((-1, 3),))?;
        let restore = slf.get_type().getattr("_restored")?;
        (restore, (corners, indices, &accel.kind, accel.quality_name())).into_pyobject(py)
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        corners: &Bound<'_, PyAny>,
        indices: &Bound<'_, PyAny>,
        kind: &str,
        quality: &str,
    ) -> PyResult<Accel> {
        Accel::new(py, corners, indices, kind, quality)
    }

    fn __repr__(&self) -> String {
        let megabytes = self.structure.memory_bytes() as f64 / 1e6;
        format!("<bilux.Accel '{}' of {} triangles, {megabytes:.1} MB>", self.kind, self.mesh.len())
    }
}

impl Accel {
    fn quality_name(&self) -> &'static str {
        match self.quality {
            Quality::Fast => "fast",
            Quality::Balanced => "balanced",
            Quality::Best => "best",
        }
    }
}

/// A mesh with a structure of this name over it.
pub(crate) fn structure_of(
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    kind: &str,
    options: &BuildOptions,
) -> PyResult<(Arc<TriangleMesh>, Box<dyn Accelerator>)> {
    let mesh = TriangleMesh::new(vertices, triangles);
    let mesh = Arc::new(mesh.map_err(|error| PyValueError::new_err(format!("triangles: {error}")))?);
    let structure = build(kind, mesh.clone(), options).map_err(|error| unbuilt(kind, &error))?;
    Ok((mesh, structure))
}

/// The unit normal of each triangle, on its front; zero where it has no area.
fn normals_of(mesh: &TriangleMesh) -> Vec<[f32; 3]> {
    let normal = |primitive| Hit { t: 0.0, u: 0.0, v: 0.0, primitive, instance: 0 }.normal(mesh);
    (0..mesh.len() as u32).into_par_iter().map(normal).collect()
}

/// The distances that count.
fn interval(t_min: f32, t_max: f32) -> PyResult<[f32; 2]> {
    match (t_min.is_nan(), t_max.is_nan()) {
        (false, false) => Ok([t_min, t_max]),
        (true, _) => Err(PyValueError::new_err("t_min: NaN is no distance: 0 is the default")),
        _ => Err(PyValueError::new_err("t_max: NaN is no distance: infinity is the default")),
    }
}

fn query(cull_back: bool) -> Query<'static> {
    Query { culling: if cull_back { Culling::Back } else { Culling::None }, ..Query::default() }
}

/// Why a structure cannot be built.
fn unbuilt(kind: &str, error: &BuildError) -> PyErr {
    match error {
        BuildError::UnknownName(_) => {
            let names = bilux::accel::ACCELERATORS.iter().map(|row| row.entry.name).chain(["auto"]);
            let error = SceneError::unknown("accelerator", kind, names, &Span::default());
            PyValueError::new_err(format!("kind: {error}"))
        }
        error => Error::new_err(error.to_string()),
    }
}
