//! Light in photometric units against closed forms, of the kind of CIE 171:2006: computed here, not copied.

use bilux::formats::{ReadOptions, read_distribution};
use bilux::math::photometry::LUMENS_PER_WATT;
use bilux::math::transcendental::{atan2_f64, sin_cos_f64};
use bilux::math::{Aabb, Vec2, Vec3};
use bilux::prelude::*;
use bilux::scene::AccelChoice;
use bilux::scene::cameras::CameraSpec;
use bilux::scene::mesh::shapes;
use std::f64::consts::PI;
use std::sync::Arc;

/// Allowed difference of a picture from a closed form, as a fraction of the latter.
const ALLOWED: f64 = 1e-3;
const REFLECTANCE: f32 = 0.5;
const LAMP: Vec3 = Vec3::new(0.2, 3.0, -0.1);

/// A file whose intensity is 1000 + 5γ + 2C candela, C from 0 to 360 and γ from 0 to 90 degrees, by the factors that it states.
fn file(multiplier: f64, turned: impl Fn(f64) -> f64) -> String {
    let [azimuths, polar] =
        [360.0, 90.0].map(|last| (0..=4).map(|i| 0.25 * last * f64::from(i)).collect::<Vec<f64>>());
    let line = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join("\r\n ");
    let mut text = format!(
        "IESNA:LM-63-2002\r\n[TEST] linear\r\nTILT=NONE\r\n1 -1 {multiplier} 5 5 1 2 0 0 0\r\n0.8 1 40\r\n{}\r\n{}\r\n",
        line(&polar),
        line(&azimuths)
    );
    for c in azimuths {
        let plane: Vec<f64> =
            polar.iter().map(|g| (1000.0 + 5.0 * g + 2.0 * turned(c)) / 0.8 / 0.5).collect();
        text += &(line(&plane) + "\r\n");
    }
    text
}

fn lamp(text: &str) -> Spec {
    let (distribution, _) = read_distribution(text.as_bytes(), "lamp.ies", &ReadOptions::default()).unwrap();
    Spec::new("lamp", "luminaire").with("position", LAMP).with("distribution", Arc::new(distribution))
}

/// A floor under a light.
fn room(light: Spec) -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let grey = scene.add_material(Spec::new("grey", "diffuse").with("reflectance", REFLECTANCE));
    scene.objects.push(Object::new("floor", Arc::new(shapes::floor(Vec3::ZERO, 20.0)), grey));
    scene.lights.push(light);
    scene
}

/// The illuminance at a point of the floor in lux: by the light that it reflects into a camera that sees a square millimetre.
fn illuminance(scene: SceneBuilder, at: Vec3, integrator: &str, spp: i64) -> f64 {
    illuminance_of(scene, at, integrator, spp, 1e-3)
}

/// The illuminance of a square with this side.
fn illuminance_of(mut scene: SceneBuilder, at: Vec3, integrator: &str, spp: i64, side: f32) -> f64 {
    let spec = Spec::new("eye", "orthographic")
        .with("position", at + Vec3::Y)
        .with("look_at", at)
        .with("up", Vec3::Z)
        .with("height", side);
    scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    let mut settings = Parameters::default();
    settings.set("size", "1x1");
    settings.set("integrator", integrator);
    settings.set("spp", Value::Integer(spp));
    settings.set("max_depth", Value::Integer(1));
    let job = Job::new(&scene, JobRequest::from(&settings)).unwrap();
    let picture = job.render(&Quiet).unwrap().picture().unwrap();
    f64::from(picture.to_rgb().unwrap()[0].luminance() * LUMENS_PER_WATT / REFLECTANCE) * PI
}

fn off(found: f64, wanted: f64) -> f64 {
    (found - wanted).abs() / wanted
}

const POINTS: [Vec3; 3] = [Vec3::new(0.2, 0.0, -0.1), Vec3::new(1.7, 0.0, 1.1), Vec3::new(-2.0, 0.0, -1.4)];

/// The inverse square of the distance, with the intensity that the file has in that direction. The lamp hangs: γ is measured from below, and
/// C from +x towards -z.
fn under_the_lamp(at: Vec3) -> f64 {
    let away = (at - LAMP).as_dvec3();
    let gamma = atan2_f64((away.x * away.x + away.z * away.z).sqrt(), -away.y).to_degrees();
    let c = atan2_f64(-away.z, away.x).to_degrees().rem_euclid(360.0);
    // Straight below, all half planes meet: the first one counts.
    let c = if gamma < 1e-3 { 0.0 } else { c };
    (1000.0 + 5.0 * gamma + 2.0 * c) * -away.y / (away.length() * away.length_squared())
}

/// Largest relative error among the points.
fn worst(text: &str) -> f64 {
    let one = |at: Vec3| off(illuminance(room(lamp(text)), at, "path", 4), under_the_lamp(at));
    // Straight below, where half planes meet, the mean over a pixel is not that of a plane.
    POINTS[1..].iter().map(|at| one(*at)).fold(0.0, f64::max)
}

#[test]
fn a_lamp_gives_the_illuminance_of_the_inverse_square() {
    let found = worst(&file(0.5, |c| c));
    assert!(found < ALLOWED, "{found}");
}

/// Planted bugs: the multiplier left out, angles in the wrong half plane, and intensities taken for watts.
#[test]
fn a_lamp_with_a_bug_is_noticed() {
    assert!(worst(&file(1.0, |c| c)) > 0.5);
    assert!(worst(&file(0.5, |c| 360.0 - c)) > 0.05);
    let text = file(0.5, |c| c);
    let found = illuminance(room(lamp(&text).with("scale", LUMENS_PER_WATT)), POINTS[1], "path", 4);
    assert!(off(found, under_the_lamp(POINTS[1])) > 600.0);
}

/// The flux through a sphere around a lamp, in lumen.
fn through_a_sphere(light: Spec) -> f64 {
    let mut scene = room(light);
    let block = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    scene.objects.push(Object::new("block", Arc::new(shapes::cuboid(block)), 0));
    let built = scene.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let light = &built.lights()[0].light;
    let (rows, columns, radius) = (720, 720, 2.0f64);
    let mut sum = 0.0;
    for i in 0..rows * columns {
        let (sine, cosine) = sin_cos_f64(PI * (f64::from(i / columns) + 0.5) / f64::from(rows));
        let (y, x) = sin_cos_f64(2.0 * PI * (f64::from(i % columns) + 0.5) / f64::from(columns));
        let direction = Vec3::new((sine * x) as f32, cosine as f32, (sine * y) as f32);
        if let Some(sample) = light.sample_li(LAMP + direction * radius as f32, 0.0, Vec2::splat(0.5)) {
            sum += f64::from(sample.li.luminance()) * sine;
        }
    }
    sum * radius
        * radius
        * (PI / f64::from(rows))
        * (2.0 * PI / f64::from(columns))
        * f64::from(LUMENS_PER_WATT)
}

#[test]
fn the_lumens_of_a_file_pass_through_a_sphere_around_the_lamp() {
    // The mean over C is 1360 + 5γ; the integral of γ sin γ up to a right angle is 1.
    let wanted = 2.0 * PI * (1360.0 + 5.0 * 1.0f64.to_degrees());
    let text = file(0.5, |c| c);
    let found = through_a_sphere(lamp(&text));
    assert!(off(found, wanted) < ALLOWED, "{found} for {wanted}");
    let (distribution, _) = read_distribution(text.as_bytes(), "", &ReadOptions::default()).unwrap();
    assert!(off(distribution.lumens(), wanted) < 1e-6, "{}", distribution.lumens());
    // Another flux scales all of it, whichever way the lamp is turned.
    let other = lamp(&text).with("flux", 2.0f32).with("direction", Vec3::new(1.0, 1.0, 0.2));
    let found = through_a_sphere(other);
    assert!(off(found, 2.0 * f64::from(LUMENS_PER_WATT)) < ALLOWED, "{found}");
    // Without a file it is 1000 lm; planted bug: π for 4π.
    let found = through_a_sphere(Spec::new("", "luminaire").with("position", LAMP));
    assert!(off(found, 1000.0) < ALLOWED && off(4.0 * found, 1000.0) > 0.5, "{found}");
}

/// A light that is given as text, and the illuminance at the origin in lux that a closed form says.
fn lights_in_units() -> Vec<(Spec, f64)> {
    let above = |kind: &str, key: &str, text: &str| {
        let spec = Spec::new("lamp", kind).with("position", Vec3::new(0.0, 2.0, 0.0));
        spec.with("look_at", Vec3::ZERO).with(key, text)
    };
    let no_cone = |mut spec: Spec| {
        spec.parameters.0.retain(|(key, ..)| key != "look_at");
        spec
    };
    let point = |text: &str| no_cone(above("point", "intensity", text));
    let panel = |key: &str, text: &str| no_cone(above("rect", key, text)).with("edge_v", Vec3::Z * 0.5);
    let ball = no_cone(above("sphere", "intensity", "800 lm")).with("radius", 0.25f32);
    let sun = Spec::new("sun", "directional")
        .with("direction", Vec3::new(0.0, -4.0, 3.0))
        .with("irradiance", "500 lux");
    // What a panel of 1 m by 0.5 m gives 2 m below its middle, of its radiance: four times what a corner gives. [Howell 2010, C-11]
    let part = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * atan2_f64(b, (1.0 + a * a).sqrt());
    let factor = 4.0 * 0.5 * (part(0.25, 0.125) + part(0.125, 0.25));
    let cone = [10f64, 20.0].map(|angle| 0.5 * sin_cos_f64(angle.to_radians()).1).iter().sum::<f64>();
    let spot =
        |text: &str| above("spot", "intensity", text).with("angle", 20.0f32).with("inner_angle", 10.0f32);
    vec![
        (point("800 lm"), 800.0 / (4.0 * PI) / 4.0),
        (point("0.8 klm 2700 K"), 800.0 / (4.0 * PI) / 4.0),
        (point("100 cd"), 100.0 / 4.0),
        (point("40 W"), 40.0 * 683.0 / (4.0 * PI) / 4.0),
        (spot("100 cd"), 100.0 / 4.0),
        (spot("800 lm"), 800.0 / (2.0 * PI * (1.0 - cone)) / 4.0),
        (panel("radiance", "2000 nit"), 2000.0 * factor),
        (panel("intensity", "800 lm"), 800.0 / (2.0 * PI * 0.5) * factor),
        (panel("intensity", "800 lm").with("sides", "front").with("edge_u", Vec3::NEG_X), 0.0),
        (panel("intensity", "800 lm").with("sides", "front"), 800.0 / (PI * 0.5) * factor),
        (ball, 800.0 / (4.0 * PI) / 4.0),
        (sun, 500.0 * 0.8),
        (Spec::new("sky", "environment").with("radiance", "1000 cd/m2 6500 K"), 1000.0 * PI),
        (no_cone(above("luminaire", "flux", "800 lm")), 800.0 / (4.0 * PI) / 4.0),
    ]
}

#[test]
fn lights_in_photometric_units_give_the_illuminance_of_their_closed_forms() {
    for (light, wanted) in lights_in_units() {
        let found = illuminance(room(light.clone()), Vec3::ZERO, "path", 4096);
        let allowed = if light.kind == "environment" { 4e-3 } else { 2.0 * ALLOWED };
        assert!((found - wanted).abs() <= allowed * wanted, "{light:?}: {found} for {wanted}");
    }
}

/// Both ends find the same mean over 4 m by 4 m of the floor, in lux.
#[test]
fn light_paths_find_the_same_illuminance() {
    let point = Spec::new("", "point").with("position", LAMP).with("intensity", "800 lm 4000 K");
    let ball = Spec::new("", "sphere").with("position", LAMP).with("intensity", "800 lm");
    for light in [lamp(&file(0.5, |c| c)), point, ball] {
        let mean = |integrator: &str, spp: i64| {
            illuminance_of(room(light.clone()), Vec3::ZERO, integrator, spp, 4.0)
        };
        let path = mean("path", 1 << 12);
        for integrator in ["light", "bdpt"] {
            let found = mean(integrator, 1 << 16);
            assert!(off(found, path) < 0.03, "{}, {integrator}: {found} for {path}", light.kind);
        }
    }
}

/// Planted bugs: a lumen for a candela, π for 4π, watts for lumen, and a panel's other side forgotten.
#[test]
fn a_wrong_unit_is_noticed() {
    let point = |text: &str| {
        let light = Spec::new("", "point").with("position", Vec3::new(0.0, 2.0, 0.0)).with("intensity", text);
        illuminance(room(light), Vec3::ZERO, "path", 4)
    };
    let wanted = 800.0 / (4.0 * PI) / 4.0;
    assert!(off(point("800 lm"), wanted) < ALLOWED);
    for wrong in ["800 cd", "3200 lm", "800 W", "400 lm"] {
        assert!(off(point(wrong), wanted) > 0.3, "{wrong}");
    }
}

/// A floodlight of type B whose beam is level shines up where V is positive, and to its right where H is: half as much 30 degrees up,
/// a quarter 30 degrees to the right.
#[test]
fn floodlights_and_headlights_shine_up_and_to_the_right() {
    for (kind, candela) in [(2, "0 0 0\n0 1000 500\n0 250 0\n"), (3, "0 0 0\n0 1000 500\n0 250 0\n")] {
        let text =
            format!("IESNA91\nTILT=NONE\n1 -1 1 3 3 {kind} 2 0 0 0\n1 1 9\n-30 0 30\n-30 0 30\n{candela}");
        // Level, along -z; its right is +x.
        let light = lamp(&text).with("direction", Vec3::NEG_Z).with("c0", Vec3::Y);
        let built = room(light).build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let (sine, cosine) = sin_cos_f64(29.99f64.to_radians());
        let (sine, cosine) = (sine as f32, cosine as f32);
        for (direction, wanted) in [
            (Vec3::NEG_Z, 1000.0),
            (Vec3::new(0.0, sine, -cosine), 500.0),
            (Vec3::new(0.0, -sine, -cosine), 0.0),
            (Vec3::new(sine, 0.0, -cosine), 250.0),
            (Vec3::new(-sine, 0.0, -cosine), 0.0),
        ] {
            let sample = built.lights()[0].light.sample_li(LAMP + direction, 0.0, Vec2::ZERO);
            let found = sample.map_or(0.0, |sample| sample.li.luminance() * LUMENS_PER_WATT);
            assert!((found - wanted).abs() < 1.0, "type {kind}, {direction}: {found} for {wanted}");
        }
    }
}
