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
