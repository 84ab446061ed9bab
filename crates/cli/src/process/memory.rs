//! Memory that this process takes, where the system gives it less than the machine has: a lower `--max-memory`, fewer threads,
//! and a message in place of a kill.

use anyhow::Context;
use bilux::memory_limit::{LimitSource, MemoryLimit};
use bilux::scene::Parameters;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

static LIMIT: OnceLock<Option<MemoryLimit>> = OnceLock::new();

/// Whether the limit is what bounds `--max-memory`.
static IS_TIGHTER: AtomicBool = AtomicBool::new(false);

/// Bytes that `--max-memory` allows, as it is bounded.
static ALLOWED: AtomicU64 = AtomicU64::new(0);

/// The limit that the system imposes, if it does.
pub fn imposed() -> Option<&'static MemoryLimit> {
    LIMIT.get_or_init(MemoryLimit::of_process).as_ref().filter(|limit| limit.is_imposed())
}

/// Limits the process's own data to a little less than its control group has: a process that takes more than the group has is
/// killed, but a refusal by this limit is an error which can be reported.
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
pub fn bound(max_memory: &mut u64) {
    ALLOWED.store(*max_memory, Ordering::Relaxed);
    let Some(limit) = LIMIT.get_or_init(MemoryLimit::of_process) else { return };
    let left = limit.for_pictures();
    IS_TIGHTER.store(left < *max_memory, Ordering::Relaxed);
    *max_memory = left.min(*max_memory);
    ALLOWED.store(*max_memory, Ordering::Relaxed);
}

/// The bytes that all work together may take.
pub fn allowed() -> u64 {
    ALLOWED.load(Ordering::Relaxed)
}

/// Source of the limit, if the system imposes one.
pub fn source() -> Option<LimitSource> {
    LIMIT.get()?.filter(MemoryLimit::is_imposed).map(|limit| limit.source)
}

/// Source of the limit that bounds `--max-memory`, if it is not the option itself.
pub fn tighter() -> Option<LimitSource> {
    let limit = LIMIT.get().copied().flatten()?;
    IS_TIGHTER.load(Ordering::Relaxed).then_some(limit.source)
}

/// Sets the number of threads, unless somebody has.
pub fn set_threads(parameters: &mut Parameters) {
    if let Some(limit) = imposed() {
        limit.set_threads(parameters);
    }
}

/// Prepares for the work: it gets no more memory than there is, and readers share fewer threads than cores if there is to be
/// no more. A process that only starts others does not come here, since they inherit limits.
pub fn begin_work() -> anyhow::Result<()> {
    if let Some(limit) = imposed() {
        refuse_before_kill(limit);
    }
    let Some(threads) = imposed().and_then(MemoryLimit::threads) else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    pool.context("there is not enough memory to start a thread")
}
