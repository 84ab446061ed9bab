//! Undoes the filters that were applied to elements before they were compressed.

use std::f32::consts::FRAC_1_SQRT_2;

/// A filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Filter {
    None,
    /// Directions, octahedrally encoded.
    Octahedral,
    /// Quaternions without their largest component.
    Quaternion,
    /// Floats that share their exponents.
    Exponential,
}

impl Filter {
    pub(super) fn from_name(name: &str) -> Option<Filter> {
        Some(match name {
            "NONE" => Filter::None,
            "OCTAHEDRAL" => Filter::Octahedral,
            "QUATERNION" => Filter::Quaternion,
            "EXPONENTIAL" => Filter::Exponential,
            _ => return None,
        })
    }

    /// True if the filter applies to elements of this many bytes.
    pub(super) fn takes(self, stride: usize) -> bool {
        match self {
            Filter::None | Filter::Exponential => stride.is_multiple_of(4),
            Filter::Octahedral => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
        }
    }

    /// Undoes the filter for all elements.
    pub(super) fn undo(self, stride: usize, elements: &mut [u8]) {
        match (self, stride) {
            (Filter::None, _) => {}
            (Filter::Octahedral, 4) => elements.chunks_exact_mut(4).for_each(|bytes| {
                let [x, y, one] = [bytes[0], bytes[1], bytes[2]].map(|byte| f32::from(byte as i8));
                let direction = unfolded(x, y, one).map(|c| rounded(c * 127.0) as i8 as u8);
                bytes[..3].copy_from_slice(&direction);
            }),
            (Filter::Octahedral, _) => elements.chunks_exact_mut(8).for_each(|bytes| {
                let [x, y, one] = [0, 2, 4].map(|at| f32::from(short(bytes, at)));
                put(bytes, &unfolded(x, y, one).map(|c| rounded(c * 32767.0) as i16));
            }),
            (Filter::Quaternion, _) => elements.chunks_exact_mut(8).for_each(|bytes| {
                let turned = rotation([0, 2, 4, 6].map(|at| short(bytes, at)));
                put(bytes, &turned);
            }),
            (Filter::Exponential, _) => elements.chunks_exact_mut(4).for_each(|bytes| {
                let packed = i32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                bytes.copy_from_slice(&float(packed).to_le_bytes());
            }),
        }
    }
}

/// The direction at a point of the unfolded octahedron, whose corners are at a distance of `one`.
fn unfolded(x: f32, y: f32, one: f32) -> [f32; 3] {
    let z = one - x.abs() - y.abs();
    let beyond = z.min(0.0);
    let back = |c: f32| if c >= 0.0 { c + beyond } else { c - beyond };
    let (x, y) = (back(x), back(y));
    let length = (x * x + y * y + z * z).sqrt();
    let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
    [x * scale, y * scale, z * scale]
}

/// Restores a quaternion from its three smaller components, each at most the square root of a half.
///
/// The two lowest bits of the fourth number state which component is missing. With both bits set, the fourth
/// number is the code of the square root of a half.
fn rotation(packed: [i16; 4]) -> [i16; 4] {
    let scale = FRAC_1_SQRT_2 / f32::from(packed[3] | 3);
    let [x, y, z] = [packed[0], packed[1], packed[2]].map(|c| f32::from(c) * scale);
    let greatest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let first = (packed[3] & 3) as usize;
    let mut turned = [0; 4];
    for (i, c) in [greatest, x, y, z].into_iter().enumerate() {
        turned[(first + i) & 3] = rounded(c * 32767.0) as i16;
    }
    turned
}

/// A 24-bit integer mantissa times two to the power of an 8-bit exponent.
fn float(packed: i32) -> f32 {
    let (exponent, mantissa) = (packed >> 24, packed << 8 >> 8);
    // In f64, since the power by itself may be out of range for an f32.
    let power = |exponent: i32| f64::from_bits(((1023 + exponent) as u64) << 52);
    (f64::from(mantissa) * power(exponent)) as f32
}

fn rounded(x: f32) -> i32 {
    (x + 0.5f32.copysign(x)) as i32
}

fn short(bytes: &[u8], at: usize) -> i16 {
    i16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn put(bytes: &mut [u8], numbers: &[i16]) {
    for (bytes, number) in bytes.chunks_exact_mut(2).zip(numbers) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_rotations_and_floats_come_back() {
        let mut up = [0, 0, 127, 9];
        Filter::Octahedral.undo(4, &mut up);
        assert_eq!(up, [0, 0, 127, 9]);
        let mut down = [127, 127, 127, 0];
        Filter::Octahedral.undo(4, &mut down);
        assert_eq!(down[..3], [0, 0, 129], "the corners of the net are below");
        // The identity: w, the fourth component, is the largest and the others are 0.
        assert_eq!(rotation([0, 0, 0, 2047 & !3 | 3]), [0, 0, 0, 32767]);
        // A quarter turn about x: x = w, and the first is left out.
        let one = 2047 & !3;
        assert_eq!(rotation([0, 0, one | 3, one])[..3], [23170, 0, 0]);
        assert_eq!(float(3 << 24 | 5), 40.0);
        assert_eq!(float(-2 << 24 | (-3 & 0xff_ffff)), -0.75);
        assert_eq!(float(i32::MIN | 1), (f64::from_bits((1023 - 128) << 52)) as f32);
    }
}
