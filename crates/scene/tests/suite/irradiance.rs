//! The irradiance of every light against its closed form, near and far: by light samples alone, by directions that hit it alone, and
//! by both with the balance heuristic. All of it is quadrature, so there is no noise.

use bilux_math::hash::hash_words;
use bilux_math::transcendental::{atan2_f64, sin_cos};
use bilux_math::{DVec3, Frame, Motion, Transform, Vec2, Vec3, warp};
use bilux_scene::mesh::shapes;

use bilux_scene::lights::{LightExtent, LightTree};
use bilux_scene::{
    AccelChoice, Goniometer, IntensityDistribution, LIGHTS, Light, LightSample, Object, Ray, Scene,
    SceneBuilder, Spec, Surface, Tracer,
};
use std::f64::consts::PI;
use std::sync::Arc;

/// A horizontal floor, whose middle faces a light.
struct Place {
    name: String,
    scene: Scene,
    /// The point of the floor.
    floor: Surface,
    /// The irradiance there, for a radiance, intensity or irradiance of 2.
    expected: f64,
    /// The sine of the angle of a cone about the normal that has all of the light.
    sin_cone: f32,
}

const LIGHT: f32 = 2.0;
/// Distances to the nearest point of the light, in radii or half edges.
const DISTANCES: [f32; 5] = [1e-4, 1e-2, 1.0, 1e3, 1e6];
/// Maximum relative error of a quadrature.
const ALLOWED: f64 = 5e-3;

fn place(
    name: String,
    floor: [f32; 2],
    at: Vec3,
    expected: f64,
    sin_cone: f32,
    add: impl FnOnce(&mut SceneBuilder),
) -> Place {
    let mut builder = SceneBuilder::default();
    let grey = builder.add_material(Spec::new("grey", "diffuse"));
    let [half, aside] = floor;
    let mesh = shapes::floor(at + Vec3::new(aside, 0.0, 0.4 * aside), 2.0 * half);
    builder.objects.push(Object::new("floor", Arc::new(mesh), grey));
    add(&mut builder);
    let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let below = at - Vec3::Y * half;
    let ray = Ray::new(below.to_array(), Vec3::Y.to_array());
    let floor = Tracer::new(&scene, false).closest(&ray).unwrap();
    assert!((floor.p - at).length() <= 1e-6 * (half + at.length()), "{name}: {}", floor.p);
    Place { name, scene, floor, expected, sin_cone }
}

/// The irradiance below a corner of a rectangle of radiance 1, whose edges have these lengths over its distance.
/// [Howell 2010, C-11]
fn corner(x: f64, y: f64) -> f64 {
    let part = |x: f64, y: f64| {
        let far = (x * x + 1.0).sqrt();
        x / far * atan2_f64(y, far)
    };
    0.5 * (part(x, y) + part(y, x))
}

/// The places for a light of the table.
fn places(kind: &str) -> Vec<Place> {
    let spec = || Spec::new("", kind);
    let small = |name: &str, expected: f64, sin_cone: f32, spec: Spec| {
        let sizes = [1e-4, 1.0, 1e6].into_iter();
        sizes
            .map(move |half| {
                place(format!("{name} over {half}"), [half, 0.0], Vec3::ZERO, expected, sin_cone, |b| {
                    b.lights.push(spec.clone())
                })
            })
            .collect::<Vec<_>>()
    };
    let at_distances = |of: &dyn Fn(f32, f32, Vec3) -> Place| {
        let sizes = [(1.0, Vec3::ZERO), (1.0, Vec3::new(7.0, -3.0, 2.0)), (300.0, Vec3::ZERO)];
        sizes
            .iter()
            .flat_map(|(size, at)| DISTANCES.map(|distance| of(*size, distance, *at)))
            .collect::<Vec<_>>()
    };
    match kind {
        // Physical integrators ignore it.
        "ambient" => small("ambient", 0.0, 1.0, spec().with("colour", LIGHT)),
        "directional" => {
            let down = || spec().with("direction", Vec3::NEG_Y).with("irradiance", LIGHT);
            let mut all = small("directional", f64::from(LIGHT), 1.0, down());
            for diameter in [0.533f32, 40.0] {
                let sine = sin_cos(diameter.to_radians() * 0.5).0;
                all.extend(small("sun", f64::from(LIGHT), 1.05 * sine, down().with("diameter", diameter)));
            }
            all
        }
        "environment" => small("environment", PI * f64::from(LIGHT), 1.0, spec().with("radiance", LIGHT)),
        // They are as bright as they are asked to be.
        "cie-sky" => [1, 5, 12, 16]
            .into_iter()
            .flat_map(|standard| {
                let spec = spec().with("standard", standard).with("irradiance", LIGHT);
                small("cie-sky", f64::from(LIGHT), 1.0, spec)
            })
            .collect(),
        "perez-sky" => {
            let spec = spec().with("direct", 0.0f32).with("diffuse", LIGHT).with("clearness", 1.0f32);
            small("perez-sky", f64::from(LIGHT), 1.0, spec.with("brightness", 0.2f32))
        }
        // The map has no closed form: see `a_sky_is_found_by_both_strategies`.
        "sky" => Vec::new(),
        "point" | "spot" => at_distances(&|size, distance, at| {
            let up = at + Vec3::Y * (size * distance);
            let d = f64::from(up.y) - f64::from(at.y);
            let spec = spec().with("position", up).with("intensity", LIGHT);
            let spec = if kind == "spot" { spec.with("look_at", at) } else { spec };
            let half = 20.0 * size;
            place(format!("{kind} {d} away"), [half, 0.0], at, f64::from(LIGHT) / (d * d), 1.0, |b| {
                b.lights.push(spec)
            })
        }),
        // The axis is turned from the floor's point by 30 degrees, and C 0 points to that side: 30 degrees of γ in the plane C 180.
        "luminaire" => at_distances(&|size, distance, at| {
            let up = at + Vec3::Y * (size * distance);
            let d = f64::from(up.y) - f64::from(at.y);
            let (azimuths, polar) = (vec![0.0, 90.0, 270.0, 360.0], vec![0.0, 20.0, 60.0]);
            let candela = [[1.0; 3], [1.0, 10.0, 30.0], [1.0, 20.0, 70.0], [1.0; 3]].concat();
            let made = IntensityDistribution::new("", Goniometer::C, azimuths, polar, candela).unwrap();
            let (sine, cosine) = sin_cos(30f32.to_radians());
            let spec =
                spec().with("position", up).with("distribution", Arc::new(made)).with("scale", 683.0f32);
            let spec = spec.with("direction", Vec3::new(sine, -cosine, 0.0)).with("c0", Vec3::X);
            let expected = (0.5 * (10.0 + 20.0) * 0.75 + 0.5 * (30.0 + 70.0) * 0.25) / (d * d);
            place(format!("luminaire {d} away"), [20.0 * size, 0.0], at, expected, 1.0, |b| {
                b.lights.push(spec)
            })
        }),
        "sphere" => at_distances(&|size, distance, at| {
            let centre = at + Vec3::Y * (size + size * distance);
            let sine = f64::from(size) / (f64::from(centre.y) - f64::from(at.y));
            let spec = spec().with("position", centre).with("radius", size).with("radiance", LIGHT);
            let expected = PI * f64::from(LIGHT) * sine * sine;
            let name = format!("sphere of {size}, {distance} radii away, over {at}");
            place(name, [20.0 * size, 3.0 * size], at, expected, (1.05 * sine as f32).min(1.0), |b| {
                b.lights.push(spec)
            })
        }),
        "rect" => {
            let above = |kind: usize| {
                move |size: f32, distance: f32, at: Vec3| {
                    let middle = at + Vec3::Y * (size * distance);
                    let d = f64::from(middle.y) - f64::from(at.y);
                    let [a, b] = [f64::from(size), 0.5 * f64::from(size)];
                    let expected = 4.0 * f64::from(LIGHT) * corner(a / d, b / d);
                    let across = a * a + b * b;
                    let cone = (1.05 * (across / (d * d + across)).sqrt()).min(1.0) as f32;
                    let (u, v) = (Vec3::X * 2.0 * size, Vec3::Z * size);
                    let name = format!("rect {kind} of {size}, {distance} half edges away, over {at}");
                    place(name, [20.0 * size, 3.0 * size], at, expected, cone, |builder| {
                        add_panel(builder, kind, middle, u, v)
                    })
                }
            };
            (0..3).flat_map(|kind| at_distances(&above(kind))).collect()
        }
        other => panic!("{other} has no closed form here: add one"),
    }
}

/// A rectangular light: the light of the table, an emissive mesh, or an instance of one that was made smaller.
fn add_panel(builder: &mut SceneBuilder, kind: usize, middle: Vec3, u: Vec3, v: Vec3) {
    if kind == 0 {
        let spec = Spec::new("", "rect").with("position", middle).with("edge_u", u).with("edge_v", v);
        builder.lights.push(spec.with("radiance", LIGHT));
        return;
    }
    let glowing =
        builder.add_material(Spec::new("", "diffuse").with("reflectance", 0.0).with("emission", LIGHT));
    let scale = if kind == 1 { 1.0 } else { 0.25 };
    let mesh = Arc::new(shapes::quad(Vec3::ZERO, u / scale, v / scale));
    let matrix = bilux_math::DMat4::from_scale_rotation_translation(
        DVec3::splat(f64::from(scale)),
        Default::default(),
        middle.as_dvec3(),
    );
    let motion = Motion::still(Transform::from_matrix(matrix).unwrap());
    builder.objects.push(Object { motion, instanced: kind == 2, ..Object::new("panel", mesh, glowing) });
}

/// Value found at a point of the unit square, and the point of a light that was sampled.
type Found = (f64, Option<Vec3>);

/// The integral over the unit square, in cells that are small beside the distance to what they find, and where they find the
/// edge of a light.
fn integral(first: u32, from: Vec3, mut at: impl FnMut(Vec2) -> Option<Found>) -> f64 {
    let mut sum = 0.0;
    let mut cells: Vec<(Vec2, f32)> = (0..first * first)
        .map(|i| (Vec2::new((i % first) as f32, (i / first) as f32) / first as f32, 1.0 / first as f32))
        .collect();
    while let Some((corner, side)) = cells.pop() {
        let place = |i: u32| corner + Vec2::new((i % 3) as f32 + 0.5, (i / 3) as f32 + 0.5) * (side / 3.0);
        let found: Vec<Option<Found>> = (0..9).map(|i| at(place(i))).collect();
        let points: Vec<Vec3> = found.iter().flatten().filter_map(|(_, p)| *p).collect();
        let nearest = points.iter().map(|p| p.distance(from)).fold(f32::INFINITY, f32::min);
        let extent = points.iter().map(|p| p.distance(points[0])).fold(0.0, f32::max);
        let is_wide = extent > 0.35 * nearest && side > 1e-6;
        // Directions find an edge where some of them find nothing, and a steep slope beside it.
        let values = found.iter().map(|found| found.map_or(0.0, |(value, _)| value));
        let (least, most) = values.fold((f64::INFINITY, 0.0), |(a, b), x| (x.min(a), x.max(b)));
        let is_steep = points.is_empty() && most > 1.3 * least && side > 1.0 / 500.0;
        if is_wide || is_steep {
            let half = side * 0.5;
            cells
                .extend([Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].map(|aside| (corner + aside * half, half)));
        } else {
            let area = f64::from(side) * f64::from(side);
            sum += found.iter().flatten().map(|(value, _)| value).sum::<f64>() * area / 9.0;
        }
    }
    sum
}

/// The density of diffuse reflection.
fn scattered(cos: f32) -> f32 {
    warp::cosine_hemisphere_pdf_solid_angle(cos)
}

/// The irradiance by light samples, each with a weight that is a function of the density of light samples and of that of
/// scattering.
fn by_light_samples(place: &Place, light: &dyn Light, weight: impl Fn(f32, f32) -> f32) -> f64 {
    let (floor, mut tracer) = (&place.floor, Tracer::new(&place.scene, false));
    integral(16, floor.p, |u| {
        let sample = light.sample_li(floor.p, 0.0, u)?;
        let LightSample { wi, li, point, n_light, pdf_solid_angle, .. } = sample;
        let ray = floor.spawn_to_light(&sample);
        let cos = wi.y.max(0.0);
        let is_seen = !tracer.ending_on(&ray, n_light, |tracer| tracer.occluded(&ray));
        let pdf_scattered = if light.is_delta() { 0.0 } else { scattered(cos) };
        let value =
            f64::from(li.g * cos * weight(pdf_solid_angle, pdf_scattered)) / f64::from(pdf_solid_angle);
        Some((if is_seen { value } else { 0.0 }, point))
    })
}

/// The irradiance by directions from the cone.
fn by_directions(place: &Place, light: &dyn Light, weight: impl Fn(f32, f32) -> f32) -> f64 {
    let (floor, mut tracer) = (&place.floor, Tracer::new(&place.scene, false));
    let sine = f64::from(place.sin_cone);
    let up = Frame::from_normal(Vec3::Y);
    PI * sine
        * sine
        * integral(64, floor.p, |u| {
            // Uniform in the cosine-weighted solid angle of the cone.
            let disc = warp::sample_disc(u) * place.sin_cone;
            let wi = up.to_world(disc.extend((1.0 - disc.length_squared()).max(0.0).sqrt())).normalize();
            let hit = tracer.closest(&floor.spawn(wi));
            let emitted = match &hit {
                Some(surface) => place.scene.emission(surface, -wi),
                None => light.le(wi),
            };
            if emitted.is_black() {
                return None;
            }
            let pdf_light = light.li_pdf_solid_angle(floor.p, wi, hit.as_ref());
            let value = f64::from(emitted.g * weight(pdf_light, scattered(wi.y)));
            Some((value, None))
        })
}

/// Error of an estimate, relative to what is right.
fn off(found: f64, expected: f64) -> f64 {
    if expected == 0.0 { found.abs() } else { (found / expected - 1.0).abs() }
}

/// The irradiance by light samples alone, by directions alone, and by both.
fn estimates(place: &Place, light: &dyn Light) -> Vec<(&'static str, f64)> {
    let by_both = by_light_samples(place, light, |light, scattered| light / (light + scattered))
        + if light.is_delta() {
            0.0
        } else {
            by_directions(place, light, |light, scattered| scattered / (light + scattered))
        };
    let mut all = vec![("both", by_both)];
    if light.samples_all_light() {
        all.push(("light samples", by_light_samples(place, light, |_, _| 1.0)));
    }
    if !light.is_delta() {
        all.push(("directions", by_directions(place, light, |_, _| 1.0)));
    }
    all
}

#[test]
fn every_light_gives_the_irradiance_of_its_closed_form_near_and_far() {
    for row in LIGHTS {
        for place in places(row.entry.name) {
            let light = &*place.scene.lights()[0].light;
            for (by, found) in estimates(&place, light) {
                let off = off(found, place.expected);
                assert!(off < ALLOWED, "{}, by {by}: {found} instead of {}", place.name, place.expected);
            }
        }
    }
}

#[test]
fn a_sky_is_found_by_both_strategies() {
    for half in [1e-4, 1e6] {
        let sky = Spec::new("", "sky").with("sun_scale", 0.0f32);
        let place =
            place("sky".to_owned(), [half, 0.0], Vec3::ZERO, 0.0, 1.0, |builder| builder.lights.push(sky));
        let light = &*place.scene.lights()[0].light;
        let all = estimates(&place, light);
        assert!(all.len() == 2 && off(all[0].1, all[1].1) < ALLOWED, "{all:?}");
    }
}

/// Planted bug: a ray that ends a ten-thousandth of the distance too late is blocked by the light itself.
#[test]
fn a_light_that_shadows_itself_is_detected() {
    let place = places("sphere").into_iter().nth(3).unwrap();
    let light = &*place.scene.lights()[0].light;
    let (floor, mut tracer) = (&place.floor, Tracer::new(&place.scene, false));
    let found = integral(16, floor.p, |u| {
        let sample = light.sample_li(floor.p, 0.0, u)?;
        let ray = floor.spawn_to_light(&LightSample { clearance: -1e-4, ..sample });
        let is_seen = !tracer.occluded(&ray);
        let value = f64::from(sample.li.g * sample.wi.y) / f64::from(sample.pdf_solid_angle);
        Some((if is_seen { value } else { 0.0 }, sample.point))
    });
    assert!(off(found, place.expected) > 0.5, "{found}");
}

/// The tree of lights chooses a light wherever it shines: its extent leaves no such point out, which would be dark among many lights. That of a spot
/// leaves out what is outside of its cone.
#[test]
fn extents_leave_no_point_out_that_a_light_reaches() {
    let mut lights: Vec<Spec> = LIGHTS.iter().map(|row| Spec::new("", row.entry.name)).collect();
    let spot = || Spec::new("", "spot").with("look_at", Vec3::new(1.0, 2.0, -0.5)).with("angle", 40.0f32);
    lights.extend([5.0f32, 40.0].map(|inner| spot().with("inner_angle", inner)));
    lights.push(Spec::new("", "rect").with("sides", "front"));
    let (mut extents, mut left_out) = (0, 0);
    for spec in lights {
        let spec = match spec.kind.as_str() {
            "rect" | "sphere" => spec.with("intensity", 3.0f32),
            _ => spec,
        };
        let name = format!("{} {:?}", spec.kind, spec.parameters);
        let builder = SceneBuilder { lights: vec![spec], ..SceneBuilder::default() };
        let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let light = &*scene.lights()[0].light;
        let Some(extent) = light.extent([0.0, 0.0]) else { continue };
        extents += 1;
        let tree = LightTree::new(&[(extent, 1.0), (LightExtent::all_around(extent.bounds), 1.0)]);
        for i in 0..2000u64 {
            let number = |k: u64| (hash_words([i, k]) >> 40) as f32 / (1u64 << 24) as f32;
            // The lights of the table are at (0, 5, 0).
            let p = Vec3::new(number(0), number(1), number(2)) * 8.0 + Vec3::new(-4.0, 1.0, -4.0);
            let shines = (0..4).any(|j| {
                let u = Vec2::new(number(3 + 2 * j), number(4 + 2 * j));
                light.sample_li(p, 0.0, u).is_some_and(|sample| !sample.li.is_black())
            });
            let is_chosen = tree.probability(p, 0) > 0.0;
            assert!(is_chosen || !shines, "{name}: dark at {p}");
            left_out += usize::from(!is_chosen);
        }
    }
    assert!(extents >= 8 && left_out > 1000, "{extents} lights, {left_out} points");
}
