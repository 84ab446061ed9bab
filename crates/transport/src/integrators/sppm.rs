//! `sppm`: stochastic progressive photon mapping. Light subpaths store photons; camera subpaths continue through
//! mirrors and glass to the first surface that is not specular, and gather the photons around it. The radius shrinks
//! from iteration to iteration. [Hachisuka 2009; Knaus 2011]

use super::{IntegratorEntry, LightSubpaths, PixelIntegrator, merging};
use crate::bidirectional::{
    BatchQueue, CameraQueue, CameraSubpath, LightPaths, QueuedSample, Subpath, Vertex, crossed, emitted,
    from_infinity, merged,
};
use crate::photons::{Merging, Photons};
use crate::sampling::sample_queue::SampleQueue;
use crate::sampling::splats::Splats;
use crate::sampling::task::{Context, Task};
use crate::techniques::{Contribution, PerSet, PixelSum, Tally, Technique, TechniqueCounts};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2};
use bilux_scene::{Ray, Scene, Tracer};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "sppm",
        summary: "stochastic progressive photon mapping: photons from the lights, gathered around camera vertices",
        source: "Hachisuka 2009",
        parameters: &[super::ROULETTE_DEPTH, merging::radius(1e-6), merging::ALPHA, merging::LIGHT_PATHS],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        let merging = merging::read(reader, TechniqueCounts::CAMERA);
        // Nothing else would find what dense media scatter.
        Ok(Box::new(Sppm { merging: Merging { densest: Some(f32::INFINITY), ..merging } }))
    },
};

struct Sppm {
    merging: Merging,
}

impl Sppm {
    fn gathering<'a>(&self, photons: Option<&'a Photons>) -> PhotonGathering<'a> {
        PhotonGathering { photons, roulette_depth: self.merging.roulette_depth }
    }

    fn gathered(&self, ray: &Ray, photons: Option<&Photons>, task: &mut Task) -> Rgb {
        let mut sum = PixelSum::default();
        self.gathering(photons).follow(ray, &[], task, &mut sum);
        sum.0
    }
}

impl PixelIntegrator for Sppm {
    /// False if media vary: photons lie on surfaces and in media that are the same everywhere, and nothing else would find light
    /// in the others.
    fn follows_media(&self, scene: &Scene) -> bool {
        !scene.has_varying_media()
    }

    fn sees_glow(&self) -> bool {
        false
    }

    /// Light that is seen directly: all other light comes with photons.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.gathered(ray, None, task)
    }

    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }

    fn queue<'a>(
        &self,
        _context: &Context<'a>,
        photons: Option<&'a Photons>,
    ) -> Option<Box<dyn SampleQueue + 'a>> {
        let (queue, light_paths) = (CameraQueue::default(), LightPaths::default());
        Some(Box::new(PhotonGatheringSamples { gathering: self.gathering(photons), queue, light_paths }))
    }
}

impl LightSubpaths for Sppm {
    /// All are photons'.
    fn splats(&self) -> bool {
        false
    }

    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        _splats: &mut Splats,
    ) -> Rgb {
        if is_wanted { self.gathered(ray, photons, task) } else { Rgb::BLACK }
    }

    fn merging(&self) -> Option<&Merging> {
        Some(&self.merging)
    }
}

/// A camera subpath that gathers photons. There is no other technique, so nothing is weighted.
struct PhotonGathering<'a> {
    photons: Option<&'a Photons>,
    roulette_depth: u32,
}

impl CameraSubpath for PhotonGathering<'_> {
    fn techniques(&self) -> &TechniqueCounts {
        self.photons.map_or(&TechniqueCounts::CAMERA, Photons::techniques)
    }

    /// Lights are seen directly, in mirrors too; photons bring the light that they give to other surfaces.
    fn escape(&self, subpath: &mut Subpath, task: &Task, tally: &mut impl Tally<1>) {
        let technique = Technique::Connected { s: 0, t: subpath.count() };
        from_infinity(task, subpath, |hit| {
            tally.add_sample(technique, &hit.alone(subpath.walk.seen(task.sample)));
        });
    }

    fn arrive(
        &self,
        subpath: &mut Subpath,
        z: &mut Vertex,
        task: &mut Task,
        tally: &mut impl Tally<1>,
    ) -> bool {
        if let Some(hit) =
            z.at.surface().and_then(|surface| emitted(task, surface, z.wo, subpath.walk.leaves_medium, None))
        {
            let technique = Technique::Connected { s: 0, t: z.count() };
            tally.add_sample(technique, &hit.alone(subpath.walk.seen(task.sample)));
        }
        task.sample.sampler.enter(u64::from(z.depth) + 1);
        z.events().are_within(task.context.max_depth)
    }

    fn merge(&self, z: &Vertex, task: &Task, tally: &mut impl Tally<1>) {
        if let Some(photons) = self.photons
            && !z.at.is_delta()
        {
            merged(task, photons, z, |technique, found| {
                tally.add_sample(technique, &Contribution { others: PerSet::ZERO, ..*found });
            });
        }
    }

    fn cross(&self, subpath: &Subpath, task: &Task, tally: &mut impl Tally<1>) {
        let Some(photons) = self.photons else { return };
        for beam in &subpath.beams {
            let (ray, techniques) = (&subpath.walk.ray, photons.techniques());
            crossed(task, photons.beams(), beam, ray, techniques, |technique, found| {
                tally.add_sample(technique, &Contribution { others: PerSet::ZERO, ..*found });
            });
        }
    }

    /// Beyond an event that is not a delta event, photons have counted everything.
    fn scatter(&self, subpath: &mut Subpath, z: &Vertex, task: &mut Task) -> bool {
        subpath.scatter(z, self.roulette_depth, task) && subpath.walk.specular
    }
}

/// Samples of photon mapping.
struct PhotonGatheringSamples<'a> {
    gathering: PhotonGathering<'a>,
    queue: CameraQueue,
    /// None.
    light_paths: LightPaths,
}

impl BatchQueue for PhotonGatheringSamples<'_> {
    fn take_batch<'a>(
        &mut self,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        _add_splat: &mut dyn FnMut(usize, Vec2, Rgb),
    ) -> Vec<Rgb> {
        let mut sums = vec![PixelSum::default(); samples.len()];
        self.light_paths.clear(samples.len());
        self.queue.follow(&self.gathering, samples, &self.light_paths, context, tracer, &mut sums);
        sums.into_iter().map(|PixelSum(light)| light).collect()
    }
}
