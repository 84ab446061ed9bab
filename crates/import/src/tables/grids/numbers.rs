//! Numbers as files store them.

use bilux_scene::media::from_binary16;

/// Turns the bytes of numbers into values, as many as there are.
pub(super) type Decode = fn(&[u8], &mut [f32]);

pub(super) fn halves(bytes: &[u8], values: &mut [f32]) {
    each(bytes, values, |half| from_binary16(u16::from_le_bytes(half)));
}

pub(super) fn floats(bytes: &[u8], values: &mut [f32]) {
    each(bytes, values, f32::from_le_bytes);
}

pub(super) fn floats_big(bytes: &[u8], values: &mut [f32]) {
    each(bytes, values, f32::from_be_bytes);
}

pub(super) fn doubles(bytes: &[u8], values: &mut [f32]) {
    each(bytes, values, |double| f64::from_le_bytes(double) as f32);
}

pub(super) fn doubles_big(bytes: &[u8], values: &mut [f32]) {
    each(bytes, values, |double| f64::from_be_bytes(double) as f32);
}

/// Whole numbers, of which the largest is 1.
pub(super) fn bytes_of_one(bytes: &[u8], values: &mut [f32]) {
    each(bytes, values, |[byte]| f32::from(byte) / 255.0);
}

/// Each number takes as many bytes as an array has.
fn each<const BYTES: usize>(bytes: &[u8], values: &mut [f32], value: impl Fn([u8; BYTES]) -> f32) {
    for (number, bytes) in values.iter_mut().zip(bytes.as_chunks::<BYTES>().0) {
        *number = value(*bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_what_another_library_makes_of_them() {
        for bits in 0..=u16::MAX {
            let (mut value, expected) = ([0.0], half::f16::from_bits(bits).to_f32());
            halves(&bits.to_le_bytes(), &mut value);
            assert!(
                value[0].to_bits() == expected.to_bits() || value[0].is_nan() && expected.is_nan(),
                "{bits:x}"
            );
        }
    }

    #[test]
    fn numbers_of_all_types_and_orders() {
        let read = |decode: Decode, bytes: &[u8]| {
            let mut values = [0.0; 2];
            decode(bytes, &mut values);
            values
        };
        let [a, b] = [0.5f32, -3.0];
        assert_eq!(read(floats, &[a.to_le_bytes(), b.to_le_bytes()].concat()), [a, b]);
        assert_eq!(read(floats_big, &[a.to_be_bytes(), b.to_be_bytes()].concat()), [a, b]);
        let [c, d] = [a, b].map(f64::from);
        assert_eq!(read(doubles, &[c.to_le_bytes(), d.to_le_bytes()].concat()), [a, b]);
        assert_eq!(read(doubles_big, &[c.to_be_bytes(), d.to_be_bytes()].concat()), [a, b]);
        assert_eq!(read(bytes_of_one, &[255, 51]), [1.0, 0.2]);
    }
}
