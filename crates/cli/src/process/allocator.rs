//! Allocator of the system: how it gives memory back, how threads share its memory, and what happens where there is none.
//!
//! By default, glibc keeps freed memory for later use, up to 64 MB at a time in each thread's arena, once blocks of some MB have come and gone.
//! A large picture frees many such blocks between its stages, and none of the later ones fits into them. Blocks that have their own pages go back
//! to the system at once.
//!
//! Rust aborts where memory runs out, unless the code expects it. Both the reason and the status would be lost on a server, so
//! the process ends here instead, with a message.
#![allow(unsafe_code)] // An allocator that passes everything on, calls of a C function that takes two numbers, and a signal handler.

use crate::process::ending;
use crate::process::memory;
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The exit status: the work failed.
const FAILED: u8 = 1;

/// Largest block that no code can go on without; more may be asked for by code that can.
const LITTLE: usize = 64 << 10;

/// The size of the block that was refused last.
static REFUSED: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, which notices refusals.
struct Noticing;

#[global_allocator]
static ALLOCATOR: Noticing = Noticing;

/// Prepares the allocator for the limits of memory. Comes first, while there is one thread.
pub fn begin() {
    let limit = memory::imposed();
    return_large_blocks();
    report_failures();
    if let Some(limit) = limit {
        share(limit.left);
    }
}

impl Noticing {
    /// Looks at what the system gave.
    fn given(block: *mut u8, size: usize) -> *mut u8 {
        if block.is_null() {
            REFUSED.store(size, Ordering::SeqCst);
            if size <= LITTLE {
                end_without(size);
            }
        }
        block
    }
}

// SAFETY: every call goes to the system's allocator with the same arguments, and its answer comes back as it is.
unsafe impl GlobalAlloc for Noticing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: whoever calls this keeps the same promises.
        Noticing::given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        Noticing::given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        Noticing::given(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) }
    }
}

/// Ends the process with a message that needs no memory.
fn end_without(size: usize) -> ! {
    let mut text = [0; 300];
    let mut rest = &mut text[..];
    let _ = write!(rest, "there is not enough memory: {size} more bytes were refused");
    let _ = match memory::source() {
        Some(source) => {
            write!(rest, " ({source} is the limit: raise it, or make the picture or the scene smaller)")
        }
        None => write!(rest, ": make the picture or the scene smaller"),
    };
    let length = 300 - rest.len();
    ending::fail(FAILED, std::str::from_utf8(&text[..length]).unwrap_or("there is not enough memory"))
}

/// Reports where memory runs out for code that does not expect it: that aborts the process, which is noticed here.
fn report_failures() {
    #[cfg(unix)]
    {
        use signal_hook::consts::SIGABRT;
        use signal_hook::low_level::{emulate_default_handler, register};
        let report = || match REFUSED.load(Ordering::SeqCst) {
            // Something else is wrong, and its message is there, or somebody else has sent the signal: as without this.
            0 => drop(emulate_default_handler(SIGABRT)),
            size => end_without(size),
        };
        // SAFETY: after a refusal the signal comes from the thread that has just aborted, within no function of the allocator, and
        // what runs here takes no lock that it waits for and no memory.
        let registered = unsafe { register(SIGABRT, report) };
        // Without it the process aborts as every program does.
        drop(registered);
    }
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod malloc {
    use std::ffi::c_int;
    // SAFETY: declared as in `malloc.h`.
    unsafe extern "C" {
        fn mallopt(parameter: c_int, value: c_int) -> c_int;
    }

    /// Of `malloc.h`: from this size on, a block has its own pages. Setting it also stops glibc from raising it.
    pub(super) const M_MMAP_THRESHOLD: c_int = -3;
    /// Of `malloc.h`: so much of the heap's end may stay free. Setting the other one lowers it, and threads that take turns with
    /// smaller blocks would give them back and get them again all the time.
    pub(super) const M_TRIM_THRESHOLD: c_int = -1;
    /// Of `malloc.h`: the number of arenas, each of which takes 64 MB of address space.
    pub(super) const M_ARENA_MAX: c_int = -8;

    /// Sets a parameter.
    pub(super) fn set(parameter: c_int, value: c_int) {
        // SAFETY: `mallopt` takes two numbers, refuses those that it does not know, and may be called at any
        // time; other threads do not exist yet.
        unsafe {
            mallopt(parameter, value);
        }
    }
}

/// Gives each large block its own pages, so that the memory goes back to the system when the block is freed.
fn return_large_blocks() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        /// Larger than what threads allocate for a tile or a pass of photons, smaller than a plane of a large picture. At 1 MB, pages that
        /// came and went in each pass took a quarter of the time of `auto` in a small Cornell box.
        const LARGE: i32 = 8 << 20;
        malloc::set(malloc::M_MMAP_THRESHOLD, LARGE);
        malloc::set(malloc::M_TRIM_THRESHOLD, LARGE);
    }
}

/// Takes few arenas for threads where there are only so many bytes.
fn share(bytes: u64) {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        /// Arenas take at most one part in this many.
        const PART: u64 = 8;
        /// The address space of an arena, and of what is kept to align it.
        const ARENA: u64 = 128 << 20;
        let fit = (bytes / PART / ARENA).clamp(1, 1 << 10);
        malloc::set(malloc::M_ARENA_MAX, fit as i32);
    }
    #[cfg(not(all(target_os = "linux", target_env = "gnu")))]
    let _ = bytes;
}
