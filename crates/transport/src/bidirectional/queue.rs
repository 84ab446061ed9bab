//! Many samples at a time: the light subpaths of all of them, then the camera subpaths. What happens to one pair of subpaths
//! is told by [`BothEnds`].

use super::camera_queue::CameraQueue;
use super::light_paths::LightPaths;
use super::queued_sample::QueuedSample;
use super::{BatchQueue, BothEnds};
use crate::sampling::task::Context;
use crate::techniques::{Contribution, PixelSum, Step, Tally, Technique};
use bilux_math::{Rgb, Vec2};
use bilux_scene::Tracer;

/// A queue of samples: the memory that it works in.
#[derive(Default)]
pub(crate) struct BothEndsQueue<const N: usize = 1> {
    light_paths: LightPaths<N>,
    camera: CameraQueue<N>,
}

impl<const N: usize> BothEndsQueue<N> {
    /// Takes samples. What each finds goes to the tally with its index, except for splats: these go to `add_splat`, in
    /// the order of the samples.
    pub(crate) fn take<'a, T: Tally<N>>(
        &mut self,
        both_ends: &BothEnds<N>,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        tallies: &mut [T],
        add_splat: impl FnMut(usize, Vec2, Technique, &Contribution<N>),
    ) {
        let techniques = &both_ends.techniques;
        if both_ends.splats || both_ends.connects() {
            let rays = tracer.counters.rays;
            self.light_paths.trace(samples, context, &mut *tracer, both_ends.roulette_depth, techniques);
            // Who counts steps adds up those of all samples.
            tallies[0].spend(Step::Light, (tracer.counters.rays - rays) as usize);
        } else {
            self.light_paths.clear(samples.len());
        }
        if both_ends.splats {
            self.light_paths.connect_to_camera(samples, context, &mut *tracer, techniques, add_splat);
            for (i, tally) in tallies.iter_mut().enumerate() {
                tally.spend(Step::Seen, self.light_paths.connectible(i, techniques).count());
            }
        }
        self.camera.follow(both_ends, samples, &self.light_paths, context, tracer, tallies);
    }
}

/// The samples of `bdpt` and `vcm`.
pub(crate) struct BothEndsSamples<'a> {
    both_ends: BothEnds<'a>,
    queue: BothEndsQueue,
}

impl<'a> BothEndsSamples<'a> {
    pub(crate) fn new(both_ends: BothEnds<'a>) -> BothEndsSamples<'a> {
        BothEndsSamples { both_ends, queue: BothEndsQueue::default() }
    }
}

impl BatchQueue for BothEndsSamples<'_> {
    fn take_batch<'a>(
        &mut self,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        add_splat: &mut dyn FnMut(usize, Vec2, Rgb),
    ) -> Vec<Rgb> {
        let mut sums = vec![PixelSum::default(); samples.len()];
        self.queue.take(&self.both_ends, samples, context, tracer, &mut sums, |i, film, _, found| {
            add_splat(i, film, found.weighted());
        });
        sums.into_iter().map(|PixelSum(light)| light).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::failures::SamplePlace;
    use crate::film::window::Window;
    use crate::photons::{MergeCounts, Photons};
    use crate::sampling::splats::IterationSplats;
    use crate::sampling::task::Task;
    use crate::schedule::settings::RenderSettings;
    use crate::shapes::{ball, built, integrator, mixed, put, still_life};
    use crate::techniques::{PerSet, TechniqueCounts};
    use bilux_math::Vec3;
    use bilux_scene::{SceneBuilder, Spec};

    /// Sets of techniques, as in the pilot of `auto`.
    const N: usize = 3;

    /// All that a sample finds, in order, and the steps that it takes.
    #[derive(Clone, Debug, Default, PartialEq)]
    struct Record {
        samples: Vec<(Technique, Vec<u32>)>,
        splats: Vec<(Technique, Vec<u32>)>,
        steps: [usize; 7],
    }

    fn bits(found: &Contribution<N>, film: Vec2) -> Vec<u32> {
        let Contribution { light, own, others, power_factor, origin } = *found;
        let parts =
            [&light.to_array()[..], &own.0, &others.0, &[power_factor, f32::from(origin), film.x, film.y]];
        parts.concat().into_iter().map(f32::to_bits).collect()
    }

    impl Tally<N> for Record {
        fn spend(&mut self, step: Step, count: usize) {
            self.steps[step as usize] += count;
        }
        fn add_sample(&mut self, technique: Technique, found: &Contribution<N>) {
            self.samples.push((technique, bits(found, Vec2::ZERO)));
        }
        fn add_splat(&mut self, film: Vec2, technique: Technique, found: &Contribution<N>) {
            self.splats.push((technique, bits(found, film)));
        }
    }

    fn techniques(counts: &MergeCounts, direct: bool) -> TechniqueCounts<N> {
        let (splats, connections) = (PerSet([1.0, 0.25, 0.0]), PerSet([1.0, 0.0, 1.0]));
        let per_set = |often: f32| PerSet([often, 0.0, 2.0 * often]);
        let MergeCounts { densest, radius, .. } = *counts;
        let [eta, beams, points] = [counts.eta, counts.beams, counts.points].map(per_set);
        let splats_cones = false;
        TechniqueCounts { splats, connections, eta, beams, densest, points, radius, direct, splats_cones }
    }

    /// Compares all contributions of all samples, and the steps of all together.
    fn assert_same(name: &str, builder: &SceneBuilder, splats: bool) {
        let (scene, vcm) = (built(builder), integrator("vcm"));
        let settings = RenderSettings::new(64, 48, 1);
        let rays = vcm.camera_rays(&scene, &*scene.cameras()[0].1, &settings);
        let (merging, window) = (vcm.merging().unwrap(), Window::whole(64, 48));
        let techniques = |counts: &MergeCounts| techniques(counts, !splats);
        let (photons, _) =
            Photons::trace::<IterationSplats>(&rays, merging, &[window], 0, techniques, None, None);
        let both_ends = BothEnds::merging(&photons, splats, 4);
        let places: Vec<_> = (0..window.pixels()).map(|i| window.position(i)).collect();
        let mut tracer = Tracer::new(&scene, false);
        let mut queued = Vec::new();
        let mut one_by_one = vec![Record::default(); places.len()];
        for (&(x, y), record) in places.iter().zip(&mut one_by_one) {
            let (ray, mut state) = rays.sample(SamplePlace { x, y, sample: 0 });
            queued.push(QueuedSample::new((ray, state.clone()), true));
            let mut task = Task { context: &rays.context, tracer: &mut tracer, sample: &mut state };
            both_ends.sample(&ray, true, &mut task, record);
        }
        let mut together = vec![Record::default(); places.len()];
        let mut found_splats = Vec::new();
        let add_splat = |i: usize, film: Vec2, technique: Technique, found: &Contribution<N>| {
            found_splats.push((i, film, technique, *found));
        };
        BothEndsQueue::default().take(
            &both_ends,
            &mut queued,
            &rays.context,
            &mut tracer,
            &mut together,
            add_splat,
        );
        found_splats
            .iter()
            .for_each(|(i, film, technique, found)| together[*i].add_splat(*film, *technique, found));
        let steps = |records: &[Record]| {
            records.iter().fold([0; 7], |sum: [usize; 7], one| std::array::from_fn(|k| sum[k] + one.steps[k]))
        };
        assert_eq!(steps(&one_by_one), steps(&together), "{name}");
        for (one, other) in one_by_one.iter().zip(&together) {
            assert_eq!((&one.samples, &one.splats), (&other.samples, &other.splats), "{name}");
        }
        let count: usize = one_by_one.iter().map(|one| one.splats.len()).sum();
        assert_eq!(splats, count > 20, "{name}: {count}");
    }

    #[test]
    fn samples_that_are_taken_together_find_the_same_by_the_same_steps() {
        let mut nested = mixed();
        let glass = Spec::new("", "dielectric").with("absorption", 0.4f32);
        let water = glass.clone().with("eta", 1.33f32).with("priority", 1);
        put(&mut nested, "glass", ball(Vec3::new(0.1, 0.7, 1.3), 0.6, 8, true), glass.with("priority", 2));
        put(&mut nested, "water", ball(Vec3::new(0.3, 0.7, 1.3), 0.6, 8, true), water);
        let mut sheet = mixed();
        let one_sided = Spec::new("", "diffuse").with("visible_sides", "front");
        put(&mut sheet, "shell", ball(Vec3::new(0.2, 0.5, 1.2), 0.5, 8, true), one_sided.clone());
        put(&mut sheet, "other", ball(Vec3::new(0.2, 0.5, 1.2), 0.4999, 8, false), one_sided);
        let mut foggy = mixed();
        let fog = Spec::new("", "interface").with("scattering", 0.05f32).with("absorption", 0.01f32);
        put(&mut foggy, "fog", ball(Vec3::new(0.0, 0.7, 0.0), 9.0, 8, true), fog);
        let mut milky = mixed();
        let milk = Spec::new("", "dielectric").with("scattering", 60.0f32).with("absorption", 0.5f32);
        put(&mut milky, "milk", ball(Vec3::new(0.1, 0.7, 1.3), 0.6, 8, true), milk);
        for (name, builder) in [
            ("milky", milky),
            ("mixed", mixed()),
            ("still life", still_life()),
            ("nested", nested),
            ("sheet", sheet),
            ("foggy", foggy),
        ] {
            assert_same(name, &builder, true);
            assert_same(name, &builder, false);
        }
    }
}
