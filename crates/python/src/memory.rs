//! Limits on a call's memory: no more than the system leaves this process, so that a lack of it is an exception. Rust
//! aborts where memory runs out, and the interpreter with it.

use bilux::memory_limit::MemoryLimit;
use bilux::pictures::Limits;
use bilux::scene::Parameters;

/// So many bytes, or what the system leaves if that is less.
pub(crate) fn within_limits(max_memory: u64) -> u64 {
    MemoryLimit::of_process().map_or(max_memory, |limit| limit.for_pictures().min(max_memory))
}

/// Sets the number of threads to what there is memory for, unless somebody has.
pub(crate) fn set_threads(settings: &mut Parameters) {
    if let Some(limit) = MemoryLimit::of_process() {
        limit.set_threads(settings);
    }
}

/// The bytes that reading a picture may take.
pub(crate) fn for_picture_files() -> Limits {
    Limits::new(within_limits(Limits::default().max_bytes))
}
