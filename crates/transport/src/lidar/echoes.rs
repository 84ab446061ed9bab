//! The echoes of one pulse.

use super::{Pulse, Scanner};
use crate::media::Media;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Frame, Vec3};
use bilux_scene::{BsdfSample, Ray, Surface, Tracer, TransportMode, Wavelength};

/// Echo of one ray of a pulse from one surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Echo {
    /// Optical length of the way there, in metres.
    pub(super) range: f64,
    /// The power that arrives on each square metre at the scanner, of a pulse of power 1, in 1/m².
    pub(super) power: f64,
    pub(super) object: u32,
}

/// A ray of a pulse on its way to its next surface.
struct Leg {
    ray: Ray,
    media: Media,
    /// The fraction of its power that is left.
    left: f64,
    /// Sums of lengths times indices of refraction, and of lengths over these.
    optical: f64,
    reduced: f64,
    /// The index of refraction of what it travels in, over that around the scanner.
    index: f64,
    /// Smooth surfaces so far.
    events: u32,
}

/// Rays whose echoes could keep less than this fraction of their power are dropped.
const LEAST: f64 = 1e-9;

/// The angle between successive rays of a spiral that fills a disc evenly. [Vogel 1979]
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

impl Scanner {
    /// Adds the echoes of a pulse.
    pub(super) fn echoes(&self, pulse: &Pulse, tracer: &mut Tracer, echoes: &mut Vec<Echo>) {
        let frame = Frame::from_normal(pulse.direction);
        for i in 0..self.rays {
            let direction = self.direction(&frame, i);
            let origin = pulse.origin.to_array();
            let ray = Ray { time: pulse.time, ..Ray::new(origin, direction.to_array()) };
            let media = Media::at_start(tracer, &ray);
            let leg = Leg { ray, media, left: 1.0, optical: 0.0, reduced: 0.0, index: 1.0, events: 0 };
            let mut open = vec![leg];
            while let Some(leg) = open.pop() {
                self.follow(leg, tracer, &mut open, echoes);
            }
        }
    }

    /// The direction of a ray of the cone.
    fn direction(&self, frame: &Frame, i: u32) -> Vec3 {
        if self.rays == 1 {
            return frame.n;
        }
        let (sin, cos) = sin_cos_f64(f64::from(i) * GOLDEN_ANGLE);
        let across = ((f64::from(i) + 0.5) / f64::from(self.rays)).sqrt() * 0.5 * self.divergence;
        let (sin_across, cos_across) = sin_cos_f64(across);
        let local = [sin * sin_across, cos * sin_across, cos_across].map(|x| x as f32);
        frame.to_world(Vec3::from(local)).normalize()
    }

    /// Follows a ray to its next surface: the echo there, and the rays that go on from a smooth one.
    fn follow(&self, mut leg: Leg, tracer: &mut Tracer, open: &mut Vec<Leg>, echoes: &mut Vec<Echo>) {
        let Some(first) = tracer.closest(&leg.ray) else { return };
        let (surface, passed) = leg.media.closest_from(tracer, &leg.ray, first, self.seed);
        let Some(surface) = surface else { return };
        let length = f64::from(surface.t);
        leg.left *= f64::from(passed[self.channel]);
        leg.optical += length * leg.index;
        leg.reduced += length / leg.index;
        if leg.optical > self.range[1] {
            return;
        }
        let bsdf = leg.media.bsdf(tracer.scene, &surface, &Wavelength::D);
        let wo = -Vec3::from(leg.ray.direction);
        let scattered = f64::from(bsdf.eval(wo, wo, TransportMode::Radiance)[self.channel]);
        // Seen from here, the way back is a plane as far away as the reduced length says, in a medium of this index. [Born 1999, 4.4]
        let apparent = leg.reduced * leg.index;
        let power = leg.left * leg.left * scattered / (apparent * apparent) / f64::from(self.rays);
        if power > 0.0 {
            echoes.push(Echo { range: leg.optical, power, object: surface.object });
        }
        if leg.events < self.max_events {
            bsdf.each_smooth(wo, |sample| open.extend(self.after(&leg, &surface, &sample, tracer)));
        }
    }

    /// The ray that goes on from a smooth surface; `None` if too little of it is left.
    fn after(&self, leg: &Leg, surface: &Surface, sample: &BsdfSample, tracer: &Tracer) -> Option<Leg> {
        let left = leg.left * f64::from(sample.weight[self.channel]);
        let wo = -Vec3::from(leg.ray.direction);
        (left * left > LEAST).then(|| Leg {
            ray: surface.spawn(sample.wi),
            media: leg.media.beyond(tracer.scene, surface, wo, sample.wi),
            left,
            index: leg.index * f64::from(sample.eta),
            events: leg.events + 1,
            ..*leg
        })
    }
}
