//! Searching cumulative sums by a guide: for equal parts of 0..1, where the search begins. [Chen 1974]

/// Numbers that sums can be made of.
pub(super) trait Sum: Copy + PartialOrd {
    /// `part / parts`.
    fn ratio(part: usize, parts: usize) -> Self;
    /// The part that a number from 0 to 1 belongs to, or one next to it.
    fn part(self, parts: usize) -> usize;
}

impl Sum for f32 {
    fn ratio(part: usize, parts: usize) -> f32 {
        part as f32 / parts as f32
    }

    #[inline(always)]
    fn part(self, parts: usize) -> usize {
        (self * parts as f32) as usize
    }
}

impl Sum for f64 {
    fn ratio(part: usize, parts: usize) -> f64 {
        part as f64 / parts as f64
    }

    #[inline(always)]
    fn part(self, parts: usize) -> usize {
        (self * parts as f64) as usize
    }
}

/// For each of `sums.len()` equal parts of 0..1, the number of sums that are at most its beginning.
pub(super) fn guide<S: Sum>(sums: &[S]) -> impl Iterator<Item = u32> {
    let parts = sums.len();
    let mut at = 0;
    (0..parts).map(move |part| {
        while at < parts && sums[at] <= S::ratio(part, parts) {
            at += 1;
        }
        at as u32
    })
}

/// The number of sums that are at most `u`, from 0 to 1, but never all of them. The sums increase; there is at least
/// one, and their [`guide`] is as long as they are.
#[inline(always)]
pub(super) fn find<S: Sum, I: Copy + Into<u32>>(sums: &[S], guide: &[I], u: S) -> usize {
    let last = sums.len() - 1;
    let begin: u32 = guide[u.part(guide.len()).min(last)].into();
    let mut at = (begin as usize).min(last);
    // The part may have been rounded up.
    while at > 0 && sums[at - 1] > u {
        at -= 1;
    }
    while at < last && sums[at] <= u {
        at += 1;
    }
    at
}
