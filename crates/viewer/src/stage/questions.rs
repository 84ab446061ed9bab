//! Questions of those who watch about the picture, and what is measured for them.

use super::measure::Measurement;
use crate::inbox::QUESTIONS;
use crate::message::Question;

/// Questions that wait for a picture, and the measurement of accelerators.
#[derive(Default)]
pub(super) struct Questions {
    waiting: Vec<Question>,
    measurement: Option<Measurement>,
}

impl Questions {
    /// Adds questions; the oldest are dropped where there are too many. What waits for a picture is asked again by those who
    /// still want it.
    pub(super) fn add(&mut self, questions: Vec<Question>) {
        self.waiting.extend(questions);
        let many = self.waiting.len().saturating_sub(QUESTIONS);
        self.waiting.drain(..many);
    }

    /// All that wait. Those that are too early have to be kept.
    pub(super) fn take(&mut self) -> Vec<Question> {
        std::mem::take(&mut self.waiting)
    }

    /// Lets a question wait on.
    pub(super) fn keep(&mut self, early: Question) {
        self.waiting.push(early);
    }

    /// True if a question waits.
    pub(super) fn are_open(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Measures, or stops measuring.
    pub(super) fn measure(&mut self, measurement: Option<Measurement>) {
        self.measurement = measurement;
    }

    /// True if a measurement was begun and it is not known that it is over.
    pub(super) fn has_measurement(&self) -> bool {
        self.measurement.is_some()
    }

    /// True while accelerators are measured.
    pub(super) fn are_measured(&mut self) -> bool {
        self.measurement = self.measurement.take().filter(Measurement::goes_on);
        self.measurement.is_some()
    }
}
