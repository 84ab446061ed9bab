//! Paths from both ends: subpaths that begin at a light or at the camera, what they carry, and how they are joined.
//!
//! A path with `s` vertices from the light and `t` from the camera can be found in several ways, one for each pair
//! (s, t). All of them are tried, and each is weighted by the balance heuristic against all others [Veach 1997, 10.2].
//! The sums over the others are carried along while a subpath grows [Georgiev 2012, eq. 31 to 48], so that a weight
//! costs no more for long paths than for short ones. In words: [`Partial::d_vcm`] is how likely the vertex is to be
//! connected to over how likely it is to be walked to; [`Partial::d_vc`] is the same for all vertices before it.
//!
//! Densities count a film of area 1 and one light path for each camera path. Roulette is left out of them: weights need
//! to be the same for all ways and no more.

mod connect;
mod photons;
mod techniques;
mod walk;
#[cfg(test)]
mod weights;

pub(crate) use connect::{merged, show_to_camera, to_camera, to_light, to_vertex};
pub(crate) use photons::LightPathVisitor;
pub use photons::{Merging, Photons};
pub(crate) use techniques::{Contribution, Lanes, Step, Tally, Technique, TechniqueCounts, favour};
pub(crate) use walk::{Vertex, Walk, count};

use crate::emission::Start;
use crate::task::Task;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Surface, TransportMode};

/// The recursive part of the weights. [Georgiev 2012]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partial<const N: usize = 1> {
    /// dVCM: 1 over the density of the last step, times the density of joining there instead.
    pub(crate) d_vcm: f32,
    /// How much of it counts, since there are so many ways that join there.
    pub(crate) joined: Lanes<N>,
    /// The same, where joining there is being seen from the camera.
    pub(crate) shown: Lanes<N>,
    /// Light paths that merging here counts, over area.
    pub(crate) merged: Lanes<N>,
    /// dVC: what joining and merging count together, summed over the steps before.
    pub(crate) d_vc: Lanes<N>,
    /// What of it does not count if a light is met next, since light paths leave direct light to others.
    pub(crate) beyond: Lanes<N>,
}

impl<const N: usize> Partial<N> {
    /// Of a camera path that has met nothing yet.
    pub(crate) const START: Partial<N> = Partial {
        d_vcm: 0.0,
        joined: Lanes::ZERO,
        shown: Lanes::ZERO,
        merged: Lanes::ZERO,
        d_vc: Lanes::ZERO,
        beyond: Lanes::ZERO,
    };

    /// Of a light path that leaves its light with the cosine `cos`. `pdf_direct` does not know yet who would ask.
    fn of_light(pdf_direct: f32, pdf_emission: f32, cos: f32, is_delta: bool) -> Partial<N> {
        let d_vc = if is_delta { 0.0 } else { cos / pdf_emission };
        Partial { d_vcm: pdf_direct / pdf_emission, d_vc: Lanes::ONE * d_vc, ..Partial::START }
    }

    /// Of a camera path that has met its first surface, given the density of doing so over area.
    pub(crate) fn of_camera(pdf_area: f32, techniques: &TechniqueCounts<N>) -> Partial<N> {
        let d_vcm = 1.0 / pdf_area;
        Partial { d_vcm, shown: techniques.splats * d_vcm, merged: techniques.eta, ..Partial::START }
    }

    /// On arrival at a surface, from as far as the root of `distance2`, under the cosine `cos`, where `joins` ways join
    /// the last vertex with this one, and merging counts `merged`.
    fn arrive(&mut self, distance2: f32, cos: f32, joins: Lanes<N>, merged: Lanes<N>) {
        self.d_vcm *= distance2 / cos;
        self.joined = joins * self.d_vcm;
        self.shown = Lanes::ZERO;
        self.merged = merged;
        self.d_vc = self.d_vc * (1.0 / cos);
        self.beyond = self.beyond * (1.0 / cos);
    }

    /// On leaving under the cosine `cos`, with densities there and back; `None` where there is only one direction. `counts`
    /// is false where light paths do not look for what would be direct light here.
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

    /// How often all ways together find what the vertex before this subpath's end would be found by with `pdf_area`, and
    /// the one before that with `pdf_back`.
    pub(crate) fn others(&self, pdf_area: f32, pdf_back: f32) -> Lanes<N> {
        (self.merged + self.before(pdf_back)) * pdf_area
    }

    /// The same where that vertex is on a light.
    pub(crate) fn others_of_direct(&self, pdf_area: f32, pdf_back: f32, counts: bool) -> Lanes<N> {
        if counts {
            return self.others(pdf_area, pdf_back);
        }
        (self.joined + (self.d_vc + self.beyond) * pdf_back) * pdf_area
    }

    /// The same over the density of coming to this vertex, without merging there.
    fn before(&self, pdf_back: f32) -> Lanes<N> {
        self.joined + self.shown + (self.d_vc + self.beyond) * pdf_back
    }
}

/// Random numbers of light paths begin here, far from those of camera paths.
const LIGHT_STREAM: u64 = 1 << 32;

impl Task<'_, '_> {
    /// Random numbers for joining a vertex of the light path.
    pub(crate) fn enter_light_vertex(&mut self, depth: u32) {
        self.sampler.enter(2 * LIGHT_STREAM + u64::from(depth));
    }
}

/// A path from a light: every surface that it meets and that scatters into more than single directions, in order.
pub(crate) fn light_vertices<const N: usize>(
    task: &mut Task,
    time: f32,
    roulette_depth: u32,
    techniques: &TechniqueCounts<N>,
) -> Vec<Vertex<N>> {
    let mut vertices = Vec::new();
    let Some(mut walk) = begin_at_light(task, time, techniques) else { return vertices };
    while let Some(vertex) = walk.meet(task) {
        // The last event of the longest path is at the camera's side.
        let ends = vertex.depth + 1 >= task.max_depth;
        let stream = LIGHT_STREAM + 1 + u64::from(vertex.depth);
        task.sampler.enter(stream);
        let goes_on = !ends && walk.scatter(&vertex, roulette_depth, task);
        if !vertex.bsdf.is_delta() {
            vertices.push(vertex);
        }
        if !goes_on {
            break;
        }
    }
    vertices
}

fn begin_at_light<'w, const N: usize>(
    task: &mut Task,
    time: f32,
    techniques: &'w TechniqueCounts<N>,
) -> Option<Walk<'w, N>> {
    task.sampler.enter(LIGHT_STREAM);
    let (u_light, u_point, u_direction) =
        (task.sampler.next_1d(), task.sampler.next_2d(), task.sampler.next_2d());
    if task.max_depth == 0 {
        return None;
    }
    let scene = task.scene();
    let start = task.emission.sample(scene, time, u_light, (u_point, u_direction))?;
    let Start { light: index, ray, .. } = start;
    let light = &scene.lights()[index].light;
    let (cos, pdf_emission) = (ray.cos(), ray.pdf_emission);
    let pdf_direct = ray.pdf_direct * task.lights.probability(index);
    let beta = ray.le * (cos / pdf_emission);
    let partial = Partial::of_light(pdf_direct, pdf_emission, cos, light.is_delta());
    // The start of a ray from infinity is known by area already.
    let by_area = light.is_infinite();
    let spawned = ray.spawn(time);
    let walk = Walk::new(TransportMode::Importance, spawned, beta, partial, by_area, techniques);
    Some(walk.leaving(start))
}

/// Light that a camera path meets by chance (s = 0): its radiance, and the densities with which the same path would have
/// been found by picking the point on the light, and by a path from it.
pub(crate) struct EmitterHit {
    pub(crate) radiance: Rgb,
    /// Over area; from infinity, over solid angle.
    pdf_direct: f32,
    pdf_emission: f32,
}

impl EmitterHit {
    /// What no other way finds.
    fn only(radiance: Rgb) -> EmitterHit {
        EmitterHit { radiance, pdf_direct: 0.0, pdf_emission: 0.0 }
    }

    /// The same for a camera path that carries `beta`.
    pub(crate) fn by<const N: usize>(&self, beta: Rgb, partial: &Partial<N>) -> Contribution<N> {
        let picked = partial.d_vcm * self.pdf_direct;
        let others = Lanes::ONE * picked + partial.d_vc * self.pdf_emission;
        Contribution { favour: favour(picked), others, ..Contribution::only(beta * self.radiance) }
    }
}

/// Light from infinity that a camera path meets where it leaves the scene.
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

/// What a surface gives out towards `wo`; `None` where nothing.
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
    // As the vertex before would have picked it.
    let pdf_area = light.pdf_area(surface.p + wo * surface.t, surface);
    let cos = surface.n_geom.dot(wo).abs();
    let pdf_emission = task.emission.pdf(scene, index, surface.p, pdf_area, wo, cos);
    Some(EmitterHit { radiance, pdf_direct: pdf_area * task.lights.probability(index), pdf_emission })
}
