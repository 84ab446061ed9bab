//! Light below the surface of `principled`: a body has the colour that was asked for, and the same one from both ends.

use crate::common::statistics::{assert_like_path, assert_unlike_path, recorded_means};
use crate::common::{ball, built, effort, integrator, put, quad, sky, without_mirrors};
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::media::slab::{Slab, absorbed_fraction};
use bilux_scene::mesh::shapes::cuboid;
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec, Texture, Value};
use bilux_transport::RenderSettings;
use std::sync::Arc;

/// A body that lets all light in, with this mean free path.
fn body(colour: impl Into<Value>, radius: f32) -> Spec {
    Spec::new("", "principled")
        .with("subsurface_weight", 1.0f32)
        .with("subsurface_color", colour)
        .with("subsurface_radius", radius)
        .with("specular_roughness", 0.0f32)
}

/// Looks straight down at a body under an even sky, by parallel rays through a window of this width.
fn from_above(mesh: Arc<Mesh>, material: Spec, at: Vec3, window: f32) -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "body", mesh, material);
    sky(&mut builder, 1.0);
    above(&mut builder, at, window);
    built(&builder)
}

fn above(builder: &mut SceneBuilder, at: Vec3, window: f32) {
    let camera = Spec::new("", "orthographic").with("position", at + Vec3::Y * 3.0).with("look_at", at);
    let camera = camera.with("up", Vec3::Z).with("height", window);
    builder.cameras = vec![CameraSpec { spec: camera, keyframes: Vec::new() }];
}

fn slab(depth: f32) -> Arc<Mesh> {
    Arc::new(cuboid(Aabb { min: Vec3::new(-2.0, -depth, -2.0), max: Vec3::new(2.0, 0.0, 2.0) }))
}

/// The means and standard errors of the channels of a picture.
fn means(what: &str, scene: &Scene, name: &str, spp: u32) -> [(f64, f64); 3] {
    recorded_means(what, scene, &*integrator(name), &RenderSettings::new(32, 32, spp))
}

/// Light that a surface of index 1.5 reflects at once.
const SPECULAR: f64 = 0.04;

/// A body has its colour also where light goes nearly straight on at each event, so that it comes far: in a body that is deep and wide
/// enough, which a box of a few metres is not.
#[test]
fn a_deep_body_that_scatters_forwards_has_its_colour() {
    let colour = Rgb::new(0.8, 0.5, 0.2);
    let mesh = cuboid(Aabb { min: Vec3::new(-60.0, -60.0, -60.0), max: Vec3::new(60.0, 0.0, 60.0) });
    // In the short form the greater index, by which light is kept inside longer.
    for ior in effort(vec![2.0f32], vec![1.5, 2.0]) {
        let material = body(colour, 0.005).with("subsurface_scatter_anisotropy", 0.95f32);
        let scene = from_above(Arc::new(mesh.clone()), material.with("specular_ior", ior), Vec3::ZERO, 0.5);
        let amplitude = (f64::from(ior) - 1.0) / (f64::from(ior) + 1.0);
        let specular = amplitude * amplitude;
        let found = means(&format!("forwards, index {ior}"), &scene, "path", effort(5, 100));
        for (c, (mean, error)) in found.into_iter().enumerate() {
            let wanted = specular + (1.0 - specular) * f64::from(colour[c]);
            let off = (mean - wanted).abs();
            assert!(off < 3.5 * error + 3e-3, "{ior}, channel {c}: {mean} ± {error}, not {wanted}");
        }
    }
}

/// By reciprocity, a body seen straight on under an even sky is as bright as it reflects light that comes straight on, and as it passes
/// such light: a hundred mean free paths of red, which scatters forwards, still pass 2%. [OpenPBR 1.1]
#[test]
fn a_thick_body_has_its_colour() {
    let colour = Rgb::new(0.8, 0.5, 0.2);
    // Of red, green and blue, which go less far.
    let thickness = [100.0, 200.0, 400.0];
    for (anisotropy, spp) in [(0.0f32, effort(24, 400)), (0.6, effort(24, 400))] {
        let material = body(colour, 0.01).with("subsurface_scatter_anisotropy", anisotropy);
        let scene = from_above(slab(1.0), material, Vec3::ZERO, 0.5);
        for (c, (mean, error)) in
            means(&format!("anisotropy {anisotropy}"), &scene, "path", spp).into_iter().enumerate()
        {
            let (colour, g) = (f64::from(colour[c]), f64::from(anisotropy));
            let absorbed = absorbed_fraction(colour, g, 1.5);
            let slab = Slab { absorbed, thickness: thickness[c], anisotropy: g, eta: 1.5 }.light(24);
            let wanted = slab.at_surface + slab.from_inside + slab.passed;
            let deep = SPECULAR + (1.0 - SPECULAR) * colour;
            assert!((wanted - deep).abs() < if g > 0.0 && c == 0 { 0.025 } else { 2e-3 }, "{wanted}, {deep}");
            assert!(error < 6e-3, "{error}");
            assert!(
                (mean - wanted).abs() < 3.5 * error + 1.5e-3,
                "{anisotropy}, channel {c}: {mean} ± {error}, not {wanted}"
            );
        }
    }
}

/// The index that is left of the boundary where it reflects less is that of the colour too.
#[test]
fn a_body_without_highlights_has_its_colour() {
    let scene = from_above(slab(1.0), body(0.6f32, 0.01).with("specular_weight", 0.0f32), Vec3::ZERO, 0.5);
    let (mean, error) = means("body", &scene, "path", effort(16, 200))[1];
    assert!(error < 5e-3 && (mean - 0.6).abs() < 3.5 * error + 1.5e-3, "{mean} ± {error}");
}

/// A thin body under the same sky, against adding and doubling.
#[test]
fn a_thin_body_shines_as_a_slab_does() {
    let (radius, depth, anisotropy) = (0.01f32, 0.02f32, 0.3f32);
    let material = body(0.7f32, radius).with("subsurface_scatter_anisotropy", anisotropy);
    let material = material.with("subsurface_radius_scale", Rgb::WHITE);
    let scene = from_above(slab(depth), material, Vec3::ZERO, 0.5);
    let absorbed = absorbed_fraction(0.7, f64::from(anisotropy), 1.5);
    let slab =
        Slab { absorbed, thickness: f64::from(depth / radius), anisotropy: anisotropy.into(), eta: 1.5 };
    let light = slab.light(24);
    let wanted = light.at_surface + light.from_inside + light.passed;
    let (mean, error) = means("body", &scene, "path", effort(16, 200))[1];
    assert!(error < 4e-3 && (mean - wanted).abs() < 3.5 * error + 1e-3, "{mean} ± {error}, not {wanted}");
}

/// A body that neither absorbs nor is coloured vanishes in a furnace, whatever it is mixed with.
#[test]
fn a_white_body_vanishes_in_a_furnace() {
    let mixed = body(1.0f32, 0.3)
        .with("subsurface_weight", 0.6f32)
        .with("base_color", 1.0f32)
        .with("specular_roughness", 0.3f32)
        .with("transmission_weight", 0.3f32);
    for (i, material) in [body(1.0f32, 0.1), mixed].into_iter().enumerate() {
        let scene = from_above(ball(Vec3::ZERO, 1.0, 12, false), material, Vec3::ZERO, 1.2);
        for name in ["path", "bdpt"] {
            for (mean, error) in means(&format!("{i}, {name}"), &scene, name, effort(6, 100)) {
                // The rough boundary loses a little, as glass does.
                let lost = if i == 1 { 0.03 } else { 2e-3 };
                assert!(
                    mean < 1.0 + 3.5 * error + 1e-3 && mean > 1.0 - 3.5 * error - lost,
                    "{i}, {name}: {mean} ± {error}"
                );
            }
        }
    }
}

/// Wax beside skin, with a texture, rough, below a coat.
fn still_life(wax: Spec) -> SceneBuilder {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let mut builder = without_mirrors(panel);
    let texels = (0..16)
        .map(|i| if (i % 4 + i / 4) % 2 == 0 { Rgb::new(0.8, 0.5, 0.3) } else { Rgb::new(0.3, 0.5, 0.6) });
    builder.textures.push(Arc::new(Texture::new("", 4, 4, texels.collect(), true)));
    let texture = builder.textures.len() - 1;
    let skin =
        body(Value::Texture(texture), 0.05).with("specular_roughness", 0.4f32).with("coat_weight", 0.3f32);
    put(&mut builder, "wax", ball(Vec3::new(0.0, 0.5, 1.6), 0.5, 10, true), wax);
    let mut board = cuboid(Aabb { min: Vec3::new(-1.8, 0.0, 1.0), max: Vec3::new(-1.2, 0.9, 1.3) });
    board.uvs = board.positions.iter().map(|p| Vec2::new(p.x, p.y) * 3.0).collect();
    put(&mut builder, "skin", Arc::new(board), skin);
    builder
}

#[test]
fn bodies_look_the_same_from_both_ends() {
    let wax = |scale: f32| body(Rgb::new(0.8, 0.7, 0.4), 0.1 * scale).with("specular_roughness", 0.4f32);
    let right = built(&still_life(wax(1.0)));
    assert_like_path("wax and skin", &right, effort(&["bdpt", "vcm"][..], &["bdpt", "vcm", "light"]));
    assert_unlike_path(&right, &built(&still_life(wax(10.0))), &["path"]);
}

/// Each place of a body has its own colour, where the colour varies.
#[test]
fn a_textured_body_has_the_colour_of_each_place() {
    let colours = [Rgb::new(0.8, 0.6, 0.4), Rgb::new(0.4, 0.6, 0.2)];
    for (side, wanted) in [(-1.0, colours[0]), (1.0, colours[1])] {
        let mut mesh = (*slab(1.0)).clone();
        mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(0.5 + 0.25 * p.x, 0.5)).collect();
        let texels = (0..8).map(|i| colours[i / 4]).collect();
        let mut builder = SceneBuilder::default();
        builder.textures.push(Arc::new(Texture::new("", 8, 1, texels, true)));
        put(&mut builder, "body", Arc::new(mesh), body(Value::Texture(0), 0.005));
        sky(&mut builder, 1.0);
        above(&mut builder, Vec3::X * side, 0.2);
        let scene = built(&builder);
        for (c, (mean, error)) in
            means(&format!("side {side}"), &scene, "path", effort(24, 300)).into_iter().enumerate()
        {
            let wanted = SPECULAR + (1.0 - SPECULAR) * f64::from(wanted[c]);
            assert!(
                (mean - wanted).abs() < 3.5 * error + 4e-3,
                "{side}, channel {c}: {mean} ± {error}, not {wanted}"
            );
        }
    }
}

/// A thin wall reflects and transmits at once, in the parts that the mean cosine says.
#[test]
fn thin_walls_reflect_and_transmit() {
    for (anisotropy, passed) in [(-1.0f32, 0.0), (0.0, 0.5), (0.6, 0.8)] {
        let material = body(0.5f32, 1.0)
            .with("thin_walled", true)
            .with("specular_ior", 1.0f32)
            .with("subsurface_scatter_anisotropy", anisotropy);
        let mut builder = SceneBuilder::default();
        let sheet = quad(Vec3::new(-9.0, 0.0, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
        put(&mut builder, "sheet", sheet, material);
        let panel = quad(Vec3::new(-9.0, -0.05, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
        let glow = Spec::new("", "diffuse").with("reflectance", 0.0f32).with("emission", 1.0f32);
        put(&mut builder, "panel", panel, glow);
        above(&mut builder, Vec3::ZERO, 0.5);
        let (mean, error) = means(&format!("anisotropy {anisotropy}"), &built(&builder), "path", 16)[1];
        assert!((mean - 0.5 * passed).abs() < 3.5 * error + 2e-3, "{anisotropy}: {mean} ± {error}");
    }
}

/// Without a mean free path a body is a diffuse surface of its colour.
#[test]
fn a_dense_body_is_a_diffuse_surface() {
    let dense =
        Spec::new("", "principled").with("subsurface_weight", 1.0f32).with("subsurface_color", 0.7f32);
    let dense = dense.with("subsurface_radius", 0.0f32);
    let plain = Spec::new("", "principled").with("base_color", 0.7f32);
    let mean = |what, material| means(what, &from_above(slab(1.0), material, Vec3::ZERO, 0.5), "path", 64)[1];
    let ((a, error_a), (b, error_b)) = (mean("dense", dense), mean("plain", plain));
    assert!((a - b).abs() < 3.5 * (error_a + error_b) + 1e-4, "{a} {b}");
}

/// Extinction and scattering of a clear inside, and what is absorbed at least. [OpenPBR 1.1]
#[test]
fn murky_glass_scatters_what_it_says() {
    let material = Spec::new("", "principled")
        .with("transmission_weight", 1.0f32)
        .with("transmission_depth", 2.0f32)
        .with("transmission_color", Rgb::new(0.2, 0.5, 0.9))
        .with("transmission_scatter", Rgb::new(0.4, 0.4, 0.5))
        .with("transmission_scatter_anisotropy", 0.25f32);
    let scene = from_above(slab(1.0), material, Vec3::ZERO, 1.0);
    let medium = scene.material_of(0).medium().unwrap();
    // -ln T / 2 is (.80472, .34657, .05268); the blue one is below .25, so all absorb by .19732 more.
    let [a, s] = [medium.sigma_a, medium.sigma_s];
    for (found, wanted) in [(s, [0.2, 0.2, 0.25]), (a, [0.80204, 0.34389, 0.0])] {
        for c in 0..3 {
            assert!((found[c] - wanted[c]).abs() < 2e-5, "{found:?}, not {wanted:?}");
        }
    }
    assert_eq!(medium.phase.mean_cosine(), 0.25);
}
