//! All unbiased integrators find the same light, block by block: the short form of the example `agreement`, which runs
//! over every scene that we ship. The comparison also detects integrators that are wrong.

use bilux_math::Rgb;
use bilux_scene::{Ray, SceneBuilder, Spec, Value};
use bilux_testing::effort;
use bilux_testing::verdicts::{Bits, Hash};
use bilux_transport::{LightSubpaths, Photons, PixelIntegrator, Splats, Task, integrators};
use bilux_validation::SUITE;
use bilux_validation::agreement::{Evidence, Stage, Technique, stages, techniques};
use bilux_validation::statistics::{histogram, uniformity_p};

/// A p-value below this means a bug, not chance.
const UNLIKELY: f64 = 1e-4;

const PICTURES: usize = 16;

fn pictures(stage: &Stage, integrator: &dyn PixelIntegrator, spp: u32, seed: u64, count: usize) -> Evidence {
    stage.render(integrator, spp, seed, count).unwrap()
}

fn evidence_of(stage: &Stage, technique: &Technique, seed: u64, count: usize) -> Evidence {
    let spp = if technique.name == "light" { 64 } else { 16 };
    pictures(stage, &*integrators::build(&technique.spec).unwrap(), spp, seed, count)
}

/// Scenes whose light is found quickly: diffuse surfaces, mirrors and glass, lights, a sun and a sky.
fn scenes() -> Vec<(&'static str, SceneBuilder)> {
    let spheres = Spec::new("", "cornell-spheres").with("level", Value::Integer(2));
    let teapot = bilux::generate(&Spec::new("", "teapot")).unwrap();
    vec![
        ("cornell", bilux::generate(&Spec::new("", "cornell")).unwrap()),
        ("spheres", bilux::generate(&spheres).unwrap()),
        ("teapot", teapot),
    ]
}

/// Evidence of each technique in a stage, if there is another to compare it with.
struct Found(Vec<Option<Evidence>>);

impl Bits for Found {
    fn add_to(&self, hash: &mut Hash) {
        self.0.iter().flatten().for_each(|evidence| evidence.cells.add_to(hash));
    }
}

/// The pairs of techniques that are compared in a stage.
fn pairs(stage: &Stage, techniques: &[Technique]) -> Vec<[usize; 2]> {
    // Without merging, `vcm` is `bdpt` to the bit, as a test of theirs shows: it is in the long form only.
    let taken = |i: usize| effort(techniques[i].name != "vcm", true);
    let all = (0..techniques.len()).flat_map(|a| (a + 1..techniques.len()).map(move |b| [a, b]));
    let compared = |[a, b]: &[usize; 2]| stage.compares(&techniques[*a], &techniques[*b]);
    all.filter(|pair| pair.iter().all(|i| taken(*i)) && compared(pair)).collect()
}

fn found(stage: &Stage, techniques: &[Technique], count: usize) -> Found {
    let pairs = pairs(stage, techniques);
    let of = |(i, technique): (usize, &Technique)| {
        let is_compared = pairs.iter().flatten().any(|one| *one == i);
        is_compared.then(|| evidence_of(stage, technique, 1000 * i as u64, count))
    };
    Found(techniques.iter().enumerate().map(of).collect())
}

/// The verdicts on a stage: of each pair the number of decided cells and the least p-value, and after these the p-values of what
/// differs by its seeds alone.
fn verdicts(stage: &Stage, techniques: &[Technique], found: &Found) -> Vec<f64> {
    let of = |[a, b]: [usize; 2]| {
        let side = |i: usize| Some((&techniques[i], found.0[i].as_ref()?));
        let comparison = side(a).zip(side(b)).map(|(a, b)| stage.compare(a, b)).unwrap_or_default();
        [comparison.p_values.len() as f64, comparison.least()]
    };
    let verdicts = pairs(stage, techniques).into_iter().flat_map(of);
    let by_chance = found.0.iter().flatten().flat_map(|evidence| stage.against_itself(evidence).green);
    verdicts.chain(by_chance).collect()
}

#[test]
fn all_unbiased_integrators_agree_block_by_block() {
    let (techniques, mut by_chance, mut decided) = (techniques(), Vec::new(), 0);
    for (name, scene) in &scenes()[..effort(2, 3)] {
        for stage in stages(name, scene, [32, 24]).unwrap() {
            let numbers = SUITE.numbers(
                &stage.name,
                "least p of each pair, and of each half against the other, by pictures",
                PICTURES as u32,
                |count| found(&stage, &techniques, count as usize),
                |found| verdicts(&stage, &techniques, found),
            );
            let pairs = pairs(&stage, &techniques);
            by_chance.extend(&numbers[2 * pairs.len()..]);
            for ([a, b], verdict) in pairs.into_iter().zip(numbers.chunks(2)) {
                let (p, [a, b]) = (verdict[1], [a, b].map(|i| techniques[i].name));
                decided += verdict[0] as usize;
                assert!(p > UNLIKELY, "{}: {a} and {b}: p = {p:.1e}", stage.name);
            }
        }
    }
    assert!(decided > effort(150, 300), "only {decided} cells are decided");
    // The test itself: where nothing differs but the seeds, p-values are uniform.
    let even = uniformity_p(&by_chance);
    assert!(even > 1e-3, "{:?}", histogram(&by_chance));
}

/// An integrator with a bug.
struct Buggy {
    integrator: Box<dyn PixelIntegrator>,
    camera_paths: f32,
    forgets_splats: bool,
}

impl PixelIntegrator for Buggy {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.integrator.radiance(ray, task) * self.camera_paths
    }
    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }
}

impl LightSubpaths for Buggy {
    fn splats(&self) -> bool {
        !self.forgets_splats && self.integrator.splats()
    }
    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        self.integrator.sample(ray, is_wanted, photons, task, splats) * self.camera_paths
    }
}

#[test]
fn a_biased_integrator_is_detected() {
    let techniques = techniques();
    let cornell = bilux::generate(&Spec::new("", "cornell")).unwrap();
    let stage = &stages("cornell", &cornell, [32, 24]).unwrap()[0];
    let (path, bdpt) = (&techniques[0], &techniques[2]);
    let of_path = evidence_of(stage, path, 0, PICTURES);
    let least = |camera_paths, forgets_splats| {
        let integrator = integrators::build(&bdpt.spec).unwrap();
        let buggy = Buggy { integrator, camera_paths, forgets_splats };
        stage.compare((path, &of_path), (bdpt, &pictures(stage, &buggy, 16, 5000, PICTURES))).least()
    };
    let p = least(1.0, false);
    assert!(p > UNLIKELY, "p = {p:.1e}");
    for (what, camera_paths, forgets_splats) in
        [("3% too bright", 1.03, false), ("the light image is forgotten", 1.0, true)]
    {
        let p = least(camera_paths, forgets_splats);
        assert!(p < UNLIKELY, "{what}: passes with p = {p:.1e}");
    }
}
