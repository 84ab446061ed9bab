//! The curves of ICC profiles, from samples to light. [ICC.1:2022, 10.6 and 10.18]

use crate::ColourSpace;
use bilux_math::transcendental::powf_f64;

/// From a sample to light.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Curve {
    /// One that pictures have.
    Known(ColourSpace),
    /// A power.
    Power(f64),
    /// Light at equal steps of samples, two or more. [ICC.1:2022, 10.6]
    Table(Vec<f32>),
    /// A function of this kind with parameters g, a, b, c, d, e and f, as far as it has them. [ICC.1:2022, 10.18]
    Function { kind: u16, numbers: [f64; 7] },
}

impl Curve {
    /// The one that these bytes of a tag describe; `None` if they are none.
    pub(super) fn of(curve: &[u8]) -> Option<Curve> {
        match curve.get(..4)? {
            b"curv" => match u32_at(curve, 8)? as usize {
                0 => Some(Curve::Power(1.0)),
                1 => Some(Curve::Power(f64::from(u16_at(curve, 12)?) / 256.0)),
                count => {
                    let entries = curve.get(12..12 + count.checked_mul(2)?)?.as_chunks::<2>().0;
                    let light = |pair: &[u8; 2]| f32::from(u16::from_be_bytes(*pair)) / 65535.0;
                    Some(Curve::Table(entries.iter().map(light).collect()))
                }
            },
            b"para" => {
                let kind = u16_at(curve, 8)?;
                let count = *[1, 3, 4, 5, 7].get(usize::from(kind))?;
                let mut numbers = [0.0; 7];
                for (i, number) in numbers.iter_mut().take(count).enumerate() {
                    *number = f64::from(u32_at(curve, 12 + 4 * i)?.cast_signed()) / 65536.0;
                }
                Some(Curve::Function { kind, numbers })
            }
            _ => None,
        }
    }

    /// The light of a sample, which is within 0 and 1.
    pub(super) fn light(&self, sample: f64) -> f64 {
        match self {
            Curve::Known(space) => f64::from(space.decode(sample as f32)),
            Curve::Power(power) => powf_f64(sample.max(0.0), *power),
            Curve::Table(entries) => {
                let at = sample.clamp(0.0, 1.0) * (entries.len() - 1) as f64;
                let below = (at as usize).min(entries.len() - 2);
                let [low, high] = [entries[below], entries[below + 1]].map(f64::from);
                low + (high - low) * (at - below as f64)
            }
            Curve::Function { kind, numbers: [g, a, b, c, d, e, f] } => {
                let power = |base: f64| powf_f64(base.max(0.0), *g);
                let bent = power(a * sample + b);
                match kind {
                    0 => power(sample),
                    // Below where its base is 0, a power is 0.
                    1 => bent,
                    2 => bent + c,
                    3 if sample >= *d => bent,
                    3 => c * sample,
                    _ if sample >= *d => bent + e,
                    _ => c * sample + f,
                }
            }
        }
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|pair| u16::from_be_bytes(*pair))
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|four| u32::from_be_bytes(*four))
}
