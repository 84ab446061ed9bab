//! Searching cumulative sums by a guide: for equal parts of 0..1, where the search begins. [Chen 1974]

/// For each of `sums.len()` equal parts of 0..1, the number of sums that are at most its beginning.
pub(super) fn guide<S: Copy + Into<f64>>(sums: &[S]) -> impl Iterator<Item = u32> {
    let parts = sums.len();
    let mut at = 0;
    (0..parts).map(move |part| {
        while at < parts && sums[at].into() <= part as f64 / parts as f64 {
            at += 1;
        }
        at as u32
    })
}

/// The number of sums that are at most `u`, from 0 to 1, but never all of them. The sums increase; there is at least
/// one, and their [`guide`] is as long as they are.
#[inline(always)]
pub(super) fn find<S, I>(sums: &[S], guide: &[I], u: S) -> usize
where
    S: Copy + PartialOrd + Into<f64>,
    I: Copy + Into<u32>,
{
    find_from(sums, begin(guide, u), u)
}

/// Index at which the search for a number begins.
#[inline(always)]
pub(super) fn begin<S: Into<f64>, I: Copy + Into<u32>>(guide: &[I], u: S) -> usize {
    let part = (u.into() * guide.len() as f64) as usize;
    let begin: u32 = guide[part.min(guide.len() - 1)].into();
    begin as usize
}

/// [`find`] from where the search begins.
#[inline(always)]
pub(super) fn find_from<S: Copy + PartialOrd>(sums: &[S], begin: usize, u: S) -> usize {
    let last = sums.len() - 1;
    let mut at = begin.min(last);
    // The part may have been rounded up.
    while at > 0 && sums[at - 1] > u {
        at -= 1;
    }
    while at < last && sums[at] <= u {
        at += 1;
    }
    at
}
