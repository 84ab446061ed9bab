//! Spheres, cylinders, cones, capsules, cubes and planes.

use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Vertices around an axis.
const AROUND: usize = 64;
/// Rings from a pole to the equator.
const RINGS: usize = 16;

/// A ring around the z axis: its radius and height, and the normal outwards and upwards.
#[derive(Clone, Copy)]
struct Ring {
    radius: f64,
    z: f64,
    normal: [f64; 2],
    v: f64,
}

/// The mesh of a shape; `None` for prims of other types.
pub(crate) fn mesh(stage: &Stage, prim: u32, budget: &mut Budget) -> Result<Option<Mesh>, FormatError> {
    let mut number = |name: &str, default: f64| -> Result<f64, FormatError> {
        Ok(stage.number(prim, name, budget)?.unwrap_or(default))
    };
    let mut mesh = match &*stage.prim(prim).type_name {
        "Sphere" => {
            let radius = number("radius", 1.0)?;
            turned(&[dome(radius, 0.0, -1.0), dome(radius, 0.0, 1.0)].concat())
        }
        "Capsule" | "Capsule_1" => {
            let half = 0.5 * number("height", 1.0)?;
            let both = number("radius", 0.5)?;
            let (low, high) = (number("radiusBottom", both)?, number("radiusTop", both)?);
            turned(&[dome(low, -half, -1.0), dome(high, half, 1.0)].concat())
        }
        "Cylinder" | "Cylinder_1" => {
            let half = 0.5 * number("height", 2.0)?;
            let both = number("radius", 1.0)?;
            let (low, high) = (number("radiusBottom", both)?, number("radiusTop", both)?);
            turned(&frustum(low, high, half))
        }
        "Cone" => {
            let half = 0.5 * number("height", 2.0)?;
            turned(&frustum(number("radius", 1.0)?, 0.0, half))
        }
        "Cube" => cube(0.5 * number("size", 2.0)?),
        "Plane" => {
            let (width, length) = (number("width", 2.0)? as f32, number("length", 2.0)? as f32);
            let corner = Vec3::new(-0.5 * width, -0.5 * length, 0.0);
            Mesh::quad(corner, Vec3::X * width, Vec3::Y * length)
        }
        _ => return Ok(None),
    };
    // Shapes stand along z. Planes face it; their width is then along x, and along z if they face x.
    let is_plane = &*stage.prim(prim).type_name == "Plane";
    let axis = stage.text(prim, "axis", budget)?;
    let turn = |p: &mut Vec3| {
        *p = match (axis.as_deref(), is_plane) {
            (Some("X"), false) => Vec3::new(p.z, p.x, p.y),
            (Some("X"), true) => Vec3::new(p.z, p.y, -p.x),
            (Some("Y"), false) => Vec3::new(p.y, p.z, p.x),
            (Some("Y"), true) => Vec3::new(p.x, p.z, -p.y),
            _ => *p,
        };
    };
    mesh.positions.iter_mut().for_each(turn);
    mesh.normals.iter_mut().for_each(turn);
    Ok(Some(mesh))
}

/// Half of a sphere around a point of the axis: the lower one from its pole up, or the upper one up to its pole.
fn dome(radius: f64, z: f64, sign: f64) -> Vec<Ring> {
    let ring = |i: usize| {
        let part = if sign < 0.0 { RINGS - i } else { i } as f64 / RINGS as f64;
        let (sin, cos) = sin_cos_f64(part * FRAC_PI_2);
        let cos = if part == 1.0 { 0.0 } else { cos };
        Ring {
            radius: radius * cos,
            z: z + sign * radius * sin,
            normal: [cos, sign * sin],
            v: 0.5 + 0.5 * sign * part,
        }
    };
    (0..=RINGS).map(ring).collect()
}

/// A wall between two discs; a disc without radius is a tip.
fn frustum(low: f64, high: f64, half: f64) -> Vec<Ring> {
    let slope = [2.0 * half, low - high];
    let length = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt().max(f64::MIN_POSITIVE);
    let normal = slope.map(|x| x / length);
    let ring = |radius, z, normal, v| Ring { radius, z, normal, v };
    vec![
        ring(0.0, -half, [0.0, -1.0], 0.0),
        ring(low, -half, [0.0, -1.0], 0.0),
        ring(low, -half, normal, 0.0),
        ring(high, half, normal, 1.0),
        ring(high, half, [0.0, 1.0], 1.0),
        ring(0.0, half, [0.0, 1.0], 1.0),
    ]
}

/// A surface through rings, from the lowest up.
fn turned(rings: &[Ring]) -> Mesh {
    let mut mesh = Mesh::default();
    let columns = AROUND + 1;
    for ring in rings {
        for column in 0..columns {
            // The first meridian again, bit for bit, so that there is no gap.
            let (sin, cos) = sin_cos_f64((column % AROUND) as f64 / AROUND as f64 * TAU);
            let at = |radius: f64, z: f64| Vec3::new((radius * cos) as f32, (radius * sin) as f32, z as f32);
            mesh.positions.push(at(ring.radius, ring.z));
            mesh.normals.push(at(ring.normal[0], ring.normal[1]));
            mesh.uvs.push(Vec2::new(column as f32 / AROUND as f32, ring.v as f32));
        }
    }
    for (i, pair) in rings.windows(2).enumerate() {
        // Rings in one place have different normals.
        if pair[0].radius == pair[1].radius && pair[0].z == pair[1].z {
            continue;
        }
        for column in 0..AROUND {
            let a = (i * columns + column) as u32;
            let (b, c, d) = (a + 1, a + 1 + columns as u32, a + columns as u32);
            if pair[0].radius != 0.0 {
                mesh.triangles.push([a, b, c]);
            }
            if pair[1].radius != 0.0 {
                mesh.triangles.push([a, c, d]);
            }
        }
    }
    mesh
}

fn cube(half: f64) -> Mesh {
    let half = half as f32;
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let normal = Vec3::AXES[axis] * sign;
            let (u, v) = (Vec3::AXES[(axis + 1) % 3] * sign, Vec3::AXES[(axis + 2) % 3]);
            let side = Mesh::quad((normal - u - v) * half, u * 2.0 * half, v * 2.0 * half);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(side.positions);
            mesh.normals.extend([normal; 4]);
            mesh.uvs.extend(side.uvs);
            mesh.triangles.extend(side.triangles.iter().map(|t| t.map(|i| first + i)));
        }
    }
    mesh
}
