//! Boundaries of media that are open, cut away, in contact, or no surface at all: paths from lights and from the camera mean the same by them.

use crate::common::{built, diffuse, floor, integrator, put, shoot};
use crate::nesting::{assert_seen, block, bright_floor, fog, passed};
use bilux_math::{Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Mesh, SceneBuilder, Spec, Value};
use bilux_transport::RenderSettings;
use std::f32::consts::PI;
use std::sync::Arc;

const FOG: Rgb = Rgb { r: 0.3, g: 0.6, b: 0.05 };

/// A square about a point with this normal.
fn sheet(middle: Vec3, normal: Vec3, side: f32) -> Arc<Mesh> {
    let u = normal.any_orthonormal_vector() * side;
    let v = normal.cross(u);
    Arc::new(Mesh::quad(middle - (u + v) * 0.5, u, v))
}

/// A square of this side of a floor that reflects 0.6 from 4 m above, and a lamp of 5 W/sr.
fn lit_floor(lamp: Vec3, side: f32) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 30.0), diffuse(0.6f32));
    builder.add_light(Spec::new("", "point").with("position", lamp).with("intensity", 5.0f32));
    let eye = Spec::new("eye", "orthographic").with("position", Vec3::Y * 4.0).with("look_at", Vec3::ZERO);
    let spec = eye.with("up", Vec3::X).with("height", side);
    builder.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    builder
}

/// The mean of that square: ρ/π I cos/r², times what is left after the distance from the lamp.
fn of_lit_floor(lamp: Vec3, side: f32, left: impl Fn(f32) -> Rgb) -> Rgb {
    const COUNT: usize = 64;
    let at = |i: usize| ((i as f32 + 0.5) / COUNT as f32 - 0.5) * side;
    let of = |x: f32, z: f32| {
        let r = lamp.distance(Vec3::new(x, 0.0, z));
        left(r) * (0.6 / PI * 5.0 * lamp.y / (r * r * r))
    };
    let rows = (0..COUNT).map(|i| (0..COUNT).map(|j| of(at(i), at(j))).sum::<Rgb>());
    rows.sum::<Rgb>() * (1.0 / (COUNT * COUNT) as f32)
}

fn assert_mean(case: &str, builder: &SceneBuilder, (depth, spp): (u32, u32), wanted: Rgb) {
    let scene = built(builder);
    for (name, spp, within) in
        [("path", spp, 0.02), ("light", 12 * spp, 0.04), ("bdpt", 2 * spp, 0.02), ("vcm", 2 * spp, 0.02)]
    {
        let settings = RenderSettings { max_depth: depth, ..RenderSettings::new(16, 16, spp) };
        let pixels = shoot(&scene, &*integrator(name), &settings).film.to_rgb();
        let found = pixels.into_iter().sum::<Rgb>() * (1.0 / 256.0);
        let is_near = |channel: usize| (found[channel] / wanted[channel] - 1.0).abs() < within;
        assert!((0..3).all(is_near), "{case}, {name}: {found:?}, not {wanted:?}");
    }
}

/// By Beer's law, of a floor 1 m below 0 that is seen through sheets: one in front of it, two, and six that close each other.
#[test]
fn sheets_of_one_material_bound_one_medium() {
    let [top, bottom] = [2.0, 0.7];
    let ends = [(top, Vec3::Y), (bottom, Vec3::NEG_Y)].map(|(y, n)| sheet(Vec3::Y * y, n, 4.0));
    let sides = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z];
    let walls = sides.map(|n| sheet(n * 2.0 + Vec3::Y * 1.35, n, 4.0));
    let meshes: Vec<_> = ends.into_iter().chain(walls).collect();
    for (case, count, length) in
        [("one sheet", 1, top + 1.0), ("two sheets", 2, top - bottom), ("six", 6, top - bottom)]
    {
        let mut builder = bright_floor();
        for mesh in &meshes[..count] {
            put(&mut builder, "sheet", mesh.clone(), fog(FOG, None));
            builder.objects.last_mut().unwrap().material = 1;
        }
        assert_seen(case, &builder, passed(&[(FOG, length)]));
    }
}

/// A lamp in fog of which only the front is bounded, by a sheet, and by a box without a floor of its own.
#[test]
fn light_begins_behind_an_open_boundary_as_the_camera_ends_there() {
    const FRONT: f32 = 1.6;
    let lamp = Vec3::new(0.2, 1.1, -0.1);
    let wanted = of_lit_floor(lamp, 1.5, |r| passed(&[(FOG, r + FRONT)]));
    let mut open = Mesh::clone(&block([30.0, 30.0], -0.5, FRONT));
    open.triangles.drain(4..6);
    for (case, boundary) in [("a sheet", sheet(Vec3::Y * FRONT, Vec3::Y, 30.0)), ("a box", Arc::new(open))] {
        let mut builder = lit_floor(lamp, 1.5);
        put(&mut builder, "front", boundary, fog(FOG, None));
        assert_mean(case, &builder, (1, 16), wanted);
    }
}

/// A lamp before the front of the fog, and a camera within: only from the front on is something lost.
#[test]
fn nothing_is_lost_before_an_open_boundary() {
    let lamp = Vec3::new(0.2, 1.9, -0.1);
    const FRONT: f32 = 0.7;
    let wanted = of_lit_floor(lamp, 1.5, |r| passed(&[(FOG, r * FRONT / lamp.y + FRONT)]));
    let mut builder = lit_floor(lamp, 1.5);
    put(&mut builder, "front", sheet(Vec3::Y * FRONT, Vec3::Y, 30.0), fog(FOG, None));
    assert_mean("before", &builder, (1, 16), wanted);
    let eye = &mut builder.cameras[0].spec;
    *eye = eye.clone().with("position", Vec3::Y * 0.4);
    let wanted = of_lit_floor(lamp, 1.5, |r| passed(&[(FOG, r * FRONT / lamp.y + 0.4)]));
    assert_mean("a camera within", &builder, (1, 16), wanted);
}

/// The fraction of light that plates of these indices pass, one on the other, with all reflections between their faces: of each face r, they
/// pass 1 / (1 + Σ r / (1 - r)).
fn passed_by_plates(indices: &[f32]) -> f32 {
    let all: Vec<f32> = [1.0].iter().chain(indices).chain(&[1.0]).copied().collect();
    let lost = |pair: &[f32]| {
        let amplitude = (pair[0] - pair[1]) / (pair[0] + pair[1]);
        let r = amplitude * amplitude;
        r / (1.0 - r)
    };
    1.0 / (1.0 + all.windows(2).map(lost).sum::<f32>())
}

fn glass(eta: f32) -> Spec {
    Spec::new("", "dielectric").with("eta", eta)
}

/// Plates of glass without a priority whose faces lie on each other are in contact: between those of one index nothing is there.
#[test]
fn glass_that_touches_glass_is_in_contact() {
    let heights = [0.3, 0.9, 1.27, 1.4, 1.95, 2.3];
    for indices in [&[1.5, 1.5][..], &[1.5; 5], &[1.5, 1.33], &[1.33, 1.7, 1.2]] {
        for is_reversed in [false, true] {
            let mut builder = bright_floor();
            for (i, eta) in indices.iter().enumerate() {
                // Faces of two sizes, shifted, so that no corner lies on another.
                let mesh = block([3.0 + 0.4 * i as f32, 3.5 - 0.3 * i as f32], heights[i], heights[i + 1]);
                put(&mut builder, &format!("plate {i}"), mesh, glass(*eta));
            }
            if is_reversed {
                builder.objects[1..].reverse();
            }
            let wanted = Rgb::grey(passed_by_plates(indices));
            for (name, found) in crate::nesting::seen(&builder, 32) {
                let error = (found.g / wanted.g - 1.0).abs();
                assert!(error < 0.012, "{indices:?}, {is_reversed}, {name}: {found:?}, not {wanted:?}");
            }
        }
    }
}

/// With media inside, of which one has a priority: (1 - r)² a b / (1 - (r a b)²), where a and b are what each leaves.
#[test]
fn media_of_glass_that_touches_are_both_there() {
    let [first, second] = [FOG, Rgb::new(0.1, 0.2, 1.3)];
    for priority in [0, 3] {
        let mut builder = bright_floor();
        put(&mut builder, "lower", block([3.0, 2.5], 0.3, 0.9), glass(1.5).with("absorption", first));
        let upper = glass(1.5).with("absorption", second).with("priority", Value::Integer(priority));
        put(&mut builder, "upper", block([2.5, 3.0], 0.9, 2.2), upper);
        let left = passed(&[(first, 0.6), (second, 1.3)]);
        let wanted = left.map(|ab| 0.96 * 0.96 * ab / (1.0 - 0.04 * ab * 0.04 * ab));
        for (name, found) in crate::nesting::seen(&builder, 32) {
            let error = (0..3).map(|c| (found[c] / wanted[c] - 1.0).abs()).fold(0.0, f32::max);
            assert!(error < 0.012, "{priority}, {name}: {found:?}, not {wanted:?}");
        }
    }
}

/// A lamp over milk whose upper part an interface cuts away, so that no glass is between: as over the same medium without glass.
#[test]
fn milk_that_an_interface_cuts_open_is_lit() {
    let lamp = Vec3::new(1.5, 4.0, 0.0);
    let of = |parts: &[(&str, Spec, [f32; 2])]| {
        let mut builder = lit_floor(lamp, 0.5);
        builder.objects.clear();
        for (name, spec, [low, high]) in parts {
            put(&mut builder, name, block([30.0, 30.0], *low, *high), spec.clone());
        }
        let eye = &mut builder.cameras[0].spec;
        *eye = eye.clone().with("position", Vec3::Y * 2.5);
        let settings = RenderSettings { max_depth: 64, ..RenderSettings::new(16, 16, 64) };
        let pixels = shoot(&built(&builder), &*integrator("path"), &settings).film.to_rgb();
        pixels.into_iter().sum::<Rgb>().g / 256.0
    };
    let filled = |spec: Spec| spec.with("scattering", 2.0f32).with("absorption", 0.8f32);
    let milk = filled(glass(1.35)).with("priority", Value::Integer(1));
    let cut = Spec::new("", "interface").with("priority", Value::Integer(2));
    let found = of(&[("milk", milk, [-4.0, 1.0]), ("cut", cut, [0.0, 2.0])]);
    let wanted = of(&[("milk", filled(Spec::new("", "interface")), [-4.0, 0.0])]);
    assert!((found / wanted - 1.0).abs() < 0.03, "{found}, not {wanted}");
}

/// A plate whose index is that of what is around it bends nothing and blocks nothing: ρ/π I cos/r².
#[test]
fn what_has_the_index_of_its_surroundings_blocks_no_light() {
    let lamp = Vec3::new(0.2, 1.6, -0.1);
    let wanted = of_lit_floor(lamp, 1.0, |_| Rgb::WHITE);
    let clear = Spec::new("", "principled").with("transmission_weight", 1.0f32).with("specular_ior", 1.0f32);
    let in_water = glass(1.33).with("priority", Value::Integer(2));
    let cases = [
        ("glass", glass(1.0)),
        ("thin glass", glass(1.0).with("thin", true)),
        ("rough glass", glass(1.0).with("roughness", 0.4f32)),
        ("with a priority", glass(1.0).with("priority", Value::Integer(3))),
        ("principled", clear.clone()),
        ("thin principled", clear.with("thin_walled", true)),
        ("in water", in_water),
    ];
    for (case, spec) in cases {
        let mut builder = lit_floor(lamp, 1.0);
        put(&mut builder, "plate", block([3.0, 2.0], 0.9, 1.1), spec);
        if case == "in water" {
            let water = glass(1.33).with("priority", Value::Integer(1));
            put(&mut builder, "water", block([90.0, 90.0], -9.0, 9.0), water);
        }
        assert_mean(case, &builder, (4, 16), wanted);
    }
}
