//! Which tests run in one process.

use super::found::Suite;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// A process takes about this many CPU seconds, if its tests are known.
const SECONDS: f64 = 15.0;

/// CPU seconds that a test is taken to need of which nothing is known.
const UNKNOWN: f64 = 0.6;

/// Tests of one suite that run in one process, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chunk {
    pub(super) suite: Arc<Suite>,
    pub(super) tests: Vec<String>,
    /// CPU seconds that the tests are expected to take.
    pub(super) seconds: f64,
}

/// Divides the tests of a suite into chunks. Tests that stand together stay together, since those of one file often share what they
/// prepare.
pub(super) fn divide(suite: Suite, times: &Times) -> Vec<Chunk> {
    let suite = Arc::new(suite);
    let chunk = || Chunk { suite: suite.clone(), tests: Vec::new(), seconds: 0.0 };
    let mut chunks = vec![chunk()];
    for test in &suite.tests {
        let seconds = times.of(&suite.name, test).unwrap_or(UNKNOWN);
        let is_full = |last: &Chunk| !last.tests.is_empty() && last.seconds + seconds > SECONDS;
        if chunks.last().is_none_or(is_full) {
            chunks.push(chunk());
        }
        if let Some(last) = chunks.last_mut() {
            last.tests.push(test.clone());
            last.seconds += seconds;
        }
    }
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
    fn no_test_is_lost() {
        let times = [("a", "x", 9.0), ("a", "y", 8.0), ("b", "y", 1.0), ("a", "u", 40.0)];
        let chunks =
            divide(suite("a", &["x", "y", "z", "u", "v"]), &Times::default().with(times.into_iter()));
        let found: Vec<_> = chunks.iter().map(|chunk| (chunk.tests.join(" "), chunk.seconds)).collect();
        let wanted = [("x", 9.0), ("y z", 8.6), ("u", 40.0), ("v", UNKNOWN)];
        assert_eq!(found, wanted.map(|(tests, seconds)| (tests.to_owned(), seconds)));
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
