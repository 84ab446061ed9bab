//! Cuts a picture or an animation into ranges of samples or of frames.

use crate::arguments::farming::Farm;
use anyhow::bail;
use bilux::Settings;

/// The parts of a job, as the options of `bilux render` say them.
pub(super) enum Split {
    /// Ranges of frames, such as `0-5`.
    Frames(Vec<String>),
    /// Ranges of samples, such as `0..64`.
    Samples(Vec<String>),
}

impl Split {
    /// Cuts what the arguments ask for. `by_default` says that nobody has said when a picture is good enough.
    ///
    /// # Errors
    /// If there are more tasks than frames or samples, or if the number of samples is not known before.
    pub(super) fn of(arguments: &Farm, settings: &Settings, by_default: bool) -> anyhow::Result<Split> {
        let chunks = arguments.chunks;
        let turned = arguments.turntable.map(|count| (0, count - 1));
        if let Some((first, last)) = arguments.frames.or(turned) {
            let count = u64::from(last - first) + 1;
            check(chunks, count, "frames")?;
            let ranges = ranges(u64::from(first), count, chunks);
            return Ok(Split::Frames(ranges.map(|(a, b)| format!("{a}-{}", b - 1)).collect()));
        }
        if by_default || settings.stop.is_any() {
            bail!(
                "a picture is split by its samples, so their number has to be known: add `-- --spp 256`, or --frames \
                 for an animation{}",
                if by_default { "" } else { "; leave out limits of noise and time, or set them to 0" }
            );
        }
        check(chunks, u64::from(settings.spp), "samples per pixel")?;
        let ranges = ranges(0, u64::from(settings.spp), chunks);
        Ok(Split::Samples(ranges.map(|(a, b)| format!("{a}..{b}")).collect()))
    }

    pub(super) fn ranges(&self) -> &[String] {
        match self {
            Split::Frames(ranges) | Split::Samples(ranges) => ranges,
        }
    }

    /// The option of `bilux render` that takes a range.
    pub(super) fn flag(&self) -> &'static str {
        match self {
            Split::Frames(_) => "--frames",
            Split::Samples(_) => "--samples",
        }
    }

    /// The folders that the tasks write to.
    pub(super) fn folders(&self) -> &'static [&'static str] {
        match self {
            Split::Frames(_) => &["pictures"],
            Split::Samples(_) => &["pictures", "parts"],
        }
    }

    /// Work that the tasks do together, in a few words.
    pub(super) fn describe(&self) -> &'static str {
        match self {
            Split::Frames(_) => "the frames",
            Split::Samples(_) => "the samples of one picture, and one that merges them",
        }
    }
}

fn check(chunks: u32, count: u64, of_what: &str) -> anyhow::Result<()> {
    if u64::from(chunks) > count {
        bail!("--chunks {chunks}: there are only {count} {of_what}: write {count} or fewer");
    }
    Ok(())
}

/// Cuts `count` numbers from `first` on into ranges that differ by one at most. The end is excluded.
fn ranges(first: u64, count: u64, chunks: u32) -> impl Iterator<Item = (u64, u64)> {
    let at = move |chunk: u32| first + count * u64::from(chunk) / u64::from(chunks);
    (0..chunks).map(move |chunk| (at(chunk), at(chunk + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_follow_each_other_and_differ_by_one_at_most() {
        for (first, count, chunks) in [(0, 7, 3), (5, 1024, 1024), (3, 1 << 31, 7), (9, 1, 1)] {
            let cut: Vec<_> = ranges(first, count, chunks).collect();
            assert_eq!((cut[0].0, cut[cut.len() - 1].1), (first, first + count));
            assert!(cut.windows(2).all(|pair| pair[0].1 == pair[1].0));
            let sizes = || cut.iter().map(|(a, b)| b - a);
            assert!(sizes().min() >= Some(1) && sizes().max() <= sizes().min().map(|least| least + 1));
        }
    }
}
