//! The only source of transcendental functions (`clippy.toml` bans the standard library's).
//!
//! `libm` is pure Rust, so that the same call gives the same bits on every machine, which the platform's own C
//! library does not guarantee. Square roots, `floor` and `abs` are exact in IEEE 754 and are used from `std`.

pub use libm::{
    acos as acos_f64, acosf as acos, asin as asin_f64, asinf as asin, atan2 as atan2_f64, atan2f as atan2,
    atanf as atan, cos as cos_f64, cosf as cos, erf as erf_f64, erff as erf, exp as exp_f64, expf as exp,
    lgamma as ln_gamma_f64, log as ln_f64, log2f as log2, logf as ln, pow as powf_f64, powf, sin as sin_f64,
    sincos as sin_cos_f64, sincosf as sin_cos, sinf as sin, tan as tan_f64, tanf as tan,
};

/// Sine and cosine for `|x| <= π/4`, without a branch, so that loops over many angles can be vectorised. The error is at
/// most one unit in the last place. [Moshier 1992, sinf]
#[inline(always)]
pub fn sin_cos_near_zero(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * x + x;
    let cos = ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0;
    (sin, cos)
}

/// Sine and cosine of an angle in whole turns, 0..=1, without a branch. The error is at most one unit in the last place of
/// [`sin_cos_near_zero`] for the angle's distance from the nearest quarter turn.
#[inline(always)]
pub fn sin_cos_of_turns(turns: f32) -> (f32, f32) {
    let quarters = 4.0 * turns;
    let nearest = (quarters + 0.5) as i32;
    let (sin, cos) = sin_cos_near_zero((quarters - nearest as f32) * std::f32::consts::FRAC_PI_2);
    let (sin, cos) = if nearest & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let signed = |x: f32, is_negative: bool| if is_negative { -x } else { x };
    (signed(sin, nearest & 2 != 0), signed(cos, (nearest + 1) & 2 != 0))
}

/// The angle of the point (`x`, `y`) from the positive x axis in whole turns, -0.5..=0.5, without a branch, so that loops over
/// many points can be vectorised; 0 at the origin. The absolute error is below 6e-8 turns. [Moshier 1992, atanf]
#[inline(always)]
pub fn turns_of_point(x: f32, y: f32) -> f32 {
    const TAN_OF_SIXTEENTH: f32 = 0.414_213_56;
    let (long, short) = (x.abs().max(y.abs()), x.abs().min(y.abs()));
    let slope = short / long.max(f32::MIN_POSITIVE);
    let is_steep = slope > TAN_OF_SIXTEENTH;
    let rest = if is_steep { (slope - 1.0) / (slope + 1.0) } else { slope };
    let z = rest * rest;
    let series = (8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1;
    let angle = (series * z - 3.333_295e-1) * z * rest + rest;
    let eighth = angle * (1.0 / std::f32::consts::TAU) + if is_steep { 0.125 } else { 0.0 };
    let quarter = if y.abs() > x.abs() { 0.25 - eighth } else { eighth };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    half.copysign(y)
}

/// The arc cosine of `x`, which must be in -1..=1, without a branch, so that loops over many numbers can be vectorised. The error
/// is at most 4e-7. [Moshier 1992, asinf]
#[inline(always)]
pub fn acos_without_branch(x: f32) -> f32 {
    use std::f32::consts::{FRAC_PI_2, PI};
    let is_far = x.abs() > 0.5;
    let half = 0.5 * (1.0 - x.abs());
    let (z, root) = if is_far { (half, half.sqrt()) } else { (x * x, x.abs()) };
    let series = ((4.216_32e-2 * z + 2.418_131e-2) * z + 4.547_002_6e-2) * z + 7.495_300_3e-2;
    let arc_sine = (series * z + 1.666_675_2e-1) * z * root + root;
    let of_positive = if is_far { 2.0 * arc_sine } else { FRAC_PI_2 - arc_sine };
    if x < 0.0 { PI - of_positive } else { of_positive }
}

/// The inverse of [`erf`]: below 4 in magnitude, for numbers that f32 can tell from -1 and 1; those are taken as their
/// neighbours. The relative error is at most 1e-6. [Giles 2012]
pub fn inverse_erf(x: f32) -> f32 {
    let most = 1.0 - 0.5 * f32::EPSILON;
    let x = x.clamp(-most, most);
    let w = -ln((1.0 - x) * (1.0 + x));
    let series = |of: f32, coefficients: [f32; 9]| coefficients.iter().fold(0.0, |sum, c| sum * of + c);
    x * if w < 5.0 { series(w - 2.5, CENTRAL) } else { series(w.sqrt() - 3.0, TAIL) }
}

/// The coefficients of [`inverse_erf`], from the highest power down.
const CENTRAL: [f32; 9] = [
    2.810_226_4e-8,
    3.432_739_4e-7,
    -3.523_387_7e-6,
    -4.391_506_5e-6,
    2.185_808_7e-4,
    -1.253_725e-3,
    -4.177_681_6e-3,
    2.466_407_3e-1,
    1.501_409_4,
];
const TAIL: [f32; 9] = [
    -2.002_142_6e-4,
    1.009_505_6e-4,
    1.349_343_2e-3,
    -3.673_428_4e-3,
    5.739_508e-3,
    -7.622_461_3e-3,
    9.438_870_5e-3,
    1.001_674,
    2.832_976_8,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_the_error_function_is_one() {
        for i in -9999..=9999 {
            let x = f64::from(inverse_erf(i as f32 / 1e4));
            // Newton's step from there in f64.
            let slope = exp_f64(-x * x) * std::f64::consts::FRAC_2_SQRT_PI;
            let off = (erf_f64(x) - f64::from(i as f32 / 1e4)) / slope;
            assert!(off.abs() <= 1e-6 * x.abs(), "{i}: {x} is off by {off}");
        }
        assert!([-1.0, 1.0].map(inverse_erf).iter().all(|x| (3.5..4.0).contains(&x.abs())));
    }

    #[test]
    fn points_have_angles_all_around() {
        for i in 0..=100_000 {
            let turns = f64::from(i - 50_000) / 100_000.0;
            let (sin, cos) = sin_cos_f64(turns * std::f64::consts::TAU);
            for length in [1e-20, 0.3, 1.0, 1e20] {
                let (x, y) = ((cos * length) as f32, (sin * length) as f32);
                let exact = atan2_f64(f64::from(y), f64::from(x)) / std::f64::consts::TAU;
                let found = f64::from(turns_of_point(x, y));
                assert!((found - exact).abs() < 6e-8, "({x}, {y}): {found}, {exact}");
            }
        }
        assert_eq!(turns_of_point(0.0, 0.0), 0.0);
        assert_eq!((turns_of_point(-1.0, 0.0), turns_of_point(-1.0, -0.0)), (0.5, -0.5));
        assert_eq!((turns_of_point(0.0, 2.0), turns_of_point(0.0, -2.0)), (0.25, -0.25));
    }

    #[test]
    fn the_arc_cosine_without_a_branch_is_close() {
        let all = (-100_000..=100_000).map(|i| i as f32 / 100_000.0);
        for x in all.chain([1.0f32.next_down(), -1.0f32.next_down(), f32::MIN_POSITIVE, 0.5f32.next_up()]) {
            let (found, exact) = (f64::from(acos_without_branch(x)), acos_f64(f64::from(x)));
            assert!((found - exact).abs() <= 4e-7, "{x}: {found}, {exact}");
        }
        assert_eq!((acos_without_branch(1.0), acos_without_branch(-1.0)), (0.0, std::f32::consts::PI));
    }

    #[test]
    fn the_short_sine_and_cosine_are_right_to_the_last_place() {
        for i in -100_000..=100_000 {
            let x = i as f32 * (std::f32::consts::FRAC_PI_4 / 100_000.0);
            let (sin, cos) = sin_cos_near_zero(x);
            let (exact_sin, exact_cos) = sin_cos_f64(f64::from(x));
            let places = |found: f32, exact: f64| {
                let place = f64::from((exact as f32).abs().next_up() - (exact as f32).abs());
                (f64::from(found) - exact).abs() / place.max(f64::from(f32::MIN_POSITIVE))
            };
            assert!(places(sin, exact_sin) <= 1.0, "sin {x}: {sin}, {exact_sin}");
            assert!(places(cos, exact_cos) <= 1.0, "cos {x}: {cos}, {exact_cos}");
        }
    }

    #[test]
    fn turns_go_all_around() {
        for i in 0..=100_000 {
            let turns = i as f32 / 100_000.0;
            let (sin, cos) = sin_cos_of_turns(turns);
            let (exact_sin, exact_cos) = sin_cos_f64(f64::from(turns) * std::f64::consts::TAU);
            assert!((f64::from(sin) - exact_sin).abs() < 2e-7, "sin {turns}: {sin}, {exact_sin}");
            assert!((f64::from(cos) - exact_cos).abs() < 2e-7, "cos {turns}: {cos}, {exact_cos}");
        }
    }
}
