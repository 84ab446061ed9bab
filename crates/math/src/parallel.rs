//! Work shared by the threads of a pool: items of an iterator, and two pieces at once.
//!
//! Rayon's own iterators compile thousands of bytes of splitting, stealing and joining for each closure; here all that exists once, behind
//! `dyn Fn`, and a use of it costs a lock and a loop. So rayon's pools, their sizes and their stealing stay as they are, and what is
//! called is known to the compiler within an item, not between items: an item should take microseconds, such as a row of pixels
//! or a thousand numbers. It stands in this crate because all others use this one, and it needs no other.
//!
//! Threads take items in their order, one after the other, so that none waits for another that was dealt more. Which thread takes
//! which item is left to chance: results are to depend on items alone.

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

pub use rayon::{ThreadPool, ThreadPoolBuildError};

/// Calls `body` with each item, on the threads of the current pool. A single item stays on the calling thread.
///
/// The iterator is advanced under a lock: items should be cheap to make.
pub fn for_each<I>(items: I, body: impl Fn(I::Item) + Sync)
where
    I: IntoIterator<IntoIter: Send>,
{
    for_each_with(items, || (), |(), item| body(item));
}

/// As [`for_each`], with a state that each thread makes for itself, such as a buffer that it uses again for its next item.
pub fn for_each_with<I, S>(items: I, state: impl Fn() -> S + Sync, body: impl Fn(&mut S, I::Item) + Sync)
where
    I: IntoIterator<IntoIter: Send>,
{
    let items = items.into_iter();
    let most = items.size_hint().1.unwrap_or(usize::MAX);
    let items = Mutex::new(items);
    let next = || lock(&items).next();
    on_threads(most, &|| {
        let mut own = None;
        while let Some(item) = next() {
            body(own.get_or_insert_with(&state), item);
        }
    });
}

/// As [`for_each`], until an item fails: none is begun after that.
///
/// # Errors
/// The error of the first item, in their order, of those that failed.
pub fn try_for_each<I, E: Send>(items: I, body: impl Fn(I::Item) -> Result<(), E> + Sync) -> Result<(), E>
where
    I: IntoIterator<IntoIter: Send>,
{
    let failed: Mutex<Option<(usize, E)>> = Mutex::new(None);
    let items = items.into_iter().enumerate().take_while(|_| lock(&failed).is_none());
    for_each(items, |(place, item)| {
        let Err(error) = body(item) else { return };
        let mut failed = lock(&failed);
        if failed.as_ref().is_none_or(|(first, _)| place < *first) {
            *failed = Some((place, error));
        }
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some((_, error)) => Err(error),
        None => Ok(()),
    }
}

/// The results of all items, in the order of the items.
///
/// Large tables of small numbers are better written in place by [`fill`].
pub fn map<I, T: Send>(items: I, of: impl Fn(I::Item) -> T + Sync) -> Vec<T>
where
    I: IntoIterator<IntoIter: ExactSizeIterator + Send>,
{
    map_with(items, || (), |(), item| of(item))
}

/// As [`map`], with a state that each thread makes for itself.
pub fn map_with<I, S, T: Send>(
    items: I,
    state: impl Fn() -> S + Sync,
    of: impl Fn(&mut S, I::Item) -> T + Sync,
) -> Vec<T>
where
    I: IntoIterator<IntoIter: ExactSizeIterator + Send>,
{
    let items = items.into_iter();
    let mut results: Vec<Option<T>> = Vec::new();
    results.resize_with(items.len(), || None);
    for_each_with(items.zip(&mut results), state, |state, (item, result)| *result = Some(of(state, item)));
    results.into_iter().flatten().collect()
}

/// True if something holds for any of the items, of which no more are tried then.
pub fn any<I>(items: I, is: impl Fn(I::Item) -> bool + Sync) -> bool
where
    I: IntoIterator<IntoIter: Send>,
{
    try_for_each(items, |item| if is(item) { Err(()) } else { Ok(()) }).is_err()
}

/// Writes a result to each place of a table, `size` of them at a time.
pub fn fill<T: Send>(table: &mut [T], size: usize, of: impl Fn(usize) -> T + Sync) {
    let size = size.max(1);
    for_each(table.chunks_mut(size).enumerate(), |(chunk, places)| {
        places.iter_mut().zip(chunk * size..).for_each(|(place, i)| *place = of(i));
    });
}

/// The results for all numbers from 0 up to `count`, in their order: a large table, of which each thread writes ranges of at `least` so
/// many where they stay, since the first touch of memory is the expensive one.
///
/// Only rayon can write so, and it is compiled again for each use. [`map`] serves if there are few, and
/// [`fill`] for a table of zeros, which the system touches late.
pub fn table<T: Send>(count: usize, least: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut table = Vec::new();
    (0..count).into_par_iter().with_min_len(least).map(&of).collect_into_vec(&mut table);
    table
}

/// The numbers from 0 up to `count`, in ranges of a `size` of which the last may be shorter.
pub fn ranges(count: usize, size: usize) -> impl ExactSizeIterator<Item = Range<usize>> + Send {
    let size = size.max(1);
    (0..count.div_ceil(size)).map(move |i| i * size..count.min((i + 1) * size))
}

/// Runs both, at the same time if a thread of the current pool is free, and returns their results.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    let (mut a, mut b) = (Some(a), Some(b));
    let (mut of_a, mut of_b) = (None, None);
    both(&mut || of_a = a.take().map(|a| a()), &mut || of_b = b.take().map(|b| b()));
    (done(of_a), done(of_b))
}

/// A pool of so many threads, 0 for one on each core, with stacks of a size or of the system's.
///
/// # Errors
/// When the system gives no more threads.
pub fn pool(threads: usize, stack_bytes: Option<usize>) -> Result<ThreadPool, ThreadPoolBuildError> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    stack_bytes.into_iter().fold(builder, |builder, bytes| builder.stack_size(bytes)).build()
}

/// The number of threads of the current pool.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// Runs it on a thread of a pool, whose threads then share its work, and returns its result.
pub fn install<R: Send>(pool: &ThreadPool, work: impl FnOnce() -> R + Send) -> R {
    let (mut work, mut result) = (Some(work), None);
    within(pool, &mut || result = work.take().map(|work| work()));
    done(result)
}

/// The result of what was run: where it panicked, so did its caller.
fn done<R>(result: Option<R>) -> R {
    result.expect("a result")
}

/// Runs `body` once on each thread of the current pool, but no more than `most` times. Those that begin late find the work done.
#[inline(never)]
fn on_threads(most: usize, body: &(dyn Fn() + Sync)) {
    if most <= 1 {
        return body();
    }
    // Two even for a pool of one thread, since only `join` enters the pool.
    times(threads().clamp(2, most), body);
}

fn times(count: usize, body: &(dyn Fn() + Sync)) {
    if count <= 1 {
        return body();
    }
    both(&mut || times(count - count / 2, body), &mut || times(count / 2, body));
}

#[inline(never)]
fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    rayon::join(a, b);
}

#[inline(never)]
fn within(pool: &ThreadPool, work: &mut (dyn FnMut() + Send)) {
    pool.install(work);
}

/// Locks `shared`, even after a panic in a thread that held the lock: that leaves everything whole, and is passed on in the end.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Runs it in pools of one thread, of two and of five.
    fn in_pools(work: impl Fn(usize) + Sync) {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            install(&pool, || work(threads));
        }
    }

    #[test]
    fn all_items_are_taken_once_and_results_stand_in_their_order() {
        in_pools(|_| {
            for count in [0, 1, 2, 3, 1000] {
                let mut seen = vec![0; count];
                for_each(seen.iter_mut().enumerate(), |(i, seen)| *seen += i + 1);
                assert!(seen.iter().enumerate().all(|(i, seen)| *seen == i + 1));
                assert_eq!(
                    map(0..count, |i| i.to_string()).concat(),
                    (0..count).map(|i| i.to_string()).collect::<String>()
                );
            }
        });
    }

    #[test]
    fn ranges_follow_one_another_up_to_the_end() {
        assert_eq!(ranges(7, 3).collect::<Vec<_>>(), [0..3, 3..6, 6..7]);
        assert_eq!(ranges(6, 3).len(), 2);
        assert_eq!(ranges(0, 3).len(), 0);
        assert_eq!(ranges(2, 0).len(), 2);
    }

    #[test]
    fn each_thread_makes_one_state_and_none_for_nothing() {
        in_pools(|threads| {
            let made = AtomicUsize::new(0);
            let make = || made.fetch_add(1, Ordering::Relaxed);
            for_each_with(0..0, make, |_, _| unreachable!());
            assert_eq!(made.load(Ordering::Relaxed), 0);
            for_each_with(0..1000, make, |_, _| {});
            assert!((1..=threads.max(2)).contains(&made.load(Ordering::Relaxed)));
        });
    }

    #[test]
    fn the_first_error_in_order_ends_the_work() {
        in_pools(|threads| {
            let begun = AtomicUsize::new(0);
            let fails = |i: usize| {
                begun.fetch_add(1, Ordering::Relaxed);
                if i < 100 { Ok(()) } else { Err(i) }
            };
            assert_eq!(try_for_each(0..1_000_000, fails), Err(100));
            assert!(begun.load(Ordering::Relaxed) <= 101 + threads);
            assert_eq!(try_for_each(0..100, fails), Ok(()));
        });
    }

    #[test]
    fn work_within_work_ends() {
        in_pools(|_| {
            let of_row = |row: usize| map(0..50, |i| i * row).into_iter().sum::<usize>();
            let (a, b) = join(|| map(0..50, of_row), || "beside".to_owned());
            assert_eq!((a[49], b.as_str()), (49 * 1225, "beside"));
        });
    }

    #[test]
    fn everything_stays_in_the_pool() {
        in_pools(|threads| {
            assert_eq!(rayon::current_num_threads(), threads);
            for_each(0..100, |_| assert_eq!(rayon::current_num_threads(), threads));
        });
    }

    #[test]
    fn a_panic_is_passed_on() {
        let panics = || for_each(0..100, |i| assert_ne!(i, 50));
        assert!(std::panic::catch_unwind(panics).is_err());
    }
}
