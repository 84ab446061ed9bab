//! Textures filtered over half a pixel: less noise, the same picture, from both ends.

use crate::common::statistics::{SUITE, assert_like_path, assert_unlike_path};
use crate::common::{ball, built, diffuse, effort, floor, integrator, look, put, shoot, sky};
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::texture::{Filter, Image, Texels};
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec, Texture, Value};
use bilux_transport::{RenderSettings, Window};
use std::sync::Arc;

/// A floor over which a texture repeats this often.
fn tiled(half: f32, tiles: f32) -> Arc<Mesh> {
    let mut mesh = (*floor(0.0, half)).clone();
    mesh.uvs = [Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X].map(|uv| uv * tiles).to_vec();
    Arc::new(mesh)
}

/// A checkerboard of black and white squares, two texels wide.
fn board(side: usize) -> Texture {
    let texel = |i: usize| [((i / 2 + i / side / 2) % 2 * 255) as u8; 3];
    let texels = (0..side * side).map(|i| [texel(i)[0], texel(i)[1], texel(i)[2], 255]).collect();
    Texture::of("board", Arc::new(Image { width: side, height: side, texels: Texels::Bytes(texels) }), false)
}

fn far_floor(texture: Texture) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", tiled(40.0, 40.0), diffuse(Value::Texture(0)));
    builder.textures.push(Arc::new(texture));
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 0.0, -12.0), 30.0);
    builder
}

/// The scene with unfiltered textures, and with textures filtered for a picture of this many rows.
fn both(builder: &SceneBuilder, rows: u32) -> [Scene; 2] {
    let camera = built(builder).cameras()[0].1.clone();
    [built(builder), built(builder).filtered(camera, rows)]
}

fn pixels(scene: &Scene, side: u32, spp: u32) -> Vec<f64> {
    let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(side, side, spp) };
    let film = shoot(scene, &*integrator("path"), &settings).film;
    film.to_rgb().into_iter().map(|pixel| f64::from(pixel.g)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn mean_square(a: &[f64], b: &[f64]) -> f64 {
    mean(&a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).collect::<Vec<_>>())
}

#[test]
fn a_far_board_has_a_third_of_the_noise_at_most_and_the_same_mean() {
    for side in effort(vec![1000], vec![512, 1000]) {
        let [plain, filtered] = both(&far_floor(board(side)), 64);
        let pictures = |spp| [&plain, &filtered].map(|scene| pixels(scene, 64, spp));
        let asked = "noise and means of plain and filtered, their distance, of samples a pixel";
        let numbers = SUITE.numbers(&format!("{side}"), asked, 1024, pictures, |[wanted, found]| {
            let [noise, less] = pictures(1).map(|one| mean_square(&one, wanted));
            vec![noise, less, mean(wanted), mean(found), mean_square(found, wanted).sqrt()]
        });
        let [noise, less, b, a, off] = [0, 1, 2, 3, 4].map(|i| numbers[i]);
        assert!(less < noise / 3.0, "{less} beside {noise}");
        assert!((a / b - 1.0).abs() < 0.01, "{a}, not {b}");
        // With many samples the picture is the same, pixel by pixel.
        assert!(off < 0.02 * b, "{off} of {b}");
    }
}

#[test]
fn a_surface_that_is_near_is_the_same_to_the_bit() {
    // Texels are wider than a quarter of a pixel everywhere; textures without interpolation, and cut-outs, have no
    // levels.
    let cut = Texture { threshold: Some(0.5), ..board(512) };
    let nearest = Texture { filter: Filter::Nearest, ..board(512) };
    for texture in [board(16), nearest, cut] {
        let [plain, filtered] = both(&far_floor(texture), 4096);
        assert_eq!(pixels(&plain, 24, 4), pixels(&filtered, 24, 4));
    }
}

/// Squared noise in every texel.
fn noise(seed: u64, number: impl Fn(f32) -> f32, is_data: bool) -> Arc<Texture> {
    let noise = |i: usize| unit_f32(hash_words([seed, i as u64]) as u32);
    let texel = |i: usize| Rgb::grey(number(noise(i) * noise(i)));
    Arc::new(Texture::new("", 64, 64, (0..64 * 64).map(texel).collect(), is_data))
}

/// A floor and a ball with textures far finer than a pixel: the base is light where the coat is dark, and dark where it
/// is clear, so that the width of the filter shows in the mean; their roughness varies as finely.
fn fine_noise() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    builder.textures.push(noise(1, |x| x, false));
    builder.textures.push(noise(1, |x| 1.0 - x, false));
    builder.textures.push(noise(2, |x| 0.2 + 0.8 * x, true));
    let material = Spec::new("", "principled")
        .with("base_color", Value::Texture(0))
        .with("coat_weight", 1.0f32)
        .with("coat_color", Value::Texture(1))
        .with("coat_roughness", 0.5f32)
        .with("specular_roughness", Value::Texture(2));
    put(&mut builder, "floor", tiled(3.0, 40.0), material.clone());
    let mut round = (*ball(Vec3::new(0.0, 0.8, 0.0), 0.8, 12, true)).clone();
    round.uvs = round.positions.iter().map(|p| Vec2::new(p.x + 0.3 * p.y, p.z - p.y) * 7.0).collect();
    put(&mut builder, "ball", Arc::new(round), material);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    builder.lights.push(panel);
    look(&mut builder, Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0), 40.0);
    builder
}

#[test]
fn filtered_textures_look_the_same_from_both_ends() {
    let [_, filtered] = both(&fine_noise(), 16);
    assert_like_path("fine noise", &filtered, &["light", "bdpt", "vcm", "auto"]);
}

/// A planted bug: a footprint as seen from the light, where a light subpath comes from.
#[test]
fn a_footprint_that_depends_on_the_path_is_detected() {
    let builder = fine_noise();
    let [_, right] = both(&builder, 16);
    let mut from_light = builder.clone();
    from_light.cameras.clear();
    look(&mut from_light, Vec3::new(-0.5, 2.5, 0.0), Vec3::new(-0.4, 0.0, 0.1), 1.0);
    let light = built(&from_light).cameras()[0].1.clone();
    let wrong = built(&builder).filtered(light, 16);
    assert_unlike_path(&right, &wrong, &["light", "bdpt", "vcm"]);
}

#[test]
fn filtered_pictures_are_the_same_whatever_threads_and_crops() {
    let [_, scene] = both(&far_floor(board(512)), 40);
    let film = |settings: RenderSettings| shoot(&scene, &*integrator("path"), &settings).film;
    let whole = RenderSettings { threads: 2, ..RenderSettings::new(40, 40, 4) };
    let window = Window { x: 7, y: 11, width: 20, height: 9 };
    let part = film(RenderSettings { crop: Some(window), threads: 1, ..whole.clone() });
    let whole = film(whole);
    for i in 0..window.pixels() {
        let (x, y) = window.position(i);
        assert_eq!(whole.pixel(x, y), part.pixel(x, y));
    }
}

#[test]
fn pictures_on_moving_and_repeated_objects_are_as_coarse_as_on_those_that_stand_still() {
    let mut builder = far_floor(board(512));
    let [_, still] = both(&builder, 32);
    builder.objects[0].instanced = true;
    let [_, instanced] = both(&builder, 32);
    let (a, b) = (pixels(&still, 32, 4), pixels(&instanced, 32, 4));
    assert!(mean_square(&a, &b).sqrt() < 1e-3 * mean(&a), "{}", mean_square(&a, &b));
}
