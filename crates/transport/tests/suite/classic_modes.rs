//! `cast` and `whitted` against Equations 1 to 3, worked out by hand.

use crate::common::{built, diffuse, floor, look, put, quad, shoot};
use bilux_math::transcendental::{cos, exp, powf, sin_cos};
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::mesh::shapes::cuboid;
use bilux_scene::{SceneBuilder, Spec};
use bilux_transport::{RenderSettings, integrators};
use std::sync::Arc;

/// The single pixel that a narrow camera sees, for a given integrator and depth.
fn seen(builder: &SceneBuilder, integrator: &Spec, max_depth: u32) -> Rgb {
    let settings = RenderSettings { max_depth, ..RenderSettings::new(1, 1, 1) };
    shoot(&built(builder), &*integrators::build(integrator).unwrap(), &settings).film.pixel(0, 0)
}

fn whitted() -> Spec {
    Spec::new("", "whitted")
}

fn assert_near(found: Rgb, wanted: Rgb) {
    let off = (found - wanted).map(f32::abs).max_channel();
    assert!(off < 2e-5, "{found:?}, not {wanted:?}");
}

fn light(name: &str, position: Vec3, colour: Rgb) -> Spec {
    Spec::new(name, "point").with("position", position).with("classic", colour)
}

/// A shiny floor under two lights and ambient light, viewed at 45 degrees.
fn shiny_floor() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let phong = Spec::new("", "phong")
        .with("kd", Rgb::new(0.5, 0.3, 0.1))
        .with("ka", 0.2f32)
        .with("ks", 0.4f32)
        .with("exponent", 10.0f32)
        .with("reflectivity", 0.0f32);
    put(&mut builder, "floor", floor(0.0, 5.0), phong);
    builder.lights.push(light("left", Vec3::new(-1.0, 2.0, 0.0), Rgb::new(0.4, 0.5, 0.6)));
    builder.lights.push(light("right", Vec3::new(3.0, 3.0, 0.0), Rgb::grey(0.3)));
    builder.lights.push(light("below", Vec3::new(0.0, -2.0, 0.0), Rgb::WHITE));
    builder.lights.push(Spec::new("", "ambient").with("colour", Rgb::new(0.1, 0.2, 0.3)));
    look(&mut builder, Vec3::new(0.0, 2.0, 2.0), Vec3::ZERO, 0.02);
    builder
}

/// Equation 1 for [`shiny_floor`], written out.
fn equation_1(reflect: bool) -> Rgb {
    let (kd, ka, ks, n) = (Rgb::new(0.5, 0.3, 0.1), 0.2, 0.4, Vec3::Y);
    let eye = Vec3::new(0.0, 1.0, 1.0).normalize();
    let mut sum = Rgb::new(0.1, 0.2, 0.3) * ka;
    let lights =
        [(Vec3::new(-1.0, 2.0, 0.0), Rgb::new(0.4, 0.5, 0.6)), (Vec3::new(3.0, 3.0, 0.0), Rgb::grey(0.3))];
    for (position, colour) in lights {
        let l = position.normalize();
        let cos = if reflect { (n * (2.0 * n.dot(l)) - l).dot(eye) } else { n.dot((l + eye).normalize()) };
        sum += kd * colour * n.dot(l) + colour * (ks * powf(cos, 10.0));
    }
    sum
}

#[test]
fn cast_is_equation_1() {
    let builder = shiny_floor();
    assert_near(seen(&builder, &Spec::new("", "cast"), 16), equation_1(false));
    assert_near(seen(&builder, &Spec::new("", "cast").with("specular", "reflect"), 16), equation_1(true));
    assert_near(seen(&builder, &whitted(), 16), equation_1(false));
}

#[test]
fn depth_0_is_emission_only() {
    for name in ["cast", "whitted", "cook", "path"] {
        assert_eq!(seen(&shiny_floor(), &Spec::new("", name), 0), Rgb::BLACK, "{name}");
        let mut glowing = shiny_floor();
        glowing.materials[0] = diffuse(0.5f32).with("emission", Rgb::new(0.25, 0.5, 0.75));
        assert_near(seen(&glowing, &Spec::new("", name), 0), Rgb::new(0.25, 0.5, 0.75));
    }
}

/// A sheet above the floor, half-way between it and the left light, too far aside for the right one.
fn sheet_before_left() -> SceneBuilder {
    let mut builder = shiny_floor();
    let sheet = quad(Vec3::new(-0.9, 1.0, -0.3), Vec3::X * 0.8, Vec3::Z * 0.6);
    put(&mut builder, "sheet", sheet, diffuse(0.5f32));
    builder.lights.remove(2);
    builder
}

#[test]
fn blocked_lights_are_off_unless_shadows_are() {
    let blocked = seen(&sheet_before_left(), &Spec::new("", "cast"), 16);
    let mut one_light = sheet_before_left();
    one_light.lights.remove(0);
    assert_near(blocked, seen(&one_light, &Spec::new("", "cast"), 16));
    let unshadowed = Spec::new("", "cast").with("shadows", false);
    assert_near(seen(&sheet_before_left(), &unshadowed, 16), equation_1(false));
}

#[test]
fn the_papers_rule_switches_lights_off_only_where_all_are_blocked() {
    let paper = whitted().with("shadow_rule", "paper");
    assert_near(seen(&sheet_before_left(), &paper, 16), equation_1(false));
    let mut both = sheet_before_left();
    put(&mut both, "roof", quad(Vec3::new(0.5, 1.2, -0.3), Vec3::X * 2.0, Vec3::Z * 0.6), diffuse(0.5f32));
    assert_eq!(seen(&both, &paper, 16), Rgb::BLACK);
    assert_near(seen(&both, &whitted(), 16), Rgb::new(0.1, 0.2, 0.3) * 0.2);
}

#[test]
fn an_infinite_viewer_looks_straight_from_the_film() {
    let mut builder = shiny_floor();
    builder.lights.truncate(1);
    let spec = builder.cameras[0].spec.clone().with("fov", 90.0f32);
    builder.cameras[0].spec = spec;
    let settings = RenderSettings::new(9, 9, 1);
    let scene = built(&builder);
    let film = |viewer: &str| {
        let cast = integrators::build(&Spec::new("", "cast").with("viewer", viewer)).unwrap();
        shoot(&scene, &*cast, &settings).film
    };
    let (local, infinite) = (film("local"), film("infinite"));
    assert_near(local.pixel(4, 4), infinite.pixel(4, 4));
    let eye = Vec3::new(0.0, 1.0, 1.0).normalize();
    let tracer = &mut bilux_scene::Tracer::new(&scene, false);
    let sample = bilux_scene::CameraSample {
        film: bilux_math::Vec2::new(2.5 / 9.0, 6.5 / 9.0),
        lens: bilux_math::Vec2::ZERO,
        time: 0.0,
    };
    let p = tracer.closest(&scene.cameras()[0].1.ray(&sample)).unwrap().p;
    let l = (Vec3::new(-1.0, 2.0, 0.0) - p).normalize();
    let cos = Vec3::Y.dot((l + eye).normalize());
    let colour = Rgb::new(0.4, 0.5, 0.6);
    assert_near(
        infinite.pixel(2, 6),
        colour * (Rgb::new(0.5, 0.3, 0.1) * l.y + Rgb::grey(0.4 * powf(cos, 10.0))),
    );
    assert!((local.pixel(2, 6) - infinite.pixel(2, 6)).g.abs() > 1e-3);
}

/// A small patch that emits this colour, around a point, facing along `n`.
fn target(builder: &mut SceneBuilder, at: Vec3, n: Vec3, half: f32, colour: Rgb) {
    let frame = bilux_math::Frame::from_normal(n);
    let (u, v) = (frame.s * half, frame.t * half);
    put(builder, "target", quad(at - u - v, u * 2.0, v * 2.0), diffuse(0.0f32).with("emission", colour));
}

const GLOW: Rgb = Rgb::new(0.9, 0.6, 0.3);

#[test]
fn mirrors_reflect_by_the_law() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "mirror", floor(0.0, 5.0), Spec::new("", "mirror").with("reflectance", 0.5f32));
    look(&mut builder, Vec3::new(0.0, 1.0, 2.0), Vec3::ZERO, 0.02);
    target(&mut builder, Vec3::new(0.0, 1.0, -2.0), Vec3::new(0.0, -1.0, 2.0).normalize(), 1e-3, GLOW);
    assert_near(seen(&builder, &whitted(), 16), GLOW * 0.5);
    assert_near(seen(&builder, &whitted(), 1), GLOW * 0.5);
    assert_eq!(seen(&builder, &whitted(), 0), Rgb::BLACK);
}

/// A block of glass from z = 0 back to z = -`depth`.
fn block(builder: &mut SceneBuilder, depth: f32, glass: Spec) {
    let (half, d) = (4.0, Vec3::NEG_Z * depth);
    let corner = Vec3::new(-half, -half, 0.0);
    let (u, v) = (Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half);
    let material = builder.add_material(glass);
    for mesh in [
        quad(corner, u, v),
        quad(corner + d, v, u),
        quad(corner, v, d),
        quad(corner + u, d, v),
        quad(corner, d, u),
        quad(corner + v, u, d),
    ] {
        builder.objects.push(bilux_scene::Object::new("", mesh, material));
    }
}

fn schlick(cos_outside: f32) -> f32 {
    0.04 + 0.96 * powf(1.0 - cos_outside, 5.0)
}

/// A block of glass viewed at an angle, with a small target where Snell's law sends the view.
fn through_block(degrees: f32, index: f32, material: Spec) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    block(&mut builder, 1.0, material);
    let (sin_1, cos_1) = sin_cos(degrees.to_radians());
    let sin_2 = sin_1 / index;
    let beside = sin_2 / (1.0 - sin_2 * sin_2).sqrt();
    let direction = Vec3::new(sin_1, 0.0, -cos_1);
    look(&mut builder, direction * -3.0, Vec3::ZERO, 0.02);
    let behind = Vec3::new(beside, 0.0, -1.0) + direction * 2.0;
    target(&mut builder, behind, -direction, 1e-3, GLOW);
    builder
}

#[test]
fn glass_refracts_by_snells_law_in_and_out() {
    let glass = || Spec::new("", "dielectric").with("eta", 1.5f32);
    for degrees in [0.0f32, 20.0, 45.0, 70.0] {
        let through = 1.0 - schlick(cos(degrees.to_radians()));
        let found = seen(&through_block(degrees, 1.5, glass()), &whitted(), 2);
        assert_near(found, GLOW * through * through);
        // Negative control: where another index sends the view, there is nothing.
        if degrees > 0.0 {
            assert_eq!(seen(&through_block(degrees, 1.45, glass()), &whitted(), 2), Rgb::BLACK);
        }
    }
}

#[test]
fn thin_walls_bend_nothing_and_reflect_at_both_faces() {
    let thin = Spec::new("", "dielectric").with("thin", true);
    let mut builder = through_block(45.0, 1.0, thin);
    builder.objects.truncate(1);
    let (s, c) = sin_cos(45f32.to_radians());
    target(&mut builder, Vec3::new(s, 0.0, -c) * 3.0, Vec3::new(-s, 0.0, c), 1e-3, GLOW);
    let share = schlick(c);
    assert_near(seen(&builder, &whitted(), 3), GLOW * (1.0 - 2.0 * share / (1.0 + share)));
}

#[test]
fn glass_absorbs_by_its_thickness() {
    let sigma = Rgb::new(0.1, 0.5, 2.0);
    let glass = Spec::new("", "dielectric").with("absorption", sigma);
    let left = sigma.map(|s| exp(-s));
    assert_near(seen(&through_block(0.0, 1.5, glass.clone()), &whitted(), 2), GLOW * left * 0.96 * 0.96);
    // From within the glass, half of the distance remains.
    let mut inside = through_block(0.0, 1.5, glass);
    inside.cameras.clear();
    look(&mut inside, Vec3::new(0.0, 0.0, -0.5), Vec3::new(0.0, 0.0, -3.0), 0.02);
    assert_near(seen(&inside, &whitted(), 2), GLOW * sigma.map(|s| exp(-0.5 * s)) * 0.96);
}

#[test]
fn beyond_the_critical_angle_glass_reflects_all() {
    // A right-angled prism: in by one short side, off the long side at 45 degrees, out by the other.
    let mut builder = SceneBuilder::default();
    let glass = builder.add_material(Spec::new("", "dielectric"));
    let (along, w) = (Vec3::Z * 2.0, 1.0);
    let (a, b, c) = (Vec3::new(-w, -w, -1.0), Vec3::new(w, -w, -1.0), Vec3::new(-w, w, -1.0));
    for mesh in [quad(a, b - a, along), quad(b, c - b, along), quad(c, a - c, along)] {
        builder.objects.push(bilux_scene::Object::new("", mesh, glass));
    }
    look(&mut builder, Vec3::new(-4.0, -0.2, 0.0), Vec3::new(0.0, -0.2, 0.0), 0.02);
    target(&mut builder, Vec3::new(0.2, -3.0, 0.0), Vec3::Y, 1e-3, GLOW);
    assert_near(seen(&builder, &whitted(), 3), GLOW * 0.96 * 0.96);
    assert_near(seen(&builder, &whitted().with("fresnel", "exact"), 3), GLOW * 0.96 * 0.96);
}

#[test]
fn the_specular_sum_is_clamped() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "mirror", floor(0.0, 5.0), Spec::new("", "mirror").with("reflectance", 0.5f32));
    look(&mut builder, Vec3::new(0.0, 1.0, 2.0), Vec3::ZERO, 0.02);
    builder.lights.push(Spec::new("", "environment").with("radiance", 30.0f32));
    assert_near(seen(&builder, &whitted(), 4), Rgb::grey(0.5));
}

#[test]
fn facing_mirrors_end_at_the_greatest_depth() {
    let mut builder = SceneBuilder::default();
    let mirror = || Spec::new("", "mirror").with("reflectance", 1.0f32);
    put(&mut builder, "below", floor(-1.0, 5.0), mirror());
    put(&mut builder, "above", floor(1.0, 5.0), mirror());
    look(&mut builder, Vec3::ZERO, Vec3::new(0.0, -1.0, 1e-5), 0.02);
    assert_eq!(seen(&builder, &whitted().with("cutoff", 0.0f32), 1000), Rgb::BLACK);
}

#[test]
fn tinted_shadows_let_coloured_light_through_glass() {
    let mut builder = shiny_floor();
    builder.lights.truncate(1);
    let open = seen(&builder, &whitted(), 1);
    let tint = Rgb::new(0.5, 0.25, 1.0);
    let pane = Spec::new("", "dielectric").with("thin", true).with("tint", tint);
    put(&mut builder, "pane", quad(Vec3::new(-0.9, 1.0, -0.3), Vec3::X * 0.8, Vec3::Z * 0.6), pane);
    assert_eq!(seen(&builder, &whitted(), 1), Rgb::BLACK);
    assert_near(seen(&builder, &whitted().with("shadows", "tinted"), 1), open * tint);
}

/// Glass takes of the light what Beer's law says of the way through it, in metres: 0.2 m high, of light that comes down by 2 m on 1 m. That of a lamp
/// and that of the sun, from the same direction, are alike.
#[test]
fn tinted_shadows_are_as_deep_as_the_glass_is_thick() {
    let sigma = Rgb::new(0.5, 2.0, 6.0);
    let way = 0.2 * 5f32.sqrt() / 2.0;
    let sun = Spec::new("", "directional").with("direction", Vec3::new(1.0, -2.0, 0.0));
    for sun in [None, Some(sun.with("classic", Rgb::new(0.4, 0.5, 0.6)))] {
        let mut builder = shiny_floor();
        builder.lights.truncate(1);
        builder.lights[0] = sun.unwrap_or_else(|| builder.lights[0].clone());
        let open = seen(&builder, &whitted(), 1);
        assert!(open.max_channel() > 0.05, "{open:?}");
        let body = Aabb { min: Vec3::new(-0.9, 0.9, -0.3), max: Vec3::new(-0.1, 1.1, 0.3) };
        let glass = Spec::new("", "dielectric").with("absorption", sigma);
        put(&mut builder, "body", Arc::new(cuboid(body)), glass);
        let found = seen(&builder, &whitted().with("shadows", "tinted"), 1);
        assert_near(found, open * sigma.map(|sigma| exp(-sigma * way)));
    }
}

#[test]
fn what_the_cutoff_leaves_out_cannot_be_seen() {
    let scene = built(&crate::common::still_life());
    let film = |cutoff: Option<f32>| {
        let spec = cutoff.map_or(whitted(), |c| whitted().with("cutoff", c));
        let settings = RenderSettings { max_depth: 8, ..RenderSettings::new(48, 48, 1) };
        shoot(&scene, &*integrators::build(&spec).unwrap(), &settings)
    };
    let (all, most) = (film(Some(0.0)), film(None));
    assert!(most.counters.rays < all.counters.rays);
    for (a, b) in all.film.to_rgb().into_iter().zip(most.film.to_rgb()) {
        assert!((a - b).map(f32::abs).max_channel() < 1.5 / 255.0, "{a:?} became {b:?}");
    }
}
