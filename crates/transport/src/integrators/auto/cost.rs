//! The cost of a sample: the number of its steps, times the duration of a step. Durations are never measured, since
//! pictures must not depend on the machine.

use super::sets::{SET_COUNT, Set};
use crate::techniques::{PerSet, Step};

/// Step counts of a sample.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    counts: [f64; STEPS],
    /// Merged photons and beams that each set would have.
    merged: [f64; SET_COUNT],
    /// The part of the camera steps that path tracing shades in columns, 0..=1.
    pub(super) in_columns: f64,
}

const STEPS: usize = 7;

/// Nanoseconds of each step, as measured on one machine in a few scenes of some ten thousand triangles: only their
/// ratios matter.
const LIGHT: f64 = 500.0;
const CAMERA: f64 = 330.0;
const SEEN: f64 = 290.0;
const PICKED: f64 = 210.0;
const CONNECTED: f64 = 140.0;
const LOOKUP: f64 = 250.0;
const ACROSS: f64 = 2000.0;
const MERGED: f64 = 80.0;
/// A step of a photon's subpath, which is traced among many others, with the cost of storing it and sorting it into a
/// cell.
const PHOTON: f64 = 450.0;

/// Nanoseconds of a step of paths that are followed in a queue without techniques from the light: on surfaces of any kind, and on
/// those that are shaded in columns. See docs/adr/0013-auto.md.
const CAMERA_IN_QUEUE: [f64; 2] = [500.0, 180.0];
const PICKED_IN_QUEUE: [f64; 2] = [80.0, 35.0];

impl Steps {
    pub(super) fn count(&mut self, step: Step, count: usize) {
        self.counts[step as usize] += count as f64;
    }

    /// Adds other steps, times `share`.
    pub(super) fn plus(mut self, others: &Steps, share: f64) -> Steps {
        for (count, more) in self.counts.iter_mut().zip(others.counts) {
            *count += share * more;
        }
        for (merged, more) in self.merged.iter_mut().zip(others.merged) {
            *merged += share * more;
        }
        self
    }

    /// One photon or beam is merged, as often as each set has the technique.
    pub(super) fn merge(&mut self, own: PerSet<SET_COUNT>) {
        for (merged, often) in self.merged.iter_mut().zip(own.0) {
            *merged += f64::from(often) / f64::from(own.0[0]);
        }
    }

    /// Nanoseconds of a sample with the techniques of a set of this index.
    pub(super) fn nanoseconds(&self, set: &Set, index: usize) -> f64 {
        let of = |step: Step, each: f64| self.counts[step as usize] * each;
        let Set { splats, connections, photons, .. } = *set;
        let (merges, photons) = (set.merges(), f64::from(photons));
        if !splats && !connections && !merges {
            let mean = |[any, columns]: [f64; 2]| any + (columns - any) * self.in_columns;
            return of(Step::Camera, mean(CAMERA_IN_QUEUE)) + of(Step::Picked, mean(PICKED_IN_QUEUE));
        }
        let mut sum = of(Step::Camera, CAMERA) + of(Step::Picked, PICKED);
        // Photons serve as splats without further work; connections cannot use them, so light subpaths are traced
        // again.
        if connections || (splats && !merges) {
            sum += of(Step::Light, LIGHT);
        }
        if splats {
            sum += of(Step::Seen, SEEN) * if connections || !merges { 1.0 } else { photons };
        }
        if connections {
            sum += of(Step::Connected, CONNECTED);
        }
        if merges {
            sum += of(Step::Light, PHOTON) * photons + of(Step::Lookup, LOOKUP) + of(Step::Across, ACROSS);
            sum += self.merged[index] * MERGED;
        }
        sum
    }
}
