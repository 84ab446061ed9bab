//! Numbers of tests that passed and failed.

use std::fmt;
use std::ops::AddAssign;

/// Tests that passed and failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Totals {
    pub(crate) passed: usize,
    pub(crate) failed: usize,
}

impl Totals {
    /// Reads the closing line of a suite.
    pub(crate) fn read_closing(line: &str) -> Option<Totals> {
        let mut counts = line.strip_prefix("test result: ")?.split(['.', ';']).map(str::trim);
        let mut count = |word: &str| {
            counts.find_map(|part| part.strip_suffix(word)).and_then(|number| number.trim().parse().ok())
        };
        Some(Totals { passed: count("passed")?, failed: count("failed")? })
    }

    /// Reads what it is printed as.
    pub(crate) fn read(line: &str) -> Option<Totals> {
        let (passed, failed) = line.strip_suffix(" failed")?.split_once(" passed, ")?;
        Some(Totals { passed: passed.parse().ok()?, failed: failed.parse().ok()? })
    }
}

impl fmt::Display for Totals {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} passed, {} failed", self.passed, self.failed)
    }
}

impl AddAssign for Totals {
    fn add_assign(&mut self, other: Totals) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_are_read() {
        let line = "test result: FAILED. 41 passed; 2 failed; 0 ignored; 0 measured; 3 filtered out; finished in 0.2s";
        let both = Totals { passed: 41, failed: 2 };
        assert_eq!(Totals::read_closing(line), Some(both));
        assert_eq!(Totals::read(&both.to_string()), Some(both));
        let line = "test result: ok. 7 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out";
        assert_eq!(Totals::read_closing(line), Some(Totals { passed: 7, failed: 0 }));
        for wrong in ["test a::b ... ok", "test result: ", "a passed, b failed"] {
            assert_eq!(Totals::read_closing(wrong).or(Totals::read(wrong)), None);
        }
    }
}
