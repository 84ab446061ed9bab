//! Interactions: where a path scatters, on a surface or at a point of a medium.
//!
//! A density over solid angle becomes one over the next vertex: per area of a surface, with the cosine there, or per volume of
//! a medium, without. [Pauly 2000]

use crate::media::ball::Ball;
use crate::techniques::optical_path::PathPoint;
use crate::techniques::{DirectLight, PerSet, TechniqueCounts};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Bsdf, BsdfSample, LightSample, Phase, Ray, Surface, TransportMode};

/// The number of no object: of the paper on which a camera [receives](bilux_scene::Camera::receives) light.
pub(crate) const NO_OBJECT: u32 = u32::MAX;

/// A vertex of a path, as far as it scatters.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "most are surfaces, and a box for each would be allocated at every event"
)]
pub(crate) enum Interaction {
    /// A surface, and how it scatters here.
    Surface(Surface, Bsdf),
    /// A point of a medium.
    Medium(MediumPoint),
}

/// A point of a medium that scatters light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MediumPoint {
    pub(crate) p: Vec3,
    /// Distance along the ray, in metres.
    pub(crate) t: f32,
    /// Time of the ray, in seconds.
    pub(crate) time: f32,
    pub(crate) phase: Phase,
    /// Whether its medium is behind a surface, as in skin and milk, and not fog: such events do not count against the depth.
    pub(crate) is_inside: bool,
    /// Extinction coefficient of its medium, per metre, if it is the same everywhere.
    pub(crate) even: Option<Rgb>,
    /// Whether its medium has [equiangular points](crate::media::equiangular) too.
    pub(crate) is_equiangular: bool,
}

impl Interaction {
    /// The surface, if it is one.
    #[inline]
    pub(crate) fn surface(&self) -> Option<&Surface> {
        match self {
            Interaction::Surface(surface, _) => Some(surface),
            Interaction::Medium(_) => None,
        }
    }

    /// BSDF of the surface, if it is one.
    #[inline]
    pub(crate) fn bsdf(&self) -> Option<&Bsdf> {
        match self {
            Interaction::Surface(_, bsdf) => Some(bsdf),
            Interaction::Medium(_) => None,
        }
    }

    /// True for a point of a medium.
    #[inline]
    pub(crate) fn is_in_medium(&self) -> bool {
        matches!(self, Interaction::Medium(_))
    }

    /// True for a point of a medium behind a surface: [`MediumPoint::is_inside`].
    #[inline]
    pub(crate) fn is_inside(&self) -> bool {
        matches!(self, Interaction::Medium(MediumPoint { is_inside: true, .. }))
    }

    /// True for a point of a medium that has [equiangular points](crate::media::equiangular) too.
    #[inline]
    pub(crate) fn is_equiangular(&self) -> bool {
        matches!(self, Interaction::Medium(MediumPoint { is_equiangular: true, .. }))
    }

    /// The point for which [lights are chosen](crate::LightChoice::sample): there is none in a medium.
    #[inline]
    pub(crate) fn lit_at(&self) -> Option<Vec3> {
        self.surface().map(|surface| surface.p)
    }

    /// The point.
    #[inline]
    pub(crate) fn p(&self) -> Vec3 {
        match self {
            Interaction::Surface(surface, _) => surface.p,
            Interaction::Medium(point) => point.p,
        }
    }

    /// Time, in seconds.
    #[inline]
    pub(crate) fn time(&self) -> f32 {
        match self {
            Interaction::Surface(surface, _) => surface.time,
            Interaction::Medium(point) => point.time,
        }
    }

    /// Distance along the ray that came here, in metres.
    #[inline]
    pub(crate) fn t(&self) -> f32 {
        match self {
            Interaction::Surface(surface, _) => surface.t,
            Interaction::Medium(point) => point.t,
        }
    }

    /// The cosine between a direction and the surface's own normal, without sign; `None` in a medium.
    #[inline]
    pub(crate) fn cos(&self, direction: Vec3) -> Option<f32> {
        Some(self.surface()?.n_geom.dot(direction).abs())
    }

    /// The sine between two directions at a point of a medium, on which depends how often beams are merged there; 1 where there are
    /// none.
    #[inline]
    pub(crate) fn sine<const N: usize>(&self, wo: Vec3, wi: Vec3, techniques: &TechniqueCounts<N>) -> f32 {
        match self {
            Interaction::Medium(MediumPoint { even: Some(sigma_t), .. })
                if techniques.has_beams_in(*sigma_t) =>
            {
                wo.cross(wi).length()
            }
            _ => 1.0,
        }
    }

    /// Frequency with which merging counts this vertex, but for the [sine](Interaction::sine) of the angle at it, in a channel.
    /// `ball` is that in which it is merged if it is a point of a dense medium.
    #[inline]
    pub(crate) fn merged<const N: usize>(
        &self,
        techniques: &TechniqueCounts<N>,
        channel: u8,
        ball: Option<Ball>,
    ) -> PerSet<N> {
        match (self, ball) {
            (Interaction::Surface(..), _) => techniques.eta,
            (_, Some(ball)) => techniques.points * ball.volume,
            (Interaction::Medium(MediumPoint { even: Some(sigma_t), .. }), None) => {
                techniques.crossings(*sigma_t, channel)
            }
            _ => PerSet::ZERO,
        }
    }

    /// Techniques by which light subpaths find light here where they come straight from a light.
    #[inline]
    pub(crate) fn direct_light<const N: usize>(&self, techniques: &TechniqueCounts<N>) -> DirectLight {
        let is_in_medium = self.is_in_medium();
        let merges = techniques.direct || (is_in_medium && !self.is_equiangular());
        DirectLight { splats: merges || (is_in_medium && techniques.splats_cones), merges }
    }

    /// Place of the vertex, for the lengths of paths that come along `wo`.
    pub(crate) fn place(&self, wo: Vec3) -> PathPoint {
        match self {
            Interaction::Surface(surface, bsdf) => {
                PathPoint { p: surface.p, wo, n: surface.n_geom, eta: bsdf.relative_index() }
            }
            Interaction::Medium(point) => PathPoint { p: point.p, wo, n: Vec3::ZERO, eta: 1.0 },
        }
    }

    /// A ray that leaves it.
    #[inline]
    pub(crate) fn spawn(&self, direction: Vec3) -> Ray {
        match self {
            Interaction::Surface(surface, _) => surface.spawn(direction),
            Interaction::Medium(point) => point.spawn(direction),
        }
    }

    /// A ray from here to `target`, which it reaches at `t = 1`.
    #[inline]
    pub(crate) fn spawn_to(&self, target: Vec3) -> Ray {
        match self {
            Interaction::Surface(surface, _) => surface.spawn_to(target),
            Interaction::Medium(point) => point.spawn_to(target),
        }
    }

    /// A ray from here to a light sample, up to where the light itself cannot block it.
    #[inline]
    pub(crate) fn spawn_to_light(&self, sample: &LightSample) -> Ray {
        match (self, sample.point) {
            (Interaction::Surface(surface, _), _) => surface.spawn_to_light(sample),
            (Interaction::Medium(point), Some(target)) => {
                Ray { t_max: 1.0 - sample.clearance, ..point.spawn_to(target) }
            }
            (Interaction::Medium(point), None) => point.spawn(sample.wi),
        }
    }

    /// True where it scatters into single directions only.
    #[inline]
    pub(crate) fn is_delta(&self) -> bool {
        self.bsdf().is_some_and(Bsdf::is_delta)
    }

    /// True where other wavelengths scatter differently.
    #[inline]
    pub(crate) fn splits(&self) -> bool {
        self.bsdf().is_some_and(Bsdf::splits)
    }

    /// The scattered fraction of light per solid angle, with the cosine at a surface: [`Bsdf::eval`].
    #[inline]
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        match self {
            Interaction::Surface(_, bsdf) => bsdf.eval(wo, wi, mode),
            Interaction::Medium(point) => Rgb::grey(point.phase.eval(wo, wi)),
        }
    }

    /// The density of [`Interaction::sample`] over solid angle.
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        match self {
            Interaction::Surface(_, bsdf) => bsdf.pdf_solid_angle(wo, wi, mode),
            Interaction::Medium(point) => point.phase.eval(wo, wi),
        }
    }

    /// Both.
    #[inline]
    pub(crate) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        match self {
            Interaction::Surface(_, bsdf) => bsdf.eval_and_pdf(wo, wi, mode),
            Interaction::Medium(point) => {
                let pdf = point.phase.eval(wo, wi);
                (Rgb::grey(pdf), pdf)
            }
        }
    }

    /// Samples a direction; `None` where nothing is scattered.
    #[inline]
    pub(crate) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        match self {
            Interaction::Surface(_, bsdf) => bsdf.sample(wo, u_choice, u, mode),
            Interaction::Medium(point) => {
                let sample = point.phase.sample(wo, u_choice, u);
                Some(BsdfSample {
                    wi: sample.wi,
                    weight: Rgb::WHITE,
                    pdf_solid_angle: sample.pdf_solid_angle,
                    is_delta: false,
                    transmits: false,
                    eta: 1.0,
                })
            }
        }
    }
}

impl MediumPoint {
    /// A ray that leaves it.
    #[inline]
    pub(crate) fn spawn(&self, direction: Vec3) -> Ray {
        Ray { time: self.time, ..Ray::new(self.p.to_array(), direction.to_array()) }
    }

    /// A ray from here to `target`, which it reaches at `t = 1`.
    #[inline]
    pub(crate) fn spawn_to(&self, target: Vec3) -> Ray {
        Ray { t_max: 1.0, ..self.spawn(target - self.p) }
    }
}
