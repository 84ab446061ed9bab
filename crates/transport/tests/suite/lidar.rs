//! Laser scans against closed forms: plates, spheres, mirrors, glass, edges of plates, and things that move.

use crate::common::{along, ball, built, diffuse, moving, put, quad, still_life};
use bilux_math::Vec3;
use bilux_math::transcendental::{cos, sin};
use bilux_scene::{AccelChoice, SceneBuilder, Spec};
use bilux_transport::lidar::{Keep, Pulse, Return, Scanner, scan};
use std::f64::consts::PI;

fn scanner() -> Scanner {
    Scanner {
        channel: 0,
        divergence: 0.0,
        rays: 1,
        range: [0.0, 1e9],
        separation: 0.2,
        threshold: 0.0,
        range_noise: 0.0,
        intensity_noise: 0.0,
        max_events: 8,
        keep: Keep::All,
        seed: 1,
    }
}

fn pulse(origin: Vec3, direction: Vec3) -> Pulse {
    Pulse { origin, direction: direction.normalize(), time: 0.0 }
}

fn shot(builder: &SceneBuilder, scanner: &Scanner, pulse: Pulse) -> Vec<Return> {
    scan(&built(builder), &[pulse], scanner)
}

fn is_near(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 2e-5
}

/// A plate through `centre`, across `normal`.
fn plate(centre: Vec3, normal: Vec3, half: f32) -> std::sync::Arc<bilux_scene::Mesh> {
    let u = normal.any_orthonormal_vector() * 2.0 * half;
    let v = normal.cross(u);
    quad(centre - 0.5 * (u + v), u, v)
}

/// Compares a matt plate at distances and angles with ρ cosθ / (π r²).
fn check_plates(measure: impl Fn(Return) -> Return) -> Result<(), String> {
    for distance in [0.5f32, 7.0, 120.0] {
        for degrees in [0.0f32, 35.0, 70.0] {
            let mut builder = SceneBuilder::default();
            let tilt = degrees.to_radians();
            let normal = Vec3::new(sin(tilt), 0.0, cos(tilt));
            let mesh = plate(Vec3::new(0.0, 0.0, -distance), normal, 50.0);
            put(&mut builder, "plate", mesh, diffuse(0.5f32));
            let found = shot(&builder, &scanner(), pulse(Vec3::ZERO, -Vec3::Z));
            let [one] = found[..] else { return Err(format!("{} returns", found.len())) };
            let one = measure(one);
            let (distance, cos) = (f64::from(distance), f64::from(cos(tilt)));
            let intensity = 0.5 * cos / (PI * distance * distance);
            if !is_near(one.range, distance) || !is_near(one.intensity, intensity) {
                return Err(format!("{one:?}, expected {distance} m and {intensity}"));
            }
        }
    }
    Ok(())
}

#[test]
fn a_matt_plate_echoes_by_cosine_and_inverse_square() {
    check_plates(|one| one).unwrap();
    // Planted bugs.
    let without_square = |one: Return| Return { intensity: one.intensity * one.range, ..one };
    let there_and_back = |one: Return| Return { range: 2.0 * one.range, ..one };
    let albedo_alone = |one: Return| Return { intensity: one.intensity * PI, ..one };
    assert!(check_plates(without_square).is_err());
    assert!(check_plates(there_and_back).is_err());
    assert!(check_plates(albedo_alone).is_err());
}

#[test]
fn spheres_are_where_they_are() {
    let mut builder = SceneBuilder::default();
    let (centre, radius) = (Vec3::new(0.5, 0.2, -9.0), 1.5f32);
    put(&mut builder, "ball", ball(centre, radius, 400, false), diffuse(0.8f32));
    let scene = built(&builder);
    let directions = (0..200).map(|i| Vec3::new((i % 20) as f32 * 0.02 - 0.15, (i / 20) as f32 * 0.03, -1.0));
    let pulses: Vec<Pulse> = directions.map(|direction| pulse(Vec3::ZERO, direction)).collect();
    let found = scan(&scene, &pulses, &scanner());
    let mut hit = 0;
    for (i, pulse) in pulses.iter().enumerate() {
        let (towards, c) = (centre.dot(pulse.direction), centre.length_squared() - radius * radius);
        let within = towards * towards - c;
        // Triangles are as much as 5e-5 m inside; grazing rays may miss them.
        if within.abs() < 0.02 {
            continue;
        }
        let one = found.iter().find(|one| one.pulse == i);
        assert_eq!(one.is_some(), within > 0.0, "{pulse:?}");
        if let Some(one) = one {
            assert!((one.range - f64::from(towards - within.sqrt())).abs() < 1e-3, "{one:?}");
            hit += 1;
        }
    }
    assert!(hit > 50);
}

#[test]
fn a_corner_of_two_mirrors_shows_what_is_behind_at_its_longer_range() {
    let mut builder = SceneBuilder::default();
    let mirror = || Spec::new("", "mirror").with("reflectance", 0.8f32);
    // A beam along x meets both at 45°, and comes back 2 m further left, towards a plate behind the scanner.
    put(
        &mut builder,
        "one",
        plate(Vec3::new(5.0, 0.0, 1.0), Vec3::new(-1.0, 0.0, -1.0).normalize(), 0.9),
        mirror(),
    );
    put(
        &mut builder,
        "two",
        plate(Vec3::new(5.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 1.0).normalize(), 0.9),
        mirror(),
    );
    put(&mut builder, "plate", plate(Vec3::new(-3.0, 0.0, -1.0), Vec3::X, 0.5), diffuse(0.5f32));
    let found = shot(&builder, &scanner(), pulse(Vec3::new(0.0, 0.0, 1.0), Vec3::X));
    let [one] = found[..] else { panic!("{found:?}") };
    let (length, left) = (5.0 + 2.0 + 8.0, 0.8 * 0.8);
    assert!(is_near(one.range, length) && one.object == 2, "{one:?}");
    assert!(is_near(one.intensity, left * left * 0.5 / (PI * length * length)), "{one:?}");
    // A scanner that follows no mirror misses it.
    let blind = Scanner { max_events: 1, ..scanner() };
    assert!(shot(&builder, &blind, pulse(Vec3::new(0.0, 0.0, 1.0), Vec3::X)).is_empty());
}

#[test]
fn glass_lengthens_the_way_and_weakens_the_echo() {
    let mut builder = SceneBuilder::default();
    let glass = Spec::new("", "dielectric").with("eta", 1.5f32);
    let slab = |z: f32, facing: Vec3| plate(Vec3::new(0.0, 0.0, z), facing, 20.0);
    // Two faces of one closed object would be the same.
    let mut mesh = (*slab(-2.0, Vec3::Z)).clone();
    let back = slab(-2.5, -Vec3::Z);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&back.positions);
    mesh.triangles.extend(back.triangles.iter().map(|corners| corners.map(|i| i + first)));
    put(&mut builder, "slab", mesh.into(), glass);
    put(&mut builder, "plate", plate(Vec3::new(0.0, 0.0, -4.0), Vec3::Z, 20.0), diffuse(0.5f32));
    let near = Scanner { separation: 1e-3, ..scanner() };
    let found = shot(&builder, &near, pulse(Vec3::ZERO, -Vec3::Z));
    let one = found[0];
    let passed: f64 = (1.0 - 0.04) * (1.0 - 0.04);
    let apparent = 3.5 + 0.5 / 1.5;
    assert!(is_near(one.range, 3.5 + 0.5 * 1.5), "{one:?}");
    assert!(is_near(one.intensity, passed * passed * 0.5 / (PI * apparent * apparent)), "{one:?}");
    // After it comes what has gone to and fro in the slab once more.
    assert!(is_near(found[1].range, 3.5 + 1.5 * 1.5), "{found:?}");
}

#[test]
fn a_pane_echoes_what_is_before_and_behind() {
    let mut builder = SceneBuilder::default();
    let pane = Spec::new("", "dielectric").with("eta", 1.5f32).with("thin", true);
    put(
        &mut builder,
        "pane",
        plate(Vec3::new(0.0, 0.0, -3.0), Vec3::new(1.0, 0.0, 1.0).normalize(), 2.0),
        pane,
    );
    put(&mut builder, "behind", plate(Vec3::new(0.0, 0.0, -8.0), Vec3::Z, 2.0), diffuse(0.5f32));
    put(&mut builder, "beside", plate(Vec3::new(4.0, 0.0, -3.0), -Vec3::X, 2.0), diffuse(0.5f32));
    let found = shot(&builder, &scanner(), pulse(Vec3::ZERO, -Vec3::Z));
    let [beside, behind] = found[..] else { panic!("{found:?}") };
    assert!(is_near(beside.range, 7.0) && beside.object == 2 && beside.number == 1);
    assert!(is_near(behind.range, 8.0) && behind.object == 1 && behind.number == 2 && behind.count == 2);
    // What the pane does not reflect it lets through.
    let part = |one: Return| (one.intensity * PI * one.range * one.range / 0.5).sqrt();
    assert!((part(beside) + part(behind) - 1.0).abs() < 1e-4 && part(beside) < 0.2);
    let one = |keep| shot(&builder, &Scanner { keep, ..scanner() }, pulse(Vec3::ZERO, -Vec3::Z))[0].object;
    assert_eq!([Keep::First, Keep::Last, Keep::Strongest].map(one), [2, 1, 1]);
}

#[test]
fn a_wide_pulse_over_an_edge_returns_twice() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "near",
        quad(Vec3::new(0.0, -5.0, -10.0), Vec3::X * 5.0, Vec3::Y * 10.0),
        diffuse(0.5f32),
    );
    put(&mut builder, "far", plate(Vec3::new(0.0, 0.0, -20.0), Vec3::Z, 5.0), diffuse(0.5f32));
    let wide = Scanner { divergence: 2e-3, rays: 1000, ..scanner() };
    let found = shot(&builder, &wide, pulse(Vec3::ZERO, -Vec3::Z));
    let [near, far] = found[..] else { panic!("{found:?}") };
    for (one, distance) in [(near, 10.0), (far, 20.0)] {
        assert!((one.range - distance).abs() < 1e-4, "{one:?}");
        let half = 0.5 * 0.5 / (PI * distance * distance);
        assert!((one.intensity / half - 1.0).abs() < 0.01, "{one:?}");
    }
    let together = shot(&builder, &Scanner { separation: 11.0, ..wide }, pulse(Vec3::ZERO, -Vec3::Z));
    assert!(together.len() == 1 && is_near(together[0].intensity, near.intensity + far.intensity));
    let narrow = Scanner { range: [12.0, 30.0], ..scanner() };
    assert!(shot(&builder, &narrow, pulse(Vec3::ZERO, Vec3::new(0.01, 0.0, -1.0))).is_empty());
    let deaf = Scanner { threshold: 1e-3, ..scanner() };
    assert!(shot(&builder, &deaf, pulse(Vec3::ZERO, Vec3::new(-0.01, 0.0, -1.0))).is_empty());
}

/// A pulse whose two plates are one return is of the one that sends back most of it together, though each ray of the nearer one is a little
/// stronger, and comes first.
#[test]
fn a_return_of_several_objects_is_that_of_most_of_its_light() {
    for (share, object) in [(0.1f32, 1), (0.9, 0)] {
        let mut builder = SceneBuilder::default();
        // The cone is 0.02 m wide there, and the plate ends beside its middle.
        let edge = 0.01 * (1.0 - 2.0 * share);
        let near = quad(Vec3::new(edge, -5.0, -10.0), Vec3::X * 5.0, Vec3::Y * 10.0);
        put(&mut builder, "near", near, diffuse(0.5f32));
        put(&mut builder, "far", plate(Vec3::new(0.0, 0.0, -10.1), Vec3::Z, 5.0), diffuse(0.5f32));
        let wide = Scanner { divergence: 2e-3, rays: 200, ..scanner() };
        let found = shot(&builder, &wide, pulse(Vec3::ZERO, -Vec3::Z));
        assert!(found.len() == 1 && found[0].object == object, "{share}: {found:?}");
    }
}

#[test]
fn each_pulse_meets_things_where_they_are_at_its_time() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "car", plate(Vec3::ZERO, Vec3::Z, 2.0), diffuse(0.5f32));
    builder.objects[0].motion = along(Vec3::new(0.0, 0.0, -30.0), Vec3::new(0.0, 0.0, -10.0));
    let scene = builder.build(&AccelChoice::default(), [0.0, 1.0], 1.0).unwrap();
    let at = |time: f32| Pulse { time, ..pulse(Vec3::ZERO, -Vec3::Z) };
    let pulses: Vec<Pulse> = (0..=10).map(|i| at(i as f32 / 10.0)).collect();
    for (i, one) in scan(&scene, &pulses, &scanner()).iter().enumerate() {
        assert!((one.range - (30.0 - 2.0 * i as f64)).abs() < 1e-4, "{one:?}");
    }
}

#[test]
fn noise_has_its_deviation_and_depends_on_the_seed_and_the_pulse_alone() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "plate", plate(Vec3::new(0.0, 0.0, -10.0), Vec3::Z, 5.0), diffuse(0.5f32));
    let scene = built(&builder);
    let noisy = Scanner { range_noise: 0.02, intensity_noise: 0.1, ..scanner() };
    let pulses = vec![pulse(Vec3::ZERO, -Vec3::Z); 20_000];
    let found = scan(&scene, &pulses, &noisy);
    let deviation = |of: &dyn Fn(&Return) -> f64| {
        (found.iter().map(|one| of(one) * of(one)).sum::<f64>() / found.len() as f64).sqrt()
    };
    // Four standard deviations of the estimate are 2%.
    assert!((deviation(&|one| one.range - 10.0) / 0.02 - 1.0).abs() < 0.02);
    let intensity = 0.5 / (PI * 100.0);
    assert!((deviation(&|one| one.intensity / intensity - 1.0) / 0.1 - 1.0).abs() < 0.02);
    let by_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| scan(&scene, &pulses, &noisy))
    };
    assert!(by_threads(1) == by_threads(3) && by_threads(1) == found);
    assert!(scan(&scene, &pulses, &Scanner { seed: 2, ..noisy }) != found);
}

#[test]
fn whole_scenes_are_scanned_by_every_accelerator_alike() {
    for builder in [still_life(), moving()] {
        let scanned = |name: &str| {
            let choice = AccelChoice { name: name.to_owned(), ..AccelChoice::default() };
            let scene = builder.build(&choice, [0.0, 0.0], 1.0).unwrap();
            let direction =
                |i: i32| Vec3::new((i % 32) as f32 / 32.0 - 0.5, (i / 32) as f32 / 64.0 - 0.4, -1.0);
            let pulses: Vec<Pulse> =
                (0..1024).map(|i| pulse(Vec3::new(0.0, 3.0, 8.0), direction(i))).collect();
            scan(&scene, &pulses, &Scanner { rays: 4, divergence: 3e-3, ..scanner() })
        };
        let brute = scanned("brute");
        assert!(brute.len() > 300);
        assert!(["bvh8", "kd", "bsp"].into_iter().all(|name| scanned(name) == brute));
    }
}
