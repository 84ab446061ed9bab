//! Grounds that a model stands on: one of which only the shadow is in the picture, and a mirror.

use bilux::math::{Aabb, Rgb, Vec3};
use bilux::prelude::*;
use std::sync::Arc;

/// A slab above the ground, lit by the studio or by one light of its own.
fn slab(light_spec: Option<Spec>) -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let red = scene.add_material(Spec::new("", "diffuse").with("reflectance", Rgb::new(0.7, 0.1, 0.1)));
    let bounds = Aabb { min: Vec3::new(-1.0, 0.0, -0.3), max: Vec3::new(1.0, 1.6, 0.3) };
    scene.objects.push(Object::new("slab", Arc::new(bilux::scene::mesh::shapes::cuboid(bounds)), red));
    scene.lights.extend(light_spec);
    scene
}

fn picture(scene: &SceneBuilder, settings: &[(&str, &str)]) -> Picture {
    let mut all = Parameters::default();
    for (key, value) in [("size", "48x48"), ("denoise", "off"), ("ground", "shadow")].iter().chain(settings) {
        all.set(key, *value);
    }
    all.set("spp", Value::Integer(64));
    Job::new(scene, &all).unwrap().render(&Quiet).unwrap().picture().unwrap()
}

fn alpha(picture: &Picture) -> Vec<f32> {
    picture.channel("A").expect("a picture without surroundings has alpha").to_vec()
}

#[test]
fn an_invisible_ground_writes_its_shadow_to_alpha() {
    for light_spec in [None, Some(Spec::new("", "directional").with("direction", Vec3::new(0.8, -1.0, 0.1)))]
    {
        let has_light = light_spec.is_some();
        let cut = picture(&slab(light_spec), &[("background", "transparent")]);
        let (alpha, light) = (alpha(&cut), cut.to_rgb().unwrap());
        assert!(
            alpha.iter().filter(|a| **a == 0.0).count() > 48 * 48 / 20 || !has_light,
            "nothing is left of the background"
        );
        assert!(alpha.iter().filter(|a| **a == 1.0).count() > 48 * 48 / 10, "the model is opaque");
        let shaded = alpha.iter().zip(&light).filter(|(a, l)| **a > 0.2 && l.is_black()).count();
        assert!(shaded > 48 * 48 / 50, "no shadow: {shaded}");
        // A shadow adds nothing to what is behind it.
        assert!(alpha.iter().zip(&light).all(|(a, l)| *a >= 0.0 && *a <= 1.0 && (*a > 0.0 || l.is_black())));
    }
}

/// The shadow of a denoised picture is denoised as well: it has far less noise, and is as dark on average.
#[test]
fn a_denoised_picture_has_a_denoised_shadow() {
    let shadow = |denoise: &str| {
        let mut all = Parameters::default();
        let settings =
            [("size", "96x96"), ("ground", "shadow"), ("background", "transparent"), ("denoise", denoise)];
        settings.into_iter().for_each(|(key, value)| all.set(key, value));
        all.set("spp", Value::Integer(4));
        let request = JobRequest::from(&all).denoised(Denoised::ForDisplay);
        let job = Job::new(&slab(None), request).unwrap();
        alpha(&job.render(&Quiet).unwrap().picture().unwrap())
    };
    let (plain, smooth) = (shadow("off"), shadow("builtin"));
    // Pixels whose neighbours show the ground too, by how much they differ from the mean of the two beside them.
    let is_ground = |i: usize| (i - 1..=i + 1).all(|j| plain[j] < 0.9 && smooth[j] < 0.9);
    let ground: Vec<usize> = (1..plain.len() - 1).filter(|&i| is_ground(i)).collect();
    let noise = |alpha: &[f32]| {
        let one = |&i: &usize| f64::from(alpha[i] - 0.5 * (alpha[i - 1] + alpha[i + 1])).abs();
        ground.iter().map(one).sum::<f64>() / ground.len() as f64
    };
    let mean = |alpha: &[f32]| ground.iter().map(|&i| f64::from(alpha[i])).sum::<f64>() / ground.len() as f64;
    assert!(ground.len() > 1000);
    assert!(noise(&smooth) < 0.5 * noise(&plain), "{} of {}", noise(&smooth), noise(&plain));
    assert!((mean(&smooth) - mean(&plain)).abs() < 0.01, "{} and {}", mean(&smooth), mean(&plain));
}

/// Composited over white, the shadow is that on a white ground: as dark as the lid's form factor says.
#[test]
fn the_shadow_over_white_is_that_of_the_ground() {
    // Under a uniform environment light, far below a large lid, the ground keeps the light that the lid does not block.
    let mut scene = SceneBuilder::default();
    let black = scene.add_material(Spec::new("", "diffuse").with("reflectance", 0.0f32));
    // The ground lies at the foot of the post.
    let lid = Aabb { min: Vec3::new(-1.0, 1.0, -1.0), max: Vec3::new(1.0, 1.001, 1.0) };
    let post = Aabb { min: Vec3::new(-0.001, 0.0, -0.001), max: Vec3::new(0.001, 1.0, 0.001) };
    for bounds in [lid, post] {
        let mesh = bilux::scene::mesh::shapes::cuboid(bounds);
        scene.objects.push(Object::new("", Arc::new(mesh), black));
    }
    scene.lights.push(Spec::new("", "environment").with("radiance", 1.0f32));
    let camera = Spec::new("", "perspective").with("position", Vec3::new(0.05, 0.5, 0.05));
    let camera = camera.with("look_at", Vec3::new(0.05, 0.0, 0.0501)).with("fov", 4.0f32);
    scene.cameras.push(bilux::scene::cameras::CameraSpec { spec: camera, keyframes: Vec::new() });
    let alpha = alpha(&picture(&scene, &[("background", "transparent")]));
    let mean = alpha.iter().map(|a| f64::from(*a)).sum::<f64>() / alpha.len() as f64;
    // A square of side 2 straight above, one unit away. [Howell 2010, C-11]
    let side = 0.5f32.sqrt();
    let covered = f64::from(4.0 / std::f32::consts::PI * side * bilux::math::transcendental::atan(side));
    assert!((mean - covered).abs() < 0.01, "{mean}, of {covered} covered");
}

#[test]
fn a_mirror_shows_the_model() {
    let light_spec = Spec::new("", "environment").with("radiance", 1.0f32);
    let redness = |ground: &str| {
        let picture = picture(&slab(Some(light_spec.clone())), &[("ground", ground)]);
        let red = |p: &&Rgb| p.r > 2.0 * p.g && p.r > 0.02;
        picture.to_rgb().unwrap().iter().filter(red).count()
    };
    let (bare, mirrored) = (redness("none"), redness("mirror"));
    assert!(mirrored as f64 > 1.25 * bare as f64, "{mirrored} pixels are red, of the model itself {bare}");
}
