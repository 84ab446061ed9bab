//! The samples before and after a time.

use bilux_math::Vec3;

/// Of all samples that are seen, the last one before a time and the first one after it.
pub(super) struct Around {
    wanted: f64,
    before: Option<(f64, Vec<Vec3>)>,
    after: Option<(f64, Vec<Vec3>)>,
}

impl Around {
    pub(super) fn new(wanted: f64) -> Around {
        Around { wanted, before: None, after: None }
    }

    /// True if a sample of this time is closer than the one that is there.
    pub(super) fn wants(&self, time: f64) -> bool {
        match time <= self.wanted {
            true => self.before.as_ref().is_none_or(|(known, _)| time > *known),
            false => self.after.as_ref().is_none_or(|(known, _)| time < *known),
        }
    }

    /// Takes a sample in; returns the one that it replaces.
    pub(super) fn add(&mut self, time: f64, vectors: Vec<Vec3>) -> Vec<Vec3> {
        let slot = if time <= self.wanted { &mut self.before } else { &mut self.after };
        slot.replace((time, vectors)).map_or_else(Vec::new, |(_, vectors)| vectors)
    }

    /// True if nothing later matters, when samples are in order.
    pub(super) fn is_full(&self) -> bool {
        self.after.is_some() || self.before.as_ref().is_some_and(|(time, _)| *time == self.wanted)
    }

    /// The vectors at the time: on the line between both, or where there is only one, those; empty without any.
    pub(super) fn vectors(self) -> Vec<Vec3> {
        match (self.before, self.after) {
            (Some((start, mut from)), Some((end, to))) if from.len() == to.len() => {
                let share = ((self.wanted - start) / (end - start)) as f32;
                from.iter_mut().zip(to).for_each(|(from, to)| *from = from.lerp(to, share));
                from
            }
            (Some((_, only)), _) | (None, Some((_, only))) => only,
            (None, None) => Vec::new(),
        }
    }
}
