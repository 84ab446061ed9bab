//! All unbiased integrators find the same light, block by block: the short form of the example `agreement`, which runs
//! over every scene that we ship. The comparison also detects integrators that are wrong.

use bilux_math::Rgb;
use bilux_scene::{Ray, SceneBuilder, Spec, Value};
use bilux_transport::{LightSubpaths, PixelIntegrator, Splats, Task, integrators};
use bilux_validation::agreement::{Evidence, Stage, Technique, stages, techniques};
use bilux_validation::effort::effort;
use bilux_validation::statistics::{histogram, uniformity_p};

/// A p-value below this means a bug, not chance.
const UNLIKELY: f64 = 1e-4;

const PICTURES: usize = 16;

fn pictures(stage: &Stage, integrator: &dyn PixelIntegrator, spp: u32, seed: u64) -> Evidence {
    stage.render(integrator, spp, seed, PICTURES).unwrap()
}

fn evidence_of(stage: &Stage, technique: &Technique, seed: u64) -> Evidence {
    let spp = if technique.name == "light" { 64 } else { 16 };
    pictures(stage, &*integrators::build(&technique.spec).unwrap(), spp, seed)
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

#[test]
fn all_unbiased_integrators_agree_block_by_block() {
    let (techniques, mut by_chance, mut decided) = (techniques(), Vec::new(), 0);
    for (name, scene) in &scenes()[..effort(2, 3)] {
        for stage in stages(name, scene, [32, 24]).unwrap() {
            let compared = |technique: &Technique| {
                // Without merging, `vcm` is `bdpt` to the bit, as a test of theirs shows: it is in the long form only.
                if effort(technique.name == "vcm", false) {
                    return false;
                }
                techniques.iter().any(|b| b.name != technique.name && stage.compares(technique, b))
            };
            let found: Vec<Option<Evidence>> = (techniques.iter().enumerate())
                .map(|(i, technique)| {
                    compared(technique).then(|| evidence_of(&stage, technique, 1000 * i as u64))
                })
                .collect();
            for (i, a) in techniques.iter().enumerate() {
                let Some(of_a) = &found[i] else { continue };
                by_chance.extend(stage.against_itself(of_a).green);
                for (b, of_b) in techniques.iter().zip(&found).skip(i + 1) {
                    let Some(of_b) = of_b else { continue };
                    if stage.compares(a, b) {
                        let comparison = stage.compare((a, of_a), (b, of_b));
                        decided += comparison.p_values.len();
                        let p = comparison.least();
                        assert!(p > UNLIKELY, "{}: {} and {}: p = {p:.1e}", stage.name, a.name, b.name);
                    }
                }
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
    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        self.integrator.sample(ray, is_wanted, task, splats) * self.camera_paths
    }
}

#[test]
fn a_biased_integrator_is_detected() {
    let techniques = techniques();
    let cornell = bilux::generate(&Spec::new("", "cornell")).unwrap();
    let stage = &stages("cornell", &cornell, [32, 24]).unwrap()[0];
    let (path, bdpt) = (&techniques[0], &techniques[2]);
    let of_path = evidence_of(stage, path, 0);
    let least = |camera_paths, forgets_splats| {
        let integrator = integrators::build(&bdpt.spec).unwrap();
        let buggy = Buggy { integrator, camera_paths, forgets_splats };
        stage.compare((path, &of_path), (bdpt, &pictures(stage, &buggy, 16, 5000))).least()
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
