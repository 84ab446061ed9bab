//! Which tests run in one process, and in which order the processes begin.

use super::found::Suite;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A process takes about this many CPU seconds, if its tests are known.
const SECONDS: f64 = 15.0;

/// What a test is taken to need of which nothing is known, in CPU seconds.
const UNKNOWN: f64 = 0.6;

/// Tests of one suite that run in one process, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chunk {
    /// The place of the suite.
    pub(super) suite: usize,
    pub(super) tests: Vec<String>,
    seconds: f64,
}

/// Divides all tests into chunks. The last begins first: it takes longest, so that all cores end together. Tests that stand
/// together stay together, since those of one file often share what they prepare.
pub(super) fn divide(suites: &[Suite], times: &Times) -> Vec<Chunk> {
    let mut chunks: Vec<Chunk> = Vec::new();
    for (suite, Suite { name, tests, .. }) in suites.iter().enumerate() {
        let mut chunk = Chunk { suite, tests: Vec::new(), seconds: 0.0 };
        for test in tests {
            let seconds = times.of(name, test).unwrap_or(UNKNOWN);
            if !chunk.tests.is_empty() && chunk.seconds + seconds > SECONDS {
                let next = Chunk { suite, tests: Vec::new(), seconds: 0.0 };
                chunks.push(std::mem::replace(&mut chunk, next));
            }
            chunk.tests.push(test.clone());
            chunk.seconds += seconds;
        }
        chunks.push(chunk);
    }
    chunks.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    chunks
}

/// The CPU seconds of each test, by its suite and its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Times(BTreeMap<(String, String), f64>);

impl Times {
    /// Reads what the last run has left; nothing, if there is none or it is damaged: it only decides the order.
    pub(super) fn read(path: &Path) -> Times {
        let text = fs::read_to_string(path).unwrap_or_default();
        let lines = text.lines().filter_map(|line| {
            let mut cells = line.split('\t');
            let (suite, test, seconds) = (cells.next()?, cells.next()?, cells.next()?.parse().ok()?);
            Some(((suite.to_owned(), test.to_owned()), seconds))
        });
        Times(lines.collect())
    }

    /// These, and newer ones of some tests.
    pub(super) fn with<'a>(mut self, newer: impl Iterator<Item = (&'a str, &'a str, f64)>) -> Times {
        self.0.extend(newer.map(|(suite, test, seconds)| ((suite.to_owned(), test.to_owned()), seconds)));
        self
    }

    /// Leaves them for the next run. Without them, that run only takes another order.
    pub(super) fn write(&self, path: &Path) {
        let mut text = String::new();
        for ((suite, test), seconds) in &self.0 {
            let _ = writeln!(text, "{suite}\t{test}\t{seconds:.2}");
        }
        drop(fs::write(path, text));
    }

    fn of(&self, suite: &str, test: &str) -> Option<f64> {
        self.0.get(&(suite.to_owned(), test.to_owned())).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suite(name: &str, tests: &[&str]) -> Suite {
        let tests = tests.iter().map(|test| (*test).to_owned()).collect();
        Suite { name: name.to_owned(), tests, ..Suite::default() }
    }

    #[test]
    fn long_chunks_begin_first_and_no_test_is_lost() {
        let suites = [suite("a", &["x", "y", "z"]), suite("b", &["u", "v"])];
        let times = [("a", "x", 9.0), ("a", "y", 8.0), ("b", "u", 40.0)];
        let chunks = divide(&suites, &Times::default().with(times.into_iter()));
        let found: Vec<_> = chunks.iter().map(|chunk| (chunk.suite, chunk.tests.join(" "))).collect();
        let wanted = [(1, "v"), (0, "y z"), (0, "x"), (1, "u")];
        assert_eq!(found, wanted.map(|(suite, tests)| (suite, tests.to_owned())));
    }

    #[test]
    fn times_are_kept_for_the_next_run() {
        let folder = crate::process::target_folder().join("tmp");
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("times-{}.tsv", std::process::id()));
        let times = Times::default().with([("a suite", "b::c", 1.25)].into_iter());
        times.write(&path);
        assert_eq!(Times::read(&path), times);
        fs::write(&path, "damaged\na suite\tb::c\n\0\n").unwrap();
        assert_eq!(Times::read(&path), Times::default());
        fs::remove_file(&path).unwrap();
        assert_eq!(Times::read(&path), Times::default());
    }
}
