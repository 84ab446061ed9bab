//! Pictures whose light is known in closed form, or by an integral that is computed once more here in f64. Each test
//! would reject a value a few percent off: that is asserted with the same samples.

use bilux_math::transcendental::{acos_f64, asin_f64, cos_f64, exp_f64, sin_f64, tan_f64};
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::mesh::shapes::{cuboid, disc, icosphere, quad};
use bilux_scene::{AccelChoice, CameraSample, Mesh, Object, Scene, SceneBuilder, Spec, Value};
use bilux_testing::effort;
use bilux_transport::{FILTERS, Filter, RenderSettings, Silent, integrators, render};
use bilux_validation::SUITE;
use bilux_validation::statistics::estimate;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// Number of pictures for each mean and its standard error.
const SEEDS: u32 = 16;
/// A p-value below this means an error, not chance.
const UNLIKELY: f64 = 1e-5;
/// The fraction of a mean that rounding may explain.
const ROUNDING: f64 = 5e-4;

fn put(builder: &mut SceneBuilder, mesh: Mesh, material: Spec) {
    let material = builder.add_material(material);
    builder.objects.push(Object::new("", Arc::new(mesh), material));
}

fn diffuse(reflectance: impl Into<Value>) -> Spec {
    Spec::new("", "diffuse").with("reflectance", reflectance)
}

/// A square film with parallel rays from `from` to `at`, `height` metres high.
fn plan(builder: &mut SceneBuilder, from: Vec3, at: Vec3, height: f32) {
    let spec = Spec::new("eye", "orthographic").with("position", from).with("look_at", at);
    let spec = spec.with("up", Vec3::new(0.0, 0.0, -1.0)).with("height", height);
    builder.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
}

fn built(builder: &SceneBuilder) -> Scene {
    builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
}

/// As many pictures with different seeds, each as its pixels.
fn pictures(scene: &Scene, integrator: &Spec, settings: &RenderSettings, count: u32) -> Vec<Vec<Rgb>> {
    let integrator = integrators::build(integrator).unwrap();
    let box_filter = FILTERS.iter().find(|row| row.entry.name == "box").unwrap();
    let of_seed = |seed| {
        let settings = RenderSettings { seed, filter: Filter::new(box_filter), ..settings.clone() };
        let camera = &*scene.cameras()[0].1;
        render(scene, camera, &*integrator, &settings, &Silent).unwrap().film.to_rgb()
    };
    (0..u64::from(count)).map(of_seed).collect()
}

/// Results for `numbers` of all pictures: by the record of this case, where the first picture is as it was.
fn found(
    case: &str,
    asked: &str,
    (scene, integrator, settings): (&Scene, &Spec, &RenderSettings),
    numbers: impl FnOnce(&[Vec<Rgb>]) -> Vec<f64>,
) -> Vec<f64> {
    let render = |count| pictures(scene, integrator, settings, count);
    SUITE.numbers(case, &format!("{asked} of pictures"), SEEDS, render, |pictures| numbers(pictures))
}

/// A mean over all pictures, and its variance.
type Mean = (f64, f64);

/// The mean of each channel.
fn means(case: &str, rendered: (&Scene, &Spec, &RenderSettings)) -> [Mean; 3] {
    let found = found(case, "means and their variances", rendered, |pictures| {
        let of_channel = |channel: usize| {
            let mean = |pixels: &Vec<Rgb>| {
                pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / pixels.len() as f64
            };
            <[f64; 2]>::from(estimate(&pictures.iter().map(mean).collect::<Vec<_>>()))
        };
        (0..3).flat_map(of_channel).collect()
    });
    [0, 1, 2].map(|channel| (found[2 * channel], found[2 * channel + 1]))
}

/// The probability that values whose true mean is `exact` have a mean at least as far from it. [Student 1908]
fn p_value((mean, variance): Mean, exact: f64) -> f64 {
    let off = ((mean - exact).abs() - ROUNDING * exact.abs()).max(0.0);
    if off == 0.0 {
        return 1.0;
    }
    let student = StudentsT::new(0.0, 1.0, f64::from(SEEDS - 1)).unwrap();
    2.0 * student.sf(off / variance.sqrt().max(f64::MIN_POSITIVE))
}

/// The mean is `exact`, and neither 3% more nor less would pass; with photons, whose merging is noisy, neither would
/// 10%.
fn assert_mean(name: &str, found: Mean, exact: f64) {
    let more = if name.contains("sppm") { 0.1 } else { 0.03 };
    let (p, mean) = (p_value(found, exact), found.0);
    assert!(p > UNLIKELY, "{name}: {mean}, not {exact}: p = {p:.1e}");
    for wrong in [1.0 - more, 1.0 + more] {
        let p = p_value(found, exact * wrong);
        assert!(p < UNLIKELY, "{name}: {mean} would pass for {wrong} times {exact}: p = {p:.1e}");
    }
}

fn named(names: &[&'static str]) -> Vec<Spec> {
    names.iter().map(|&name| Spec::new("", name)).collect()
}

/// All integrators that must be right; photons are gathered over discs that are large enough to contain some.
fn all() -> Vec<Spec> {
    let mut integrators = named(&["path", "light", "bdpt", "vcm", "auto"]);
    integrators.push(Spec::new("", "sppm").with("radius", 0.05f32));
    integrators
}

#[test]
fn light_in_a_furnace_sums_to_the_geometric_series() {
    let albedo = Rgb::new(0.2, 0.4, 0.6);
    let mut builder = SceneBuilder::default();
    let glowing = diffuse(albedo).with("emission", Rgb::WHITE);
    let shell = icosphere(Vec3::ZERO, 1.0, 2);
    put(&mut builder, Mesh { normals: Vec::new(), ..shell }, glowing);
    let eye = Spec::new("eye", "perspective").with("position", Vec3::ZERO).with("look_at", -Vec3::Z);
    builder.cameras.push(CameraSpec { spec: eye.with("fov", 90.0f32), keyframes: Vec::new() });
    let scene = built(&builder);
    for integrator in all() {
        let more = if ["light", "sppm"].contains(&integrator.kind.as_str()) { 8 } else { 1 };
        // In the short form, long paths from one end and from both.
        let is_deep = effort(["path", "bdpt"].contains(&integrator.kind.as_str()), true);
        for (depth, spp) in [(2, 16 * more), (20, 16 * more)].into_iter().take(1 + usize::from(is_deep)) {
            let settings = RenderSettings { max_depth: depth, ..RenderSettings::new(16, 16, spp) };
            let name = format!("{} to depth {depth}", integrator.kind);
            let means = means(&name, (&scene, &integrator, &settings));
            for channel in 0..3 {
                let a = f64::from(albedo[channel]);
                let series: f64 =
                    (0..=depth).scan(1.0, |power, _| Some(std::mem::replace(power, *power * a))).sum();
                assert!(depth < 20 || (series - 1.0 / (1.0 - a)).abs() < 1e-3, "{series}");
                assert_mean(&name, means[channel], series);
            }
        }
    }
}

/// The mean of a function over a square of side 1 about `x`, 0 on the floor.
fn mean_over_square(x: f64, of: impl Fn([f64; 2]) -> f64) -> f64 {
    let side = 64;
    let place = |i: usize| (i as f64 + 0.5) / side as f64 - 0.5;
    let sum: f64 = (0..side * side).map(|i| of([x + place(i % side), place(i / side)])).sum();
    sum / (side * side) as f64
}

/// Irradiance of the floor at `[x, z]` from a polygon of radiance 1 that lies entirely above it. [Lambert 1760]
fn by_polygon(corners: &[[f64; 3]], [x, z]: [f64; 2]) -> f64 {
    let unit = |[a, b, c]: [f64; 3]| {
        let to = [a - x, b, c - z];
        let length = to.iter().map(|k| k * k).sum::<f64>().sqrt();
        to.map(|k| k / length)
    };
    let edge = |i: usize| {
        let (a, b) = (unit(corners[i]), unit(corners[(i + 1) % corners.len()]));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let sine = cross.iter().map(|k| k * k).sum::<f64>().sqrt();
        let cosine: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        bilux_math::transcendental::atan2_f64(sine, cosine) * cross[1] / sine
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / 2.0
}

/// Compares the floor under a light, around `x`, as each integrator renders it (in the short form, every other one), with its
/// irradiance.
fn check_direct(turn: usize, name: &str, x: f32, irradiance: f64, add: impl Fn(&mut SceneBuilder)) {
    let mut builder = SceneBuilder::default();
    let middle = Vec3::new(x, 0.0, 0.0);
    put(&mut builder, quad(middle, Vec3::X * 1.5, Vec3::Z * 1.5), diffuse(0.5f32));
    add(&mut builder);
    // Below the light, which the film therefore does not see.
    plan(&mut builder, middle + Vec3::Y * 0.05, middle, 1.0);
    let scene = built(&builder);
    for integrator in all().into_iter().skip(effort(turn % 2, 0)).step_by(effort(2, 1)) {
        let spp = match integrator.kind.as_str() {
            "light" => 1200,
            "sppm" => 256,
            _ => 16,
        };
        let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(16, 16, spp) };
        let name = format!("{name}, {x} m aside, {}", integrator.kind);
        let [_, green, _] = means(&name, (&scene, &integrator, &settings));
        assert_mean(&name, green, 0.5 / PI * irradiance);
    }
}

#[test]
fn a_disc_lights_the_floor_as_lambert_says() {
    const SIDES: u32 = 48;
    let around = |sides: u32, radius: f64, height: f64| -> Vec<[f64; 3]> {
        let angle = |i: u32| TAU * f64::from(i) / f64::from(sides);
        (0..sides).map(|i| [radius * cos_f64(angle(i)), height, radius * sin_f64(angle(i))]).collect()
    };
    // With this many sides it is a disc: E = π r² / (r² + h²).
    let (r, h) = (0.5, 1.2);
    let axis = by_polygon(&around(10_000, r, h), [0.0; 2]);
    assert!((axis / (PI * r * r / (r * r + h * h)) - 1.0).abs() < 1e-6, "{axis}");
    let corners = around(SIDES, r, h);
    for x in effort(vec![1.5], vec![0.0, 1.5]) {
        let irradiance = mean_over_square(x, |p| by_polygon(&corners, p));
        check_direct(1, "disc", x as f32, irradiance, |builder| {
            let glowing = diffuse(0.0f32).with("emission", Rgb::WHITE);
            put(builder, disc(Vec3::Y * h as f32, r as f32, SIDES), glowing);
        });
    }
}

#[test]
fn a_sphere_lights_the_floor_as_if_from_its_middle() {
    // E = π (R / d)² cosθ, wherever all of it is above the horizon.
    let cases = [(0.0, 0.9, 0.6), (0.7, 1.5, 0.01), (1.5, 1.0, 0.6)];
    for (turn, (x, height, radius)) in cases.into_iter().take(effort(1, 3)).enumerate() {
        let irradiance = mean_over_square(x, |[x, z]| {
            let distance2 = x * x + height * height + z * z;
            PI * radius * radius / distance2 * height / distance2.sqrt()
        });
        check_direct(turn, &format!("sphere of {radius} m"), x as f32, irradiance, |builder| {
            let light_spec = Spec::new("", "sphere").with("radius", radius as f32).with("radiance", 1.0f32);
            builder.lights.push(light_spec.with("position", Vec3::Y * height as f32));
        });
    }
}

/// Fraction of light that a slab of glass of this thickness transmits, at an angle of incidence in radians:
/// transmission through both faces, absorption in between, and all interreflections within. [Born 1999, 7.6.1]
fn through_slab(eta: f64, thickness: f64, sigma_a: f64, angle: f64) -> f64 {
    let (sin_i, cos_i) = (sin_f64(angle), cos_f64(angle));
    let cos_t = (1.0 - sin_i * sin_i / (eta * eta)).sqrt();
    let (across, along) =
        ((cos_i - eta * cos_t) / (cos_i + eta * cos_t), (eta * cos_i - cos_t) / (eta * cos_i + cos_t));
    let fresnel = (across * across + along * along) / 2.0;
    let passed = exp_f64(-sigma_a * thickness / cos_t);
    (1.0 - fresnel) * (1.0 - fresnel) * passed / (1.0 - fresnel * fresnel * passed * passed)
}

#[test]
fn a_slab_of_glass_absorbs_by_beer_and_reflects_by_fresnel() {
    let (eta, thickness, absorption) = (1.5, 0.8, Rgb::new(0.0, 0.5, 1.5));
    for degrees in effort(vec![40.0f64], vec![0.0, 40.0, 75.0]) {
        let angle = degrees.to_radians();
        let mut builder = SceneBuilder::default();
        let half = 60.0;
        let bounds = Aabb { min: Vec3::new(-half, -thickness, -half), max: Vec3::new(half, 0.0, half) };
        let glass = Spec::new("", "dielectric").with("eta", eta).with("absorption", absorption);
        put(&mut builder, cuboid(bounds), glass);
        // Light below, none above.
        let (below, side) = (Vec3::NEG_Y * (thickness + 1.0), 8.0 * half);
        put(
            &mut builder,
            quad(below, Vec3::X * side, Vec3::Z * side),
            diffuse(0.0f32).with("emission", Rgb::WHITE),
        );
        let from = Vec3::new(sin_f64(angle) as f32, cos_f64(angle) as f32, 0.0);
        plan(&mut builder, from, Vec3::ZERO, 0.1);
        let scene = built(&builder);
        for integrator in named(&["path", "bdpt", "vcm", "sppm", "auto"]) {
            let settings = RenderSettings { max_depth: 60, ..RenderSettings::new(16, 16, 64) };
            let name = format!("{}, {degrees} degrees", integrator.kind);
            let means = means(&name, (&scene, &integrator, &settings));
            for channel in 0..3 {
                let sigma_a = f64::from(absorption[channel]);
                let exact = through_slab(f64::from(eta), f64::from(thickness), sigma_a, angle);
                let name = format!("{name}, channel {channel}");
                assert_mean(&name, means[channel], exact);
                // Nor would it pass to forget the slant in the glass.
                let straight = through_slab(f64::from(eta), f64::from(thickness) * 0.85, sigma_a, angle);
                let p = p_value(means[channel], straight);
                assert!(sigma_a == 0.0 || p < UNLIKELY, "{name} passes for {straight}: p = {p:.1e}");
            }
        }
    }
}

/// The fraction of a disc of radius 1 that lies to the left of `x`.
fn left_of(x: f64) -> f64 {
    if x.abs() >= 1.0 {
        return f64::from(u8::from(x > 0.0));
    }
    0.5 + (x * (1.0 - x * x).sqrt() + FRAC_PI_2 - acos_f64(x)) / PI
}

#[test]
fn a_lens_is_sharp_where_it_is_focused_and_blurs_by_its_formula_elsewhere() {
    const COLUMNS: usize = 24;
    let (aperture, focus, fov) = (0.08f64, 2.0f64, 12.0f64);
    // A diffuse half-plane, lit along the line of sight, at several distances.
    for distance in effort(vec![3.5], vec![2.0, 3.5, 1.2]) {
        let mut builder = SceneBuilder::default();
        let side = 1.0f32;
        let middle = Vec3::new(-0.5 * side, 0.0, -distance as f32);
        put(&mut builder, quad(middle, Vec3::X * side, Vec3::Y * side), diffuse(1.0f32));
        let light = Spec::new("", "directional").with("direction", -Vec3::Z);
        builder.lights.push(light.with("irradiance", std::f32::consts::PI));
        let eye = Spec::new("eye", "perspective").with("position", Vec3::ZERO).with("look_at", -Vec3::Z);
        let eye = eye.with("fov", fov as f32).with("aperture", aperture as f32).with("focus", focus as f32);
        builder.cameras.push(CameraSpec { spec: eye, keyframes: Vec::new() });
        let scene = built(&builder);
        // The light at `x`, -1..=1 across the film, through a lens of radius `aperture`.
        let seen = |x: f64, aperture: f64| {
            let at_focus = x * focus * tan_f64(fov.to_radians() / 2.0);
            // From the point `l` of the lens through the point in focus: x = l (1 - d / f) + at_focus d / f < 0.
            let (edge, blur) = (-at_focus * distance / focus, aperture * (1.0 - distance / focus).abs());
            if blur == 0.0 { f64::from(u8::from(edge > 0.0)) } else { left_of(edge / blur) }
        };
        let column = |i: usize, aperture: f64| {
            let at = |k: usize| ((i * 64 + k) as f64 + 0.5) / (COLUMNS * 32) as f64 - 1.0;
            (0..64).map(|k| seen(at(k), aperture)).sum::<f64>() / 64.0
        };
        for integrator in named(effort(&["path", "bdpt"], &["path", "light", "bdpt", "vcm"])) {
            let spp = if integrator.kind == "light" { 512 } else { 32 };
            let settings =
                RenderSettings { max_depth: 1, ..RenderSettings::new(COLUMNS as u32, COLUMNS as u32, spp) };
            let pictures = pictures(&scene, &integrator, &settings, SEEDS);
            let least = |aperture: f64| {
                let of_column = |i: usize| {
                    let mean = |pixels: &Vec<Rgb>| {
                        let column = pixels.iter().skip(i).step_by(COLUMNS);
                        column.map(|pixel| f64::from(pixel.g)).sum::<f64>() / COLUMNS as f64
                    };
                    let values: Vec<f64> = pictures.iter().map(mean).collect();
                    p_value(estimate(&values), column(i, aperture))
                };
                // Not where hardly any ray passes the edge on either side: such values are not normally distributed.
                let is_rare = |i: usize| {
                    let part = column(i, aperture);
                    (part > 0.0 && part < 0.02) || (part > 0.98 && part < 1.0)
                };
                (0..COLUMNS).filter(|i| !is_rare(*i)).map(of_column).fold(1.0, f64::min) * COLUMNS as f64
            };
            let (name, p) = (&integrator.kind, least(aperture));
            assert!(p > UNLIKELY, "{name} at {distance} m: p = {p:.1e}");
            for wrong in [0.9, 1.1] {
                let p = least(aperture * wrong);
                let is_blurred = distance != focus;
                assert!(
                    !is_blurred || p < UNLIKELY,
                    "{name} at {distance} m passes for {wrong}: p = {p:.1e}"
                );
            }
        }
    }
}

/// Height of the ring of radius 1, and slope of the light: light that grazes the rim lands at the ring's centre.
const SLANT: f64 = 0.6;

/// The light that reaches the floor in a mirroring ring of radius `ring`, in the bins of a strip along the light's
/// direction, in units of the irradiance there without the ring: directly over the rim, and by one reflection.
///
/// The reflected light is the sum over all points of the wall, each of which sends its light along a line on the floor:
/// the envelope of these lines is the nephroid.
fn in_ring(ring: f64, bins: usize, half_width: f64) -> Vec<f64> {
    const BEAMS: i32 = 20_000;
    const STEPS: i32 = 2_000;
    let mut sums = vec![0.0; bins];
    let mut add = |x: f64, z: f64, light: f64| {
        let bin = ((x + 1.0) / 2.0 * bins as f64).floor();
        if z.abs() < half_width && (0.0..bins as f64).contains(&bin) {
            sums[bin as usize] += light;
        }
    };
    for i in 0..BEAMS {
        // A beam of the light, `b` aside of the centre, that travels along +x and hits the wall at the angle with this
        // sine: the higher it hits, the farther it still travels before it reaches the floor.
        let b = ((f64::from(i) + 0.5) / f64::from(BEAMS) * 2.0 - 1.0) * ring;
        let sine = b / ring;
        let cosine = (1.0 - sine * sine).sqrt();
        let (wall, chord) = ([ring * cosine, b], 2.0 * ring * cosine);
        let back = [1.0 - 2.0 * cosine * cosine, -2.0 * cosine * sine];
        let step = 2.0 * ring / f64::from(STEPS);
        let light = step * 2.0 * ring / f64::from(BEAMS);
        for k in 0..STEPS {
            let way = (f64::from(k) + 0.5) * step;
            // In units of the distance that light travels while it falls by the height of the ring, 1: over the rim
            // where it comes in, below it where it is reflected, and before it hits the wall again.
            if way + chord > 1.0 && way < chord.min(1.0) {
                add(wall[0] + back[0] * way, wall[1] + back[1] * way, light);
            }
            if way > 1.0 && way < chord {
                add(way - wall[0], b, light);
            }
        }
    }
    let area = 2.0 / bins as f64 * 2.0 * half_width;
    sums.into_iter().map(|sum| sum / area).collect()
}

#[test]
fn a_ring_of_metal_draws_the_nephroid() {
    const BINS: usize = 40;
    const FACETS: u32 = 2048;
    let mut builder = SceneBuilder::default();
    put(&mut builder, quad(Vec3::ZERO, Vec3::X * 2.4, Vec3::Z * 2.4), diffuse(1.0f32));
    let rim = |i: u32, y: f64| {
        let angle = TAU * f64::from(i % FACETS) / f64::from(FACETS);
        Vec3::new(cos_f64(angle) as f32, y as f32, sin_f64(angle) as f32)
    };
    let ring = Mesh {
        positions: (0..FACETS).flat_map(|i| [rim(i, 0.0), rim(i, SLANT)]).collect(),
        triangles: (0..FACETS)
            .flat_map(|i| {
                let (a, b) = (2 * i, 2 * ((i + 1) % FACETS));
                [[a, b, b + 1], [a, b + 1, a + 1]]
            })
            .collect(),
        ..Mesh::default()
    };
    put(&mut builder, ring, Spec::new("", "mirror").with("reflectance", 1.0f32));
    let direction = Vec3::new(1.0, -SLANT as f32, 0.0);
    let across = f64::from(direction.length()) / SLANT * PI;
    let light = Spec::new("", "directional").with("direction", direction);
    builder.lights.push(light.with("irradiance", across as f32));
    plan(&mut builder, Vec3::Y * 3.0, Vec3::ZERO, 2.0);
    let scene = built(&builder);
    let expected = in_ring(1.0, BINS, 0.05);
    // The cusp lies half-way from the centre to the wall, and opens towards it.
    let brightest = |light: &[f64]| light.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
    let is_cusp = |bin: usize| (BINS * 3 / 4..BINS * 3 / 4 + 2).contains(&bin);
    assert!(is_cusp(brightest(&expected)), "{expected:.3?}");
    let wrong = [0.95, 1.05].map(|ring| (ring, in_ring(ring, BINS, 0.05)));
    for integrator in named(&["bdpt", "light", "sppm", "vcm"][..effort(1, 4)]) {
        let settings = RenderSettings { max_depth: 2, ..RenderSettings::new(BINS as u32, BINS as u32, 64) };
        // The two central rows.
        let strip = |pictures: &[Vec<Rgb>], i: usize| {
            let mean = |p: &Vec<Rgb>| {
                [BINS / 2 - 1, BINS / 2].map(|y| f64::from(p[y * BINS + i].g)).iter().sum::<f64>() / 2.0
            };
            <[f64; 2]>::from(estimate(&pictures.iter().map(mean).collect::<Vec<_>>()))
        };
        let rendered = (&scene, &integrator, &settings);
        let strips = found(&integrator.kind, "means and their variances", rendered, |pictures| {
            (0..BINS).flat_map(|i| strip(pictures, i)).collect()
        });
        let found: Vec<f64> = strips.iter().copied().step_by(2).collect();
        let least = |expected: &[f64]| {
            // Skips the wall itself.
            let of_bin = |i: usize| p_value((strips[2 * i], strips[2 * i + 1]), expected[i]);
            (1..BINS - 1).map(of_bin).fold(1.0, f64::min) * BINS as f64
        };
        let (name, p) = (&integrator.kind, least(&expected));
        assert!(is_cusp(brightest(&found)), "{name}: {found:.3?}");
        assert!(p > UNLIKELY, "{name}: {found:.3?}, not {expected:.3?}: p = {p:.1e}");
        for (ring, wrong) in &wrong {
            let p = least(wrong);
            assert!(p < UNLIKELY, "{name} passes for a ring of {ring} m: p = {p:.1e}");
        }
    }
}

/// Light from straight above on the floor, under a ball of smooth glass whose centre hangs at `height`, by the distance
/// from its axis in steps of `step`, in units of the irradiance without the ball: each ring of light is refracted where
/// it enters the ball and where it leaves, and lands on a ring of the floor. [Born 1999, 4.2 and 1.5.2]
fn under_ball(eta: f64, height: f64, step: f64, count: usize) -> Vec<f64> {
    const RINGS: i32 = 1_000_000;
    let mut sums = vec![0.0; count];
    for i in 0..RINGS {
        let from_axis = BALL * (f64::from(i) + 0.5) / f64::from(RINGS);
        let (incident, bent) = (asin_f64(from_axis / BALL), asin_f64(from_axis / BALL / eta));
        // Where it leaves, as an angle from the top, and its deviation by then.
        let (leaves, turned) = (incident + PI - 2.0 * bent, 2.0 * (incident - bent));
        let lands = BALL * sin_f64(leaves) - tan_f64(turned) * (height + BALL * cos_f64(leaves));
        let along = (cos_f64(incident) - eta * cos_f64(bent)) / (cos_f64(incident) + eta * cos_f64(bent));
        let across = (eta * cos_f64(incident) - cos_f64(bent)) / (eta * cos_f64(incident) + cos_f64(bent));
        let passes = 1.0 - (along * along + across * across) / 2.0;
        let bin = (lands.abs() / step) as usize;
        if bin < count {
            sums[bin] += passes * passes * 2.0 * from_axis * BALL / f64::from(RINGS);
        }
    }
    let square = |i: usize| (i as f64 * step) * (i as f64 * step);
    sums.iter().enumerate().map(|(i, sum)| sum / (square(i + 1) - square(i))).collect()
}

/// Radius of the glass ball, in metres; its focus lies η R / (2 η - 2) behind its centre.
const BALL: f64 = 0.3;

#[test]
fn a_ball_of_glass_gathers_light_at_its_focus_and_spreads_it_behind() {
    const SIDE: usize = 32;
    const GROUPS: usize = 6;
    const STEP: f64 = 0.0005;
    for (turn, height) in [0.45, 0.8].into_iter().enumerate() {
        let mut builder = SceneBuilder::default();
        put(&mut builder, quad(Vec3::ZERO, Vec3::X, Vec3::Z), diffuse(1.0f32));
        let ball = icosphere(Vec3::Y * height as f32, BALL as f32, 6);
        put(&mut builder, ball, Spec::new("", "dielectric").with("eta", 1.5f32));
        let light = Spec::new("", "directional").with("direction", -Vec3::Y);
        builder.lights.push(light.with("irradiance", std::f32::consts::PI));
        // From so low that the ball is not in the way.
        plan(&mut builder, Vec3::new(3f32.sqrt(), 1.0, 0.0), Vec3::ZERO, 0.16);
        let scene = built(&builder);
        let from_axis = |x: f64, y: f64| {
            let film = Vec2::new((x / SIDE as f64) as f32, (y / SIDE as f64) as f32);
            let ray = scene.cameras()[0].1.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 });
            let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
            f64::from((origin - direction * (origin.y / direction.y)).length())
        };
        // Pixels are grouped by the distance of their centres from the axis.
        let farthest = from_axis(0.0, 0.0) * 1.0001;
        let group = |i: usize| {
            let middle = from_axis((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5);
            (middle / farthest * GROUPS as f64) as usize
        };
        let groups: Vec<usize> = (0..SIDE * SIDE).map(group).collect();
        let sizes = groups.iter().fold([0.0; GROUPS], |mut sizes, group| {
            sizes[*group] += 1.0;
            sizes
        });
        // Of each pixel, the steps from the axis of many places in it.
        let places = (0..SIDE * SIDE).flat_map(|i| (0..256).map(move |k| (i, k))).map(|(i, k)| {
            let within = [k % 16, k / 16].map(|k| (f64::from(k) + 0.5) / 16.0);
            let at = from_axis((i % SIDE) as f64 + within[0], (i / SIDE) as f64 + within[1]);
            (groups[i], (at / STEP) as usize)
        });
        let places: Vec<(usize, usize)> = places.collect();
        let expected = |eta: f64| {
            let light = under_ball(eta, height, STEP, (farthest / STEP) as usize + 2);
            let mut sums = [0.0; GROUPS];
            places.iter().for_each(|(group, step)| sums[*group] += light[*step] / 256.0 / sizes[*group]);
            sums
        };
        let (right, wrong) = (expected(1.5), [1.47, 1.53].map(|eta| (eta, expected(eta))));
        // In the short form, one in turn.
        for integrator in named(&["light", "bdpt", "vcm"][effort(turn..turn + 1, 0..3)]) {
            let settings =
                RenderSettings { max_depth: 3, ..RenderSettings::new(SIDE as u32, SIDE as u32, 64) };
            let mean_of = |g: usize, pixels: &Vec<Rgb>| {
                let sum = pixels.iter().enumerate().filter(|(i, _)| groups[*i] == g);
                sum.map(|(_, pixel)| f64::from(pixel.g)).sum::<f64>() / sizes[g]
            };
            let of_group = |pictures: &[Vec<Rgb>], g: usize| {
                <[f64; 2]>::from(estimate(&pictures.iter().map(|p| mean_of(g, p)).collect::<Vec<f64>>()))
            };
            let (name, rendered) = (&integrator.kind, (&scene, &integrator, &settings));
            let case = format!("{name} at {height} m");
            let means = found(&case, "means and their variances", rendered, |pictures| {
                (0..GROUPS).flat_map(|g| of_group(pictures, g)).collect()
            });
            let least = |expected: &[f64; GROUPS]| {
                let of_group = |g: usize| p_value((means[2 * g], means[2 * g + 1]), expected[g]);
                (0..GROUPS).map(of_group).fold(1.0, f64::min) * GROUPS as f64
            };
            let p = least(&right);
            let found: Vec<f64> = means.iter().copied().step_by(2).collect();
            assert!(p > UNLIKELY, "{name} at {height} m: {found:.3?}, not {right:.3?}: p = {p:.1e}");
            for (eta, wrong) in &wrong {
                let p = least(wrong);
                assert!(p < UNLIKELY, "{name} at {height} m passes for glass of {eta}: p = {p:.1e}");
            }
        }
    }
}
