//! Features of surfaces for denoisers and compositors, where they are known without rendering.

use crate::common::labelled::Labelled;
use crate::common::{built, diffuse, floor, integrator, look, put, quad, still_life};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{SceneBuilder, Spec};
use bilux_transport::{Features, RenderSettings, Silent, Window, features};

fn seen(builder: &SceneBuilder, settings: &RenderSettings) -> Features {
    let scene = built(builder);
    let camera = &*scene.cameras()[0].1;
    features(&scene, camera, &*integrator("path"), settings, None, &Silent).unwrap().unwrap()
}

const RED: Rgb = Rgb { r: 0.7, g: 0.2, b: 0.1 };

/// A red floor from 2 metres above.
fn from_above() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 10.0), diffuse(RED));
    look(&mut builder, Vec3::new(0.0, 2.0, 0.001), Vec3::ZERO, 40.0);
    builder
}

fn near(a: Rgb, b: Rgb) -> bool {
    (a - b).to_array().into_iter().all(|c| c.abs() < 1e-5)
}

#[test]
fn features_of_a_floor_are_exact() {
    let found = seen(&from_above(), &RenderSettings::new(33, 33, 8));
    let middle = 33 * 16 + 16;
    assert!(found.albedo.iter().all(|&albedo| near(albedo, RED)));
    let labels = Labelled::of(&built(&from_above()), &RenderSettings::new(33, 33, 8));
    assert!(labels.normal.iter().all(|n| n.distance(Vec3::Y) < 1e-4));
    assert!((labels.depth[middle] - 2.0).abs() < 1e-3, "{}", labels.depth[middle]);
    // Depth is measured along the rays, and z-depth straight down.
    assert!(labels.depth[0] > 2.2 && labels.z_depth.iter().all(|z| (z - 2.0).abs() < 1e-3));
    assert!(labels.camera_normal.iter().all(|n| n.distance(Vec3::Z) < 1e-3));
    assert!(labels.object.iter().chain(&labels.material).all(|&id| id == 1));
}

/// The mirror is tilted by 45° and shows the ceiling; the sky is around it.
#[test]
fn mirrors_show_what_is_seen_in_them() {
    let mut builder = SceneBuilder::default();
    let mirror = Spec::new("", "mirror").with("reflectance", 0.5f32);
    put(
        &mut builder,
        "mirror",
        quad(Vec3::new(-1.0, -1.0, -1.0), Vec3::X * 2.0, Vec3::new(0.0, 2.0, -2.0)),
        mirror,
    );
    put(
        &mut builder,
        "ceiling",
        quad(Vec3::new(-9.0, 5.0, -9.0), Vec3::X * 18.0, Vec3::Z * 18.0),
        diffuse(RED),
    );
    builder.lights.push(Spec::new("sky", "environment").with("radiance", Rgb::new(0.25, 3.0, 0.5)));
    look(&mut builder, Vec3::new(0.0, 0.0, 6.0), Vec3::new(0.0, 0.0, -2.0), 40.0);
    let found = seen(&builder, &RenderSettings::new(33, 33, 8));
    let middle = 33 * 16 + 16;
    assert!(near(found.albedo[middle], RED * 0.5), "{:?}", found.albedo[middle]);
    assert!(found.mean_normal[middle].distance(Vec3::NEG_Y) < 1e-4, "{}", found.mean_normal[middle]);
    // The labels are those of the mirror itself.
    let labels = Labelled::of(&built(&builder), &RenderSettings::new(33, 33, 8));
    let normal = Vec3::new(0.0, 1.0, 1.0).normalize();
    assert!(labels.normal[middle].distance(normal) < 1e-4, "{}", labels.normal[middle]);
    assert!((labels.depth[middle] - 8.0).abs() < 0.1, "{}", labels.depth[middle]);
    assert_eq!((labels.object[middle], labels.material[middle]), (1, 1));
    // Sky: its emission, at most 1; no depth and no id.
    assert!(near(found.albedo[33 * 16], Rgb::new(0.25, 1.0, 0.5)));
    assert_eq!((labels.normal[33 * 16], labels.object[33 * 16]), (Vec3::ZERO, 0));
    assert_eq!((labels.depth[33 * 16], labels.z_depth[33 * 16]), (f32::INFINITY, f32::INFINITY));
}

/// A picture of one sample knows its edges as well as others do: denoisers rebuild them from the features.
#[test]
fn few_samples_have_the_features_of_many() {
    let builder = still_life();
    let [one, many] = [1, 64].map(|spp| seen(&builder, &RenderSettings::new(40, 30, spp)));
    assert!(one == many);
}

#[test]
fn features_do_not_depend_on_threads_crop_or_range() {
    let builder = still_life();
    let base = RenderSettings::new(40, 30, 8);
    let all = seen(&builder, &RenderSettings { threads: 1, ..base.clone() });
    assert_eq!(seen(&builder, &RenderSettings { threads: 3, ..base.clone() }), all);
    assert_eq!(seen(&builder, &RenderSettings { samples: 3..5, ..base.clone() }), all);
    let crop = Window { x: 7, y: 5, width: 20, height: 11 };
    let part = seen(&builder, &RenderSettings { crop: Some(crop), ..base });
    for i in 0..crop.pixels() {
        let (x, y) = crop.position(i);
        let whole = (y * 40 + x) as usize;
        assert_eq!((part.albedo[i], part.mean_normal[i]), (all.albedo[whole], all.mean_normal[whole]));
    }
}

/// Beside nothing, the guides of a cut-out are those of what covers a part of the pixel: a normal of unit length, and the whole
/// albedo. Elsewhere they are means over all samples.
#[test]
fn guides_of_a_cut_out_are_those_of_what_is_there() {
    let mut builder = SceneBuilder::default();
    let card = quad(Vec3::new(-0.52, -0.53, 0.0), Vec3::X * 1.03, Vec3::Y * 1.07);
    put(&mut builder, "card", card, diffuse(RED));
    look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 40.0);
    let found = seen(&builder, &RenderSettings::new(16, 16, 8));
    let [cut_out, whole] = [true, false].map(|is_cut_out| found.guides(is_cut_out, 0..256));
    let parts = found.coverage.iter().filter(|coverage| (0.1..0.9).contains(*coverage));
    assert!(parts.count() > 8, "{:?}", found.coverage);
    for (i, coverage) in found.coverage.iter().enumerate().filter(|(_, coverage)| **coverage > 0.0) {
        let normals = [&cut_out, &whole].map(|(_, normals)| Vec3::from(normals[i]));
        assert!(near(cut_out.0[i], RED) && near(whole.0[i], RED * *coverage), "{i}: {coverage}");
        assert!(normals[0].distance(Vec3::Z) < 1e-4, "{i}: {}", normals[0]);
        assert!(normals[1].distance(Vec3::Z * *coverage) < 1e-4, "{i}: {}", normals[1]);
    }
}
