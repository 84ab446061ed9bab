//! The only source of transcendental functions (`clippy.toml` bans the standard library's).
//!
//! `libm` is pure Rust, so that the same call gives the same bits on every machine, which the platform's own C
//! library does not guarantee. Square roots, `floor` and `abs` are exact in IEEE 754 and are used from `std`.

pub use libm::{
    acos as acos_f64, acosf as acos, asin as asin_f64, asinf as asin, atan2 as atan2_f64, atan2f as atan2,
    atanf as atan, cos as cos_f64, cosf as cos, exp as exp_f64, expf as exp, log as ln_f64, log2f as log2,
    logf as ln, pow as powf_f64, powf, sin as sin_f64, sincos as sin_cos_f64, sincosf as sin_cos,
    sinf as sin, tan as tan_f64, tanf as tan,
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

#[cfg(test)]
mod tests {
    use super::*;

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
