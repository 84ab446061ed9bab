//! Time that a step took.

use crate::process::cpu_time;
use std::fmt;
use std::time::{Duration, Instant};

/// One step that has run.
pub(super) struct Report {
    pub(super) name: &'static str,
    pub(super) time: Duration,
    /// Of all cores, where the system tells.
    pub(super) cpu: Option<Duration>,
    pub(super) ok: bool,
}

impl Report {
    /// The report of a step that began then, when this process and its children had taken so much CPU time.
    pub(super) fn since(name: &'static str, (begun, cpu): (Instant, Option<Duration>), ok: bool) -> Report {
        let cpu = cpu_time().zip(cpu).map(|(now, then)| now.saturating_sub(then));
        Report { name, time: begun.elapsed(), cpu, ok }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let minutes = |time: Duration| time.as_secs_f64() / 60.0;
        let cpu = self.cpu.map_or("unknown".to_owned(), |cpu| format!("{:.2}", minutes(cpu)));
        let verdict = if self.ok { "ok" } else { "FAILED" };
        write!(out, "{:<16} {:>6.2} min, {cpu:>6} min of CPU  {verdict}", self.name, minutes(self.time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_a_line() {
        let report = Report { name: "doc", time: Duration::from_secs(90), cpu: None, ok: false };
        assert_eq!(report.to_string(), "doc                1.50 min, unknown min of CPU  FAILED");
    }
}
