//! Numbers of 16 bits: IEEE 754's binary16. Those of grids have no sign.

/// Halves are exact from here to their maximum; smaller values lose digits.
const HALF_NORMAL: f32 = 6.103_515_6e-5;
const HALF_MAX: f32 = 65_504.0;

/// The factor on halves: 1 where they hold values like this maximum well, so that halves of files stay as they are; otherwise a power
/// of two.
pub(super) fn scale_of(largest: f32) -> f32 {
    let holds = (1024.0 * HALF_NORMAL..=HALF_MAX).contains(&largest) || largest == 0.0;
    // The exponent of a half's maximum is 15.
    let exponent = (largest.to_bits() >> 23) as i32 - 127 - 14;
    if holds { 1.0 } else { f32::from_bits(((exponent + 127).clamp(1, 254) as u32) << 23) }
}

/// The half nearest to a number that is not negative, and at most the maximum of halves.
#[inline(always)]
pub(super) fn half(x: f32) -> u16 {
    // Adding this rounds subnormal halves to their last digit; others lose 13 digits, to even. Both are computed, for vectors.
    let subnormal = (x + 0.5).to_bits() - 0.5f32.to_bits();
    let bits = x.min(HALF_MAX).to_bits().wrapping_sub(112 << 23);
    let normal = bits.wrapping_add(0xfff + (bits >> 13 & 1)) >> 13;
    (if x < HALF_NORMAL { subnormal } else { normal }) as u16
}

/// A half that is neither negative nor infinite.
#[inline(always)]
pub(super) fn from_half(half: u16) -> f32 {
    // 2¹¹², the difference of the exponents.
    f32::from_bits(u32::from(half) << 13) * f32::from_bits((112 + 127) << 23)
}

/// Any number of binary16, given by its bits.
#[inline(always)]
pub fn from_binary16(bits: u16) -> f32 {
    let digits = u32::from(bits & 0x3ff) << 13;
    let is_finite = bits & 0x7c00 != 0x7c00;
    let magnitude =
        if is_finite { from_half(bits & 0x7fff).to_bits() } else { f32::INFINITY.to_bits() | digits };
    f32::from_bits(magnitude | u32::from(bits & 0x8000) << 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_those_of_the_standard() {
        let cases = [
            (0.0, 0),
            (5.960_464_5e-8, 1),
            (6.103_515_6e-5, 0x400),
            (1.0, 0x3c00),
            (1.000_976_6, 0x3c01),
            (65_504.0, 0x7bff),
        ];
        for (number, bits) in cases {
            assert_eq!((half(number), from_half(bits)), (bits, number));
        }
        assert_eq!(half(1.0 + 1.0 / 2048.0), 0x3c00, "ties go to even");
        assert!((0..0x7c00u16).all(|bits| half(from_half(bits)) == bits));
        let infinite = [0x7c00, 0xfc00, 0x7e00].map(from_binary16);
        assert!(infinite[0] == f32::INFINITY && infinite[1] == f32::NEG_INFINITY && infinite[2].is_nan());
        assert!((0..0x7c00u16).all(|bits| from_binary16(bits | 0x8000) == -from_half(bits)));
    }
}
