//! Hashes of contents, computed once for as long as the content lives.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, LazyLock, Mutex, PoisonError, Weak};

/// The BLAKE3 hash of some bytes: equal contents have equal hashes, on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentHash(pub [u8; 32]);

impl ContentHash {
    /// The hash of these bytes.
    pub fn of(bytes: &[u8]) -> ContentHash {
        ContentHash(blake3::hash(bytes).into())
    }

    /// The hash of bytes that `write` gives piece by piece.
    pub(super) fn of_pieces(write: impl FnOnce(&mut dyn FnMut(&[u8]))) -> ContentHash {
        let mut hash = blake3::Hasher::new();
        write(&mut |piece| {
            hash.update(piece);
        });
        ContentHash(hash.finalize().into())
    }

    /// Reads 64 hexadecimal digits.
    pub fn from_hex(text: &str) -> Option<ContentHash> {
        let digits: Vec<u8> =
            text.chars().map(|c| c.to_digit(16).map(|digit| digit as u8)).collect::<Option<_>>()?;
        let bytes: Vec<u8> =
            digits.chunks(2).map(|pair| pair.iter().fold(0, |sum, d| sum << 4 | d)).collect();
        (digits.len() == 64).then_some(ContentHash(bytes.try_into().ok()?))
    }
}

/// 64 hexadecimal digits.
impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// The hashes of shared values that do not change while they are shared.
///
/// A [`Weak`] keeps the address of a value from being used again, and `Arc::make_mut` moves a value away from it. So a
/// value at a known address is the one whose hash is known.
pub(super) struct KnownHashes<T>(LazyLock<Mutex<ByAddress<T>>>);

type ByAddress<T> = HashMap<usize, (Weak<T>, ContentHash)>;

/// When this many are known, those of values that are gone are forgotten.
const FORGET_FROM: usize = 256;

impl<T> KnownHashes<T> {
    pub(super) const fn new() -> KnownHashes<T> {
        KnownHashes(LazyLock::new(Mutex::default))
    }

    /// The hash of a value, which `compute` gives if it is not known.
    pub(super) fn of(&self, value: &Arc<T>, compute: impl FnOnce() -> ContentHash) -> ContentHash {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = Arc::as_ptr(value) as usize;
        if let Some((_, hash)) = known().get(&key).filter(|(held, _)| held.upgrade().is_some()) {
            return *hash;
        }
        let hash = compute();
        let mut known = known();
        if known.len() >= FORGET_FROM && known.len().is_power_of_two() {
            known.retain(|_, (held, _)| held.strong_count() > 0);
        }
        known.insert(key, (Arc::downgrade(value), hash));
        hash
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_is_computed_once_and_again_after_a_change() {
        static KNOWN: KnownHashes<Vec<u8>> = KnownHashes::new();
        let mut count = 0;
        let mut hash = |value: &Arc<Vec<u8>>| {
            KNOWN.of(value, || {
                count += 1;
                ContentHash::of(value)
            })
        };
        let mut value = Arc::new(vec![1, 2, 3]);
        let first = hash(&value);
        assert_eq!(hash(&value), first);
        Arc::make_mut(&mut value).push(4);
        assert_eq!(hash(&value), ContentHash::of(&[1, 2, 3, 4]));
        assert_eq!(count, 2);
    }

    #[test]
    fn hashes_are_read_from_hexadecimal_digits() {
        let hash = ContentHash::of(b"abc");
        assert!(hash.to_string().starts_with("6437b3ac38465133"));
        assert_eq!(ContentHash::from_hex(&hash.to_string()), Some(hash));
        assert_eq!(ContentHash::from_hex("ba78"), None);
        assert_eq!(ContentHash::from_hex(&"x".repeat(64)), None);
    }
}
