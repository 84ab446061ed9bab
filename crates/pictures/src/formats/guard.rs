//! The last line of defence around external decoders.
//!
//! Input that is known to make them panic is rejected beforehand; but a fuzzer found such input for decoders that had
//! been fuzzed for years, so there will be more. A panic in one of them becomes an error here.

use crate::PictureError;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// True while this thread is inside a guarded decoder, whose panic will become an error: a program's panic hook may
/// then stay silent.
pub fn is_decoding() -> bool {
    DECODING.get()
}

/// Runs a decoder that shares nothing with the rest of the program except the bytes that it reads.
pub(super) fn guarded<T>(
    format: &'static str,
    decode: impl FnOnce() -> Result<T, PictureError>,
) -> Result<T, PictureError> {
    let contradicts = || PictureError::invalid(format, "its contents contradict each other");
    guarded_decoding(decode).unwrap_or_else(|| Err(contradicts()))
}

/// Runs any decoder that shares nothing with the rest of the program except the bytes that it reads; `None` if it
/// panics.
pub fn guarded_decoding<T>(decode: impl FnOnce() -> T) -> Option<T> {
    let before = DECODING.replace(true);
    // No half-finished state of the decoder outlives it.
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
