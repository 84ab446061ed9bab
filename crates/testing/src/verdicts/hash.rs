//! Hashes of what was rendered.

use std::fmt;

/// The hash of a picture's bits, or of a text: FNV-1a with 128 bits, the same on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hash(u128);

impl Hash {
    /// The hash of nothing.
    pub const NOTHING: Hash = Hash(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);

    /// The hash of all bits of a value.
    pub fn of(value: &(impl Bits + ?Sized)) -> Hash {
        let mut hash = Hash::NOTHING;
        value.add_to(&mut hash);
        hash
    }

    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// Reads what [`struct@Hash`] displays.
    pub fn parse(text: &str) -> Option<Hash> {
        if text.len() != 32 {
            return None;
        }
        u128::from_str_radix(text, 16).ok().map(Hash)
    }
}

impl fmt::Display for Hash {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:032x}", self.0)
    }
}

/// A value all of whose bits can be hashed: numbers, and lists of them.
pub trait Bits {
    /// Adds all bits to a hash.
    fn add_to(&self, hash: &mut Hash);
}

impl Bits for u8 {
    fn add_to(&self, hash: &mut Hash) {
        hash.add(&[*self]);
    }
}

impl Bits for f32 {
    fn add_to(&self, hash: &mut Hash) {
        hash.add(&self.to_bits().to_le_bytes());
    }
}

impl Bits for f64 {
    fn add_to(&self, hash: &mut Hash) {
        hash.add(&self.to_bits().to_le_bytes());
    }
}

#[cfg(feature = "statistics")]
impl Bits for bilux_math::Rgb {
    fn add_to(&self, hash: &mut Hash) {
        self.to_array().add_to(hash);
    }
}

impl<T: Bits> Bits for [T] {
    fn add_to(&self, hash: &mut Hash) {
        self.iter().for_each(|one| one.add_to(hash));
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn add_to(&self, hash: &mut Hash) {
        self[..].add_to(hash);
    }
}

impl<T: Bits> Bits for Vec<T> {
    fn add_to(&self, hash: &mut Hash) {
        self[..].add_to(hash);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_definition() {
        // From the draft's own list of examples.
        assert_eq!(Hash::of(b"").to_string(), "6c62272e07bb014262b821756295c58d");
        assert_eq!(Hash::of(b"a").to_string(), "d228cb696f1a8caf78912b704e4a8964");
        assert_eq!(Hash::of(b"foobar").to_string(), "343e1662793c64bf6f0d3597ba446f18");
    }

    #[test]
    fn every_bit_of_a_picture_counts() {
        let picture = vec![[0.5f32, 1.0, 0.0]; 64];
        let mut other = picture.clone();
        other[63][2] = -0.0;
        assert_ne!(Hash::of(&picture), Hash::of(&other));
        assert_ne!(Hash::of(&picture), Hash::of(&picture[1..]));
        let hash = Hash::of(&picture);
        assert_eq!(Hash::parse(&hash.to_string()), Some(hash));
        assert_eq!(Hash::parse("abc"), None);
        assert_eq!(Hash::of(&Vec::<f32>::new()), Hash::NOTHING);
    }
}
