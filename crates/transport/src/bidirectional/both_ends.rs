//! One sample of the bidirectional integrators: a subpath from the camera and one from a light, every vertex of one
//! connected with every vertex of the other, with the camera and with a light, and merged with photons.
//!
//! Here stands what happens to *one* pair of subpaths. [`super::queue`] follows many pairs at a time, and finds the
//! same light, bit for bit.

use super::connect::{Connection, to_light, to_vertex};
use super::{
    CameraSubpath, Subpath, Vertex, connect_to_camera, crossed, emitted, from_infinity, light_vertices,
    merged,
};
use crate::media::equiangular::EquiangularSample;
use crate::photons::Photons;
use crate::sampling::task::Task;
use crate::techniques::mis::Partial;
use crate::techniques::{Contribution, PerSet, Step, Tally, Technique, TechniqueCounts};
use bilux_math::Rgb;
use bilux_scene::{Ray, TransportMode};

/// One subpath from each end, and all that they find.
pub struct BothEnds<'a, const N: usize = 1> {
    pub(super) techniques: TechniqueCounts<N>,
    photons: Option<&'a Photons<N>>,
    /// Whether the sample's own light subpath is connected with the camera; false where the photons' light subpaths replace it.
    pub(super) splats: bool,
    pub(super) roulette_depth: u32,
}

impl<'a, const N: usize> BothEnds<'a, N> {
    /// Without merging.
    pub(crate) fn new(techniques: TechniqueCounts<N>, roulette_depth: u32) -> BothEnds<'a, N> {
        BothEnds { techniques, photons: None, splats: techniques.splats != PerSet::ZERO, roulette_depth }
    }

    /// With photons that camera subpaths are merged with.
    pub(crate) fn merging(photons: &'a Photons<N>, splats: bool, roulette_depth: u32) -> BothEnds<'a, N> {
        BothEnds { techniques: *photons.techniques(), photons: Some(photons), splats, roulette_depth }
    }

    /// This pair with its own light subpath connected with the camera, if the technique counts at all.
    pub(crate) fn splatting(self) -> BothEnds<'a, N> {
        BothEnds { splats: self.techniques.splats != PerSet::ZERO, ..self }
    }

    /// Whether light subpaths are connected with camera subpaths.
    pub(super) fn connects(&self) -> bool {
        self.techniques.connections != PerSet::ZERO
    }

    /// The weights of the first vertex of a camera subpath, which is on this ray.
    fn see_first(&self, ray: &Ray, z: &mut Vertex<N>, task: &Task) {
        if z.depth == 0 {
            let density =
                task.context.camera.density(ray, z.at.t()) * task.context.exposure.density(ray.time);
            z.partial = Partial::of_camera(density * z.arriving, &self.techniques, z.partial.merged);
        }
    }

    /// Traces both subpaths; the one from the camera only where it `is_wanted`.
    pub(crate) fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, tally: &mut impl Tally<N>) {
        let light_path = if !self.splats && !self.connects() {
            Vec::new()
        } else {
            let rays = task.tracer.counters.rays;
            let scene = task.context.scene;
            let visit = |y: &Vertex<N>| {
                tally.reach_from_light(y.depth, || y.start(scene), || y.at.place(y.wo));
            };
            let vertices = light_vertices(task, ray.time, self.roulette_depth, &self.techniques, visit);
            tally.spend(Step::Light, (task.tracer.counters.rays - rays) as usize);
            vertices
        };
        if self.splats {
            connect_to_camera(task, &light_path, &self.techniques, tally);
        }
        if is_wanted && !ray.is_nowhere() {
            self.follow(ray, &light_path, task, tally);
        }
    }
}

impl<const N: usize> CameraSubpath<N> for BothEnds<'_, N> {
    fn techniques(&self) -> &TechniqueCounts<N> {
        &self.techniques
    }

    fn escape(&self, subpath: &mut Subpath<N>, task: &Task, tally: &mut impl Tally<N>) {
        let technique = Technique::Connected { s: 0, t: subpath.count() };
        if let Some(glow) = subpath.take_glow(task.sample) {
            tally.add_sample(technique, &Contribution::only(glow));
        }
        from_infinity(task, subpath, |hit| {
            let through_panes = subpath.sampled_through_panes(task.context, hit.light, None);
            let seen = subpath.walk.seen(task.sample);
            tally.add_sample(technique, &hit.by(seen, &subpath.partial, through_panes));
        });
    }

    /// The emitter is found by chance (s = 0).
    fn arrive(
        &self,
        subpath: &mut Subpath<N>,
        z: &mut Vertex<N>,
        task: &mut Task,
        tally: &mut impl Tally<N>,
    ) -> bool {
        self.see_first(&subpath.walk.ray, z, task);
        if z.depth == 0 {
            subpath.partial = z.partial;
        }
        if let Some(glow) = subpath.take_glow(task.sample) {
            tally.add_sample(Technique::Connected { s: 0, t: z.count() }, &Contribution::only(glow));
        }
        if let Some(hit) = z
            .at
            .surface()
            .and_then(|surface| emitted(task, surface, z.wo, subpath.walk.leaves_medium, subpath.approach()))
        {
            let (seen, technique) =
                (subpath.walk.seen(task.sample), Technique::Connected { s: 0, t: z.count() });
            let through_panes = subpath.sampled_through_panes(task.context, hit.light, z.at.surface());
            let found = if z.depth == 0 { hit.alone(seen) } else { hit.by(seen, &z.partial, through_panes) };
            tally.add_sample(technique, &found);
        }
        if !z.events().are_within(task.context.max_depth) {
            return false;
        }
        task.sample.sampler.enter(u64::from(z.depth) + 1);
        true
    }

    /// Connects a vertex with points on lights (s = 1), then with the vertices of the light subpath (s, t > 1).
    #[inline]
    fn connect<'v>(
        &self,
        z: &Vertex<N>,
        light_path: impl Iterator<Item = &'v Vertex<N>>,
        task: &mut Task,
        mut visit: impl FnMut(&mut Task, Step, Option<Connection<N>>),
    ) {
        let is_open = z.is_open();
        let is_lit = is_open && !z.media.hide_lights(task.context.scene, &z.at);
        let lights = &task.context.lights;
        let u = task.sample.sampler.next_1d();
        for light in lights.sample(u, z.at.lit_at()) {
            let u = task.sample.sampler.next_2d();
            if is_lit {
                let connection = to_light(task, z, light, u, &self.techniques);
                visit(task, Step::Picked, connection);
            }
        }
        if !is_open || !self.connects() {
            return;
        }
        let max_depth = task.context.max_depth;
        let is_short = |y: &&Vertex<N>| z.events().joined(y.events()).are_within(max_depth);
        for y in light_path.filter(is_short) {
            let connection = to_vertex(task, z, y, &self.techniques);
            visit(task, Step::Connected, connection);
        }
    }

    #[inline]
    fn merge(&self, z: &Vertex<N>, task: &Task, tally: &mut impl Tally<N>) {
        if let Some(photons) = self.photons
            && !z.at.is_delta()
        {
            let has_looked = merged(task, photons, z, |technique, found| tally.add_sample(technique, found));
            tally.spend(Step::Lookup, usize::from(has_looked));
        }
    }

    #[inline]
    fn cross(&self, subpath: &Subpath<N>, task: &Task, tally: &mut impl Tally<N>) {
        let Some(photons) = self.photons else { return };
        for beam in &subpath.beams {
            tally.spend(Step::Across, 1);
            let ray = &subpath.walk.ray;
            crossed(task, photons.beams(), beam, ray, &self.techniques, |technique, found| {
                tally.add_sample(technique, found);
            });
        }
    }

    fn equiangular(&self, subpath: &Subpath<N>, task: &mut Task, tally: &mut impl Tally<N>) {
        let Some(walk) = subpath.equiangular_walk() else { return };
        walk.each_equiangular(
            task,
            |task, EquiangularSample { light, probability, points, distance, u_light }| {
                let Some(mut z) = subpath.equiangular_vertex(distance, task) else { return };
                self.see_first(&walk.ray, &mut z, task);
                tally.spend(Step::Picked, 1);
                let connection = to_light(task, &z, (light, probability), u_light, &self.techniques);
                let Some(Connection { join, segment }) = connection else { return };
                if let Some(passage) = segment.passage(task.tracer) {
                    let join = join.equiangular(points.density(distance) / z.arriving);
                    tally.join(z.at.p(), segment.ray.direction.into(), segment.through.distance);
                    let (technique, found) = join.along(&passage);
                    tally.add_sample(technique, &found);
                }
            },
        );
    }

    fn leave_camera(&self, ray: &Ray) -> Subpath<'_, N> {
        let subpath =
            Subpath::new(TransportMode::Radiance, *ray, Rgb::WHITE, Partial::START, false, &self.techniques);
        subpath.with_equiangular_points()
    }

    #[inline]
    fn scatter(&self, subpath: &mut Subpath<N>, z: &Vertex<N>, task: &mut Task) -> bool {
        subpath.scatter(z, self.roulette_depth, task)
    }
}
