//! Pictures of fog and smoke: what the denoiser makes of them, and their alpha.

use bilux::math::{Aabb, Transform, Vec3};
use bilux::prelude::*;
use bilux::scene::cameras::CameraSpec;
use bilux::scene::media::Grid;
use bilux::scene::mesh::shapes::cuboid;
use std::sync::Arc;

fn put(scene: &mut SceneBuilder, [low, high]: [Vec3; 2], material: Spec) {
    let material = scene.add_material(material);
    scene.objects.push(Object::new("part", Arc::new(cuboid(Aabb { min: low, max: high })), material));
}

fn seen(scene: &mut SceneBuilder, from: Vec3) {
    let spec = Spec::new("eye", "perspective")
        .with("position", from)
        .with("look_at", Vec3::ZERO)
        .with("fov", 40.0f32);
    scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
}

fn picture(scene: &SceneBuilder, settings: &[(&str, &str)]) -> Picture {
    let mut all = Parameters::default();
    let fixed = [("size", "64x64"), ("integrator", "path")];
    fixed.iter().chain(settings).for_each(|(key, value)| all.set(key, *value));
    all.set("spp", Value::Integer(8));
    all.set("max_depth", Value::Integer(100));
    let job = Job::new(scene, JobRequest::from(&all).denoised(Denoised::ForDisplay)).unwrap();
    let outcome = job.render(&Quiet).unwrap();
    match job.denoiser().unwrap() {
        Some(chosen) => outcome.denoised(chosen).unwrap(),
        None => outcome.picture().unwrap(),
    }
}

/// The root of the mean squared difference from 1.
fn error(picture: &Picture) -> f64 {
    let light = picture.to_rgb().unwrap();
    let sum: f64 = light.iter().map(|rgb| f64::from(rgb.g - 1.0) * f64::from(rgb.g - 1.0)).sum();
    (sum / light.len() as f64).sqrt()
}

/// White blocks in white fog under a white sky: everything has a radiance of 1. Guides that know only how much of the blocks shows through
/// the fog, and not what the fog adds, leave an error almost three times as large.
#[test]
fn little_noise_is_left_in_fog() {
    let mut scene = SceneBuilder::default();
    let fog = Spec::new("", "interface").with("scattering", 0.5f32).with("priority", Value::Integer(1));
    put(&mut scene, [Vec3::splat(-4.0), Vec3::splat(4.0)], fog);
    for x in [-2.4f32, 0.0, 2.4] {
        let middle = Vec3::new(x, 0.0, x);
        let white = Spec::new("", "diffuse").with("reflectance", 1.0f32);
        put(&mut scene, [middle - Vec3::new(0.7, 1.5, 0.7), middle + Vec3::new(0.7, 0.5, 0.7)], white);
    }
    scene.lights.push(Spec::new("sky", "environment").with("radiance", 1.0f32));
    seen(&mut scene, Vec3::new(0.0, 1.0, 7.0));
    let [noisy, smooth] = ["off", "builtin"].map(|denoise| error(&picture(&scene, &[("denoise", denoise)])));
    assert!(noisy > 0.02, "{noisy}");
    assert!(smooth < 0.1 * noisy, "{smooth} of {noisy}");
}

/// A ball of smoke in an empty box before nothing: thick in its middle, clear in the corners of the box, and without holes.
#[test]
fn smoke_is_cut_out_as_it_is_seen() {
    const SIDE: usize = 24;
    let place = Transform::scale(Vec3::splat(2.0 / SIDE as f32)).unwrap();
    let place = place.then(&Transform::translate(Vec3::NEG_ONE).unwrap());
    let at = |i: usize| {
        let voxel = Vec3::new((i % SIDE) as f32, (i / SIDE % SIDE) as f32, (i / SIDE / SIDE) as f32);
        ((voxel + 0.5) * (2.0 / SIDE as f32) - 1.0).length()
    };
    let values: Vec<f32> = (0..SIDE.pow(3)).map(|i| if at(i) < 0.8 { 1.0 } else { 0.0 }).collect();
    let grid = Grid::dense("ball", [SIDE; 3], &place, &values).unwrap();
    let mut scene = SceneBuilder::default();
    let smoke = Spec::new("", "interface").with("scattering", 3.0f32).with("density", Arc::new(grid));
    put(&mut scene, [Vec3::NEG_ONE, Vec3::ONE], smoke.with("priority", Value::Integer(1)));
    scene.lights.push(Spec::new("sky", "environment").with("radiance", 1.0f32));
    seen(&mut scene, Vec3::Z * 5.0);
    for denoise in ["off", "builtin"] {
        let settings = [("denoise", denoise), ("background", "transparent"), ("ground", "none")];
        let cut = picture(&scene, &settings);
        let (alpha, light) = (cut.channel("A").unwrap(), cut.to_rgb().unwrap());
        // 1.6 m of it, and half a voxel of fading on each side.
        let middle = alpha[32 * 64 + 32];
        assert!((middle - 0.991).abs() < 4e-3, "{middle}");
        assert!((0..64).all(|i| alpha[i] == 0.0 && alpha[i * 64] == 0.0 && light[i].is_black()), "{denoise}");
        // White smoke under a white sky has the radiance 1 that it hides: premultiplied, its alpha.
        let sum = |of: &dyn Fn(usize) -> f32| (0..64 * 64).map(|i| f64::from(of(i))).sum::<f64>();
        let [covered, lit] = [sum(&|i| alpha[i]), sum(&|i| light[i].g)];
        assert!(covered > 400.0 && (lit / covered - 1.0).abs() < 0.03, "{denoise}: {lit} of {covered}");
        assert!((0..64 * 64).all(|i| light[i].is_finite() && (alpha[i] > 0.0 || light[i].is_black())));
    }
}
