//! The report about all suites: what failed, what was skipped, and which tests took longest.

use super::found::Suite;
use super::process::Outcome;
use std::fmt;
use std::time::Duration;

/// Number of the slowest tests that are printed.
const SLOWEST: usize = 10;

/// Results so far.
#[derive(Debug, Default)]
pub(super) struct Report {
    pub(super) passed: usize,
    /// The suite and the name of each test that failed.
    pub(super) failed: Vec<String>,
    /// Suite, test and reason.
    skipped: Vec<(String, String, String)>,
    /// Suite, test and CPU time.
    times: Vec<(String, String, Duration)>,
}

impl Report {
    /// Adds the outcome of one process; the text says what it was.
    pub(super) fn add(&mut self, suite: &Suite, outcome: &Outcome) -> String {
        let named = |test: &str| (suite.name.clone(), test.to_owned());
        self.passed += outcome.passed.len();
        self.failed.extend(outcome.failed.iter().map(|(test, _)| format!("{} {test}", suite.name)));
        let skipped =
            outcome.skipped.iter().map(|(test, why)| (suite.name.clone(), test.clone(), why.clone()));
        self.skipped.extend(skipped);
        let all = outcome.passed.iter().chain(&outcome.failed);
        self.times.extend(all.clone().map(|(test, time)| (named(test).0, named(test).1, *time)));
        let seconds: f64 = all.map(|(_, time)| time.as_secs_f64()).sum();
        let (passed, failed) = (outcome.passed.len(), outcome.failed.len());
        let name = &suite.name;
        let mut text = format!("{name}: {passed} passed, {failed} failed, {seconds:.1} s of CPU\n");
        if failed > 0 {
            let names: Vec<&str> = outcome.failed.iter().map(|(test, _)| &**test).collect();
            text += &format!("FAILED {}\n{}\n", names.join(", "), outcome.said);
        }
        text
    }

    /// Time of each test, in seconds.
    pub(super) fn times(&self) -> impl Iterator<Item = (&str, &str, f64)> {
        self.times.iter().map(|(suite, test, time)| (&**suite, &**test, time.as_secs_f64()))
    }

    /// The CPU seconds of each suite, and of its tests.
    fn suites(&self) -> Vec<(&str, usize, f64)> {
        let mut suites: Vec<(&str, usize, f64)> = Vec::new();
        for (suite, _, seconds) in self.times() {
            match suites.iter_mut().find(|(name, ..)| *name == suite) {
                Some((_, tests, sum)) => (*tests, *sum) = (*tests + 1, *sum + seconds),
                None => suites.push((suite, 1, seconds)),
            }
        }
        suites.sort_by(|a, b| b.2.total_cmp(&a.2));
        suites
    }
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (suite, test, why) in &self.skipped {
            writeln!(out, "skipped {suite} {test}: {why}")?;
        }
        writeln!(out, "\nCPU time of the suites:")?;
        for (suite, tests, seconds) in self.suites() {
            writeln!(out, "{seconds:>8.1} s  {suite}, {tests} tests")?;
        }
        let mut times: Vec<_> = self.times().collect();
        times.sort_by(|a, b| b.2.total_cmp(&a.2));
        writeln!(out, "\nCPU time of the slowest tests:")?;
        for (suite, test, seconds) in times.iter().take(SLOWEST) {
            writeln!(out, "{seconds:>8.1} s  {suite} {test}")?;
        }
        for failed in &self.failed {
            writeln!(out, "FAILED {failed}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_come_first_and_failures_last() {
        let suite = Suite { name: "a suite".to_owned(), ..Suite::default() };
        let test = |name: &str, seconds| (name.to_owned(), Duration::from_secs(seconds));
        let outcome = Outcome {
            passed: (1..12).map(|i| test(&format!("t{i}"), i)).collect(),
            failed: vec![test("bad", 0)],
            skipped: vec![("t1".to_owned(), "no Mitsuba".to_owned())],
            said: "panicked".to_owned(),
            ..Outcome::default()
        };
        let mut report = Report::default();
        let text = report.add(&suite, &outcome);
        assert_eq!(text, "a suite: 11 passed, 1 failed, 66.0 s of CPU\nFAILED bad\npanicked\n");
        let text = report.to_string();
        assert!(text.starts_with("skipped a suite t1: no Mitsuba\n"), "{text}");
        assert!(text.contains("    66.0 s  a suite, 12 tests\n"), "{text}");
        assert!(text.contains("slowest tests:\n    11.0 s  a suite t11\n"), "{text}");
        assert!(text.contains(" t2\n") && !text.contains("s  a suite t1\n"), "{text}");
        assert!(text.ends_with("FAILED a suite bad\n"), "{text}");
    }
}
