//! Light that points and plans receive, against closed forms; and what of it comes from each patch of the sky.

use crate::common::media::boxed;
use crate::common::{built, diffuse, floor, integrator, put, quad};
use bilux_math::transcendental::{atan2_f64, exp_f64, sin, sin_cos};
use bilux_math::{Rgb, Vec3};
use bilux_scene::cameras::{CameraSpec, SensorPoint, SensorPoints, build};
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{
    DaylightCoefficients, PartOfSky, Received, RenderError, RenderSettings, Silent, SkyPatches, Stop,
    daylight_coefficients, received, render, sunlight,
};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Irradiance and standard error of a point.
pub(crate) fn measured(scene: &Scene, [p, normal]: [Vec3; 2], spp: u32) -> [f64; 2] {
    let points = SensorPoints::new(vec![SensorPoint { p, normal: normal.normalize() }]);
    let settings = RenderSettings::new(1, 1, spp);
    let found = received(scene, &points, &*integrator("path"), &settings, &Silent);
    let Received { points, quantile, .. } = found.unwrap().unwrap();
    [points[0][3].mean, points[0][3].half_width / quantile]
}

/// Fails where it is more than five standard errors off, or knows itself badly.
fn assert_received(scene: &Scene, at: [Vec3; 2], expected: f64) {
    let [found, error] = measured(scene, at, 4096);
    assert!((found - expected).abs() <= 5.0 * error + 1e-5 * expected, "{found} ± {error} for {expected}");
    assert!(error < 0.02 * expected, "{found} ± {error}");
}

fn lit_by(light: Spec) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    builder.lights.push(light);
    builder
}

#[test]
fn lamps_follow_the_inverse_square_and_the_cosine() {
    let lamp = Spec::new("", "point").with("position", Vec3::new(0.0, 2.0, 0.0)).with("intensity", 100.0f32);
    let scene = built(&lit_by(lamp));
    let aside = Vec3::new(1.0, 0.0, 0.0);
    let expected = 100.0 * (2.0 / 5f64.sqrt()) / 5.0;
    let [found, error] = measured(&scene, [aside, Vec3::Y], 64);
    assert!((found / expected - 1.0).abs() < 1e-5 && error < 1e-5 * expected, "{found} ± {error}");
    // Without the cosine it would be 12% more, and behind it is dark.
    assert!((found / 20.0 - 1.0).abs() > 0.1);
    assert_eq!(measured(&scene, [aside, -Vec3::Y], 64), [0.0, 0.0]);
}

/// The configuration factor of a rectangle `a` by `b` seen from below a corner at distance 1, by a surface parallel to it.
/// [Howell 2010, B-3]
fn corner_factor(a: f64, b: f64) -> f64 {
    let part = |a: f64, b: f64| {
        let root = (1.0 + a * a).sqrt();
        a / root * atan2_f64(b, root)
    };
    (part(a, b) + part(b, a)) / TAU
}

#[test]
fn panels_light_by_their_configuration_factor() {
    let panel = Spec::new("", "rect").with("radiance", 3.0f32).with("position", Vec3::new(0.0, 2.0, 0.0));
    let panel = panel.with("edge_u", Vec3::X * 3.0).with("edge_v", Vec3::Z * 1.0);
    let scene = built(&lit_by(panel));
    // `position` is the middle of the panel.
    let expected = 3.0 * PI * 4.0 * corner_factor(0.75, 0.25);
    assert_received(&scene, [Vec3::ZERO, Vec3::Y], expected);
}

/// The fraction of unpolarised light that a thin pane of glass lets through: reflected back and forth between its faces, each
/// of which reflects by [Fresnel's equations](bilux_scene::bsdf::fresnel_dielectric).
fn pane_transmits(cos: f64) -> f64 {
    const ETA: f64 = 1.5;
    let inside = (1.0 - (1.0 - cos * cos) / (ETA * ETA)).sqrt();
    let across = (cos - ETA * inside) / (cos + ETA * inside);
    let along = (ETA * cos - inside) / (ETA * cos + inside);
    let reflected = 0.5 * (across * across + along * along);
    1.0 - 2.0 * reflected / (1.0 + reflected)
}

#[test]
fn a_pane_lets_its_part_of_an_even_sky_through() {
    let mut builder =
        lit_by(Spec::new("", "cie-sky").with("standard", 5).with("zenith", 2.0f32).with("ground", 0.0f32));
    let glass = Spec::new("", "dielectric").with("thin", true).with("eta", 1.5f32);
    put(&mut builder, "pane", floor(1.0, 2000.0), glass);
    let step = |i: u32| (f64::from(i) + 0.5) / 1000.0;
    let transmits = (0..1000).map(|i| 2.0 * step(i) * pane_transmits(step(i))).sum::<f64>() / 1000.0;
    assert!((0.84..0.85).contains(&transmits), "{transmits}");
    assert_received(&built(&builder), [Vec3::ZERO, Vec3::Y], 2.0 * PI * transmits);
}

/// A closed box whose walls shine with `glow` and reflect `albedo`.
fn glowing_box(glow: f32, albedo: f32) -> Scene {
    let mut builder = SceneBuilder::default();
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * 2.0);
    let (low, high) = (-Vec3::ONE, Vec3::ONE);
    let walls = [(low, x, z), (low, y, x), (low, z, y), (high, -z, -x), (high, -x, -y), (high, -y, -z)];
    for (corner, u, v) in walls {
        put(&mut builder, "wall", quad(corner, u, v), diffuse(albedo).with("emission", glow));
    }
    built(&builder)
}

#[test]
fn light_in_a_closed_box_is_reflected_for_ever() {
    let scene = glowing_box(1.0, 0.5);
    for at in [[Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.2, 1.0, -0.4)], [Vec3::new(0.5, -1.0, 0.5), Vec3::Y]] {
        assert_received(&scene, at, PI / 0.5 * (1.0 - 1.0 / f64::from(1 << 18)));
    }
}

/// Ground of albedo 0.5 below the sky, and a wall to the east.
fn under_the_sky() -> Scene {
    let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
    put(&mut builder, "ground", floor(0.0, 50.0), diffuse(0.5f32));
    let wall = quad(Vec3::new(1.0, 0.0, -50.0), Vec3::Y * 50.0, Vec3::Z * 100.0);
    put(&mut builder, "wall", wall, diffuse(0.0f32));
    built(&builder)
}

fn tregenza() -> SkyPatches {
    let rows = [30, 30, 24, 24, 18, 12, 6, 1];
    SkyPatches::new((0..).map(|row| sin((12.0 * row as f32).to_radians())).zip(rows))
}

pub(crate) fn measured_parts(
    scene: &Scene,
    [p, normal]: [Vec3; 2],
    count: usize,
    spp: u32,
) -> DaylightCoefficients {
    let points = SensorPoints::new(vec![SensorPoint { p, normal }; count]);
    let settings = RenderSettings::new(points.size()[0], points.size()[1], spp);
    let all = daylight_coefficients(scene, &points, &*integrator("path"), &settings, &tregenza(), &Silent);
    all.unwrap().unwrap()
}

fn coefficients(scene: &Scene, at: [Vec3; 2], spp: u32) -> Vec<f32> {
    measured_parts(scene, at, 3, spp).all[..146].iter().map(|part| part.mean).collect()
}

#[test]
fn the_patches_add_up_to_the_light() {
    let scene = under_the_sky();
    let at = [Vec3::new(0.0, 0.7, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    let sum: f32 = coefficients(&scene, at, 4096).iter().sum();
    let [plain, error] = measured(&scene, at, 4096);
    assert!((f64::from(sum) - plain).abs() < 7.0 * error, "{sum} in patches, {plain} ± {error} in all");
    // They are different samples of the same light.
    assert!(f64::from(sum) != plain && error < 0.02 * plain);
}

#[test]
fn each_patch_gets_its_own_light() {
    // Nothing reflects: each patch sends its cosine times its solid angle.
    let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
    put(&mut builder, "below", floor(-1.0, 1.0), diffuse(0.0f32));
    let plain = coefficients(&built(&builder), [Vec3::ZERO, Vec3::Y], 1 << 16);
    let (mut first, mut worst) = (1, 0f64);
    for (row, count) in [30usize, 30, 24, 24, 18, 12, 6, 1].into_iter().enumerate() {
        let height = |row: usize| f64::from(sin((12.0 * row as f32).min(90.0).to_radians()));
        let square = |row: usize| height(row) * height(row);
        let expected = PI * (square(row + 1) - square(row)) / count as f64;
        for found in &plain[first..first + count] {
            worst = worst.max((f64::from(*found) / expected - 1.0).abs());
        }
        first += count;
    }
    assert!(worst < 0.15, "{worst}");
    // The wall hides the east, and no patch of the west.
    let beside = coefficients(&under_the_sky(), [Vec3::new(0.99, 0.5, 0.0), Vec3::Y], 4096);
    let patches = tregenza();
    let towards = |x: f32| beside[patches.number(Vec3::new(x, 0.3, 0.01))];
    assert!(towards(1.0) == 0.0 && towards(-1.0) > 0.0, "{} {}", towards(1.0), towards(-1.0));
}

/// The errors of coefficients are those by which many measurements of them differ.
#[test]
fn coefficients_know_their_errors() {
    const COUNT: usize = 96;
    let at = [Vec3::new(0.3, 0.7, 0.0), Vec3::new(0.2, 1.0, 0.1).normalize()];
    let found = measured_parts(&under_the_sky(), at, COUNT, 64);
    for parts in [&found.all, &found.reflected] {
        let (mut known, mut seen) = (0.0, 0.0);
        for patch in 0..146 {
            let of_patch = || parts.iter().skip(patch).step_by(146).map(|part| f64::from(part.mean));
            let mean = of_patch().sum::<f64>() / COUNT as f64;
            seen += of_patch().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (COUNT - 1) as f64;
            let errors = parts.iter().skip(patch).step_by(146).map(|part| f64::from(part.error));
            known += errors.map(|error| error * error).sum::<f64>() / COUNT as f64;
        }
        let ratio = (known / seen).sqrt();
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
    }
    assert!(measured_parts(&under_the_sky(), at, 1, 4).all.iter().all(|part| part.error.is_infinite()));
}

/// Light that comes straight is no reflection, through a pane either; what matt walls reflect is nothing else.
#[test]
fn straight_light_is_not_reflected() {
    let pane = |builder: &mut SceneBuilder| {
        let glass = Spec::new("", "dielectric").with("thin", true).with("eta", 1.5f32);
        put(builder, "pane", floor(1.0, 2000.0), glass);
    };
    let at = [Vec3::new(0.0, 0.2, 0.0), Vec3::Y];
    for has_pane in [false, true] {
        let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
        put(&mut builder, "black", floor(0.0, 9e4), diffuse(0.0f32));
        if has_pane {
            pane(&mut builder);
        }
        let found = measured_parts(&built(&builder), at, 1, 4096);
        let sum = |parts: &[PartOfSky]| parts.iter().map(|part| part.mean).sum::<f32>();
        assert!(
            sum(&found.all) > 2.0 && sum(&found.reflected) == 0.0,
            "{has_pane}: {}",
            sum(&found.reflected)
        );
    }
    // The wall hides a part of the half sphere above.
    let found = measured_parts(&under_the_sky(), at, 1, 1 << 14);
    let sum = |parts: &[PartOfSky]| parts.iter().map(|part| f64::from(part.mean)).sum::<f64>();
    let straight = sum(&found.all) - sum(&found.reflected);
    assert!(straight < PI && straight > 0.4 * PI, "{straight}");
    assert_eq!(
        sum(&found.reflected[1..]),
        0.0,
        "the ground reflects upwards, away from the point, and the wall is black"
    );
}

/// The sun at an elevation and an azimuth, in degrees.
fn sun(elevation: f32, azimuth: f32) -> Vec3 {
    let ((up, flat), (east, north)) = (sin_cos(elevation.to_radians()), sin_cos(azimuth.to_radians()));
    Vec3::new(flat * east, up, -flat * north)
}

fn sun_at(scene: &Scene, [p, normal]: [Vec3; 2], directions: &[Vec3]) -> Vec<f32> {
    let points = SensorPoints::new(vec![SensorPoint { p: p + Vec3::Z, normal }, SensorPoint { p, normal }]);
    let found =
        sunlight(scene, &points, directions, &RenderSettings::new(2, 1, 1), &Silent).unwrap().unwrap();
    found[directions.len()..].to_vec()
}

#[test]
fn shadows_of_the_sun_are_exact() {
    // The wall to the east is 50 m high and 1 m away: a point 2 m to the west of it sees the sun above atan(50 / 3).
    let at = [Vec3::new(-2.0, 0.0, 0.0), Vec3::Y];
    let edge = atan2_f64(50.0, 3.0).to_degrees() as f32;
    let suns =
        [sun(edge - 0.01, 90.0), sun(edge + 0.01, 90.0), sun(30.0, 270.0), sun(30.0, 0.0), sun(-5.0, 270.0)];
    let found = sun_at(&under_the_sky(), at, &suns);
    assert_eq!([found[0], found[4]], [0.0, 0.0]);
    for (i, elevation) in [(1, edge + 0.01), (2, 30.0), (3, 30.0)] {
        assert!((found[i] - sin(elevation.to_radians())).abs() < 1e-6, "{i}: {}", found[i]);
    }
}

/// A thin pane takes what a stack of its two faces reflects; a thick one what each face reflects, once.
#[test]
fn panes_let_their_part_of_the_sun_through() {
    let up = f64::from(sin(40f32.to_radians()));
    for (is_thin, share) in [(true, pane_transmits(up)), (false, thick_pane_transmits(up))] {
        let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
        let glass = Spec::new("", "dielectric").with("thin", is_thin).with("eta", 1.5f32);
        let plate = || boxed(Vec3::new(-99.0, 1.0, -99.0), Vec3::new(99.0, 1.02, 99.0));
        put(&mut builder, "pane", if is_thin { floor(1.0, 200.0) } else { plate() }, glass);
        let found = sun_at(&built(&builder), [Vec3::ZERO, Vec3::Y], &[sun(40.0, 130.0)]);
        assert!(
            (f64::from(found[0]) / (up * share) - 1.0).abs() < 1e-4,
            "{is_thin}: {} for {}",
            found[0],
            up * share
        );
    }
    // A wedge turns it away, so that the point sees the sun in another direction.
    let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
    let mut wedge = (*boxed(Vec3::new(-99.0, 1.0, -99.0), Vec3::new(99.0, 2.0, 99.0))).clone();
    wedge.positions.iter_mut().filter(|p| p.y > 1.5).for_each(|p| p.y += 0.1 * (p.x + 99.0));
    put(&mut builder, "wedge", Arc::new(wedge), Spec::new("", "dielectric").with("eta", 1.5f32));
    assert_eq!(sun_at(&built(&builder), [Vec3::ZERO, Vec3::Y], &[sun(60.0, 130.0)]), [0.0]);
    // From within smoke, by Beer's law.
    let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
    let smoke = Spec::new("", "interface").with("absorption", 0.7f32);
    put(&mut builder, "smoke", boxed(Vec3::new(-99.0, -5.0, -99.0), Vec3::new(99.0, 1.5, 99.0)), smoke);
    let found = sun_at(&built(&builder), [Vec3::ZERO, Vec3::Y], &[sun(40.0, 130.0)]);
    let wanted = up * exp_f64(-0.7 * 1.5 / up);
    assert!((f64::from(found[0]) / wanted - 1.0).abs() < 1e-4, "{} for {wanted}", found[0]);
    let mut builder = lit_by(Spec::new("", "environment").with("radiance", 1.0f32));
    put(&mut builder, "paper", floor(1.0, 200.0), diffuse(0.9f32));
    assert_eq!(sun_at(&built(&builder), [Vec3::ZERO, Vec3::Y], &[sun(40.0, 130.0)]), [0.0]);
}

/// The fraction that two faces let through, by Fresnel's equations, without what they send back and forth.
fn thick_pane_transmits(cos: f64) -> f64 {
    let thin = pane_transmits(cos);
    // 1 - 2R/(1 + R) = (1 - R)/(1 + R).
    let reflected = (1.0 - thin) / (1.0 + thin);
    (1.0 - reflected) * (1.0 - reflected)
}

#[test]
fn patches_are_numbered_from_the_north_to_the_east() {
    let patches = tregenza();
    assert_eq!(patches.count(), 146);
    let number = |x: f32, y: f32, z: f32| patches.number(Vec3::new(x, y, z));
    assert_eq!([number(0.0, -1.0, 0.0), number(0.0, 1.0, 0.0), number(0.0, 0.1, -1.0)], [0, 145, 1]);
    // A quarter of a turn of 30 patches.
    assert_eq!([number(1.0, 0.1, 0.08), number(-0.01, 0.1, -1.0), number(-0.2, 0.1, -1.0)], [9, 1, 30]);
    assert_eq!(number(f32::NAN, 0.0, 0.0), 0);
}

#[test]
fn measuring_ends_when_it_is_good_enough() {
    let scene = glowing_box(1.0, 0.5);
    let points = SensorPoints::new(vec![SensorPoint { p: Vec3::ZERO, normal: Vec3::Y }; 5]);
    let stop = Stop { noise: Some(0.02), ..Stop::default() };
    let settings = RenderSettings { stop, ..RenderSettings::new(3, 2, 1 << 16) };
    let few = received(&scene, &points, &*integrator("auto"), &settings, &Silent).unwrap().unwrap();
    assert!((64..4096).contains(&few.samples), "{}", few.samples);
    // The same samples give the same numbers, whatever the number of threads.
    let exact = RenderSettings { threads: 1, ..RenderSettings::new(3, 2, few.samples) };
    let again = received(&scene, &points, &*integrator("path"), &exact, &Silent).unwrap().unwrap();
    assert_eq!(few, again);
    assert_ne!(few.points[0], few.points[1]);
    let refused = received(&scene, &points, &*integrator("vcm"), &exact, &Silent);
    assert!(matches!(refused, Err(RenderError::Receives)));
}

fn plan(scene: &Scene, kind: &str) -> Result<Vec<Rgb>, RenderError> {
    let spec = Spec::new("", "irradiance").with("position", Vec3::ZERO).with("height", 2.0f32);
    let camera = build(&CameraSpec::new(spec), 2.0).unwrap();
    Ok(render(scene, &*camera, &*integrator(kind), &RenderSettings::new(4, 2, 16), &Silent)?.film.to_rgb())
}

#[test]
fn a_plan_has_its_light_where_the_lamp_is() {
    // Above the plan's upper right corner: x is to the right, and north (-z) at the top.
    let lamp = Spec::new("", "point").with("position", Vec3::new(1.5, 0.5, -0.5)).with("intensity", 1.0f32);
    let scene = built(&lit_by(lamp));
    let pixels = plan(&scene, "path").unwrap();
    let brightest = pixels.iter().enumerate().max_by(|a, b| a.1.g.total_cmp(&b.1.g)).unwrap();
    assert_eq!(brightest.0, 3);
    // The pixel is 1 m wide and 1 m high, and the lamp sees it as it would see a face of a cube from its middle.
    let solid_angle = 4.0 * PI / 6.0;
    let found = f64::from(brightest.1.g) * PI;
    assert!((found / solid_angle - 1.0).abs() < 0.1, "{found} for {solid_angle}");
    // auto measures with paths, whatever else it could do; the others refuse.
    assert_eq!(plan(&scene, "auto").unwrap().len(), pixels.len());
    for kind in ["bdpt", "light", "vcm", "occlusion", "whitted"] {
        assert!(matches!(plan(&scene, kind), Err(RenderError::Receives)), "{kind}");
    }
}
