//! Ray queries on the meshes of trimesh, for `bilux.trimesh`: rays and positions are of 64 bits.

use crate::accel::structure_of;
use crate::arrays;
use crate::ending::without_gil;
use crate::hits::{self, Buffers, in_batches, joined, rows};
use crate::rays::{Meaning, NotFinite, Placement, RayArrays, Rays};
use bilux::accel::{Accelerator, BuildOptions, Hit, Query, Ray, TriangleMesh};
use bilux::math::glam::DVec3;
use numpy::PyArray1;
use pyo3::prelude::*;
use rayon::prelude::*;
use std::sync::Arc;

/// Arbitrary directions, which no edge of an ordinary model is parallel to.
const DIRECTIONS: [[f32; 3]; 3] = [[0.317, 0.577, 0.753], [-0.693, 0.147, 0.706], [0.271, -0.828, 0.491]];

/// A hit whose barycentric weights are closer to an edge than this may be that of a neighbour as well.
const NEAR_EDGE: f32 = 1e-3;

/// A mesh that was moved and scaled into a box, in which 32-bit floats resolve it.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct PlacedMesh {
    mesh: Arc<TriangleMesh>,
    structure: Box<dyn Accelerator>,
    placement: Placement,
    /// The planes of the triangles, relative to the placement's origin.
    planes: Vec<Plane>,
    /// The corners of the bounding box.
    bounds: [DVec3; 2],
    /// How far hits are from each other, in lengths of the box, that are at the same place.
    same_place: f32,
}

/// The points whose product with the normal is `distance`.
struct Plane {
    normal: DVec3,
    distance: f64,
}

/// Arrays of triangles, of rays and, if they are wanted, of positions.
type Crossings<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Option<Bound<'py, PyAny>>);

#[pymethods]
impl PlacedMesh {
    /// `size` is the size of the mesh, which is scaled to 100; without it the mesh stays as it is.
    #[new]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        size: Option<f64>,
        kind: &str,
    ) -> PyResult<PlacedMesh> {
        crate::forks::check()?;
        let points = arrays::points("vertices", vertices)?;
        let points = points.rows();
        let triangles = arrays::triangles("triangles", triangles, points.len())?;
        let vertices: Vec<DVec3> = (0..points.len()).map(|i| points.row(i).into()).collect();
        let placement = match size {
            Some(size) if !vertices.is_empty() => {
                let origin = vertices.iter().fold(DVec3::INFINITY, |least, vertex| least.min(*vertex));
                Placement { origin: origin.to_array(), scale: if size > 0.0 { 100.0 / size } else { 1.0 } }
            }
            _ => Placement { origin: [0.0; 3], scale: 1.0 },
        };
        let placed: Vec<[f32; 3]> = vertices.iter().map(|v| placement.place(v.to_array())).collect();
        if let Some(bad) = placed.iter().position(|vertex| vertex.iter().any(|x| !x.is_finite())) {
            return Err(arrays::not_finite("vertices", bad, points.row(bad)));
        }
        let (planes, bounds) = planes_of(&vertices, &triangles, placement.origin.into());
        let options = BuildOptions::default();
        let (mesh, structure) = without_gil(py, || structure_of(placed, triangles, kind, &options))?;
        let same_place = 4.0 * f32::EPSILON * (structure.bounds().max - structure.bounds().min).length();
        Ok(PlacedMesh { mesh, structure, placement, planes, bounds, same_place })
    }

    /// The triangle that each ray hits first, or -1.
    fn first<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let first = self.of_rays(py, ray_origins, ray_directions, |rays| hits::first(&*self.structure, rays));
        Ok(PyArray1::from_vec(py, first?))
    }

    /// Whether each ray hits anything.
    fn any<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let query = Query::default();
        let any =
            self.of_rays(py, ray_origins, ray_directions, |rays| hits::any(&*self.structure, rays, &query));
        Ok(PyArray1::from_vec(py, any?))
    }

    /// Where each ray crosses the surface, at most `most` times: triangles, rays and, if they are wanted, positions.
    fn crossings<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
        most: usize,
        positions: bool,
    ) -> PyResult<Crossings<'py>> {
        let parts = self.of_rays(py, ray_origins, ray_directions, |rays| {
            in_batches(rays.count, |which, buffers: &mut (Buffers, Vec<Hit>)| {
                let (Buffers { rays: batch, .. }, _) = buffers;
                rays.batch(which.clone(), batch)?;
                let mut part = Part::default();
                if most == 1 {
                    buffers.0.closest(&*self.structure, &Query::default());
                    for (ray, hit) in which.zip(&buffers.0.hits) {
                        part.extend(ray, hit.as_slice());
                    }
                } else {
                    for (ray, of_batch) in which.zip(&*batch) {
                        self.crossings_of(of_batch, &mut buffers.1);
                        part.extend(ray, &buffers.1[..buffers.1.len().min(most)]);
                    }
                }
                if positions {
                    part.positions = part.hits().map(|hit| self.position(rays, hit)).collect();
                }
                Ok(part)
            })
        })?;
        let (triangles, rays, positions) = without_gil(py, || {
            let positions = positions.then(|| joined(&parts, |part| &part.positions));
            (joined(&parts, |part| &part.triangles), joined(&parts, |part| &part.rays), positions)
        });
        let positions = positions.map(|positions| rows(py, positions)).transpose()?;
        Ok((PyArray1::from_vec(py, triangles), PyArray1::from_vec(py, rays), positions))
    }

    /// Whether each point is inside, if the mesh is closed.
    fn inside<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        crate::forks::check()?;
        let points = arrays::points("points", points)?;
        let points = points.rows();
        let mut inside = vec![false; points.len()];
        without_gil(py, || {
            let each = inside.par_iter_mut().enumerate().with_min_len(64);
            each.for_each_init(Vec::new, |hits, (i, inside)| {
                *inside = self.is_inside(points.row(i), hits);
            });
        });
        Ok(PyArray1::from_vec(py, inside))
    }
}

/// What was found for a batch of rays: an element for each crossing.
#[derive(Default)]
struct Part {
    triangles: Vec<i64>,
    rays: Vec<i64>,
    positions: Vec<[f64; 3]>,
}

impl Part {
    fn extend(&mut self, ray: usize, hits: &[Hit]) {
        self.triangles.extend(hits.iter().map(|hit| i64::from(hit.primitive)));
        self.rays.extend(hits.iter().map(|_| ray as i64));
    }

    /// Rays and triangles.
    fn hits(&self) -> impl Iterator<Item = (usize, usize)> {
        self.rays.iter().zip(&self.triangles).map(|(&ray, &triangle)| (ray as usize, triangle as usize))
    }
}

impl PlacedMesh {
    /// What `find` finds for the rays of two arrays, without the GIL.
    fn of_rays<T: Send>(
        &self,
        py: Python<'_>,
        ray_origins: &Bound<'_, PyAny>,
        ray_directions: &Bound<'_, PyAny>,
        find: impl Fn(&Rays<'_>) -> Result<T, NotFinite> + Sync,
    ) -> PyResult<T> {
        crate::forks::check()?;
        let arrays = RayArrays::new(ray_origins, ray_directions, ["ray_origins", "ray_directions"])?;
        let rays = arrays.rays([0.0, f32::INFINITY], Meaning::Placed(self.placement));
        let found = without_gil(py, || find(&rays));
        found.map_err(|_| arrays.not_finite(&rays))
    }

    /// Where a ray meets the plane of a triangle, in 64-bit floats.
    fn position(&self, rays: &Rays<'_>, (ray, triangle): (usize, usize)) -> [f64; 3] {
        let [origin, direction] = rays.given(ray).map(DVec3::from);
        let Plane { normal, distance } = &self.planes[triangle];
        let along = normal.dot(direction);
        if along == 0.0 {
            // A ray that lies in the plane, to the last bit, keeps its own origin.
            return origin.to_array();
        }
        let t = (distance - normal.dot(origin - DVec3::from(self.placement.origin))) / along;
        (origin + t * direction).to_array()
    }

    /// Finds all hits of a ray at which it crosses the surface. A ray through an edge or a vertex hits all triangles
    /// there, but crosses the surface once: of triangles that touch, and that it enters or leaves at the same place,
    /// only the first counts.
    fn crossings_of(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        self.structure.all_hits_into(ray, &Query::default(), hits);
        let length = DVec3::from(ray.direction.map(f64::from)).length() as f32;
        let together = |a: &Hit, b: &Hit| {
            let distance = b.t * length;
            distance - a.t * length <= self.same_place.max(4.0 * f32::EPSILON * distance)
        };
        if hits.windows(2).all(|pair| !together(&pair[0], &pair[1])) {
            return;
        }
        let repeats = |i: usize| {
            let nearer = (0..i).rev().take_while(|&k| together(&hits[k], &hits[k + 1]));
            nearer.into_iter().any(|k| {
                let [one, other] = [hits[k], hits[i]];
                self.enters(ray, &one) == self.enters(ray, &other) && self.touch(&one, &other)
            })
        };
        let counts: Vec<bool> = (0..hits.len()).map(|i| !repeats(i)).collect();
        let mut counts = counts.iter();
        hits.retain(|_| *counts.next().unwrap_or(&true));
    }

    /// Whether a ray hits the front of a triangle.
    fn enters(&self, ray: &Ray, hit: &Hit) -> bool {
        self.planes[hit.primitive as usize].normal.dot(DVec3::from(ray.direction.map(f64::from))) < 0.0
    }

    /// Whether two triangles have a corner in common.
    fn touch(&self, one: &Hit, other: &Hit) -> bool {
        let [one, other] = [one, other].map(|hit| self.mesh.triangles()[hit.primitive as usize]);
        one.iter().any(|corner| other.contains(corner))
    }

    /// Whether a point is inside. A ray crosses the surface an odd number of times then, whatever its direction. Where
    /// it grazes an edge, its count may be wrong: the majority of three decides.
    fn is_inside(&self, point: [f64; 3], hits: &mut Vec<Hit>) -> bool {
        let place = DVec3::from(point);
        if !(place.cmpge(self.bounds[0]).all() && place.cmple(self.bounds[1]).all()) {
            return false;
        }
        let origin = self.placement.place(point);
        let mut odd = |direction| {
            self.crossings_of(&Ray::new(origin, direction), hits);
            let sure = hits.iter().all(|hit| hit.u.min(hit.v).min(1.0 - hit.u - hit.v) > NEAR_EDGE);
            (hits.len() % 2 == 1, sure)
        };
        match odd(DIRECTIONS[0]) {
            (inside, true) => inside,
            (inside, false) => {
                let others = [odd(DIRECTIONS[1]).0, odd(DIRECTIONS[2]).0];
                if others[0] == others[1] { others[0] } else { inside }
            }
        }
    }
}

/// The planes of triangles relative to an origin, and the corners of their bounding box.
fn planes_of(vertices: &[DVec3], triangles: &[[u32; 3]], origin: DVec3) -> (Vec<Plane>, [DVec3; 2]) {
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| vertices[vertex as usize]);
    let plane = |triangle: &[u32; 3]| {
        let [a, b, c] = corners(triangle);
        let normal = (b - a).cross(c - a);
        Plane { normal, distance: normal.dot(a - origin) }
    };
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for corner in triangles.iter().flat_map(corners) {
        bounds = [bounds[0].min(corner), bounds[1].max(corner)];
    }
    (triangles.par_iter().map(plane).collect(), bounds)
}
