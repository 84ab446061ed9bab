//! Bidirectional transport: subpaths from a light or from the camera, their throughput, and how they are connected.
//!
//! A path with `s` vertices from the light and `t` from the camera can be found by several techniques, one for each
//! pair (s, t). All of them are tried, and each is weighted by the balance heuristic against all others
//! [Veach 1997, 10.2]. A subpath carries the sums over the other techniques along as it grows
//! [Georgiev 2012, eq. 31 to 48], so a weight costs no more for long paths than for short ones. In words:
//! [`Partial::d_vcm`] is how likely a connection to the vertex is, over how likely the random walk is to reach it;
//! [`Partial::d_vc`] is the same for all vertices before it.
//!
//! Densities assume a film of area 1 and one light subpath per camera subpath. They leave out Russian roulette: all
//! that weights need is to be the same for all techniques.

mod both_ends;
mod connect;
mod light_paths;
mod queue;
mod walk;
#[cfg(test)]
mod weights;

pub(crate) use both_ends::BothEnds;
pub(crate) use connect::{merged, to_camera};
pub(crate) use light_paths::{LightPaths, light_vertices, show_to_camera};
pub(crate) use queue::{BothEndsQueue, PATHS, QueuedSample};
pub(crate) use walk::{Vertex, Walk};

use crate::task::Task;
use crate::techniques::{Contribution, Lanes, TechniqueCounts, favour};
use bilux_math::{Rgb, Vec3};
use bilux_scene::Surface;

/// The recursive part of the MIS weights. [Georgiev 2012]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partial<const N: usize = 1> {
    /// dVCM: 1 over the density of the last step, times the density of connecting there instead.
    pub(crate) d_vcm: f32,
    /// dVCM times the number of techniques that connect there.
    pub(crate) joined: Lanes<N>,
    /// The same, where the connection is one with the camera.
    pub(crate) shown: Lanes<N>,
    /// Light subpaths that merging here counts, times the area of merging.
    pub(crate) merged: Lanes<N>,
    /// dVC: what connections and merging count together, summed over the steps before.
    pub(crate) d_vc: Lanes<N>,
    /// The part of it that does not count if an emitter is hit next, since light subpaths leave direct light to others.
    pub(crate) beyond: Lanes<N>,
}

impl<const N: usize> Partial<N> {
    /// The start of a camera subpath, before any surface.
    pub(crate) const START: Partial<N> = Partial {
        d_vcm: 0.0,
        joined: Lanes::ZERO,
        shown: Lanes::ZERO,
        merged: Lanes::ZERO,
        d_vc: Lanes::ZERO,
        beyond: Lanes::ZERO,
    };

    /// A light subpath that leaves its light under the cosine `cos`. `pdf_direct` does not yet know the point that
    /// would sample the light.
    fn of_light(pdf_direct: f32, pdf_emission: f32, cos: f32, is_delta: bool) -> Partial<N> {
        let d_vc = if is_delta { 0.0 } else { cos / pdf_emission };
        Partial { d_vcm: pdf_direct / pdf_emission, d_vc: Lanes::ONE * d_vc, ..Partial::START }
    }

    /// A camera subpath at its first surface, given the density over area of hitting it there.
    pub(crate) fn of_camera(pdf_area: f32, techniques: &TechniqueCounts<N>) -> Partial<N> {
        let d_vcm = 1.0 / pdf_area;
        Partial { d_vcm, shown: techniques.splats * d_vcm, merged: techniques.eta, ..Partial::START }
    }

    /// Arrives at a surface from the distance √`distance2`, under the cosine `cos`, where `joins` techniques connect
    /// the last vertex with this one, and merging counts `merged`.
    fn arrive(&mut self, distance2: f32, cos: f32, joins: Lanes<N>, merged: Lanes<N>) {
        self.d_vcm *= distance2 / cos;
        self.joined = joins * self.d_vcm;
        self.shown = Lanes::ZERO;
        self.merged = merged;
        self.d_vc = self.d_vc * (1.0 / cos);
        self.beyond = self.beyond * (1.0 / cos);
    }

    /// Leaves under the cosine `cos`, with the forward and reverse densities; `None` for a delta event. `counts` is
    /// false where light subpaths do not look for what would be direct light here.
    fn leave(&mut self, cos: f32, pdfs: Option<(f32, f32)>, counts: bool) {
        match pdfs {
            None => {
                self.d_vcm = 0.0;
                self.d_vc = (self.d_vc + self.beyond) * cos;
                self.beyond = Lanes::ZERO;
            }
            Some((pdf, pdf_back)) => {
                let here = (self.merged + self.shown) * (cos / pdf);
                self.d_vc = ((self.d_vc + self.beyond) * pdf_back + self.joined) * (cos / pdf);
                self.beyond = Lanes::ZERO;
                if counts {
                    self.d_vc = self.d_vc + here;
                } else {
                    self.beyond = here;
                }
                self.d_vcm = 1.0 / pdf;
            }
        }
    }

    /// The sum over all techniques that move this subpath's vertices to the other side, relative to the current one.
    ///
    /// The other side would find this subpath's end with density `pdf_area`, and from there the vertex before it with
    /// `pdf_back`.
    pub(crate) fn others(&self, pdf_area: f32, pdf_back: f32) -> Lanes<N> {
        (self.merged + self.before(pdf_back)) * pdf_area
    }

    /// The same where the vertex on the other side is on a light.
    pub(crate) fn others_of_direct(&self, pdf_area: f32, pdf_back: f32, counts: bool) -> Lanes<N> {
        if counts {
            return self.others(pdf_area, pdf_back);
        }
        (self.joined + (self.d_vc + self.beyond) * pdf_back) * pdf_area
    }

    /// The same over the density of finding this vertex, without merging here.
    fn before(&self, pdf_back: f32) -> Lanes<N> {
        self.joined + self.shown + (self.d_vc + self.beyond) * pdf_back
    }
}

/// Light that a camera subpath hits by chance (s = 0): its radiance, and the densities with which the same path would
/// have been found by sampling the point on the light, and by a light subpath.
pub(crate) struct EmitterHit {
    pub(crate) radiance: Rgb,
    /// Over area; from infinity, over solid angle.
    pdf_direct: f32,
    pdf_emission: f32,
}

impl EmitterHit {
    /// What no other technique finds.
    fn only(radiance: Rgb) -> EmitterHit {
        EmitterHit { radiance, pdf_direct: 0.0, pdf_emission: 0.0 }
    }

    /// The contribution along a camera subpath with the throughput `beta`.
    pub(crate) fn by<const N: usize>(&self, beta: Rgb, partial: &Partial<N>) -> Contribution<N> {
        let picked = partial.d_vcm * self.pdf_direct;
        let others = Lanes::ONE * picked + partial.d_vc * self.pdf_emission;
        Contribution { favour: favour(picked), others, ..Contribution::only(beta * self.radiance) }
    }
}

/// Light from infinity that a camera subpath finds where it leaves the scene.
pub(crate) fn from_infinity<const N: usize>(task: &Task, walk: &Walk<N>, mut visit: impl FnMut(EmitterHit)) {
    let scene = task.scene();
    let (origin, direction) = (Vec3::from(walk.ray.origin), Vec3::from(walk.ray.direction));
    for (index, light) in scene.lights().iter().enumerate() {
        let light = &light.light;
        let radiance = light.le(direction);
        if radiance.is_black() || !scene.shows(&**light, walk.depth, walk.specular) {
            continue;
        }
        if walk.depth == 0 || light.is_backdrop() {
            visit(EmitterHit::only(radiance));
            continue;
        }
        let pdf = light.li_pdf_solid_angle(origin, direction, None);
        let pdf_emission = task.emission.pdf(scene, index, origin, pdf, -direction, 1.0);
        visit(EmitterHit { radiance, pdf_direct: pdf * task.lights.probability(index), pdf_emission });
    }
}

/// The light that a surface emits towards `wo`; `None` where it emits none.
pub(crate) fn emitted(task: &Task, surface: &Surface, wo: Vec3) -> Option<EmitterHit> {
    let scene = task.scene();
    let radiance = scene.emission(surface, wo);
    if radiance.is_black() {
        return None;
    }
    let Some(index) = scene.light_index_of(surface.object) else {
        return Some(EmitterHit::only(radiance));
    };
    let light = &scene.lights()[index].light;
    // As the previous vertex would have sampled it.
    let pdf_area = light.pdf_area(surface.p + wo * surface.t, surface);
    let cos = surface.n_geom.dot(wo).abs();
    let pdf_emission = task.emission.pdf(scene, index, surface.p, pdf_area, wo, cos);
    Some(EmitterHit { radiance, pdf_direct: pdf_area * task.lights.probability(index), pdf_emission })
}
