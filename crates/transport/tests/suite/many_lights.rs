//! More lights than are all sampled, large and bright enough that paths hit them by chance: MIS weights must include
//! how rarely each light is chosen.

use crate::common::statistics::{UNLIKELY, agreement, assert_like_path, assert_unlike_path, blocks, least_p};
use crate::common::{along, ball, built, diffuse, floor, look, put, quad, shoot, sky};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::mesh::shapes::icosphere;
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec, Texture, Value};
use bilux_transport::{LightChoice, PixelIntegrator, RenderSettings, integrators};
use std::sync::Arc;

fn path(sampling: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", "path").with("sampling", sampling)).unwrap()
}

/// A floor, a wall, a diffuse and a glossy ball among six large panels close by, no two of which are equally bright,
/// under a bright sky.
fn large_lights() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    let wall = quad(Vec3::new(-2.0, 0.0, -1.6), Vec3::X * 4.0, Vec3::Y * 1.2);
    put(&mut builder, "wall", wall, diffuse(Rgb::new(0.4, 0.6, 0.7)));
    put(&mut builder, "ball", ball(Vec3::new(-0.7, 0.5, 0.2), 0.5, 10, true), diffuse(0.8f32));
    let satin = Spec::new("", "phong").with("kd", 0.2f32).with("ks", 0.6f32).with("exponent", 30.0f32);
    let satin = satin.with("reflectivity", 0.0f32);
    put(&mut builder, "satin", ball(Vec3::new(0.7, 0.5, 0.0), 0.5, 10, true), satin);
    for i in 0..6 {
        let (column, row) = ((i % 3) as f32, (i / 3) as f32);
        let place = Vec3::new(1.8 * column - 2.4, 1.6 + 0.2 * row, 1.7 * row - 1.5);
        let panel = Spec::new("", "rect").with("position", place).with("radiance", 3.0 + i as f32);
        builder.lights.push(panel.with("edge_u", Vec3::X * 1.3).with("edge_v", Vec3::Z * 1.3));
    }
    sky(&mut builder, 0.8);
    look(&mut builder, Vec3::new(0.0, 1.3, 4.0), Vec3::new(0.0, 0.5, 0.0), 45.0);
    builder
}

#[test]
fn one_of_them_is_chosen_at_a_time() {
    let choice = LightChoice::new(&built(&large_lights()));
    assert!(!choice.takes_all());
    for at in [None, Some(Vec3::ZERO), Some(Vec3::new(-2.0, 0.5, 1.0))] {
        let all: Vec<f32> = (0..7).map(|light| choice.probability(light, at)).collect();
        assert!(
            (all.iter().sum::<f32>() - 1.0).abs() < 1e-5 && all.iter().all(|&p| p > 0.005 && p < 0.9),
            "{all:?}"
        );
    }
}

/// Bodies of [`large_lights`] under one mesh of a dozen balls of 80 triangles each, from close to the floor to far above it, that
/// glow outside.
pub(crate) fn mesh_of_lamps(radiance: f32) -> SceneBuilder {
    let mut builder = large_lights();
    builder.lights.clear();
    let mut all: Option<Mesh> = None;
    for i in 0..12 {
        let (column, row) = ((i % 4) as f32, (i / 4) as f32);
        let place = Vec3::new(1.1 * column - 1.6, 0.45 + 0.35 * row * row + 0.1 * column, 1.0 * row - 1.0);
        let ball = icosphere(place, 0.12 + 0.04 * row, 1);
        match &mut all {
            None => all = Some(ball),
            Some(all) => {
                let first = all.positions.len() as u32;
                all.positions.extend(ball.positions);
                all.normals.extend(ball.normals);
                all.triangles.extend(ball.triangles.iter().map(|corners| corners.map(|i| i + first)));
            }
        }
    }
    let glow = diffuse(0.2f32).with("emission", radiance).with("emission_sides", "front");
    put(&mut builder, "lamps", Arc::new(all.unwrap()), glow);
    builder
}

/// The mesh of lamps in front of a picture: a third of the balls' triangles are black, and others many times as bright as the rest.
pub(crate) fn painted_lamps(scale: f32) -> SceneBuilder {
    let mut builder = mesh_of_lamps(1.0);
    let lamps = builder.objects.iter_mut().find(|object| object.name == "lamps").unwrap();
    let mesh = Arc::make_mut(&mut lamps.mesh);
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x + p.z, p.y - p.z) * 0.7).collect();
    paint(&mut builder, scale);
    builder
}

/// A screen of two triangles with the same picture, close to the floor.
pub(crate) fn screen(scale: f32) -> SceneBuilder {
    let mut builder = large_lights();
    builder.lights.clear();
    let mut screen = Mesh::clone(&quad(Vec3::new(-1.5, 0.1, -1.2), Vec3::X * 3.0, Vec3::Y * 1.4));
    screen.uvs = screen.positions.iter().map(|p| Vec2::new(p.x * 0.3 + 0.5, p.y * 0.6)).collect();
    put(&mut builder, "lamps", Arc::new(screen), diffuse(0.2f32));
    paint(&mut builder, scale);
    builder
}

/// Makes the last object glow by a picture.
fn paint(builder: &mut SceneBuilder, scale: f32) {
    let texel = |i: usize| Rgb::new(1.0, 0.7, 0.4) * [0.0, 9.0, 2.0, 0.0, 1.0, 1.0][(i + i / 8) % 6];
    builder.textures = vec![Arc::new(Texture::new("paint", 8, 8, (0..64).map(texel).collect(), false))];
    let parameters = &mut builder.materials.last_mut().unwrap().parameters;
    parameters.set("emission", Value::Texture(0));
    parameters.set("emission_scale", scale);
}

#[test]
fn painted_lamps_look_the_same_from_both_ends() {
    let right = built(&painted_lamps(1.0));
    assert_like_path("painted lamps", &right, &["light", "bdpt", "vcm"]);
    assert_unlike_path(&right, &built(&painted_lamps(0.93)), &["bdpt"]);
}

#[test]
fn a_screen_looks_the_same_from_both_ends() {
    let right = built(&screen(1.0));
    assert_like_path("screen", &right, &["light", "bdpt", "vcm"]);
    assert_unlike_path(&right, &built(&screen(0.93)), &["bdpt"]);
    assert_same_by_all_samplings(&right);
}

#[test]
fn a_mesh_of_lamps_looks_the_same_from_both_ends() {
    let right = built(&mesh_of_lamps(9.0));
    assert_eq!(right.lights().len(), 1);
    assert_like_path("mesh of lamps", &right, &["light", "bdpt", "vcm"]);
    assert_unlike_path(&right, &built(&mesh_of_lamps(8.5)), &["bdpt"]);
}

#[test]
fn all_three_samplings_of_path_find_the_same_light_of_a_mesh_of_lamps() {
    assert_same_by_all_samplings(&built(&mesh_of_lamps(9.0)));
}

#[test]
fn all_three_samplings_of_path_find_the_same_light_of_many_large_lights() {
    assert_same_by_all_samplings(&built(&large_lights()));
}

fn assert_same_by_all_samplings(scene: &Scene) {
    let of = |sampling: &str, seed: u64| blocks(scene, path(sampling), seed);
    let [mis, lights, scattering] =
        [("mis", 0), ("lights", 100), ("scattering", 200)].map(|(s, seed)| of(s, seed));
    for (name, a, b) in [
        ("mis and lights", &mis, &lights),
        ("mis and scattering", &mis, &scattering),
        ("lights and scattering", &lights, &scattering),
    ] {
        let p = agreement(name, a, b);
        assert!(p > UNLIKELY, "{name}: p = {p}");
    }
    // Negative control: light that is two hundredths too bright is detected.
    let brighter: Vec<Vec<f64>> =
        mis.cells().iter().map(|b| b.iter().map(|sum| sum * 1.02).collect()).collect();
    let others: Vec<Vec<f64>> =
        lights.cells().iter().zip(scattering.cells()).map(|(a, b)| [&**a, &**b].concat()).collect();
    let p = least_p(&brighter, &others);
    assert!(p < UNLIKELY, "too bright: p = {p}");
}

#[test]
fn many_large_lights_look_the_same_from_both_ends() {
    let right = built(&large_lights());
    assert_like_path("many large lights", &right, &["light", "bdpt", "vcm"]);
    // Negative control: a sky that is a tenth darker.
    let mut wrong = large_lights();
    wrong.lights.last_mut().unwrap().parameters.set("radiance", 0.72f32);
    assert_unlike_path(&right, &built(&wrong), &["bdpt"]);
}

/// A diffuse floor sees nothing but lights of radiance 1, some of them panels and the rest sky: it shows its albedo.
#[test]
fn panels_and_sky_of_one_radiance_are_an_even_sky() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 0.5), diffuse(Rgb::new(0.8, 0.5, 0.2)));
    for i in 0..6 {
        let place = Vec3::new(1.0 * (i % 3) as f32 - 1.5, 1.0, (i / 3) as f32 - 1.0);
        let panel = Spec::new("", "rect").with("position", place).with("radiance", 1.0f32);
        // Black, so that no light is scattered back and forth.
        builder.lights.push(panel.with("edge_u", Vec3::X).with("edge_v", Vec3::Z));
    }
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.01, 0.0, 0.0), 30.0);
    let scene = built(&builder);
    for (kind, sampling) in
        [("path", "mis"), ("path", "lights"), ("path", "scattering"), ("bdpt", ""), ("vcm", "")]
    {
        let spec = Spec::new("", kind);
        let spec = if sampling.is_empty() { spec } else { spec.with("sampling", sampling) };
        let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(16, 16, 256) };
        let pixels = shoot(&scene, &*integrators::build(&spec).unwrap(), &settings).film.to_rgb();
        let mean = pixels.into_iter().sum::<Rgb>() / 256.0;
        for (found, wanted) in mean.to_array().into_iter().zip([0.8, 0.5, 0.2]) {
            assert!((found / wanted - 1.0).abs() < 0.01, "{kind} {sampling}: {mean:?}");
        }
    }
}

/// A panel of 2 cm that shines towards -x passes a wall at a distance of 1 m while the shutter is open, among five dim lamps behind the wall: in
/// its first half it turns its back. The mean of ρ/π L A cos cos' / d² over that time, in closed form.
#[test]
fn a_lamp_that_moves_among_many_is_found_where_it_goes() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(0.0, -9.0, -9.0), Vec3::Y * 18.0, Vec3::Z * 18.0),
        diffuse(0.8f32),
    );
    let shining = diffuse(0.0f32).with("emission", 5000.0f32).with("emission_sides", "front");
    // Its front is where it is counter-clockwise: towards -x.
    let panel = quad(Vec3::new(0.0, -0.01, -0.01), Vec3::Z * 0.02, Vec3::Y * 0.02);
    put(&mut builder, "panel", panel, shining);
    builder.objects[1].motion = along(Vec3::new(-2.0, 1.0, 0.0), Vec3::new(2.0, 1.0, 0.0));
    for i in 0..5 {
        let lamp = Spec::new("", "point").with("position", Vec3::new(-1.0 - i as f32, 1.0, 0.3 * i as f32));
        builder.lights.push(lamp.with("intensity", 0.01f32));
    }
    let eye = Spec::new("", "orthographic").with("position", Vec3::X * 4.0).with("look_at", Vec3::ZERO);
    builder.cameras = vec![CameraSpec::new(eye.with("height", 0.01f32))];
    let scene = builder.build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    assert!(!LightChoice::new(&scene).takes_all());
    // ∫ x²/(x² + 1)² dx/4 over 0..2, of a panel of 4 cm².
    let integral = 0.5 * (bilux_math::transcendental::atan(2.0) - 0.4) / 4.0;
    let wanted = 0.8 / std::f32::consts::PI * 5000.0 * 4e-4 * integral;
    for name in ["path", "bdpt", "vcm"] {
        let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(8, 8, 256) };
        let film = shoot(&scene, &*crate::common::integrator(name), &settings).film;
        let mean = film.to_rgb().iter().map(|pixel| pixel.g).sum::<f32>() / 64.0;
        assert!((mean / wanted - 1.0).abs() < 0.06, "{name}: {mean}, not {wanted}");
    }
}
