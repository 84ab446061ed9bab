//! Noise in space: slopes at the corners of a lattice, blended smoothly. [Perlin 2002]

use bilux_math::Vec3;

/// The order in which corners take their slopes. [Perlin 2002]
#[rustfmt::skip]
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225,
    140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122,
    60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241,
    81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

/// Slopes towards the edges of a cube; four of the twelve count twice. [pbrt 2023]
#[rustfmt::skip]
const SLOPES: [[f32; 3]; 16] = [
    [1., 1., 0.], [-1., 1., 0.], [1., -1., 0.], [-1., -1., 0.],
    [1., 0., 1.], [-1., 0., 1.], [1., 0., -1.], [-1., 0., -1.],
    [0., 1., 1.], [0., -1., 1.], [0., 1., -1.], [0., -1., -1.],
    [1., 1., 0.], [-1., 1., 0.], [0., 1., -1.], [0., -1., -1.],
];

/// The noise at a point: 0 at corners of the lattice of whole numbers, and about -1 to 1; it repeats every 256 cells. [Perlin 2002]
pub(super) fn noise(p: Vec3) -> f32 {
    // Further away, f32 has no numbers between the corners; and of what is no number there is no noise.
    if p.is_nan() || p.abs().max_element() >= 1e9 {
        return 0.0;
    }
    let (mut cell, mut inside) = ([0u8; 3], [0.0; 3]);
    for axis in 0..3 {
        let towards_zero = p[axis] as i32;
        let floor = towards_zero - i32::from(p[axis] < towards_zero as f32);
        (cell[axis], inside[axis]) = (floor as u8, p[axis] - floor as f32);
    }
    let [x, y, z] = cell;
    let hash = |place: u8, step: u8| PERMUTATION[usize::from(place.wrapping_add(step))];
    let height = |i: u8, j: u8, k: u8| {
        let edge = hash(hash(x, i), y.wrapping_add(j));
        let [dx, dy, dz] = SLOPES[usize::from(hash(edge, z.wrapping_add(k)) & 15)];
        let [x, y, z] = inside;
        dx * (x - f32::from(i)) + dy * (y - f32::from(j)) + dz * (z - f32::from(k))
    };
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v, w) = (fade(inside[0]), fade(inside[1]), fade(inside[2]));
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |j: u8, k: u8| lerp(height(0, j, k), height(1, j, k), u);
    lerp(lerp(along_x(0, 0), along_x(1, 0), v), lerp(along_x(0, 1), along_x(1, 1), v), w)
}

/// Slope of the noise along each axis, by differences over a hundredth of a cell.
pub(super) fn rise(p: Vec3) -> Vec3 {
    const STEP: f32 = 0.01;
    let here = noise(p);
    let towards = |axis: Vec3| (noise(p + axis * STEP) - here) / STEP;
    Vec3::new(towards(Vec3::X), towards(Vec3::Y), towards(Vec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_numbers_are_in_the_permutation() {
        let mut seen = PERMUTATION;
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(i, value)| usize::from(*value) == i));
    }

    /// Computed by another program, in double precision, from the tables of slopes and orders as pbrt has them.
    #[test]
    fn it_is_the_noise_of_pbrt() {
        for (p, wanted) in [
            ([0.5, 0.25, 0.75], -0.375079),
            ([3.2, 41.5, 7.7], 0.177538),
            ([-0.3, -1.6, 2.2], 0.334214),
            ([255.5, 255.25, -0.5], -0.202637),
            ([100.1, 200.7, 31.9], -0.441643),
            ([-1000.4, 17.3, 300.8], -0.025359),
        ] {
            let found = noise(Vec3::from(p));
            assert!((found - wanted).abs() < 2e-5, "{found} for {wanted} at {p:?}");
        }
        assert_eq!(noise(Vec3::new(3.0, -7.0, 250.0)), 0.0);
        assert_eq!(noise(Vec3::splat(f32::INFINITY)), 0.0);
    }

    #[test]
    fn it_rises_as_its_differences_say_and_repeats() {
        let p = Vec3::new(0.3, 1.6, -2.2);
        let step = 1e-3;
        for axis in 0..3 {
            let along = Vec3::AXES[axis] * step;
            let slope = (noise(p + along) - noise(p - along)) / (2.0 * step);
            assert!((slope - rise(p)[axis]).abs() < 0.06, "{slope} {}", rise(p));
        }
        assert!((noise(p) - noise(p + 256.0)).abs() < 1e-3);
    }
}
