//! ICC profiles of the kind that pictures have, a curve for each channel and a matrix: what samples mean. [ICC.1:2022]

use super::curve::{Curve, u32_at};
use super::meaning::Meaning;
use super::primaries::{self, Matrix, REC709};
use crate::ColourSpace;
use bilux_math::transcendental::ln_f64;

/// Meaning of samples by a profile; `None` if it has no curve of red or of grey, or is damaged.
pub(super) fn meaning(profile: &[u8]) -> Option<Meaning> {
    let curve = |name: &[u8; 4]| Curve::of(tag(profile, *name)?);
    let first = curve(b"rTRC").or_else(|| curve(b"kTRC"))?;
    let Some(matrix) = matrix(profile).filter(|matrix| !primaries::is_identity(matrix, SAME)) else {
        return Some(Meaning::Plain(of_middle(first.light(0.5))));
    };
    let [green, blue] = [b"gTRC", b"bTRC"].map(|name| curve(name).unwrap_or_else(|| first.clone()));
    Some(Meaning::Wide { curves: Box::new([first, green, blue]), matrix })
}

/// Meaning of samples by a profile; sRGB without a profile, or with one that states none.
pub(super) fn meaning_or_srgb(profile: Option<&[u8]>) -> Meaning {
    profile.and_then(meaning).unwrap_or(Meaning::Plain(ColourSpace::Srgb))
}

/// Entries of the matrix to Rec. 709 that differ less from those of a unit matrix are roundings of the same primaries: makers
/// of profiles of sRGB do not agree on their third digits.
const SAME: f64 = 0.02;

/// Colour space of a curve whose value for half is this: straight, that of sRGB and powers near it, or a power. No two curves
/// in use meet there.
fn of_middle(light: f64) -> ColourSpace {
    // Half of the sRGB curve is .2140, and half to the power of 2.2 is .2176.
    match light {
        light if (light - 0.5).abs() < 0.01 => ColourSpace::LinearRec709,
        light if (light - 0.216).abs() < 0.008 || !(1e-3..0.999).contains(&light) => ColourSpace::Srgb,
        light => ColourSpace::Gamma((ln_f64(light) / ln_f64(0.5)).recip() as f32),
    }
}

/// The white of the space that profiles connect: D50. [ICC.1:2022, 7.2.16]
const D50: [f64; 3] = [0.9642, 1.0, 0.8249];

/// From light of a profile's primaries to Rec. 709. The profile has them adapted to D50 by Bradford's matrix, as Rec. 709 is
/// here. [ICC.1:2022, annexes E and F]
fn matrix(profile: &[u8]) -> Option<Matrix> {
    let column = |name: &[u8; 4]| {
        let xyz = tag(profile, *name).filter(|data| data.starts_with(b"XYZ "))?;
        let number = |i: usize| Some(f64::from(u32_at(xyz, 8 + 4 * i)?.cast_signed()) / 65536.0);
        Some([number(0)?, number(1)?, number(2)?])
    };
    let [r, g, b] = [column(b"rXYZ")?, column(b"gXYZ")?, column(b"bXYZ")?];
    let from = [0, 1, 2].map(|row: usize| [r[row], g[row], b[row]]);
    let to = primaries::inverse(&primaries::adapted_to(REC709, D50)?)?;
    let mut matrix = primaries::multiply(&to, &from);
    for row in &mut matrix {
        let white: f64 = row.iter().sum();
        // White stays white in spite of roundings. What is farther from it is no profile of a picture.
        if !(0.9..1.1).contains(&white) {
            return None;
        }
        row.iter_mut().for_each(|entry| *entry /= white);
    }
    Some(matrix)
}

/// The bytes of a tag. [ICC.1:2022, 7.3]
fn tag(profile: &[u8], signature: [u8; 4]) -> Option<&[u8]> {
    let count = u32_at(profile, 128)? as usize;
    let entries = profile.get(132..)?.chunks_exact(12).take(count);
    let entry = entries.into_iter().find(|entry| entry.starts_with(&signature))?;
    let [start, length] = [u32_at(entry, 4)? as usize, u32_at(entry, 8)? as usize];
    profile.get(start..start.checked_add(length)?)
}
