//! Lights that are known to light next to nothing are sampled rarely: each integrator finds the mean that it finds where they are sampled everywhere. Here they
//! light much, so that a mistake is seen.

use crate::common::statistics::{UNLIKELY, agreement, blocks, difference};
use crate::common::{ball, built, diffuse, put, sky};
use crate::many_lights::mesh_of_lamps;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{LightChoice, PixelIntegrator, integrators};

/// Lamps and a second glowing body of another colour, beside a panel and a sky that are not faint.
pub(crate) fn lamps(radiance: f32, is_faint: bool) -> SceneBuilder {
    let mut builder = mesh_of_lamps(radiance);
    let ember = diffuse(0.1f32).with("emission", Rgb::new(2.0, 0.7, 0.2));
    put(&mut builder, "ember", ball(Vec3::new(0.1, 0.25, 0.9), 0.25, 8, true), ember);
    let panel =
        Spec::new("panel", "rect").with("position", Vec3::new(1.8, 2.2, -0.5)).with("radiance", 2.5f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * -1.1).with("edge_v", Vec3::Z * 1.3));
    sky(&mut builder, 0.3);
    builder.has_faint_emitters = is_faint;
    builder
}

fn integrator(name: &str) -> Box<dyn PixelIntegrator> {
    let (name, sampling) = name.split_once(' ').unwrap_or((name, "mis"));
    let spec = Spec::new("", name);
    integrators::build(&if name == "path" { spec.with("sampling", sampling) } else { spec }).unwrap()
}

#[test]
fn faint_lights_are_the_surfaces_of_the_scene_and_no_others() {
    let scene = built(&lamps(6.0, true));
    let faint: Vec<&str> =
        scene.lights().iter().filter(|light| light.is_faint).map(|light| &*light.name).collect();
    assert_eq!(faint, ["sphere", "ember"], "by the names of their meshes");
    let choice = LightChoice::new(&scene);
    let of = |light: usize| (scene.lights()[light].is_faint, choice.probability(light, Some(Vec3::ZERO)));
    let all: Vec<(bool, f32)> = (0..scene.lights().len()).map(of).collect();
    assert!(all.iter().all(|(is_faint, probability)| *is_faint == (*probability < 1.0)), "{all:?}");
    let faint: Vec<f32> = all.into_iter().filter_map(|(is_faint, p)| is_faint.then_some(p)).collect();
    assert!((faint[0] + faint[1] - 1.0 / 16.0).abs() < 1e-6, "{faint:?}");
    assert!(faint[0] > faint[1] && faint[1] > 1.0 / 400.0, "{faint:?}");
}

#[test]
fn lights_that_are_sampled_rarely_give_the_same_mean() {
    let [usual, faint] = [false, true].map(|is_faint| built(&lamps(6.0, is_faint)));
    let right = blocks(&usual, integrator("path"), 0);
    for (i, name) in ["path", "path lights", "light", "bdpt", "vcm"].into_iter().enumerate() {
        let p = agreement(name, &right, &blocks(&faint, integrator(name), 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{name}: p = {p}");
    }
    // Negative control: lamps that are a third darker.
    let wrong: Scene = built(&lamps(4.0, true));
    let p = difference(&right, &blocks(&wrong, integrator("path"), 900));
    assert!(p < UNLIKELY, "darker lamps: p = {p}");
}
