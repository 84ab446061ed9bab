//! Delta lobes about an interpolated normal, which may send light through the triangle, or see `wo` on the wrong side.
//! In those cases the geometric normal replaces the interpolated one, so that no light is lost.
//!
//! For a camera path the rule depends on the known `wo`. A light path arrives along the direction that the rule would
//! sample, and more than one `wo` may lead to it: one about the interpolated normal, others about the geometric one. It
//! has to sample each as often as the rule does, or the image of a coarsely tessellated mirror would depend on the end
//! that paths start from.

use super::{Bsdf, BsdfSample, Lobe, TransportMode};
use bilux_math::frame::reflect;
use bilux_math::{Frame, Rgb, Vec2, Vec3};
use std::ops::Range;

/// The events of a lobe about one normal: reflection, transmission.
type Events = [Option<BsdfSample>; 2];

impl Bsdf {
    /// The index of refraction behind the surface over that in front of it; 1 for one that has no inside.
    pub fn relative_index(&self) -> f32 {
        self.weighted().find_map(|(_, lobe)| lobe.index()).map_or(1.0, |(eta, _)| eta)
    }

    /// Visits every direction of the delta lobes in which light known to come along `wo` goes on. Weights are the fractions of power
    /// that go there, probabilities 1.
    pub fn each_smooth(&self, wo: Vec3, mut visit: impl FnMut(BsdfSample)) {
        let visit: &mut dyn FnMut(BsdfSample) = &mut visit;
        match self.parts() {
            Some(parts) => parts.each(|part| part.each_smooth_of_all(wo, visit)),
            None => self.each_smooth_of_all(wo, visit),
        }
    }

    fn each_smooth_of_all(&self, wo: Vec3, visit: &mut dyn FnMut(BsdfSample)) {
        for (weight, lobe) in self.weighted().filter(|(_, lobe)| lobe.is_delta()) {
            let by = |u: f32| self.sample_delta(lobe, wo, u, TransportMode::Importance);
            let [low, high] = [by(0.0), by(1f32.next_down())];
            let is_other = |high: &BsdfSample| low.is_none_or(|low| low.transmits != high.transmits);
            for sample in low.into_iter().chain(high.filter(is_other)) {
                let share = sample.pdf_solid_angle * weight;
                visit(BsdfSample { weight: sample.weight * share, pdf_solid_angle: 1.0, ..sample });
            }
        }
    }

    /// The fraction of radiance along `wo` that passes panes straight, without a change of direction. Black where the interpolated normal
    /// does not work for it.
    pub fn straight(&self, wo: Vec3) -> Rgb {
        let mut sum = Rgb::BLACK;
        match self.parts() {
            Some(parts) => parts.each(|part| sum += part.straight_of_all(wo)),
            None => sum = self.straight_of_all(wo),
        }
        sum
    }

    fn straight_of_all(&self, wo: Vec3) -> Rgb {
        let local = self.frame.to_local(wo);
        let works =
            self.sees_side(wo) && reflect(wo, self.frame.n).dot(self.n_geom) * wo.dot(self.n_geom) > 0.0;
        let panes = self.weighted().filter(|(_, lobe)| works && lobe.transmitted(local) == Some(-local));
        let passed = panes.filter_map(|(weight, lobe)| {
            let sample = self.sample_delta(lobe, wo, 1f32.next_down(), TransportMode::Radiance)?;
            sample.transmits.then(|| sample.weight * (sample.pdf_solid_angle * weight))
        });
        passed.sum()
    }

    /// Samples a direction of a delta lobe.
    pub(super) fn sample_delta(
        &self,
        lobe: &Lobe,
        wo: Vec3,
        u_choice: f32,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        if mode == TransportMode::Importance && !self.works_in_both_directions(lobe, wo) {
            return self.sample_delta_importance(lobe, wo, u_choice);
        }
        let about = |frame: &Frame| {
            let sample = about(lobe, frame, wo, u_choice, mode).filter(|s| self.keeps_side(wo, s))?;
            let weight = self.carried(sample.weight, frame.n, wo, sample.wi, mode);
            Some(BsdfSample { weight, ..sample })
        };
        let shaded = if self.sees_side(wo) { about(&self.frame) } else { None };
        shaded.or_else(|| about(&Frame::from_normal(self.n_geom)))
    }

    /// True when the interpolated normal works for `wo`, and for every other direction that could have led to `wo`.
    ///
    /// That is nearly always so, and much cheaper to test than to compute all probabilities.
    fn works_in_both_directions(&self, lobe: &Lobe, wo: Vec3) -> bool {
        if self.frame.n == self.n_geom {
            return true;
        }
        let through = |frame: &Frame, wo: Vec3| Some(frame.to_world(lobe.transmitted(frame.to_local(wo))?));
        let holds = |wo: Vec3| {
            let side = wo.dot(self.n_geom);
            self.sees_side(wo)
                && reflect(wo, self.frame.n).dot(self.n_geom) * side > 0.0
                && through(&self.frame, wo).is_none_or(|wi| wi.dot(self.n_geom) * side < 0.0)
        };
        holds(wo)
            && holds(reflect(wo, self.n_geom))
            && through(&Frame::from_normal(self.n_geom), wo).is_none_or(holds)
    }

    /// The adjoint of the rule: samples every event that could continue along `wo`, each by its probability.
    fn sample_delta_importance(&self, lobe: &Lobe, wo: Vec3, u_choice: f32) -> Option<BsdfSample> {
        let keeps = |event: Option<BsdfSample>| event.filter(|sample| self.keeps_side(wo, sample));
        let shaded = if self.sees_side(wo) { events(lobe, &self.frame, wo).map(keeps) } else { [None; 2] };
        let flat = events(lobe, &Frame::from_normal(self.n_geom), wo).map(keeps);
        let n = self.frame.n;
        let ways = [(shaded[0], n), (shaded[1], n), (flat[0], self.n_geom), (flat[1], self.n_geom)];
        // About the interpolated normal the reverse event has the same probability, as Fresnel's equations are
        // symmetric.
        let chances: [f32; 4] = std::array::from_fn(|i| match &ways[i].0 {
            Some(event) if i < 2 => event.pdf_solid_angle,
            Some(event) => self.falls_back(lobe, event),
            None => 0.0,
        });
        let total: f32 = chances.iter().sum();
        let begins = |i: usize| chances[..i].iter().sum::<f32>();
        let chosen = (0..4).rev().find(|&i| chances[i] > 0.0 && begins(i) <= u_choice * total)?;
        let (event, n) = (ways[chosen].0?, ways[chosen].1);
        let weight = self.carried(event.weight * total, n, wo, event.wi, TransportMode::Importance);
        Some(BsdfSample { weight, pdf_solid_angle: chances[chosen] / total, ..event })
    }

    /// The probability, seen from the other end of an event about the geometric normal, that the interpolated normal
    /// fails and this event replaces it.
    fn falls_back(&self, lobe: &Lobe, event: &BsdfSample) -> f32 {
        let wo = event.wi;
        if !self.sees_side(wo) {
            return event.pdf_solid_angle;
        }
        let own = if event.transmits { 1.0 - event.pdf_solid_angle..1.0 } else { 0.0..event.pdf_solid_angle };
        let [reflected, transmitted] = events(lobe, &self.frame, wo);
        let end = reflected.map_or(0.0, |sample| sample.pdf_solid_angle);
        let fails = |sample: Option<BsdfSample>| sample.is_none_or(|s| !self.keeps_side(wo, &s));
        let lost = |fails: bool, range: Range<f32>| if fails { overlap(&own, &range) } else { 0.0 };
        lost(fails(reflected), 0.0..end) + lost(fails(transmitted), end..1.0)
    }

    /// True when `wo` is on the same side of the triangle and of the interpolated surface.
    #[inline]
    fn sees_side(&self, wo: Vec3) -> bool {
        wo.dot(self.frame.n) * wo.dot(self.n_geom) > 0.0
    }
}

#[inline]
fn about(lobe: &Lobe, frame: &Frame, wo: Vec3, u_choice: f32, mode: TransportMode) -> Option<BsdfSample> {
    let mut sample = lobe.sample(frame.to_local(wo), u_choice, Vec2::ZERO, mode)?;
    sample.wi = frame.to_world(sample.wi).normalize();
    Some(sample)
}

/// The smallest random number selects reflection if there is any; the largest selects transmission.
fn events(lobe: &Lobe, frame: &Frame, wo: Vec3) -> Events {
    let by = |u: f32| about(lobe, frame, wo, u, TransportMode::Importance);
    [by(0.0).filter(|sample| !sample.transmits), by(1f32.next_down()).filter(|sample| sample.transmits)]
}

fn overlap(a: &Range<f32>, b: &Range<f32>) -> f32 {
    (a.end.min(b.end) - a.start.max(b.start)).max(0.0)
}
