//! Results: a row for each integrator, scene and budget.

use super::reference::Reference;
use bilux::pictures::WriteOptions;
use bilux::transport::Choice;
use bilux_math::Rgb;

/// The result of one integrator on a scene within a budget.
pub(super) struct Row {
    pub(super) scene: String,
    pub(super) integrator: String,
    /// The budget, in CPU seconds.
    pub(super) seconds: f64,
    /// The CPU seconds that the pictures actually took.
    pub(super) took: f64,
    pub(super) samples: u32,
    pub(super) relmse: f64,
    pub(super) relmse_trimmed: f64,
    /// `None` for a single picture.
    pub(super) bias2: Option<f64>,
    pub(super) mean: f64,
    /// `None` if the system does not report it.
    pub(super) peak_mb: Option<f64>,
    /// The first of the pictures.
    pub(super) picture: Vec<Rgb>,
    /// Choice of `auto`, with its reasons.
    pub(super) choice: Option<Choice>,
}

/// Everything that was measured on a scene.
pub(super) struct Measured {
    pub(super) scene: String,
    pub(super) summary: String,
    pub(super) reference: Reference,
    /// Display options of the scene's pictures.
    pub(super) shown: WriteOptions,
    pub(super) rows: Vec<Row>,
}

impl Measured {
    /// The row of an integrator and a budget.
    pub(super) fn find(&self, integrator: &str, seconds: f64) -> Option<&Row> {
        self.rows.iter().find(|row| row.integrator == integrator && row.seconds == seconds)
    }

    /// The row of the integrator other than `auto` with the smallest error.
    pub(super) fn best_single(&self, seconds: f64) -> Option<&Row> {
        let single = self.rows.iter().filter(|row| row.integrator != "auto" && row.seconds == seconds);
        single.min_by(|a, b| a.relmse.total_cmp(&b.relmse))
    }
}
