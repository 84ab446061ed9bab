//! Ambient occlusion against a known form factor.

use crate::common::{built, diffuse, floor, integrator, look, put, quad, shoot};
use bilux_math::Vec3;
use bilux_scene::{SceneBuilder, Spec};
use bilux_transport::{RenderSettings, integrators};

/// A floor, and at distance 1 from the point (0, 0, 0) an endless wall of height 2.
fn beside_a_wall() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 50.0), diffuse(0.5f32));
    let wall = quad(Vec3::new(1.0, 0.0, -500.0), Vec3::Y * 2.0, Vec3::Z * 1000.0);
    put(&mut builder, "wall", wall, diffuse(0.5f32));
    look(&mut builder, Vec3::new(0.0, 20.0, 0.0), Vec3::ZERO, 0.05);
    builder.cameras[0].spec.parameters.set("up", Vec3::Z);
    builder
}

fn mean(spec: Option<Spec>) -> f64 {
    let scene = built(&beside_a_wall());
    let by = spec.map_or_else(|| integrator("occlusion"), |spec| integrators::build(&spec).unwrap());
    let rendered = shoot(&scene, &*by, &RenderSettings::new(16, 16, 64));
    rendered.film.to_rgb().iter().map(|c| f64::from(c.g)).sum::<f64>() / 256.0
}

#[test]
fn a_wall_closes_its_form_factor() {
    // An endless wall of height h at distance d covers (1 - d/√(d² + h²))/2 of a floor's cosine-weighted sky.
    let open = 1.0 - (1.0 - 1.0 / 5f64.sqrt()) / 2.0;
    let seen = mean(None);
    assert!((seen - open).abs() < 0.01, "{seen} is open, and {open} should be");
}

#[test]
fn surfaces_beyond_the_distance_occlude_nothing() {
    assert_eq!(mean(Some(Spec::new("", "occlusion").with("distance", 0.9f32))), 1.0);
}
