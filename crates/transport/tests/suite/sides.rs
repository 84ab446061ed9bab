//! Surfaces that the camera sees only from the front, and looks through from behind.

use crate::common::statistics::{UNLIKELY, agreement, assert_like_path, assert_unlike_path, blocks};
use crate::common::{
    assert_same_with_every_accelerator, ball, built, diffuse, floor, integrator, look, put, quad, shoot, sky,
};
use bilux_math::transcendental::atan;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec, Texture, Value};
use bilux_testing::verdicts::Side;
use bilux_transport::{RenderSettings, integrators};
use std::sync::Arc;

/// An upright wall with its back to a viewer at +z.
fn wall() -> Arc<Mesh> {
    let mut mesh = (*quad(Vec3::new(-1.2, 0.05, 1.2), Vec3::Y * 1.1, Vec3::X * 2.4)).clone();
    mesh.uvs = vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X];
    Arc::new(mesh)
}

/// A floor and a ball behind a wall, and a light in front of it.
fn behind(wall: Arc<Mesh>, material: Spec) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    put(&mut builder, "ball", ball(Vec3::new(0.2, 0.5, -0.2), 0.5, 12, true), diffuse(0.8f32));
    put(&mut builder, "wall", wall, material);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.3, 2.5, 2.2)).with("intensity", 12.0f32);
    builder.lights.push(panel);
    sky(&mut builder, 0.2);
    let texels = [1.0, 0.0, 0.3, 0.7].map(Rgb::grey).to_vec();
    builder.textures.push(Arc::new(Texture::new("", 2, 2, texels, true)));
    look(&mut builder, Vec3::new(0.0, 1.6, 4.5), Vec3::new(0.0, 0.4, 0.0), 40.0);
    builder
}

fn one_sided(material: Spec) -> Spec {
    material.with("visible_sides", "front")
}

#[test]
fn one_sided_visibility_looks_the_same_from_both_ends() {
    let plain = one_sided(diffuse(Rgb::new(0.3, 0.5, 0.8)));
    let shiny = one_sided(Spec::new("", "principled").with("specular_roughness", 0.3f32));
    let lace = one_sided(diffuse(0.6f32)).with("opacity", Value::Texture(0));
    let sign = one_sided(diffuse(0.3f32)).with("emission", Rgb::new(1.0, 0.7, 0.3));
    let around = ball(Vec3::new(0.0, 1.5, 4.5), 0.7, 12, false);
    for (name, mesh, material) in [
        ("plain", wall(), plain.clone()),
        ("shiny", wall(), shiny),
        ("lace", wall(), lace),
        ("sign", wall(), sign),
        ("a ball around the camera", around, plain),
    ] {
        let scene = built(&behind(mesh, material));
        assert_like_path(name, &scene, &["light", "bdpt", "vcm", "auto"]);
    }
}

/// Planted bugs: light subpaths that do not reach the camera through a back, and those that show it the back.
#[test]
fn light_subpaths_that_ignore_backs_are_detected() {
    let grey = || diffuse(0.5f32);
    let (right, wrong) = (built(&behind(wall(), one_sided(grey()))), built(&behind(wall(), grey())));
    assert_unlike_path(&right, &wrong, &["light", "bdpt"]);
}

/// Bodies behind the back are visible as if nothing were in front of them, in the shadow that it casts.
#[test]
fn a_back_is_invisible_and_casts_a_shadow() {
    let seen = |lid: Arc<Mesh>| {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
        put(&mut builder, "lid", lid, one_sided(diffuse(0.0f32)));
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::new(0.0, 2.0, 0.0), Vec3::Z * 0.01, 10.0);
        let settings = RenderSettings::new(16, 16, 256);
        let pixels = shoot(&built(&builder), &*integrator("path"), &settings).film.to_rgb();
        pixels.iter().map(|p| f64::from(p.g)).sum::<f64>() / pixels.len() as f64
    };
    let facing_down = quad(Vec3::new(-3.0, 1.0, -3.0), Vec3::X * 6.0, Vec3::Z * 6.0);
    assert_eq!(seen(floor(1.0, 3.0)), 0.0, "its front is black");
    // As seen from the floor's centre, the lid covers this much of the sky. [Howell 2010, C-11]
    let side = 3.0 / 10f32.sqrt();
    let covered = f64::from(4.0 / std::f32::consts::PI * side * atan(side));
    let shaded = seen(facing_down);
    assert!((shaded - 0.5 * (1.0 - covered)).abs() < 0.003, "{shaded}, of {covered} covered");
}

#[test]
fn backs_are_the_same_with_every_accelerator() {
    let builder = behind(wall(), one_sided(diffuse(0.6f32)));
    assert_same_with_every_accelerator(&builder);
}

/// An upright sheet of two one-sided shells; the one that faces the camera is `gap` behind the one that faces away.
fn sheet(builder: &mut SceneBuilder, gap: f32, material: &Spec) {
    let (corner, up, right) = (Vec3::new(-1.2, 0.05, 1.2), Vec3::Y * 1.1, Vec3::X * 2.4);
    put(builder, "seen", quad(corner, right, up), one_sided(material.clone()));
    put(builder, "before it", quad(corner + Vec3::Z * gap, up, right), one_sided(material.clone()));
}

/// A stage for a sheet: light from in front of it and from behind it.
fn stage(build: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    build(&mut builder);
    for z in [2.6, -1.0] {
        let panel =
            Spec::new("", "rect").with("position", Vec3::new(-0.3, 2.5, z)).with("intensity", 12.0f32);
        builder.lights.push(panel);
    }
    sky(&mut builder, 0.2);
    look(&mut builder, Vec3::new(0.0, 1.6, 4.5), Vec3::new(0.0, 0.4, 0.0), 40.0);
    built(&builder)
}

/// Materials of sheets: one that is lit, one that emits.
fn of_sheets() -> [(&'static str, Spec); 2] {
    let sign = diffuse(0.3f32).with("emission", Rgb::new(1.0, 0.7, 0.3)).with("emission_sides", "front");
    [("paper", diffuse(Rgb::new(0.3, 0.5, 0.8))), ("sign", sign)]
}

const ALL: [&str; 5] = ["light", "bdpt", "vcm", "sppm", "auto"];

/// One two-sided surface in place of a sheet of two shells.
fn one_surface(builder: &mut SceneBuilder, material: &Spec) {
    let both = material.clone().with("emission_sides", "both");
    put(builder, "sheet", quad(Vec3::new(-1.2, 0.05, 1.2), Vec3::X * 2.4, Vec3::Y * 1.1), both);
}

/// `auto` that merges, within a radius relative to the scene's.
///
/// Two emissive shells are the fourth and the fifth light of the stage, and with more than four lights `auto` merges
/// direct light too. Its own radius would be a tenth of the scene with so few pixels, and blur the light at the sheet's
/// foot.
fn merging(radius: f32) -> Spec {
    Spec::new("", "auto").with("techniques", "vcm").with("radius", radius)
}

#[test]
fn a_sheet_of_two_shells_is_lit_like_one_two_sided_surface() {
    for (name, material) in of_sheets() {
        let one = stage(|builder| one_surface(builder, &material));
        let wanted = blocks(&one, integrator("path"), 0);
        for gap in [0.0, 1e-4] {
            let two = stage(|builder| sheet(builder, gap, &material));
            for (i, other) in ["path"].iter().chain(&ALL).enumerate() {
                let spec =
                    if (name, *other) == ("sign", "auto") { merging(0.0125) } else { Spec::new("", other) };
                let integrator = integrators::build(&spec).unwrap();
                let found = blocks(&two, integrator, 100 * (i as u64 + 1));
                let case = format!("{name}, {gap} apart, by {other}");
                let p = agreement(&case, &wanted, &found);
                assert!(p > UNLIKELY, "{case}: p = {p}");
            }
        }
    }
}

/// The blur of a radius of a tenth of the scene darkens the sheet's surroundings, by as much with two shells as with one
/// surface among as many lights, and vanishes with the radius.
#[test]
fn merging_blurs_as_much_around_two_shells_as_around_one_surface() {
    let (_, sign) = &of_sheets()[1];
    let two = stage(|builder| sheet(builder, 1e-4, sign));
    let one = stage(|builder| {
        one_surface(builder, sign);
        let fifth = Spec::new("", "rect").with("position", Vec3::Y * 2.6).with("intensity", 1e-4f32);
        builder.lights.push(fifth);
    });
    fn found<'a>(scene: &'a Scene, spec: &Spec, seed: u64) -> Side<'a> {
        blocks(scene, integrators::build(spec).unwrap(), seed)
    }
    let wide = found(&two, &merging(0.1), 100);
    let p = agreement("wide", &wide, &found(&one, &merging(0.1), 200));
    assert!(p > UNLIKELY, "p = {p}");
    let light = |blocks: &Side| blocks.cells().iter().flatten().sum::<f64>();
    let unblurred = light(&found(&two, &Spec::new("", "path"), 0));
    let dark = |blocks: &Side| 1.0 - light(blocks) / unblurred;
    let (much, little) = (dark(&wide), dark(&found(&two, &merging(0.025), 300)));
    assert!(much > 0.01 && little.abs() < 0.25 * much, "{much} by a tenth, {little} by a fortieth");
}

/// Planted bug: shells that the camera looks through but that shade each other, as a canopy shades what is below it.
#[test]
fn shells_that_shade_each_other_are_detected() {
    let (_, paper) = &of_sheets()[0];
    let right = stage(|builder| sheet(builder, 1e-4, paper));
    let wrong = stage(|builder| sheet(builder, 2e-2, paper));
    assert_unlike_path(&right, &wrong, &["path", "light", "bdpt", "vcm", "sppm", "auto"]);
}

/// A ball of two shells, in the classic modes too.
#[test]
fn a_ball_of_two_shells_looks_like_a_ball() {
    let seen = |outer: Option<f32>, mode: &str| {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "inner", ball(Vec3::ZERO, 1.0, 12, false), one_sided(diffuse(0.5f32)));
        if let Some(gap) = outer {
            let mut mesh = (*ball(Vec3::ZERO, 1.0 + gap, 12, false)).clone();
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            put(&mut builder, "outer", Arc::new(mesh), one_sided(diffuse(0.5f32)));
        }
        builder.lights.push(
            Spec::new("", "point").with("position", Vec3::new(1.0, 3.0, 4.0)).with("intensity", 30.0f32),
        );
        look(&mut builder, Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, 40.0);
        let settings = RenderSettings::new(24, 24, 8);
        let pixels = shoot(&built(&builder), &*integrator(mode), &settings).film.to_rgb();
        pixels.iter().map(|p| f64::from(p.g)).sum::<f64>() / pixels.len() as f64
    };
    for mode in ["path", "cast", "whitted", "cook"] {
        let one = seen(None, mode);
        for gap in [0.0, 1e-4, 1e-3] {
            let two = seen(Some(gap), mode);
            assert!((two / one - 1.0).abs() < 0.01, "{mode}, {gap} apart: {two}, not {one}");
        }
    }
    assert!(seen(Some(0.05), "path") < 0.1 * seen(None, "path"), "a hull that is far away shades");
}

#[test]
fn sheets_are_the_same_with_every_accelerator() {
    let mut builder = behind(wall(), one_sided(diffuse(0.6f32)));
    sheet(&mut builder, 1e-4, &diffuse(0.6f32));
    sheet(&mut builder, 0.0, &diffuse(0.6f32));
    assert_same_with_every_accelerator(&builder);
}
