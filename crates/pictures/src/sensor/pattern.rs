//! Which colour each pixel of a sensor sees.

/// The colour filters in front of the pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// None: pixels see luminance.
    Mono,
    /// Every pixel has all three, as behind a prism.
    Prism,
    /// Squares of 2 × 2 pixels: the channels of their upper two pixels, then of their lower two. [Bayer 1976]
    Bayer([usize; 4]),
}

impl Pattern {
    /// The names of the patterns.
    pub const NAMES: &[&str] = &["rggb", "bggr", "grbg", "gbrg", "mono", "prism"];

    /// The pattern of one of the names.
    pub fn named(name: &str) -> Option<Pattern> {
        Some(match name {
            "mono" => Pattern::Mono,
            "prism" => Pattern::Prism,
            "rggb" => Pattern::Bayer([0, 1, 1, 2]),
            "bggr" => Pattern::Bayer([2, 1, 1, 0]),
            "grbg" => Pattern::Bayer([1, 0, 2, 1]),
            "gbrg" => Pattern::Bayer([1, 2, 0, 1]),
            _ => return None,
        })
    }

    /// The names of the planes that it is read into.
    pub(super) fn planes(&self) -> &'static [&'static str] {
        match self {
            Pattern::Prism => &["R", "G", "B"],
            Pattern::Mono | Pattern::Bayer(_) => &["Y"],
        }
    }

    /// True if each pixel sees one colour.
    pub(super) fn has_filters(&self) -> bool {
        matches!(self, Pattern::Bayer(_))
    }

    /// The channel that a pixel sees in a plane; `None` without filters.
    pub(super) fn channel(&self, x: u64, y: u64, plane: usize) -> Option<usize> {
        match self {
            Pattern::Mono => None,
            Pattern::Prism => Some(plane),
            Pattern::Bayer(square) => Some(square[(x % 2 + 2 * (y % 2)) as usize]),
        }
    }
}
