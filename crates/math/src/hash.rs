//! Integer hashes, the seeds of every sampler: the same on every machine.

/// Mixes 64 bits so that each output bit depends on every input bit (the finaliser of SplitMix64). [Steele 2014]
#[inline]
pub const fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// One hash of several words; the order matters.
#[inline]
pub fn hash_words<const N: usize>(words: [u64; N]) -> u64 {
    words.iter().fold(0x9e37_79b9_7f4a_7c15, |state, &word| hash_more(state, word))
}

/// The hash of the words that a hash is of, and one more after them: where many begin with the same words, those are hashed once.
#[inline]
pub fn hash_more(hash: u64, word: u64) -> u64 {
    mix64(hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ mix64(word.wrapping_add(0x632b_e59b_d9b4_e019)))
}

/// The upper 24 bits of a word as a float in `[0, 1)`.
#[inline]
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}
