//! How much memory this process takes, where the system gives it less than the machine has: a lower `--max-memory`, fewer
//! threads, and a message in place of a kill.

use crate::allocator;
use crate::arguments::Common;
use anyhow::Context;
use bilux::memory_limit::{LimitSource, MemoryLimit};
use bilux::scene::Parameters;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bytes per thread: 16 MB of stack, and the paths that it traces.
const THREAD: u64 = 24 << 20;
/// Threads take at most one part in this many.
const THREADS_PART: u64 = 4;
/// Bytes for everything that no estimate counts.
const RESERVE: u64 = 12 << 20;

static LIMIT: OnceLock<Option<MemoryLimit>> = OnceLock::new();

/// Whether the limit is what bounds `--max-memory`.
static IS_TIGHTER: AtomicBool = AtomicBool::new(false);

/// Looks for limits, and prepares the allocator for them. Comes first, while there is one thread.
pub fn begin() {
    let limit = imposed();
    allocator::return_large_blocks();
    allocator::report_failures();
    if let Some(limit) = limit {
        allocator::share(limit.left);
        refuse_before_kill(limit);
    }
}

/// The limit that the system imposes, if it does.
fn imposed() -> Option<&'static MemoryLimit> {
    LIMIT.get_or_init(MemoryLimit::of_process).as_ref().filter(|limit| limit.is_imposed())
}

/// Whoever takes more than its control group has is killed. A limit of the process's own data a little below makes that an
/// error which can be reported.
#[cfg(target_os = "linux")]
fn refuse_before_kill(limit: &MemoryLimit) {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    /// For what the kernel counts besides: stacks, page tables, buffers of files. A part, and bytes.
    const ASIDE: (u64, u64) = (32, 4 << 20);
    if limit.source != LimitSource::Group {
        return;
    }
    let before = getrlimit(Resource::Data);
    let most = limit.left.saturating_sub(limit.left / ASIDE.0 + ASIDE.1);
    if before.current.is_none_or(|current| current > most) {
        // If it cannot be set, the kernel's own limit holds all the same.
        let _ = setrlimit(Resource::Data, Rlimit { current: Some(most), ..before });
    }
}

#[cfg(not(target_os = "linux"))]
fn refuse_before_kill(_: &MemoryLimit) {}

/// Lowers `--max-memory` to what the system and the threads leave.
pub fn bound(common: &mut Common) {
    /// Not even a small scene can be read with less; whether there is so much, allocations show.
    const LEAST: u64 = 1 << 20;
    let Some(limit) = LIMIT.get_or_init(MemoryLimit::of_process) else { return };
    let count = threads().unwrap_or_else(cores) as u64;
    let reserve =
        if limit.is_imposed() { count * THREAD + RESERVE.min(limit.left / THREADS_PART) } else { 0 };
    let left = limit.left.saturating_sub(reserve).max(LEAST);
    if left < common.max_memory {
        common.max_memory = left;
        IS_TIGHTER.store(true, Ordering::Relaxed);
    }
}

/// What sets the limit, if the system imposes one.
pub fn source() -> Option<LimitSource> {
    LIMIT.get()?.filter(MemoryLimit::is_imposed).map(|limit| limit.source)
}

/// What bounds `--max-memory`, if it is not the option itself.
pub fn tighter() -> Option<LimitSource> {
    let limit = LIMIT.get().copied().flatten()?;
    IS_TIGHTER.load(Ordering::Relaxed).then_some(limit.source)
}

/// The number of threads for which there is memory, if it is lower than the number of cores.
fn threads() -> Option<usize> {
    let fits = usize::try_from(imposed()?.left / THREADS_PART / THREAD).unwrap_or(usize::MAX).max(1);
    (fits < cores()).then_some(fits)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Sets the number of threads, unless somebody has.
pub fn set_threads(parameters: &mut Parameters) {
    if let (Some(threads), None) = (threads(), parameters.find("threads")) {
        parameters.set("threads", bilux::scene::Value::Integer(threads as i64));
    }
}

/// Starts the threads that readers share, if there are to be fewer than cores.
pub fn begin_threads() -> anyhow::Result<()> {
    let Some(threads) = threads() else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    pool.context("there is not enough memory to start a thread")
}
