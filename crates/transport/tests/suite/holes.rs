//! Surfaces with opacity: leaves and lace cut out by textures, and gauze.

use crate::common::statistics::{assert_like_path_in_turn, assert_unlike_path};
use crate::common::{
    assert_same_with_every_accelerator, built, diffuse, floor, integrator, look, put, quad, shoot, sky,
};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, SceneBuilder, Spec, Texture, Value};
use bilux_transport::RenderSettings;
use std::sync::Arc;

/// A square above the floor, with texture coordinates.
fn sheet(height: f32, half: f32) -> Arc<Mesh> {
    let mut mesh = (*floor(height, half)).clone();
    mesh.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    Arc::new(mesh)
}

/// A sheet over a floor, under a light and a weak sky.
fn sheet_over_a_floor(material: Spec, light: f32) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    put(&mut builder, "sheet", sheet(0.6, 1.0), material);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.3, 2.5, 0.2)).with("intensity", light);
    builder.lights.push(panel);
    sky(&mut builder, 0.2);
    // Cut-outs with soft edges, and a column of partial opacity.
    let texels = [1.0, 0.0, 1.0, 0.3, 0.0, 0.0, 1.0, 0.3, 1.0, 1.0, 0.0, 0.3, 0.5, 0.5, 0.5, 0.0];
    builder.textures.push(Arc::new(Texture::new("", 4, 4, texels.map(Rgb::grey).to_vec(), true)));
    look(&mut builder, Vec3::new(0.0, 2.2, 4.0), Vec3::new(0.0, 0.3, 0.0), 40.0);
    builder
}

#[test]
fn opacity_looks_the_same_from_both_ends() {
    let lace = diffuse(0.6f32).with("opacity", Value::Texture(0));
    let screen = Spec::new("", "principled").with("opacity", 0.4f32).with("base_color", 0.7f32);
    let sign = diffuse(0.3f32).with("emission", Rgb::new(3.0, 2.0, 1.0)).with("opacity", Value::Texture(0));
    let glow = diffuse(0.3f32).with("emission", 2.0f32).with("opacity", 0.3f32);
    let sheets =
        [("lace", lace, 12.0), ("gauze", screen, 12.0), ("sign", sign, 1.0), ("glowing gauze", glow, 1.0)];
    for (turn, (name, material, light)) in sheets.into_iter().enumerate() {
        let scene = built(&sheet_over_a_floor(material, light));
        assert_like_path_in_turn(turn, name, &scene, &["light", "bdpt", "vcm", "auto"]);
    }
}

/// A planted bug: a surface that stops a quarter more light than it states.
#[test]
fn a_wrong_opacity_is_detected() {
    let gauze = |opacity: f32| {
        let material = Spec::new("", "principled").with("opacity", opacity).with("base_color", 0.7f32);
        built(&sheet_over_a_floor(material, 12.0))
    };
    assert_unlike_path(&gauze(0.4), &gauze(0.5), &["bdpt", "vcm"]);
}

/// A sheet in front of a sky lets the rest of the sky's light through, and emits its share.
#[test]
fn opacity_scales_transmission_and_emission() {
    let seen = |material: Spec| {
        let mut builder = SceneBuilder::default();
        let (corner, u, v) = (Vec3::new(-9.0, -9.0, 0.0), Vec3::X * 18.0, Vec3::Y * 18.0);
        put(&mut builder, "sheet", quad(corner, u, v), material);
        sky(&mut builder, 0.5);
        look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 40.0);
        let settings = RenderSettings::new(32, 32, 64);
        let pixels = shoot(&built(&builder), &*integrator("path"), &settings).film.to_rgb();
        pixels.iter().map(|p| f64::from(p.g)).sum::<f64>() / pixels.len() as f64
    };
    // With 65,536 rays the fraction deviates by 0.002.
    let black = seen(diffuse(0.0f32).with("opacity", 0.3f32));
    assert!((black - 0.35).abs() < 0.004, "{black}");
    let glowing = seen(diffuse(0.0f32).with("emission", 2.0f32).with("opacity", 0.25f32));
    assert!((glowing - 0.875).abs() < 0.012, "{glowing}");
    // An opacity of 0 or 1 leaves nothing to chance.
    assert_eq!(seen(diffuse(0.0f32).with("opacity", 0.0f32)), 0.5);
    assert_eq!(seen(diffuse(0.0f32).with("opacity", 1.0f32)), 0.0);
}

#[test]
fn opacity_is_the_same_with_every_accelerator() {
    let lace = diffuse(0.6f32).with("opacity", Value::Texture(0));
    let builder = sheet_over_a_floor(lace, 12.0);
    assert_same_with_every_accelerator(&builder);
}
