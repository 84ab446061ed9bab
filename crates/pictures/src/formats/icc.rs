//! The tone curve of an ICC profile: what the samples of a picture mean. [ICC.1:2022]

use crate::ColourSpace;
use bilux_math::transcendental::{ln_f64, powf_f64};

/// How samples are encoded by the curve of red, or of grey; `None` if the profile has no such curve, or is damaged.
///
/// The value of the curve in its middle tells: no two curves in use meet there. The primaries are not looked at.
pub(super) fn colour_space(profile: &[u8]) -> Option<ColourSpace> {
    let curve = tag(profile, *b"rTRC").or_else(|| tag(profile, *b"kTRC"))?;
    Some(of_middle(middle(curve)?))
}

/// What a curve is whose value for half is this: straight, that of sRGB and powers near it, or a power.
fn of_middle(light: f64) -> ColourSpace {
    // Half of the sRGB curve is .2140, and half to the power of 2.2 is .2176.
    match light {
        light if (light - 0.5).abs() < 0.01 => ColourSpace::LinearRec709,
        light if (light - 0.216).abs() < 0.008 || !(1e-3..0.999).contains(&light) => ColourSpace::Srgb,
        light => ColourSpace::Gamma((ln_f64(light) / ln_f64(0.5)).recip() as f32),
    }
}

/// The bytes of a tag. [ICC.1:2022, 7.3]
fn tag(profile: &[u8], signature: [u8; 4]) -> Option<&[u8]> {
    let count = u32_at(profile, 128)? as usize;
    let entries = profile.get(132..)?.chunks_exact(12).take(count);
    let entry = entries.into_iter().find(|entry| entry.starts_with(&signature))?;
    let [start, length] = [u32_at(entry, 4)? as usize, u32_at(entry, 8)? as usize];
    profile.get(start..start.checked_add(length)?)
}

/// The value of a curve for half: of a table, of a power, or of a function with parameters. [ICC.1:2022, 10.6 and 10.18]
fn middle(curve: &[u8]) -> Option<f64> {
    match curve.get(..4)? {
        b"curv" => match u32_at(curve, 8)? as usize {
            0 => Some(0.5),
            1 => Some(powf_f64(0.5, f64::from(u16_at(curve, 12)?) / 256.0)),
            count => {
                let at = |i: usize| u16_at(curve, 12 + 2 * i).map(|value| f64::from(value) / 65535.0);
                Some(0.5 * (at((count - 1) / 2)? + at(count / 2)?))
            }
        },
        b"para" => {
            let number = |i: usize| Some(f64::from(u32_at(curve, 12 + 4 * i)? as i32) / 65536.0);
            let power = |base: f64| Some(powf_f64(base.max(0.0), number(0)?));
            match u16_at(curve, 8)? {
                0 => power(0.5),
                // Half is above the straight part of every curve in use.
                1 | 3 => power(number(1)? * 0.5 + number(2)?),
                2 => Some(power(number(1)? * 0.5 + number(2)?)? + number(3)?),
                4 => Some(power(number(1)? * 0.5 + number(2)?)? + number(5)?),
                _ => None,
            }
        }
        _ => None,
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|pair| u16::from_be_bytes(*pair))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|four| u32::from_be_bytes(*four))
}
