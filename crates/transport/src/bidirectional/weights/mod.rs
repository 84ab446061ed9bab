//! Tests of the recursive MIS weights against their definition: the density of every technique, multiplied out from the
//! densities of lights, camera and BSDFs over area, in double precision. [Veach 1997, eq. 10.3 to 10.9]
//!
//! A delta event counts 1 over solid angle in both directions. Its true density has the same infinite factor in all
//! techniques that can find the path and, where it refracts, a ratio of cosines and squared indices; the weights leave
//! these factors out on both sides alike.
//!
//! If the weight of every technique is its share of the sum over all techniques, wherever it finds a path, then the
//! weights of one path add up to 1.

mod banks;
mod fog;
mod panes;
mod path;
mod samples;

use self::fog::Fog;
use self::path::{Flaw, Path};
use crate::film::failures::SamplePlace;
use crate::integrators;
use crate::sampling::task::Task;
use crate::schedule::settings::RenderSettings;
use crate::shapes;
use crate::techniques::{Contribution, PerSet, TechniqueCounts};
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Scene, SceneBuilder, Spec, Texture, Tracer, Value};
use std::f32::consts::FRAC_PI_4;
use std::sync::Arc;

/// The area of the panel light in these tests.
const PANEL_AREA: f32 = 1.5;

const PANEL_NORMAL: Vec3 = Vec3::Y;

/// Compares weights, and counts the results.
struct Verdict {
    techniques: TechniqueCounts,
    flaw: Flaw,
    fog: Option<Rgb>,
    /// Regions of the fog; none if it fills the scene.
    parts: &'static [Aabb],
    compared: usize,
    wrong: usize,
    worst: f64,
    /// Number of weights that were neither almost 0 nor almost 1, by kind: emitter hit, light sample, splat, connection,
    /// merge, crossed beams, equiangular point, light sample through panes.
    telling: [usize; 8],
}

impl Verdict {
    /// The fog in the channel of a sample.
    fn fog_of(&self, task: &Task) -> Option<Fog> {
        self.fog.map(|fog| Fog { extinction: fog[usize::from(task.sample.channel)], parts: self.parts })
    }

    fn look(&mut self, task: &Task, found: &Contribution, key: (bool, usize), path: &Path) {
        let all = path.densities(task, &self.techniques, self.flaw);
        let sum: f64 = all.iter().map(|(_, density)| density).sum();
        if sum == 0.0 && found.own == PerSet::ZERO {
            // No technique that takes samples finds it.
            return;
        }
        let own = all.iter().find(|(k, _)| *k == key).map_or(0.0, |(_, density)| *density);
        let wanted = own / sum;
        let weight = f64::from(found.own.0[0]) / (f64::from(found.own.0[0]) + f64::from(found.others.0[0]));
        let error = (weight - wanted).abs();
        self.compared += 1;
        // NaN counts as wrong.
        self.wrong += usize::from(error.is_nan() || error > path.tolerance());
        self.worst = if error.is_nan() { f64::INFINITY } else { self.worst.max(error) };
        let kind = match key {
            (true, 1) => 6,
            (true, i) => 4 + usize::from(path.nodes[i - 2].at.is_in_medium()),
            (_, s) if s < 2 => s,
            (_, s) if path.nodes[s - 2].is_delta => 7,
            (_, s) if s == path.nodes.len() + 1 => 2,
            _ => 3,
        };
        self.telling[kind] += usize::from((0.01..0.99).contains(&wanted));
    }
}

/// Samples per pixel.
const SAMPLES: u32 = 16;

/// Checks every path of some samples, by every technique.
fn verdict(scene: &Scene, techniques: &TechniqueCounts, flaw: Flaw, fog: Option<Rgb>) -> Verdict {
    verdict_in(scene, techniques, flaw, fog, &[])
}

/// Checks every path of some samples where fog is in these parts of the scene alone.
fn verdict_in(
    scene: &Scene,
    techniques: &TechniqueCounts,
    flaw: Flaw,
    fog: Option<Rgb>,
    parts: &'static [Aabb],
) -> Verdict {
    let integrator = integrators::build(&Spec::new("", "bdpt")).unwrap();
    let settings = RenderSettings::new(24, 24, SAMPLES);
    let eye = integrator.camera_rays(scene, &*scene.cameras()[0].1, &settings);
    let mut tracer = Tracer::new(scene, false);
    let mut verdict = Verdict {
        techniques: *techniques,
        flaw,
        fog,
        parts,
        compared: 0,
        wrong: 0,
        worst: 0.0,
        telling: [0; 8],
    };
    for i in 0..24 * 24 * SAMPLES {
        let (ray, mut state) = eye.sample(SamplePlace { x: i % 24, y: i / 24 % 24, sample: i / 576 });
        let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
        samples::one_sample(&ray, &mut task, &mut verdict);
    }
    verdict
}

/// Diffuse, rough, polished and transparent bodies, with normals from a normal map or interpolated, under a light of
/// each kind that `lights` names.
fn scene(lights: &[&str], camera: Spec) -> Scene {
    let glass = Spec::new("", "dielectric");
    shapes::built(&filled(lights, camera, &glass))
}

/// Absorption and scattering of the fog in each channel, per metre.
const FOG: [Rgb; 2] = [Rgb::new(0.02, 0.05, 0.01), Rgb::new(0.25, 0.15, 0.1)];

/// Absorption and scattering of fog without colour, per metre.
const GREY_FOG: [Rgb; 2] = [Rgb::grey(0.02), Rgb::grey(0.2)];

/// The bodies of [`scene`] inside a ball of what scatters, with mirrors in place of glass, so that fog fills every edge.
fn foggy(lights: &[&str], camera: &Spec, fog: Spec, coefficients: [Rgb; 2]) -> Scene {
    shapes::built(&foggy_of(filled(lights, camera.clone(), &Spec::new("", "mirror")), fog, coefficients))
}

/// Any bodies inside such a ball.
fn foggy_of(mut builder: SceneBuilder, fog: Spec, [absorption, scattering]: [Rgb; 2]) -> SceneBuilder {
    let fog = fog.with("absorption", absorption).with("scattering", scattering);
    let fog = fog.with("scattering_anisotropy", 0.4f32);
    shapes::put(&mut builder, "fog", shapes::ball(Vec3::ZERO, 9.0, 8, false), fog);
    builder
}

fn filled(lights: &[&str], camera: Spec, glass: &Spec) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let waves = (0..64).map(|i| {
        let lean = |k: i32| 0.5 + 0.3 * bilux_math::transcendental::sin_cos(k as f32 * FRAC_PI_4).0;
        Rgb::new(lean(i % 8), lean(i / 8), 0.75)
    });
    let waves = Texture::new("", 8, 8, waves.collect(), true);
    builder.textures.push(Arc::new(waves));
    let bent = shapes::diffuse(0.7f32).with("normal", Value::Texture(0));
    shapes::put(&mut builder, "floor", shapes::floor(0.0, 2.5), bent);
    let wall = shapes::quad(Vec3::new(-2.5, 0.0, -2.0), Vec3::X * 5.0, Vec3::Y * 3.0);
    shapes::put(&mut builder, "wall", wall, shapes::diffuse(0.6f32));
    let silver = Spec::new("", "conductor").with("metal", "silver");
    let frosted = match &*glass.kind {
        "dielectric" => glass.clone().with("roughness", 0.6f32),
        _ => glass.clone(),
    };
    let balls = [
        (-1.4, silver.clone().with("roughness", 0.5f32)),
        (-0.5, glass.clone()),
        (0.5, silver),
        (1.4, frosted),
    ];
    for (x, material) in balls {
        let ball = shapes::ball(Vec3::new(x, 0.45, 0.1 * x), 0.4, 12, true);
        shapes::put(&mut builder, "ball", ball, material);
    }
    for (i, kind) in lights.iter().enumerate() {
        let light = Spec::new("", kind);
        // Several panels lie one above the other, each brighter than the one before.
        let panels = lights[..i].iter().filter(|before| **before == "rect").count() as f32;
        builder.lights.push(match *kind {
            "rect" => {
                let place = Vec3::new(-0.7, 2.6 - 0.3 * panels, -0.4 + 0.7 * panels);
                let panel = light.with("position", place).with("intensity", 8.0 * (1.0 + panels));
                panel.with("edge_u", Vec3::X * 1.5).with("edge_v", Vec3::Z)
            }
            "point" => light.with("position", Vec3::new(0.3, 2.0, 1.5)).with("intensity", 3.0f32),
            "directional" => light.with("direction", Vec3::new(0.3, -1.0, -0.4)),
            _ => light.with("radiance", 0.5f32),
        });
    }
    let camera = camera.with("position", Vec3::new(0.0, 1.6, 4.0)).with("look_at", Vec3::new(0.0, 0.6, 0.0));
    builder.cameras = vec![CameraSpec { spec: camera, keyframes: Vec::new() }];
    builder
}

fn cameras() -> [Spec; 3] {
    let pinhole = Spec::new("", "perspective").with("fov", 45.0f32);
    let lens = pinhole.clone().with("aperture", 0.2f32).with("focus", 4.0f32);
    [pinhole, lens, Spec::new("", "orthographic").with("height", 3.0f32)]
}

/// Without merging, with it, and with it but without connections or without splats.
fn sets() -> [TechniqueCounts; 4] {
    let merging = |others: TechniqueCounts| TechniqueCounts {
        eta: PerSet([300.0]),
        beams: PerSet([4.0]),
        densest: 1.0,
        ..others
    };
    [
        TechniqueCounts::BOTH_ENDS,
        merging(TechniqueCounts::BOTH_ENDS),
        merging(TechniqueCounts::with_splats_and_connections(true, false)),
        merging(TechniqueCounts::with_splats_and_connections(false, true)),
    ]
}

#[test]
fn every_mis_weight_matches_its_definition() {
    for (i, lights) in
        [&["rect"][..], &["point", "rect"], &["environment", "rect"], &["directional", "point"]]
            .into_iter()
            .enumerate()
    {
        for (k, camera) in cameras().into_iter().enumerate() {
            let scene = scene(lights, camera);
            for direct in [true, false] {
                let techniques = TechniqueCounts { direct, ..sets()[(i + k) % 4] };
                let verdict = verdict(&scene, &techniques, Flaw::None, None);
                let Verdict { compared, wrong, worst, telling, .. } = verdict;
                assert!(
                    wrong == 0,
                    "{lights:?}, camera {k}: {wrong} of {compared} weights are wrong, by up to {worst}"
                );
                assert!(compared > 3000 && telling.iter().sum::<usize>() > 500, "{telling:?}");
            }
        }
    }
}

/// More lights than are all sampled, so that each is chosen now and then.
const MANY: [&[&str]; 2] = [
    &["rect", "rect", "rect", "rect", "rect"],
    &["point", "rect", "environment", "rect", "directional", "rect"],
];

#[test]
fn every_mis_weight_matches_its_definition_among_many_lights() {
    for (i, lights) in MANY.into_iter().enumerate() {
        let scene = scene(lights, cameras()[i].clone());
        assert!(!crate::LightChoice::new(&scene).takes_all());
        for techniques in [sets()[0], TechniqueCounts { direct: false, ..sets()[1] }] {
            let Verdict { compared, wrong, worst, telling, .. } =
                verdict(&scene, &techniques, Flaw::None, None);
            assert!(wrong == 0, "{lights:?}: {wrong} of {compared} weights are wrong, by up to {worst}");
            assert!(telling[..2].iter().all(|&n| n > 500), "{telling:?}");
        }
        for flaw in [Flaw::Choice, Flaw::ChoiceElsewhere] {
            let Verdict { compared, wrong, .. } = verdict(&scene, &sets()[0], flaw, None);
            assert!(
                wrong > compared / 20,
                "{flaw:?}: only {wrong} of {compared} weights know how often a light is chosen"
            );
        }
    }
}

#[test]
fn densities_with_a_factor_left_out_give_other_weights() {
    let scene = scene(&["rect", "environment"], cameras()[1].clone());
    let flaws = [
        Flaw::Cosine,
        Flaw::Distance,
        Flaw::LightChoice,
        Flaw::PickedTwice,
        Flaw::MergedTwice,
        Flaw::Direct,
        Flaw::Reverse,
    ];
    for flaw in flaws {
        let techniques = TechniqueCounts { direct: flaw != Flaw::Direct, ..sets()[1] };
        let verdict = verdict(&scene, &techniques, flaw, None);
        let Verdict { compared, wrong, .. } = verdict;
        assert!(wrong > compared / 20, "{flaw:?}: only {wrong} of {compared} weights differ");
    }
}

/// Fog behind a surface, so that rows of events have a limit.
fn inside(lights: &[&str]) -> Scene {
    foggy(lights, &cameras()[0], clear_surface(), FOG)
}

fn clear_surface() -> Spec {
    Spec::new("", "dielectric").with("eta", 1.0f32)
}

#[test]
fn every_mis_weight_matches_its_definition_in_fog() {
    let extinction = Some(FOG[0] + FOG[1]);
    for (i, lights) in [&["rect"][..], &["point", "rect"]].into_iter().enumerate() {
        let scene = inside(lights);
        let without_direct = |set: TechniqueCounts| TechniqueCounts { direct: false, ..set };
        for techniques in [sets()[i], without_direct(sets()[2 + i])] {
            let Verdict { compared, wrong, worst, telling, .. } =
                verdict(&scene, &techniques, Flaw::None, extinction);
            assert!(wrong == 0, "{lights:?}: {wrong} of {compared} weights are wrong, by up to {worst}");
            assert!(compared > 3000 && telling.iter().sum::<usize>() > 500, "{telling:?}");
            assert!(techniques.beams == PerSet::ZERO || telling[5] > 500, "{telling:?}");
        }
    }
}

#[test]
fn every_mis_weight_matches_its_definition_in_fog_among_many_lights() {
    let scene = inside(MANY[0]);
    let Verdict { compared, wrong, worst, telling, .. } =
        verdict(&scene, &sets()[1], Flaw::None, Some(FOG[0] + FOG[1]));
    assert!(wrong == 0, "{wrong} of {compared} weights are wrong, by up to {worst}");
    assert!(telling[..2].iter().all(|&n| n > 500), "{telling:?}");
}

/// This set where fog is dense: its points are merged in balls.
fn with_points(set: TechniqueCounts) -> TechniqueCounts {
    TechniqueCounts { densest: 0.1, points: PerSet([2000.0]), radius: 0.5, ..set }
}

fn is_dense(scene: &Scene) -> bool {
    (0..scene.geometry().objects().len() as u32).any(|object| scene.is_dense(object))
}

#[test]
fn every_mis_weight_matches_its_definition_in_dense_fog() {
    let thick = FOG.map(|coefficient| coefficient * 3.0);
    let boundaries = [(clear_surface(), FOG), (Spec::new("", "interface"), FOG), (clear_surface(), thick)];
    for (i, (boundary, fog)) in boundaries.into_iter().enumerate() {
        let scene = foggy([&["rect"][..], &["point", "rect"]][i % 2], &cameras()[0], boundary, fog);
        // How far its points are from surfaces is known where it is thick.
        assert_eq!(is_dense(&scene), i == 2);
        let techniques = TechniqueCounts { direct: i % 2 == 0, ..with_points(sets()[1 + i % 2]) };
        let Verdict { compared, wrong, worst, telling, .. } =
            verdict(&scene, &techniques, Flaw::None, Some(fog[0] + fog[1]));
        assert!(wrong == 0, "scene {i}: {wrong} of {compared} weights are wrong, by up to {worst}");
        assert!(compared > 3000 && telling[5] > 500, "{telling:?}");
    }
    let scene = inside(&["rect"]);
    for (flaw, part) in [(Flaw::Ball, 20), (Flaw::Survival, 20), (Flaw::Row, 1000)] {
        let Verdict { compared, wrong, .. } =
            verdict(&scene, &with_points(sets()[1]), flaw, Some(FOG[0] + FOG[1]));
        assert!(wrong > compared / part, "{flaw:?}: only {wrong} of {compared} weights differ");
    }
}

#[test]
fn densities_in_fog_with_a_factor_left_out_give_other_weights() {
    let scene = inside(&["rect"]);
    // The density of events per metre is the same factor at each point of fog, whichever technique finds it.
    for flaw in [Flaw::Survival, Flaw::Cosine, Flaw::Distance, Flaw::Sine, Flaw::Extinction] {
        let Verdict { compared, wrong, .. } = verdict(&scene, &sets()[1], flaw, Some(FOG[0] + FOG[1]));
        assert!(wrong > compared / 20, "{flaw:?}: only {wrong} of {compared} weights differ");
    }
    // Few paths have so many points in a row.
    let Verdict { compared, wrong, .. } = verdict(&scene, &sets()[1], Flaw::Row, Some(FOG[0] + FOG[1]));
    assert!(wrong > 20, "only {wrong} of {compared} weights know that rows are long");
}

/// All techniques, but for merging light that comes straight from a light.
fn splatting_cones() -> TechniqueCounts {
    TechniqueCounts { direct: false, splats_cones: true, ..sets()[1] }
}

/// In fog without colour, rays have equiangular points too.
#[test]
fn every_mis_weight_matches_its_definition_with_equiangular_points() {
    let extinction = Some(GREY_FOG[0] + GREY_FOG[1]);
    for (i, lights) in [&["rect"][..], &["point", "rect"]].into_iter().enumerate() {
        // The definition knows no lens.
        for camera in [0, 2].map(|camera| cameras()[camera].clone()) {
            let scene = foggy(lights, &camera, Spec::new("", "interface"), GREY_FOG);
            let without_direct = |set: TechniqueCounts| TechniqueCounts { direct: false, ..set };
            for techniques in [sets()[1], without_direct(sets()[2 + i]), splatting_cones()] {
                let Verdict { compared, wrong, worst, telling, .. } =
                    verdict(&scene, &techniques, Flaw::None, extinction);
                assert!(wrong == 0, "{lights:?}: {wrong} of {compared} weights are wrong, by up to {worst}");
                assert!(compared > 3000 && telling[6] > 500, "{telling:?}");
            }
        }
    }
    let scene = foggy(&["rect"], &cameras()[0], Spec::new("", "interface"), GREY_FOG);
    let flaws = [
        (Flaw::Points, sets()[1]),
        (Flaw::WalkedPoints, sets()[1]),
        (Flaw::UnseenCones, splatting_cones()),
        (Flaw::Direct, splatting_cones()),
    ];
    for (flaw, techniques) in flaws {
        let Verdict { compared, wrong, .. } = verdict(&scene, &techniques, flaw, extinction);
        assert!(wrong > compared / 20, "{flaw:?}: only {wrong} of {compared} weights differ");
    }
}
