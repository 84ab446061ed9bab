//! Emitters that a camera subpath hits by chance (s = 0).

use super::Subpath;
use crate::light::emission::light_number;
use crate::media::equiangular::Approach;
use crate::sampling::task::Task;
use crate::techniques::mis::Partial;
use crate::techniques::{Contribution, NO_LIGHT, PerSet, power_factor};
use bilux_math::{Rgb, Vec3};
use bilux_scene::Surface;

/// Light that a camera subpath hits by chance (s = 0): its radiance, and the densities with which the same path would
/// have been found by sampling the point on the light, and by a light subpath.
pub(crate) struct EmitterHit {
    pub(crate) radiance: Rgb,
    /// Over area; from infinity, over solid angle.
    pdf_direct: f32,
    pdf_emission: f32,
    /// The index of the light that emits it.
    pub(crate) light: Option<usize>,
}

impl EmitterHit {
    /// Hit that no other technique finds.
    fn only(radiance: Rgb, light: Option<usize>) -> EmitterHit {
        EmitterHit { radiance, pdf_direct: 0.0, pdf_emission: 0.0, light }
    }

    /// The contribution along a camera subpath with the throughput `beta`, where no other technique finds it.
    pub(crate) fn alone<const N: usize>(&self, beta: Rgb) -> Contribution<N> {
        let origin = self.light.map_or(NO_LIGHT, light_number);
        Contribution { origin, ..Contribution::only(beta * self.radiance) }
    }

    /// The contribution along a camera subpath with the throughput `beta`, of which a vertex samples the light so often through panes, for each time
    /// that it comes here.
    pub(crate) fn by<const N: usize>(
        &self,
        beta: Rgb,
        partial: &Partial<N>,
        through_panes: f32,
    ) -> Contribution<N> {
        let picked = partial.d_vcm * self.pdf_direct + through_panes;
        let others = PerSet::ONE * picked + partial.d_vc * self.pdf_emission;
        Contribution { power_factor: power_factor(picked), others, ..self.alone(beta) }
    }
}

/// Light from infinity that a camera subpath finds where it leaves the scene.
pub(crate) fn from_infinity<const N: usize>(
    task: &Task,
    subpath: &Subpath<N>,
    mut visit: impl FnMut(EmitterHit),
) {
    let scene = task.context.scene;
    let (origin, direction) = (Vec3::from(subpath.walk.ray.origin), Vec3::from(subpath.walk.ray.direction));
    for (index, light) in scene.infinite_lights() {
        let (radiance, pdf) = match subpath.walk.depth {
            0 => (light.le(direction), 0.0),
            _ => light.le_and_pdf(origin, direction),
        };
        if radiance.is_black() || !scene.shows(light, subpath.walk.depth, subpath.walk.specular) {
            continue;
        }
        if subpath.walk.depth == 0 || light.is_backdrop() {
            visit(EmitterHit::only(radiance, Some(index)));
            continue;
        }
        let pdf_emission = task.context.emission.pdf(scene, index, origin, pdf, -direction, 1.0);
        let pdf_direct = pdf * task.context.lights.probability(index, None);
        visit(EmitterHit { radiance, pdf_direct, pdf_emission, light: Some(index) });
    }
}

/// The light that a surface emits towards `wo`; `None` where it emits none. `leaves_medium` says whether the vertex before is in a medium, and
/// `approach` how a ray came to that, if it is a point of fog that is sampled by its angle to lights too.
pub(crate) fn emitted(
    task: &Task,
    surface: &Surface,
    wo: Vec3,
    leaves_medium: bool,
    approach: Option<Approach>,
) -> Option<EmitterHit> {
    let scene = task.context.scene;
    let radiance = scene.emission(surface, wo);
    if radiance.is_black() {
        return None;
    }
    let Some(index) = scene.light_index_of(surface.object) else {
        return Some(EmitterHit::only(radiance, None));
    };
    let light = &scene.lights()[index].light;
    // As the previous vertex would have sampled it.
    let from = surface.p + wo * surface.t;
    let pdf_area = light.pdf_area(from, surface);
    let cos = surface.n_geom.dot(wo).abs();
    let pdf_start = light.pdf_start(pdf_area, surface);
    let pdf_emission = task.context.emission.pdf(scene, index, surface.p, pdf_start, wo, cos);
    let often = approach.map_or(1.0, |approach| 1.0 + approach.ratio(scene, index));
    let pdf_direct =
        pdf_area * task.context.lights.probability(index, (!leaves_medium).then_some(from)) * often;
    Some(EmitterHit { radiance, pdf_direct, pdf_emission, light: Some(index) })
}
