//! Predictions of `auto` for each integrator compared with what was measured: times to the same error, relative to that
//! of its choice.

use super::measured::{Measured, Row};

/// Times to the same error, as multiples of the time that `auto` takes; `None` if nothing was predicted, or `auto` was
/// not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Compared {
    pub(super) predicted: Option<f64>,
    /// By relMSE.
    pub(super) measured: Option<f64>,
    /// By relMSE without the worst 0.1% of the pixels.
    pub(super) measured_trimmed: Option<f64>,
}

impl Measured {
    /// Compares a row with that of `auto` within the same budget.
    pub(super) fn compared(&self, row: &Row) -> Compared {
        let Some(auto) = self.find("auto", row.seconds) else { return Compared::default() };
        let techniques = match row.integrator.split_once(':') {
            Some((_, techniques)) => techniques,
            None => &row.integrator,
        };
        let predicted = auto.choice.as_ref().and_then(|choice| {
            let best = choice.best();
            let candidate = choice.candidates.iter().find(|candidate| candidate.techniques == techniques);
            let candidate = if techniques == "auto" { Some(best) } else { candidate };
            candidate.map(|candidate| candidate.time_to_error() / best.time_to_error())
        });
        let time = row.took / auto.took;
        Compared {
            predicted,
            measured: Some(time * row.relmse / auto.relmse),
            measured_trimmed: Some(time * row.relmse_trimmed / auto.relmse_trimmed),
        }
    }
}
