//! Ray queries on the meshes of trimesh, for `bilux.trimesh`: rays and positions are of 64 bits.

use crate::accel::structure_of;
use crate::arrays;
use crate::ending::without_gil;
use crate::hits::{self, Buffers, fill, in_batches};
use crate::output::Output;
use crate::rays::{Meaning, NotFinite, Placement, RayArrays, Rays};
use bilux::accel::{Accelerator, BuildOptions, Hit, Query, Ray, TriangleMesh};
use bilux::math::glam::DVec3;
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
    /// Distance between hits up to which they are at the same place, in lengths of the box.
    same_place: f32,
}

/// The points whose product with the normal is `distance`.
struct Plane {
    normal: DVec3,
    distance: f64,
}

/// Arrays of triangles, of rays and, if they are wanted, of positions.
type Crossings<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>);

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
    ) -> PyResult<Bound<'py, PyAny>> {
        let arrays = of_python(ray_origins, ray_directions)?;
        let rays = self.placed(&arrays);
        let mut first = Output::column(py, rays.count)?;
        let column = first.numbers();
        without_gil(py, || hits::first(&*self.structure, &rays, column))
            .map_err(|_| arrays.not_finite(&rays))?;
        Ok(first.into_python())
    }

    /// Whether each ray hits anything.
    fn any<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arrays = of_python(ray_origins, ray_directions)?;
        let rays = self.placed(&arrays);
        let mut any = Output::column(py, rays.count)?;
        let column = any.numbers();
        without_gil(py, || hits::any(&*self.structure, &rays, &Query::default(), column))
            .map_err(|_| arrays.not_finite(&rays))?;
        Ok(any.into_python())
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
        let arrays = of_python(ray_origins, ray_directions)?;
        let rays = self.placed(&arrays);
        let parts = without_gil(py, || match most {
            1 => self.first_crossings(&rays),
            _ => self.all_crossings(&rays, most),
        });
        let parts = parts.map_err(|_| arrays.not_finite(&rays))?;
        let count = parts.iter().map(Vec::len).sum();
        let mut outputs = [Output::column(py, count)?, Output::column(py, count)?];
        let mut places = positions.then(|| Output::rows(py, count)).transpose()?;
        let [triangles, numbers] = outputs.each_mut().map(Output::numbers);
        let positions = places.as_mut().map(Output::triples);
        without_gil(py, || {
            fill(&parts, triangles, Vec::len, |part, i| i64::from(part[i].triangle));
            fill(&parts, numbers, Vec::len, |part, i| part[i].ray as i64);
            if let Some(positions) = positions {
                fill(&parts, positions, Vec::len, |part, i| self.position(&rays, part[i]));
            }
        });
        let [triangles, numbers] = outputs.map(Output::into_python);
        Ok((triangles, numbers, places.map(Output::into_python)))
    }

    /// Whether each point is inside, if the mesh is closed.
    fn inside<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        let points = arrays::points("points", points)?;
        let points = points.rows();
        let mut inside = Output::column(py, points.len())?;
        let column = inside.numbers();
        without_gil(py, || {
            let each = column.par_iter_mut().enumerate().with_min_len(64);
            each.for_each_init(Vec::new, |hits, (i, inside)| {
                *inside = self.is_inside(points.row(i), hits);
            });
        });
        Ok(inside.into_python())
    }
}

/// Crossing of a ray and the surface.
#[derive(Clone, Copy)]
struct Crossing {
    ray: usize,
    triangle: u32,
}

/// Arrays of rays as trimesh names them.
fn of_python<'py>(
    ray_origins: &Bound<'py, PyAny>,
    ray_directions: &Bound<'py, PyAny>,
) -> PyResult<RayArrays<'py>> {
    crate::forks::check()?;
    RayArrays::new(ray_origins, ray_directions, ["ray_origins", "ray_directions"])
}

impl PlacedMesh {
    /// The rays in the mesh's box.
    fn placed<'a>(&self, arrays: &'a RayArrays<'_>) -> Rays<'a> {
        arrays.rays([0.0, f32::INFINITY], Meaning::Placed(self.placement))
    }

    /// The first crossing of each ray.
    fn first_crossings(&self, rays: &Rays<'_>) -> Result<Vec<Vec<Crossing>>, NotFinite> {
        in_batches(rays.count, |which, buffers: &mut Buffers| {
            rays.batch(which.clone(), &mut buffers.rays)?;
            buffers.closest(&*self.structure, &Query::default());
            let crossing = |(ray, hit): (usize, &Option<Hit>)| {
                hit.as_ref().map(|hit| Crossing { ray, triangle: hit.primitive })
            };
            Ok(which.zip(&buffers.hits).filter_map(crossing).collect())
        })
    }

    /// The crossings of each ray, at most so many of each.
    fn all_crossings(&self, rays: &Rays<'_>, most: usize) -> Result<Vec<Vec<Crossing>>, NotFinite> {
        in_batches(rays.count, |which, (batch, hits): &mut (Vec<Ray>, Vec<Hit>)| {
            rays.batch(which.clone(), batch)?;
            let mut crossings = Vec::new();
            for (number, ray) in which.zip(batch) {
                self.crossings_of(ray, hits);
                let kept = hits.iter().take(most);
                crossings.extend(kept.map(|hit| Crossing { ray: number, triangle: hit.primitive }));
            }
            Ok(crossings)
        })
    }

    /// Point at which a ray meets the plane of a triangle, in 64-bit floats.
    fn position(&self, rays: &Rays<'_>, crossing: Crossing) -> [f64; 3] {
        let [origin, direction] = rays.given(crossing.ray).map(DVec3::from);
        let Plane { normal, distance } = &self.planes[crossing.triangle as usize];
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
