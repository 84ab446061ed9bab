//! Dispersion: light that glass splits by wavelength goes where theory says, and both ends of a path agree on it.

use crate::common::statistics::{UNLIKELY, agreement, blocks, difference, estimate, recorded};
use crate::common::{ball, built, diffuse, effort, integrator, look, put, quad, shoot, sky, still_life};
use bilux_math::transcendental::{asin_f64, sin_cos_f64, sin_f64, tan_f64};
use bilux_math::{Aabb, DVec3, Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::mesh::shapes;
use bilux_scene::{Ray, Scene, SceneBuilder, Spec, Wavelength};
use bilux_transport::{
    LightSubpaths, Merging, Photons, PixelIntegrator, RenderSettings, Splats, Task, Window, integrators,
};
use std::sync::Arc;

/// Dense flint.
const ETA: f64 = 1.728;
const ABBE: f64 = 28.4;

/// The prism's apex angle.
const ANGLE: f64 = std::f64::consts::FRAC_PI_3;

/// Cauchy's formula by its two constants.
fn index(nm: f64) -> f64 {
    let (d, f, c) = (587.5618f64, 486.1327f64, 656.2725f64);
    let b = (ETA - 1.0) / (ABBE * (1.0 / (f * f) - 1.0 / (c * c)));
    ETA + b / (nm * nm) - b / (d * d)
}

/// The fraction of light that is transmitted at this angle of incidence, and the angle of refraction.
fn refracted(angle: f64, index: f64) -> (f64, f64) {
    let inner = asin_f64(sin_f64(angle) / index);
    let (s, p) = (angle - inner, angle + inner);
    let (across, along) = (sin_f64(s) / sin_f64(p), tan_f64(s) / tan_f64(p));
    (1.0 - 0.5 * (across * across + along * along), inner)
}

/// The deviation of light of a wavelength that falls on the prism at this angle, and the fraction that is transmitted.
fn turned(angle: f64, nm: f64) -> (f64, f64) {
    let (entered, first) = refracted(angle, index(nm));
    let second = ANGLE - first;
    let (left, out) = refracted(second, 1.0 / index(nm));
    (angle + out - ANGLE, entered * left)
}

/// A beam on a prism, at the angle of minimum deviation for a wavelength; and a wall far behind it that glows where
/// light of greater deviation goes.
fn spectrum(nm: f64, dispersion: f64) -> Scene {
    let half = ANGLE * 0.5;
    let incidence = asin_f64(index(nm) * sin_f64(half));
    let least = 2.0 * incidence - ANGLE;
    // All in the plane of x and z, whose normal is the prism's axis. The prism's first edge is at x = 1; the beam falls
    // on the side that faces -z there, and is deviated towards -x.
    let along = |angle: f64| {
        let (sin, cos) = sin_cos_f64(angle);
        DVec3::new(-sin, 0.0, cos)
    };
    let mut builder = SceneBuilder::default();
    let glass = Spec::new("", "dielectric").with("eta", ETA as f32).with("dispersion", dispersion as f32);
    put(&mut builder, "prism", Arc::new(shapes::prism(Vec3::ZERO, 1.0, 4.0, 3)), glass);
    // Inside, light of that wavelength travels along x = const: it has half of its deviation behind it.
    let beam = along(-0.5 * least);
    let middle = DVec3::new(0.25, 0.0, 0.0);
    let (forth, across) = (along(0.5 * least), along(0.5 * least + std::f64::consts::FRAC_PI_2));
    let far = 2e3;
    // The wall's edge lies on the ray of minimum deviation, from where that leaves the prism.
    let leaves = DVec3::new(0.25, 0.0, 0.75 * tan_f64(half));
    let corner = leaves + forth * far - DVec3::Y * far;
    let wall = quad(corner.as_vec3(), (across * far).as_vec3(), (DVec3::Y * 2.0 * far).as_vec3());
    put(&mut builder, "wall", wall, diffuse(0.0f32).with("emission", 1.0f32));
    let enters = DVec3::new(middle.x, 0.0, -leaves.z);
    let spec = Spec::new("eye", "orthographic").with("position", (enters - beam * 5.0).as_vec3());
    let spec = spec.with("look_at", enters.as_vec3()).with("height", 1e-3f32);
    builder.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    built(&builder)
}

fn settings() -> RenderSettings {
    RenderSettings { max_depth: 2, ..RenderSettings::new(8, 8, 4096) }
}

/// The mean light of a film, by channel.
fn means(pixels: &[Rgb]) -> Vec<f64> {
    (0..3).map(|c| pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / 64.0).collect()
}

/// The light that theory predicts there.
fn wanted(nm: f64) -> [f64; 3] {
    let incidence = asin_f64(index(nm) * sin_f64(ANGLE * 0.5));
    let least = 2.0 * incidence - ANGLE;
    const N: u32 = 1 << 16;
    let mut sums = [0.0; 3];
    for i in 0..N {
        let one = Wavelength::sample((i as f32 + 0.5) / N as f32);
        let (angle, passed) = turned(incidence, f64::from(one.nm));
        if angle > least {
            (0..3).for_each(|c| sums[c] += f64::from(one.weight[c]) * passed / f64::from(N));
        }
    }
    sums
}

#[test]
fn a_prism_turns_each_wavelength_by_its_angle() {
    let off = |nm: f64, found: Vec<f64>| {
        let wanted = wanted(nm);
        (0..3).map(|c| (found[c] - wanted[c]).abs()).fold(0.0, f64::max)
    };
    let names = ["path", "bdpt", "vcm", "sppm"];
    for (i, nm) in [450.0, 500.0, 550.0, 600.0, 650.0].into_iter().enumerate() {
        // In the short form, each in turn.
        for name in &names[effort(i % 4..i % 4 + 1, 0..4)] {
            let (scene, integrator) = (spectrum(nm, 20.0 / ABBE), integrator(name));
            let rendered = (&scene, &*integrator, &settings());
            let off = off(nm, recorded(&format!("{name}, {nm} nm"), "means", rendered, means));
            // In the middle of the spectrum this is as much as light of 0.3 nm.
            assert!(off < 4e-3, "{name}, {nm} nm: {off}");
        }
    }
    // The wall separates the light: it receives neither none nor all of it.
    let [red, green, blue] = wanted(550.0);
    assert!(red < 0.1 && (0.2..0.8).contains(&green) && blue > 0.7, "{red}, {green}, {blue}");
    // Negative control: glass that disperses a fiftieth less.
    let other = spectrum(620.0, 20.0 / (ABBE * 1.02));
    let off = off(620.0, means(&shoot(&other, &*integrator("path"), &settings()).film.to_rgb()));
    assert!(off > 4e-3, "other glass passes: {off}");
}

#[test]
fn dispersive_glass_conserves_every_colour() {
    let mut builder = SceneBuilder::default();
    let glass = Spec::new("", "dielectric").with("eta", 1.7f32).with("dispersion", 0.7f32);
    put(&mut builder, "clear", Arc::new(shapes::prism(Vec3::X * -0.8, 0.7, 1.0, 3)), glass.clone());
    put(&mut builder, "frosted", ball(Vec3::X * 0.8, 0.7, 12, true), glass.with("roughness", 0.3f32));
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::new(0.3, 0.6, 4.0), Vec3::ZERO, 30.0);
    let scene = built(&builder);
    let settings = |seed| RenderSettings { seed, max_depth: 200, ..RenderSettings::new(16, 16, 64) };
    for name in ["path", "vcm"] {
        let mut left = [const { Vec::new() }; 3];
        for seed in 0..8 {
            // Only the prism: rough glass loses a little energy at each reflection between its microfacets.
            let pixels = shoot(&scene, &*integrator(name), &settings(seed)).film.to_rgb();
            let sum = (0..256).filter(|i| i % 16 < 8).map(|i| pixels[i]).sum::<Rgb>();
            (0..3).for_each(|c| left[c].push(f64::from(sum[c]) / 128.0));
        }
        for means in left {
            let (mean, error) = estimate(&means);
            assert!((mean - 1.0).abs() < 4.0 * error + 1e-3 && error < 0.01, "{name}: {mean} ± {error}");
        }
    }
}

/// Light that a prism projects on a wall from a distant light: blue on the left, red on the right.
fn on_a_wall(light_spec: Spec, glass: Spec, dispersion: f32) -> Scene {
    let mut builder = SceneBuilder::default();
    let glass = glass.with("eta", 1.4f32).with("dispersion", dispersion);
    put(&mut builder, "prism", Arc::new(shapes::prism(Vec3::ZERO, 0.7, 8.0, 3)), glass);
    let wall = quad(Vec3::new(-3.0, -4.0, -3.0), Vec3::X * 6.0, Vec3::Y * 8.0);
    put(&mut builder, "wall", wall, diffuse(Rgb::new(0.8, 0.7, 0.6)));
    // No light gets past the prism to where the camera looks.
    let screen = quad(Vec3::new(-4.0, -4.0, 0.0), Vec3::X * 3.65, Vec3::Y * 8.0);
    put(&mut builder, "screen", screen, diffuse(0.0f32));
    builder.lights.push(light_spec.with("position", LIGHT));
    look(&mut builder, Vec3::new(-0.85, 0.0, -1.9), Vec3::new(-0.85, 0.0, -3.0), 60.0);
    built(&builder)
}

const LIGHT: Vec3 = Vec3::new(-5.7, 0.0, 19.1);

fn panel() -> Spec {
    let spec = Spec::new("", "rect").with("radiance", 10.0f32);
    spec.with("edge_u", Vec3::X * 1.5).with("edge_v", Vec3::Y * 30.0)
}

fn spot() -> Spec {
    Spec::new("", "spot").with("look_at", Vec3::ZERO).with("intensity", 1e3f32).with("angle", 2.0f32)
}

fn merging(name: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", name).with("radius", 0.002f32)).unwrap()
}

/// More dispersion than any glass has, so that a mistake shows.
const STRONG: f32 = 6.0;

#[test]
fn dispersed_light_is_the_same_from_both_ends() {
    let clear = || Spec::new("", "dielectric");
    let frosted = || clear().with("roughness", 0.4f32);
    let ends: [(&str, Spec, Spec, &[&str]); 2] = [
        ("clear", panel(), clear(), &["bdpt", "vcm", "auto"]),
        ("frosted", spot(), frosted(), &["light", "bdpt", "vcm", "auto"]),
    ];
    for (kind, light_spec, glass, names) in ends {
        let scene = on_a_wall(light_spec.clone(), glass.clone(), STRONG);
        let path = blocks(&scene, integrator("path"), 0);
        for (i, name) in names.iter().enumerate() {
            let other = if *name == "vcm" { merging(name) } else { integrator(name) };
            let case = format!("{kind}: path and {name}");
            let p = agreement(&case, &path, &blocks(&scene, other, 100 * (i as u64 + 1)));
            assert!(p > UNLIKELY, "{case}: p = {p}");
        }
        // Otherwise the test could not distinguish it from glass without dispersion.
        let plain = on_a_wall(light_spec, glass, 0.0);
        let right = blocks(&scene, integrator("bdpt"), 800);
        let p = difference(&right, &blocks(&plain, integrator("bdpt"), 900));
        assert!(p < UNLIKELY, "{kind}: plain glass passes: p = {p}");
    }
}

/// Rough flint in water that disperses too: what counts is the ratio of their indices, at each wavelength.
#[test]
fn dispersed_light_in_water_is_the_same_from_both_ends() {
    let under_water = |eta: f32, dispersion: f32| {
        let glass = Spec::new("", "dielectric").with("roughness", 0.3f32).with("eta", eta);
        let mut builder = SceneBuilder::default();
        let bounds = Aabb { min: Vec3::new(-1.5, -1.0, -1.5), max: Vec3::new(1.5, 1.0, 1.5) };
        let medium = |spec: Spec, priority| {
            spec.with("dispersion", dispersion).with("priority", bilux_scene::Value::Integer(priority))
        };
        put(
            &mut builder,
            "prism",
            Arc::new(shapes::prism(Vec3::ZERO, 0.8, 1.6, 3)),
            medium(glass.clone(), 2),
        );
        put(&mut builder, "water", Arc::new(shapes::cuboid(bounds)), medium(glass.with("eta", 1.6f32), 1));
        let panel =
            Spec::new("", "rect").with("position", Vec3::new(0.5, 0.0, -2.5)).with("intensity", 10.0f32);
        builder.lights.push(panel.with("edge_u", Vec3::X * 1.2).with("edge_v", Vec3::Y * 1.2));
        look(&mut builder, Vec3::new(0.0, 0.5, 4.0), Vec3::ZERO, 40.0);
        built(&builder)
    };
    let scene = under_water(1.33, STRONG);
    let path = blocks(&scene, integrator("path"), 0);
    // Not `light`: too few of its paths come through for their mean to be normally distributed.
    for (i, name) in ["bdpt", "vcm"].into_iter().enumerate() {
        let case = format!("path and {name}");
        let p = agreement(&case, &path, &blocks(&scene, integrator(name), 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
    // Where the two indices are equal, they are equal at every wavelength, and the prism is invisible.
    let same = blocks(under_water(1.6, STRONG), integrator("bdpt"), 0);
    let p = difference(&same, &blocks(under_water(1.6, 0.0), integrator("bdpt"), 400));
    let q = difference(&path, &blocks(under_water(1.33, 0.0), integrator("path"), 500));
    assert!(p < UNLIKELY && q < UNLIKELY, "water that parts nothing passes: p = {p}, {q}");
}

/// Changes the wavelength of a sample before its camera subpath is traced, and after photons were.
struct Wrong(Box<dyn PixelIntegrator>, fn(&mut Task));

impl PixelIntegrator for Wrong {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        (self.1)(task);
        self.0.radiance(ray, task)
    }
    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }
}

impl LightSubpaths for Wrong {
    fn splats(&self) -> bool {
        self.0.splats()
    }
    fn merging(&self) -> Option<&Merging> {
        self.0.merging()
    }
    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        (self.1)(task);
        self.0.sample(ray, is_wanted, photons, task, splats)
    }
}

#[test]
fn wavelength_bugs_are_detected() {
    let scene = on_a_wall(spot(), Spec::new("", "dielectric"), STRONG);
    let light = blocks(&scene, integrator("light"), 0);
    let others = [("bdpt", integrator("bdpt")), ("vcm", merging("vcm")), ("sppm", merging("sppm"))];
    for (i, (name, other)) in others.iter().enumerate() {
        let case = format!("light and {name}");
        let p = agreement(&case, &light, &blocks(&scene, other, 100 * (i as u64 + 6)));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
    let twice = |task: &mut Task| task.sample.wavelength.weight *= task.sample.wavelength.weight;
    let forgotten = |task: &mut Task| task.sample.wavelength.weight = Rgb::WHITE;
    let another = |task: &mut Task| {
        task.sample.sampler.enter(1 << 40);
        task.sample.wavelength = Wavelength::sample(task.sample.sampler.next_1d());
    };
    let wrong: [(&str, Box<dyn PixelIntegrator>); 3] = [
        ("a colour that counts twice", Box::new(Wrong(integrator("light"), twice))),
        ("a colour that is forgotten", Box::new(Wrong(integrator("light"), forgotten))),
        ("photons of another wavelength", Box::new(Wrong(merging("sppm"), another))),
    ];
    for (i, (name, wrong)) in wrong.iter().enumerate() {
        let p = difference(&light, &blocks(&scene, wrong, 100 * (i as u64 + 1)));
        assert!(p < UNLIKELY, "{name} passes: p = {p}");
    }
}

/// The still life with dispersive glass.
fn dispersive_still_life() -> SceneBuilder {
    let mut builder = still_life();
    builder.materials.iter_mut().filter(|spec| spec.kind == "dielectric").for_each(|spec| {
        spec.parameters.set("dispersion", 0.7f32);
    });
    builder
}

#[test]
fn a_picture_with_dispersion_is_deterministic() {
    let scene = built(&dispersive_still_life());
    let whole = RenderSettings { threads: 2, ..RenderSettings::new(20, 18, 6) };
    let window = Window { x: 5, y: 7, width: 9, height: 4 };
    for name in ["path", "light", "bdpt", "vcm", "sppm", "auto"] {
        let of = |settings| shoot(&scene, &*integrator(name), &settings).film;
        let film = of(whole.clone());
        assert_eq!(film, of(RenderSettings { threads: 1, ..whole.clone() }), "{name}");
        let part = of(RenderSettings { crop: Some(window), ..whole.clone() });
        for (x, y) in (0..window.pixels()).map(|i| window.position(i)) {
            assert_eq!(film.pixel(x, y), part.pixel(x, y), "{name} at {x}, {y}");
        }
        let mut merged = of(RenderSettings { samples: 0..2, ..whole.clone() });
        merged.merge(&of(RenderSettings { samples: 2..6, ..whole.clone() })).unwrap();
        assert_eq!(merged.to_rgb(), film.to_rgb(), "{name}");
        let plain = shoot(&built(&still_life()), &*integrator(name), &whole).film;
        assert_ne!(film, plain, "{name} shows no dispersion");
    }
    let unmerged = integrators::build(&Spec::new("", "vcm").with("radius", 0.0f32)).unwrap();
    assert_eq!(shoot(&scene, &*unmerged, &whole).film, shoot(&scene, &*integrator("bdpt"), &whole).film);
}

/// Paths that hit no dispersive glass are the same as without it, to the bit.
#[test]
fn paths_without_dispersion_are_unchanged() {
    let mut builder = still_life();
    let plain = built(&builder);
    builder.add_material(Spec::new("", "dielectric").with("dispersion", 1.0f32));
    let parted = built(&builder);
    assert!(parted.disperses() && !plain.disperses());
    let settings = RenderSettings::new(24, 16, 4);
    for name in ["cook", "path", "light", "bdpt", "vcm", "sppm", "auto"] {
        let film = |scene: &Scene| shoot(scene, &*integrator(name), &settings).film;
        assert_eq!(film(&plain), film(&parted), "{name}");
    }
}
