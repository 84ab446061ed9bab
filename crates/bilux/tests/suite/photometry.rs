//! Light in photometric units against closed forms, of the kind of CIE 171:2006: computed here, not copied.

use bilux::formats::{ReadOptions, read_distribution};
use bilux::math::photometry::LUMENS_PER_WATT;
use bilux::math::transcendental::{atan2_f64, sin_cos_f64};
use bilux::math::{Aabb, Vec2, Vec3};
use bilux::prelude::*;
use bilux::scene::AccelChoice;
use bilux::scene::cameras::CameraSpec;
use bilux::scene::generators::shapes;
use std::f64::consts::PI;
use std::sync::Arc;

/// What a closed form and a picture may differ by, of the former.
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
fn illuminance(mut scene: SceneBuilder, at: Vec3, integrator: &str, spp: i64) -> f64 {
    let spec = Spec::new("eye", "orthographic")
        .with("position", at + Vec3::Y)
        .with("look_at", at)
        .with("up", Vec3::Z)
        .with("height", 1e-3f32);
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

/// How much the worst of the points is off.
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
