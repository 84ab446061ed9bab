//! Points on up to [`LANES`] triangles, in columns.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, run_at, vec3};
use bilux_accel::Hit;
use bilux_math::Vec3;
use bilux_scene::Scene;
use bilux_scene::geometry::{Geometry, StillTriangle};

/// The triangles, and where they are hit.
pub(super) struct Triangles {
    /// The lanes in use, each with its object and primitive.
    lanes: Vec<(usize, u32, u32)>,
    corners: [Columns3; 3],
    normals: [Columns3; 3],
    inverse: [Columns3; 3],
    turn: Column,
    u: Column,
    v: Column,
    points: Points,
}

/// The points, the bounds on their errors, and their geometric and shading normals.
pub(super) struct Points {
    pub(super) p: Columns3,
    pub(super) p_error: Columns3,
    pub(super) n_geom: Columns3,
    pub(super) n_shade: Columns3,
}

impl Default for Triangles {
    fn default() -> Triangles {
        Triangles {
            lanes: Vec::with_capacity(LANES),
            corners: [ZERO3; 3],
            normals: [ZERO3; 3],
            inverse: [ZERO3; 3],
            turn: Column::ZERO,
            u: Column::ZERO,
            v: Column::ZERO,
            points: Points { p: ZERO3, p_error: ZERO3, n_geom: ZERO3, n_shade: ZERO3 },
        }
    }
}

impl Triangles {
    /// Sets where the triangle of a lane is hit.
    #[inline]
    pub(super) fn put(&mut self, i: usize, object: u32, hit: &Hit) {
        self.lanes.push((i, object, hit.primitive));
        (self.u.0[i], self.v.0[i]) = (hit.u, hit.v);
    }

    /// The points where they are hit. Afterwards no lane is in use.
    pub(super) fn points(&mut self, scene: &Scene) -> &Points {
        self.read(scene.geometry());
        self.lanes.clear();
        run_at(scene.cpu_level(), FindPoints { triangles: self });
        &self.points
    }

    fn read(&mut self, geometry: &Geometry) {
        let Triangles { lanes, corners, normals, inverse, turn, .. } = self;
        let put_all = |columns: &mut [Columns3; 3], i, vectors: [Vec3; 3]| {
            for (columns, vector) in columns.iter_mut().zip(vectors) {
                put(columns, i, vector.to_array());
            }
        };
        for &(i, _, primitive) in &*lanes {
            put_all(corners, i, geometry.still_corners(primitive));
        }
        let mut vertices = [[0; 3]; LANES];
        for &(i, object, primitive) in &*lanes {
            vertices[i] = geometry.still_vertices(object, primitive);
        }
        for &(i, object, _) in &*lanes {
            put_all(normals, i, geometry.still_normals(object, vertices[i]));
        }
        for &(i, object, _) in &*lanes {
            let (axes, orientation) = geometry.still_place(object);
            put_all(inverse, i, axes);
            turn.0[i] = orientation;
        }
    }
}

struct FindPoints<'a> {
    triangles: &'a mut Triangles,
}

impl Stage for FindPoints<'_> {
    #[inline(always)]
    fn run(self) {
        let Triangles { corners, normals, inverse, turn, u, v, points, .. } = self.triangles;
        let Points { p, p_error, n_geom, n_shade } = points;
        for i in 0..LANES {
            let triangle = StillTriangle {
                corners: [vec3(&corners[0], i), vec3(&corners[1], i), vec3(&corners[2], i)],
                normals: [vec3(&normals[0], i), vec3(&normals[1], i), vec3(&normals[2], i)],
                inverse: [vec3(&inverse[0], i), vec3(&inverse[1], i), vec3(&inverse[2], i)],
                turn: turn.0[i],
            };
            let point = triangle.point(u.0[i], v.0[i]);
            put(p, i, point[0].to_array());
            put(p_error, i, point[1].to_array());
            put(n_geom, i, point[2].to_array());
            put(n_shade, i, point[3].to_array());
        }
    }
}
