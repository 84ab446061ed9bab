//! The cores of the machine: what runs beside other work takes one first, so that no more runs at a time than there are.

use std::sync::{Condvar, LazyLock, Mutex, PoisonError};

/// The number of cores.
pub(crate) fn count() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Waits until a core is free, and takes it.
pub(crate) fn take() -> Core {
    let mut free = FREE.count.lock().unwrap_or_else(PoisonError::into_inner);
    while *free == 0 {
        free = FREE.changed.wait(free).unwrap_or_else(PoisonError::into_inner);
    }
    *free -= 1;
    Core(())
}

/// A core that is taken until this is dropped.
pub(crate) struct Core(());

impl Drop for Core {
    fn drop(&mut self) {
        *FREE.count.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        FREE.changed.notify_one();
    }
}

struct Free {
    count: Mutex<usize>,
    changed: Condvar,
}

static FREE: LazyLock<Free> = LazyLock::new(|| Free { count: Mutex::new(count()), changed: Condvar::new() });

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn no_more_cores_are_taken_than_there_are() {
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..3 * count() {
                scope.spawn(|| {
                    let _core = take();
                    most.fetch_max(1 + now.fetch_add(1, Ordering::SeqCst), Ordering::SeqCst);
                    std::thread::sleep(std::time::Duration::from_millis(5));
                    now.fetch_sub(1, Ordering::SeqCst);
                });
            }
        });
        assert!((1..=count()).contains(&most.load(Ordering::SeqCst)));
    }
}
