//! How the system's allocator gives memory back.
//!
//! By default, glibc keeps freed memory for later use, up to 64 MB at a time in each thread's arena, once blocks of some MB have come and gone.
//! A large picture frees many such blocks between its stages, and none of the later ones fits into them. Blocks that have their own pages go back
//! to the system at once.
#![allow(unsafe_code)] // Two calls of a C function that takes two numbers.

/// Gives each large block its own pages, so that the memory goes back to the system when the block is freed.
pub fn return_large_blocks() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        use std::ffi::c_int;
        // SAFETY: declared as in `malloc.h`.
        unsafe extern "C" {
            fn mallopt(parameter: c_int, value: c_int) -> c_int;
        }
        /// Of `malloc.h`: from this size on, a block has its own pages. Setting it also stops glibc from raising it.
        const M_MMAP_THRESHOLD: c_int = -3;
        /// Of `malloc.h`: so much of the heap's end may stay free. Setting the other one lowers it, and threads that take turns with
        /// smaller blocks would give them back and get them again all the time.
        const M_TRIM_THRESHOLD: c_int = -1;
        /// Larger than what threads allocate for a tile or a pass of photons, smaller than a plane of a large picture. At 1 MB, pages that
        /// came and went in each pass took a quarter of the time of `auto` in a small Cornell box.
        const LARGE: c_int = 8 << 20;
        // SAFETY: `mallopt` takes two numbers, refuses those that it does not know, and may be called at any
        // time; other threads do not exist yet.
        unsafe {
            mallopt(M_MMAP_THRESHOLD, LARGE);
            mallopt(M_TRIM_THRESHOLD, LARGE);
        }
    }
}
