//! Interface of a light source.

use super::{Beam, EmissionSample, LightExtent, distant};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use crate::surface::light_sample::LightSample;
use bilux_math::{Aabb, Rgb, Vec2, Vec3, warp};
use std::any::Any;

/// A light source, as a point of the scene sees it: what camera subpaths and the tracer need.
pub trait Light: LightTracing + ClassicLighting + Any + Send + Sync {
    /// Samples a direction from which light arrives at `from`; `None` if none does.
    fn sample_li(&self, from: Vec3, time: f32, u: Vec2) -> Option<LightSample>;

    /// [`Light::sample_li`] for many points; `samples` is emptied first. A light that reads large tables reads them for
    /// all points in turn, so that reads which miss the caches overlap.
    fn sample_li_each(&self, receivers: &[Receiver], samples: &mut Vec<Option<LightSample>>) {
        samples.clear();
        samples.extend(receivers.iter().map(|r| self.sample_li(r.p, r.time, r.u)));
    }

    /// The density of [`Light::sample_li`] for the direction `wi`; zero for delta lights.
    ///
    /// `hit` is what a ray along `wi` hits; `None` means that it hits nothing, and the light is infinite.
    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32;

    /// False when [`Light::sample_li`] leaves light to BSDF sampling, in directions where its density is zero.
    ///
    /// [`LightTracing::sample_le`] emits that light nevertheless. [Karlík 2019]
    fn samples_all_light(&self) -> bool {
        true
    }

    /// The density over area with which [`Light::sample_li`] at `from` samples a point of this light.
    ///
    /// Zero for a point that is not on it, and for lights without a surface.
    fn pdf_area(&self, _from: Vec3, _hit: &Surface) -> f32 {
        0.0
    }

    /// False where a point of its surface emits no light towards `wo`, because the light is one-sided.
    fn emits_towards(&self, _hit: &Surface, _wo: Vec3) -> bool {
        true
    }

    /// Radiance from infinity, along a direction away from the scene.
    fn le(&self, _direction: Vec3) -> Rgb {
        Rgb::BLACK
    }

    /// [`Light::le`] of a ray from `from` that leaves the scene, and [`Light::li_pdf_solid_angle`] of its direction.
    fn le_and_pdf(&self, from: Vec3, direction: Vec3) -> (Rgb, f32) {
        (self.le(direction), self.li_pdf_solid_angle(from, direction, None))
    }

    /// [`Light::le_and_pdf`] for many rays, each with its direction; the density is 0 for a ray without an origin. `found`
    /// is emptied first.
    fn le_and_pdf_each(&self, rays: &[(Option<Vec3>, Vec3)], found: &mut Vec<(Rgb, f32)>) {
        found.clear();
        found.extend(rays.iter().map(|&(from, direction)| match from {
            Some(from) => self.le_and_pdf(from, direction),
            None => (self.le(direction), 0.0),
        }));
    }

    /// True when only the camera sees it, and it lights nothing ([`crate::Scene::shows`]).
    fn is_backdrop(&self) -> bool {
        false
    }

    /// A point in its middle, in metres, and about how far from there it reaches; `None` for an infinite light. What is sampled close to it is
    /// sampled around there.
    fn middle_and_reach(&self) -> Option<(Vec3, f32)> {
        None
    }

    /// The cone from its middle that most of its light goes into, if that is narrow.
    fn beam(&self) -> Option<Beam> {
        None
    }

    /// Bounds of where it is and where it shines, between these times in seconds; `None` for an infinite light.
    fn extent(&self, _shutter: [f32; 2]) -> Option<LightExtent> {
        None
    }

    /// True for a delta light, which no ray can hit by chance.
    fn is_delta(&self) -> bool;

    /// Approximately the luminance of the power that it emits into the scene, in W, for choosing among lights.
    fn power(&self, bounds: &Aabb) -> f32;
}

/// A point that a light is sampled from.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// The point.
    pub p: Vec3,
    /// The time in seconds.
    pub time: f32,
    /// The random point that picks the sample.
    pub u: Vec2,
}

/// Light source as light subpaths see it: the rays that leave it.
pub trait LightTracing {
    /// Samples a ray of light into a scene within `bounds`, at a time in seconds.
    ///
    /// `None` where no light leaves, or where the scene has no size that an infinite light could aim at.
    fn sample_le(&self, bounds: &Aabb, time: f32, u_point: Vec2, u_direction: Vec2)
    -> Option<EmissionSample>;

    /// The direct density of the origin of a ray that arrives at `from`.
    ///
    /// It is [`EmissionSample::pdf_direct`], unless that depends on the receiver, as for a sphere, which is sampled by
    /// the solid angle that it subtends.
    fn direct_pdf(&self, sample: &EmissionSample, _from: Vec3) -> f32 {
        sample.pdf_direct
    }

    /// The density ([`EmissionSample::pdf_emission`]) with which [`LightTracing::sample_le`] emits a ray along `direction`.
    ///
    /// `direction` is a unit vector away from the light. `pdf_start` is [`EmissionSample::pdf_direct`] of the ray's origin, or
    /// [`LightTracing::pdf_start`] of a point that was hit. `cos` is [`EmissionSample::cos`].
    fn emission_pdf(&self, bounds: &Aabb, pdf_start: f32, direction: Vec3, cos: f32) -> f32;

    /// The density over area with which light subpaths begin at a point of its surface, which some point samples with the density `pdf_direct`.
    fn pdf_start(&self, pdf_direct: f32, _hit: &Surface) -> f32 {
        pdf_direct
    }

    /// Like [`LightTracing::sample_le`], but aimed ([`LightTracing::aim`]): `u` picks the rest, the point on a finite light or the
    /// direction of an infinite one. The sample's `pdf_emission` is the density of the rest alone.
    fn sample_le_aimed(&self, bounds: &Aabb, time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample>;

    /// The density of the rest that [`LightTracing::sample_le_aimed`] picks; otherwise like [`LightTracing::emission_pdf`].
    fn unaimed_pdf(&self, bounds: &Aabb, pdf_start: f32, direction: Vec3, cos: f32) -> f32;

    /// The aim of a ray of light through `p` along `direction`, as a point on the unit square.
    ///
    /// For a finite light it is the direction, by [`warp::sphere_to_square`]. For an infinite one it is the point where
    /// the ray crosses a perpendicular square around the scene; a ray that misses the square has an aim outside of
    /// 0..=1.
    fn aim(&self, bounds: &Aabb, p: Vec3, direction: Vec3) -> Vec2 {
        if self.is_infinite() {
            distant::place_across(bounds, p, direction)
        } else {
            warp::sphere_to_square(direction)
        }
    }

    /// The density of an aim that is uniform over the square: over solid angle, or over area for an infinite light.
    fn aim_pdf(&self, bounds: &Aabb) -> f32 {
        if self.is_infinite() { distant::square_pdf_area(bounds) } else { warp::sphere_pdf_solid_angle() }
    }

    /// True for an infinite light, whose direct density is one of directions.
    fn is_infinite(&self) -> bool;
}

/// Light source as Equations 1 and 2 see it.
pub trait ClassicLighting {
    /// The light under Equations 1 and 2, from its centre offset by `extent` (0..=1) of its size towards the point that
    /// `u` picks; `None` where it does not shine.
    fn classic(&self, from: Vec3, time: f32, u: Vec2, extent: f32) -> Option<ClassicLight>;

    /// Colour under Equations 1 and 2, for a scene within these bounds.
    fn classic_colour(&self, bounds: &Aabb) -> Rgb;

    /// Contribution to the ambient light of Equations 1 and 2.
    fn classic_ambient(&self) -> Rgb {
        Rgb::BLACK
    }
}
