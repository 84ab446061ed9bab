//! A lobe with a normal of its own, such as a smooth coat over a rough base: a [`Bsdf`] split into two parts, each
//! about a single normal. Their sum keeps every guarantee of a [`Bsdf`].

use super::lobe_frame::LobeFrame;
use super::{Bsdf, BsdfSample, MAX_LOBES, TransportMode};
use bilux_math::{Frame, Rgb, Vec2, Vec3};

/// The lobes about the shared normal, and the lobe about its own.
pub(super) struct Parts([Bsdf; 2]);

impl Bsdf {
    /// Gives one of the lobes, by index, a normal of its own.
    pub fn with_lobe_frame(mut self, index: usize, n: Vec3) -> Bsdf {
        self.set_lobe_frame(index, n);
        self
    }

    /// [`Bsdf::with_lobe_frame`] in place.
    #[inline]
    pub(crate) fn set_lobe_frame(&mut self, index: usize, n: Vec3) {
        let is_there = self.lobes.get(index).is_some_and(|lobe| lobe.is_some());
        let apart = LobeFrame { index: index as u8, n, bends: false };
        self.apart = (is_there && n != self.frame.n).then_some(apart);
    }

    /// The two parts, if a lobe has its own normal.
    #[inline]
    pub(super) fn parts(&self) -> Option<Parts> {
        self.apart.as_ref().map(|apart| self.split_lobes(apart))
    }

    #[inline(never)]
    fn split_lobes(&self, apart: &LobeFrame) -> Parts {
        let index = usize::from(apart.index);
        let about = |frame, bends| Bsdf { bends, splits: self.splits, ..Bsdf::empty(frame, self.n_geom) };
        let mut shared = about(self.frame, self.bends);
        let mut own = about(Frame::from_normal(apart.n), apart.bends);
        let mut place = 0;
        for i in (0..MAX_LOBES).take_while(|&i| self.lobes[i].is_some()) {
            if i == index {
                own.set_from(0, self, i);
            } else {
                shared.set_from(place, self, i);
                place += 1;
            }
        }
        Parts([shared, own])
    }

    /// Sets a lobe to one of another BSDF.
    #[inline]
    fn set_from(&mut self, place: usize, other: &Bsdf, i: usize) {
        (self.lobes[place], self.weights[place]) = (other.lobes[i], other.weights[i]);
        (self.strengths[place], self.rises[place]) = (other.strengths[i], other.rises[i]);
        self.total_strength += other.strengths[i];
        self.total_rise += other.rises[i];
    }
}

impl Parts {
    /// Visits both.
    pub(super) fn each(&self, visit: impl FnMut(&Bsdf)) {
        self.0.iter().for_each(visit);
    }

    /// [`Bsdf::eval_and_pdf`].
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        let (mut scattered, mut pdf, mut total) = (Rgb::BLACK, 0.0, 0.0);
        for part in &self.0 {
            let strength = part.strength_along(wo);
            let (f, p) = part.eval_and_pdf(wo, wi, mode);
            scattered += f;
            pdf += strength * p;
            total += strength;
        }
        (scattered, if total > 0.0 { pdf / total } else { 0.0 })
    }

    /// [`Bsdf::sample`].
    pub(super) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let [shared, own] = &self.0;
        let share = shared.strength_along(wo) / (shared.strength_along(wo) + own.strength_along(wo));
        let (chosen, share, u_choice) = if u_choice < share {
            (shared, share, u_choice / share)
        } else {
            (own, 1.0 - share, (u_choice - share) / (1.0 - share))
        };
        let u_choice = u_choice.clamp(0.0, 1.0 - f32::EPSILON);
        let mut sample = chosen.sample_direction(wo, u_choice, u, mode)?;
        if sample.is_delta {
            sample.weight = sample.weight / share;
            sample.pdf_solid_angle *= share;
            return (sample.pdf_solid_angle > 0.0).then_some(sample);
        }
        let (scattered, pdf_solid_angle) = self.eval_and_pdf(wo, sample.wi, mode);
        (sample.weight, sample.pdf_solid_angle) = (scattered / pdf_solid_angle, pdf_solid_angle);
        (pdf_solid_angle > 0.0).then_some(sample)
    }
}
