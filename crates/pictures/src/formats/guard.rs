//! The last line of defence around decoders that are not ours.
//!
//! Whatever we know to make them panic is refused beforehand; but a fuzzer found such inputs in decoders
//! that had been fuzzed for years, so there will be others. A panic in one becomes an error here.

use crate::PictureError;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// True while this thread is inside a guarded decoder, whose panic will become an error: a program's panic
/// hook may then stay silent.
pub fn is_decoding() -> bool {
    DECODING.get()
}

/// Runs a decoder that shares nothing with the world but the bytes it reads.
pub(super) fn guarded<T>(
    format: &'static str,
    decode: impl FnOnce() -> Result<T, PictureError>,
) -> Result<T, PictureError> {
    let contradicts = || PictureError::invalid(format, "its contents contradict each other");
    guarded_decoding(decode).unwrap_or_else(|| Err(contradicts()))
}

/// Runs any decoder that shares nothing with the world but the bytes it reads; none where it panics.
pub fn guarded_decoding<T>(decode: impl FnOnce() -> T) -> Option<T> {
    let before = DECODING.replace(true);
    // Nothing of what the decoder left half done outlives it.
    let outcome = catch_unwind(AssertUnwindSafe(decode));
    DECODING.set(before);
    outcome.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error() {
        let broken: Vec<u8> = Vec::new();
        let outcome = guarded("PNG", || {
            assert!(is_decoding());
            Ok(broken[0])
        });
        assert!(matches!(outcome, Err(PictureError::Invalid { .. })) && !is_decoding());
    }
}
