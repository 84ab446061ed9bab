//! Rays that have broken ray tracers.

use super::Numbers;
use bilux_accel::{Ray, TriangleMesh};
use bilux_math::Vec3;

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn mix(a: [f32; 3], b: [f32; 3], x: f32) -> [f32; 3] {
    std::array::from_fn(|k| a[k] * (1.0 - x) + b[k] * x)
}

/// `count` rays of every kind, for a mesh of any size and position.
pub fn nasty(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut numbers = Numbers::new(seed);
    let bounds = mesh.bounds();
    let (centre, extent) = if bounds.is_empty() {
        (Vec3::ZERO, Vec3::ONE)
    } else {
        (bounds.centre(), bounds.max * 0.5 - bounds.min * 0.5)
    };
    let size = extent.max_element().max(f32::MIN_POSITIVE);
    let corner = [[0.0; 3]; 3];
    (0..count)
        .map(|i| {
            let pick = numbers.below(mesh.len());
            let [a, b, c] = mesh.triangles().get(pick).copied().unwrap_or(corner);
            let around = |numbers: &mut Numbers, reach: f32| -> [f32; 3] {
                let v = numbers.vector();
                std::array::from_fn(|k| centre[k] + v[k] * size * reach)
            };
            let target = match numbers.below(5) {
                0 => a,
                1 => mix(a, b, numbers.unit()),
                2 => mix(b, c, 0.5),
                3 => mix(mix(a, b, numbers.unit()), c, numbers.unit()),
                _ => around(&mut numbers, 1.0),
            };
            one(&mut numbers, i, [a, b, c], target, around)
        })
        .collect()
}

fn one(
    numbers: &mut Numbers,
    kind: usize,
    [a, b, c]: [[f32; 3]; 3],
    target: [f32; 3],
    around: impl Fn(&mut Numbers, f32) -> [f32; 3],
) -> Ray {
    let origin = around(numbers, 2.0);
    let mut ray = Ray::new(origin, sub(target, origin));
    match kind % 12 {
        // Along an axis, through the target, with zeros of either sign.
        0 | 1 => {
            let axis = numbers.below(3);
            let zero = if kind.is_multiple_of(12) { 0.0 } else { -0.0 };
            let towards = if numbers.below(2) == 0 { 1.0 } else { -1.0 };
            ray.direction = [zero; 3];
            ray.direction[axis] = towards;
            ray.origin = std::array::from_fn(|k| if k == axis { origin[k] } else { target[k] });
        }
        // In a coordinate plane.
        2 => {
            let axis = numbers.below(3);
            ray.origin[axis] = target[axis];
            ray.direction[axis] = 0.0;
        }
        // From the surface, or from a corner, in any direction.
        3 => ray = Ray::new(target, numbers.vector()),
        4 => ray = Ray::new(a, sub(target, a)),
        // Along an edge, in the plane of the triangle.
        5 => ray = Ray::new(a, sub(b, a)),
        6 => {
            let from = mix(a, b, -1.0);
            ray = Ray::new(from, sub(mix(b, c, numbers.unit()), from));
        }
        // Tiny or enormous directions.
        7 => ray.direction = ray.direction.map(|d| d * 1e-30 * 1e-12),
        8 => ray.direction = ray.direction.map(|d| d * 1e30),
        // From far away.
        9 => {
            let origin = around(numbers, 1e4);
            ray = Ray::new(origin, sub(target, origin));
        }
        // Ray segments, including reversed ones.
        10 => {
            let (x, y) = (numbers.unit() * 3.0 - 1.0, numbers.unit() * 3.0 - 1.0);
            (ray.t_min, ray.t_max) = (x.min(y), x.max(y));
        }
        _ => {}
    }
    if numbers.below(8) == 0 {
        ray.t_min = f32::NEG_INFINITY;
    }
    ray
}

/// Rays that must hit nothing.
pub fn senseless() -> Vec<Ray> {
    let sound = Ray::new([0.1, 0.2, 5.0], [0.0, 0.0, -1.0]);
    vec![
        Ray { origin: [f32::NAN, 0.0, 0.0], ..sound },
        Ray { origin: [0.0, f32::INFINITY, 0.0], ..sound },
        Ray { direction: [0.0, -0.0, 0.0], ..sound },
        Ray { direction: [0.0, f32::NAN, 1.0], ..sound },
        Ray { direction: [0.0, f32::NEG_INFINITY, 1.0], ..sound },
        Ray { t_min: f32::NAN, ..sound },
        Ray { t_max: f32::NAN, ..sound },
        Ray { t_min: 2.0, t_max: 1.0, ..sound },
        Ray { t_max: f32::NEG_INFINITY, ..sound },
    ]
}
