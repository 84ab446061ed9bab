//! Photons at points of dense media: behind smooth boundaries nothing else finds small lamps.

use crate::common::statistics::{assert_like_path, assert_unlike_path, recorded_means};
use crate::common::{ball, built, diffuse, effort, floor, look, put, sky};
use bilux_math::Vec3;
use bilux_scene::{SceneBuilder, Spec};
use bilux_transport::{RenderSettings, integrators};

/// A ball of wax on a floor.
fn wax(lamp: Spec, absorption: f32) -> SceneBuilder {
    let mut builder = SceneBuilder { lights: vec![lamp], ..SceneBuilder::default() };
    let wax = Spec::new("", "dielectric").with("eta", 1.4f32);
    let wax = wax.with("scattering", 25.0f32).with("absorption", absorption);
    put(&mut builder, "wax", ball(Vec3::Y, 1.0, 16, true), wax.with("scattering_anisotropy", 0.3f32));
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
    look(&mut builder, Vec3::new(0.0, 2.0, 4.0), Vec3::Y, 38.0);
    builder
}

/// Lamps that walks out of the wax happen to hit.
#[test]
fn wax_looks_the_same_whether_photons_are_merged_in_it_or_not() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-2.0, 3.0, -2.0)).with("intensity", 5.0f32);
    let panel = panel.with("edge_u", Vec3::X * 4.0).with("edge_v", Vec3::Z * 4.0);
    let right = built(&wax(panel.clone(), 0.2));
    assert_like_path("wax", &right, effort(&["vcm"][..], &["vcm", "auto"]));
    assert_unlike_path(&right, &built(&wax(panel, 2.0)), &["vcm"]);
}

/// Wax that absorbs nothing is as bright as what surrounds it, though balls reach beyond the wax.
#[test]
fn white_wax_vanishes_in_a_furnace_by_photons() {
    let mut builder = SceneBuilder::default();
    let white = Spec::new("", "dielectric").with("eta", 1.4f32).with("scattering", 25.0f32);
    put(&mut builder, "wax", ball(Vec3::ZERO, 1.0, 16, true), white);
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 20.0);
    let scene = built(&builder);
    // Balls of half a mean free path, without connections that share the work.
    let spec = Spec::new("", "vcm").with("radius", 0.04f32).with("connections", false);
    let settings = RenderSettings { max_depth: 500, ..RenderSettings::new(32, 32, effort(16, 256)) };
    let (mean, error) =
        recorded_means("white wax", &scene, &*integrators::build(&spec).unwrap(), &settings)[1];
    // Pixels share photons, so their scatter says too little. Balls that count what is beyond the wax lose a twentieth.
    assert!((mean - 1.0).abs() < 0.015 && error < 0.01, "{mean} ± {error}");
}
