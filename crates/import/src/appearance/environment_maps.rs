//! Pictures of all directions, in the mappings of other programs. Bilux uses longitude and latitude.

use crate::FormatError;
use crate::input::reading::Reading;
use bilux_math::transcendental::{acos_f64, atan2_f64, sin_cos_f64};
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::{Span, Texture};
use std::f64::consts::{FRAC_2_PI, PI, TAU};

/// Mapping of an image to directions; z is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// The upper hemisphere is the inner square, standing on its corner; the lower one fills the four corners.
    /// [Clarberg 2008]
    Square,
    /// Longitude and latitude, as in version 3.
    Latitudes,
}

impl Mapping {
    /// The image position of a unit direction, from 0 to 1 from the left and from the top.
    pub fn place(self, d: DVec3) -> [f64; 2] {
        if self == Mapping::Latitudes {
            let u = atan2_f64(d.y, d.x) / TAU;
            return [u - u.floor(), acos_f64(d.z.clamp(-1.0, 1.0)) / PI];
        }
        let (x, y) = (d.x.abs(), d.y.abs());
        let r = (1.0 - d.z.abs()).max(0.0).sqrt();
        let phi = if x == 0.0 && y == 0.0 { 0.0 } else { atan2_f64(y, x) * FRAC_2_PI };
        let (v, u) = (phi * r, r - phi * r);
        let (u, v) = if d.z < 0.0 { (1.0 - v, 1.0 - u) } else { (u, v) };
        [(u.copysign(d.x) + 1.0) * 0.5, (v.copysign(d.y) + 1.0) * 0.5]
    }
}

/// The direction at a position on the square. [Clarberg 2008]
pub fn on_the_sphere(u: f64, v: f64) -> DVec3 {
    let (u, v) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (x, y) = (u.abs(), v.abs());
    let depth = 1.0 - (x + y);
    let r = 1.0 - depth.abs();
    let phi = if r == 0.0 { 1.0 } else { (y - x) / r + 1.0 } * PI / 4.0;
    let (sin, cos) = sin_cos_f64(phi);
    let (z, across) = (1.0 - r * r, r * (2.0 - r * r).sqrt());
    DVec3::new(across * cos.copysign(u), across * sin.copysign(v), z.copysign(depth))
}

/// The bilinear interpolation of the four texels around a direction.
pub fn looked_up(picture: &Texture, mapping: Mapping, d: DVec3) -> Rgb {
    let (width, height) = (picture.width() as i64, picture.height() as i64);
    let [u, v] = mapping.place(d);
    let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = ((x - x0) as f32, (y - y0) as f32);
    let texel = |dx: i64, dy: i64| {
        let [x, y] = wrapped(mapping, [x0 as i64 + dx, y0 as i64 + dy], [width, height]);
        picture.texel(x, y)
    };
    texel(0, 0).lerp(texel(1, 0), fx).lerp(texel(0, 1).lerp(texel(1, 1), fx), fy)
}

/// The texel at a position at most one beyond an edge.
fn wrapped(mapping: Mapping, [x, y]: [i64; 2], [width, height]: [i64; 2]) -> [usize; 2] {
    if mapping == Mapping::Latitudes {
        return [x.rem_euclid(width) as usize, y.clamp(0, height - 1) as usize];
    }
    // Beyond an edge of the square, the same edge continues in the opposite direction.
    let (mut x, mut y) = (x, y);
    if x < 0 || x >= width {
        (x, y) = (x.clamp(0, width - 1), height - 1 - y);
    }
    if y < 0 || y >= height {
        (x, y) = (width - 1 - x, y.clamp(0, height - 1));
    }
    [x.clamp(0, width - 1) as usize, y.clamp(0, height - 1) as usize]
}

/// Resamples the image to Bilux's mapping in world space: its middle at -z, and +y up.
pub fn by_longitude(
    name: &str,
    picture: &Texture,
    mapping: Mapping,
    matrix: &DMat4,
    at: &Span,
    reading: &mut Reading,
) -> Result<Texture, FormatError> {
    /// The maximum number of rows.
    const MAX: usize = 4096;
    if !picture.image.is_whole() {
        return Ok(picture.clone());
    }
    let to_light = matrix.inverse();
    if !to_light.is_finite() {
        return Err(FormatError::malformed("this light has a scale of zero", at.clone()));
    }
    let height = picture.height().clamp(16, MAX);
    let width = 2 * height;
    let bytes = (width * height * size_of::<Rgb>()) as u64;
    reading.budget.take_bytes(bytes, name)?;
    let mut texels = Vec::with_capacity(width * height);
    for row in 0..height {
        let (r, y) = sin_cos_f64(PI * (row as f64 + 0.5) / height as f64);
        for column in 0..width {
            let (sin, cos) = sin_cos_f64(TAU * ((column as f64 + 0.5) / width as f64 - 0.5));
            let direction = DVec3::new(r * sin, y, -r * cos);
            let d = to_light.transform_vector3(direction).try_normalize().unwrap_or(DVec3::Z);
            texels.push(looked_up(picture, mapping, d));
        }
    }
    reading.budget.release(bytes);
    reading.picture(name, [width, height], texels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_is_of_equal_area_and_its_middle_is_up() {
        let middle = Mapping::Square.place(DVec3::Z);
        assert_eq!(middle, [0.5, 0.5]);
        assert_eq!(Mapping::Square.place(DVec3::X), [1.0, 0.5]);
        // Uniformly distributed directions fill equal parts of the square equally.
        let mut counts = [0u32; 16];
        let (n, m) = (200, 200);
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
            let (sin, cos) = sin_cos_f64(TAU * (f64::from(j) + 0.5) / f64::from(m));
            let r = (1.0 - z * z).sqrt();
            let [u, v] = Mapping::Square.place(DVec3::new(r * cos, r * sin, z));
            assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v));
            counts[((v * 4.0) as usize).min(3) * 4 + ((u * 4.0) as usize).min(3)] += 1;
        }
        let mean = (n * m) as f64 / 16.0;
        assert!(counts.iter().all(|&c| (f64::from(c) / mean - 1.0).abs() < 0.03), "{counts:?}");
    }

    /// Worked out by hand from the book's formulas, to detect mirrored or swapped axes. [pbrt 2023, 3.8.3]
    #[test]
    fn positions_on_the_square_match_the_book() {
        let r = 0.661_438; // 0.5 √1.75
        for ([u, v], wanted) in [
            ([0.75, 0.5], DVec3::new(r, 0.0, 0.75)),
            ([0.5, 0.75], DVec3::new(0.0, r, 0.75)),
            ([0.25, 0.5], DVec3::new(-r, 0.0, 0.75)),
            ([0.5, 0.25], DVec3::new(0.0, -r, 0.75)),
            // In a corner, and so in the lower hemisphere: r = 0.4, and 0.4 √1.84 / √2 is 0.383 667.
            ([0.9, 0.9], DVec3::new(0.383_667, 0.383_667, -0.84)),
            ([0.9, 0.1], DVec3::new(0.383_667, -0.383_667, -0.84)),
        ] {
            let found = on_the_sphere(u, v);
            assert!((found - wanted).length() < 1e-5, "{u} {v}: {found}");
            let [x, y] = Mapping::Square.place(wanted);
            assert!((x - u).abs() + (y - v).abs() < 1e-5, "{wanted}: {x} {y}");
        }
    }

    #[test]
    fn directions_round_trip_through_the_square() {
        for (i, j) in (0..32).flat_map(|i| (0..32).map(move |j| (i, j))) {
            let [u, v] = [i, j].map(|k| (f64::from(k) + 0.4) / 32.0);
            let [x, y] = Mapping::Square.place(on_the_sphere(u, v));
            assert!((x - u).abs() + (y - v).abs() < 1e-9, "{u} {v} {x} {y}");
        }
    }

    #[test]
    fn texels_beyond_an_edge_of_the_square_are_neighbours_on_the_sphere() {
        // The two halves of an edge coincide, mirrored about its middle.
        let (beside, across) = (on_the_sphere(1.0 - 1e-9, 2.5 / 8.0), on_the_sphere(1.0 - 1e-9, 5.5 / 8.0));
        assert!((beside - across).length() < 1e-3, "{beside} {across}");
        assert_eq!(wrapped(Mapping::Square, [8, 2], [8, 8]), [7, 5]);
        assert_eq!(wrapped(Mapping::Square, [2, -1], [8, 8]), [5, 0]);
    }
}
