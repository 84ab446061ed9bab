//! The teapot, from its 32 bicubic Bézier patches. [Newell 1975]
//!
//! It is 3.15 high by default, stands on the plane y = 0, and its spout points to +x. As Newell left it, the surface is
//! open: the lid lies loosely in the rim, the spout is a tube without an end, and spout and handle pass through the
//! wall. `vessel` makes a closed version of it, for glass.

mod graft;
pub mod vessel;

use crate::{GeneratorEntry, integer, length, switch};
use bilux_math::registry::{Entry, Parameter};
use bilux_math::{DVec3, Rgb, Vec2};
use bilux_scene::{Mesh, Object, SceneBuilder, Spec};
use std::sync::Arc;

pub(super) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "teapot",
        summary: "only the teapot; the studio provides camera and lights",
        source: "Newell 1975",
        parameters: &[
            Parameter { default: "16", ..TESSELLATION },
            length("height", "height from the table to the top of the lid", "3.15"),
            switch("bottom", "whether it has a bottom, which Newell's original lacks", "true"),
        ],
    },
    triangles: |reader| 64 * (reader.integer("tessellation") as u64).pow(2),
    generate: |reader| {
        let teapot = Teapot {
            tessellation: reader.integer("tessellation") as u32,
            height: f64::from(reader.number("height")),
            bottom: reader.bool("bottom"),
        };
        let mut builder = SceneBuilder::default();
        let clay = Spec::new("clay", "phong")
            .with("kd", Rgb::new(0.72, 0.64, 0.55))
            .with("ks", 0.08f32)
            .with("exponent", 60.0f32)
            .with("reflectivity", 0.0f32);
        let material = builder.add_material(clay);
        builder.objects.push(Object::new("teapot", Arc::new(teapot.mesh()), material));
        Ok(builder)
    },
};

pub(super) const TESSELLATION: Parameter =
    integer("tessellation", "number of segments along each edge of the 32 patches", 1, 256, "8");

/// The height of the original control points.
pub const NEWELL_HEIGHT: f64 = 3.15;

/// Tessellation and scale of the teapot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Teapot {
    /// Segments along each patch edge, at least 1; the teapot has about 64 times the square of this many triangles.
    pub tessellation: u32,
    /// From the table to the top of the lid, metres.
    pub height: f64,
    /// Whether it is closed at the bottom.
    pub bottom: bool,
}

impl Default for Teapot {
    fn default() -> Teapot {
        Teapot { tessellation: 8, height: NEWELL_HEIGHT, bottom: true }
    }
}

impl Teapot {
    /// The mesh, patch by patch: normals point outwards, counter-clockwise from outside; uv from 0 to 1 over each
    /// patch.
    ///
    /// Each patch has its own vertices, but their positions along shared edges are equal bit for bit.
    pub fn mesh(&self) -> Mesh {
        let mut mesh = Mesh { name: "teapot".to_owned(), ..Mesh::default() };
        let scale = self.height / NEWELL_HEIGHT;
        for patch in patches(self.bottom) {
            patch.tessellate(self.tessellation.clamp(1, 256), scale, &mut mesh);
        }
        mesh
    }
}

/// A bicubic Bézier patch: four rows of control points, v from row to row and u along each row.
///
/// Outside is where ∂u × ∂v points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch(pub [[DVec3; 4]; 4]);

/// Newell's patches, y up: lid, rim and body by quarters, then handle and spout by halves.
pub fn patches(bottom: bool) -> impl Iterator<Item = Patch> {
    let profile = PROFILE.iter().take(if bottom { 6 } else { 5 });
    let body = profile.flat_map(|row| (0..4).map(move |quarter| quarter_of(row, quarter)));
    body.chain(TUBES.iter().flat_map(|rows| [half_of(rows), mirrored(&half_of(rows))]))
}

/// The outline that is revolved into lid, rim and body, from inside out and top down: radius, the control points'
/// offset that makes a quarter of a circle of it (0.56 of the radius, except for the lid's knob), height.
pub(super) const PROFILE: [[[f64; 3]; 4]; 6] = [
    [[0.0, 0.0, 3.15], [0.8, 0.45, 3.15], [0.0, 0.0, 2.85], [0.2, 0.112, 2.7]],
    [[0.2, 0.112, 2.7], [0.4, 0.224, 2.55], [1.3, 0.728, 2.55], [1.3, 0.728, 2.4]],
    [[1.4, 0.784, 2.4], [1.3375, 0.749, 2.53125], [1.4375, 0.805, 2.53125], [1.5, 0.84, 2.4]],
    [[1.5, 0.84, 2.4], [1.75, 0.98, 1.875], [2.0, 1.12, 1.35], [2.0, 1.12, 0.9]],
    [[2.0, 1.12, 0.9], [2.0, 1.12, 0.45], [1.5, 0.84, 0.225], [1.5, 0.84, 0.15]],
    [[1.5, 0.84, 0.15], [1.5, 0.84, 0.075], [1.425, 0.798, 0.0], [0.0, 0.0, 0.0]],
];

/// Indices of the profile's curves.
pub(super) const LID: u32 = 1;
pub(super) const RIM: u32 = 2;
pub(super) const SHOULDER: u32 = 3;
pub(super) const FOOT: u32 = 5;

/// Handle and spout, two patches each, by rings of control points: x and y of the ring's first and last crossing of the
/// middle plane, and how far it bulges from that plane.
pub(super) const TUBES: [[[f64; 5]; 4]; 4] = [
    [
        [-1.6, 2.025, -1.5, 2.25, 0.3],
        [-2.3, 2.025, -2.5, 2.25, 0.3],
        [-2.7, 2.025, -3.0, 2.25, 0.3],
        [-2.7, 1.8, -3.0, 1.8, 0.3],
    ],
    [
        [-2.7, 1.8, -3.0, 1.8, 0.3],
        [-2.7, 1.575, -3.0, 1.35, 0.3],
        [-2.5, 1.125, -2.65, 0.9375, 0.3],
        [-2.0, 0.9, -1.9, 0.6, 0.3],
    ],
    [
        [1.7, 1.425, 1.7, 0.6, 0.66],
        [2.6, 1.425, 3.1, 0.825, 0.66],
        [2.3, 2.1, 2.4, 2.025, 0.25],
        [2.7, 2.4, 3.3, 2.4, 0.25],
    ],
    [
        [2.7, 2.4, 3.3, 2.4, 0.25],
        [2.8, 2.475, 3.525, 2.49375, 0.25],
        [2.9, 2.475, 3.45, 2.5125, 0.15],
        [2.8, 2.4, 3.2, 2.4, 0.15],
    ],
];

/// The patch swept by a quarter turn of a profile, starting from +x towards +z.
///
/// Here and below the code says `0.0 - x`, not `-x`: a zero stays positive, so that edges are equal bit for bit.
pub(super) fn quarter_of(profile: &[[f64; 3]; 4], quarter: usize) -> Patch {
    Patch(profile.map(|[r, k, y]| {
        [(r, 0.0), (r, k), (k, r), (0.0, r)].map(|(x, z)| match quarter % 4 {
            0 => DVec3::new(x, y, z),
            1 => DVec3::new(0.0 - z, y, x),
            2 => DVec3::new(0.0 - x, y, 0.0 - z),
            _ => DVec3::new(z, y, 0.0 - x),
        })
    }))
}

/// The half of a tube on the +z side.
pub(super) fn half_of(rings: &[[f64; 5]; 4]) -> Patch {
    Patch(
        rings.map(|[x0, y0, x1, y1, w]| {
            [(x0, y0, 0.0), (x0, y0, w), (x1, y1, w), (x1, y1, 0.0)].map(DVec3::from)
        }),
    )
}

/// The other half, with reversed rows so that outside stays outside.
fn mirrored(patch: &Patch) -> Patch {
    Patch(patch.0.map(|[a, b, c, d]| [d, c, b, a].map(|p| DVec3::new(p.x, p.y, 0.0 - p.z))))
}

impl Patch {
    /// The point and the unit normal at `i / n` along u and `j / n` along v.
    ///
    /// The point is the same, bit for bit, from either side of an edge and in either direction along it: at an edge
    /// three of the four weights are exactly 0, and weights and sums are symmetric in `i` and `n - i`.
    pub fn at(&self, i: u32, j: u32, n: u32) -> (DVec3, DVec3) {
        self.blend(&Cubic::new(i, n), &Cubic::new(j, n))
    }

    /// The point and the unit normal at any u and v.
    pub(super) fn blend(&self, u: &Cubic, v: &Cubic) -> (DVec3, DVec3) {
        let rows = self.0.map(|row| u.blend(&row));
        let slopes = self.0.map(|row| u.slope(&row));
        let (along_u, along_v) = (v.blend(&slopes), v.slope(&rows));
        let size = along_u.length().max(along_v.length());
        // At a pole the row is a single point: ∂u vanishes, and the change of ∂u along v replaces it.
        let normal = if along_u.length() > 1e-12 * size {
            along_u.cross(along_v)
        } else {
            v.slope(&slopes).cross(along_v) * if v.weights[0] > v.weights[3] { 1.0 } else { -1.0 }
        };
        (v.blend(&rows), normal.normalize_or_zero())
    }

    fn tessellate(&self, n: u32, scale: f64, mesh: &mut Mesh) {
        let first = mesh.positions.len() as u32;
        for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
            let (p, normal) = self.at(i, j, n);
            mesh.positions.push((p * scale).as_vec3());
            mesh.normals.push(normal.as_vec3());
            mesh.uvs.push(Vec2::new(i as f32, j as f32) / n as f32);
        }
        for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
            let corner = |di: u32, dj: u32| first + (j + dj) * (n + 1) + i + di;
            let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
            for triangle in [[a, b, c], [a, c, d]] {
                let [p, q, r] = triangle.map(|k| mesh.positions[k as usize]);
                // At a pole one side of the square is a point.
                if p != q && q != r && r != p {
                    mesh.triangles.push(triangle);
                }
            }
        }
    }
}

/// The cubic Bernstein polynomials and their derivatives at one parameter.
pub(super) struct Cubic {
    weights: [f64; 4],
    slopes: [f64; 3],
}

impl Cubic {
    pub(super) fn new(i: u32, n: u32) -> Cubic {
        Cubic::of(f64::from(i) / f64::from(n), f64::from(n - i) / f64::from(n))
    }

    /// The polynomials at a parameter in 0..=1.
    pub(super) fn at(t: f64) -> Cubic {
        Cubic::of(t, 1.0 - t)
    }

    /// The polynomials at a parameter, given with its complement to 1.
    fn of(a: f64, b: f64) -> Cubic {
        Cubic {
            weights: [b * b * b, 3.0 * (a * (b * b)), 3.0 * (b * (a * a)), a * a * a],
            slopes: [3.0 * (b * b), 6.0 * (a * b), 3.0 * (a * a)],
        }
    }

    pub(super) fn blend(&self, p: &[DVec3; 4]) -> DVec3 {
        let w = &self.weights;
        (p[0] * w[0] + p[3] * w[3]) + (p[1] * w[1] + p[2] * w[2])
    }

    fn slope(&self, p: &[DVec3; 4]) -> DVec3 {
        let s = &self.slopes;
        (p[1] - p[0]) * s[0] + (p[2] - p[1]) * s[1] + (p[3] - p[2]) * s[2]
    }
}
