//! Media within media: what is inside exists there, in whatever order a file names them, and however many surfaces a ray passes.

use crate::common::{built, diffuse, floor, integrator, look, put, shoot};
use bilux_math::transcendental::exp;
use bilux_math::{Motion, Rgb, Transform, Vec3};
use bilux_scene::{AccelChoice, MAX_NESTED, Mesh, SceneBuilder, Spec, Value};
use bilux_transport::RenderSettings;
use std::sync::Arc;

/// Absorption of the outer medium and of the one inside, per metre.
const OUTER: Rgb = Rgb { r: 0.3, g: 1.0, b: 0.05 };
const INNER: Rgb = Rgb { r: 2.0, g: 0.1, b: 0.5 };

/// A closed box about the middle of its heights, with sides of these lengths.
pub(crate) fn block([x, z]: [f32; 2], low: f32, high: f32) -> Arc<Mesh> {
    let pick = |i: usize, [a, b]: [f32; 2]| if i == 0 { a } else { b };
    let corner = |i: usize| {
        let (x, z) = (pick(i & 1, [-x, x]) / 2.0, pick(i >> 2, [-z, z]) / 2.0);
        Vec3::new(x, pick(i >> 1 & 1, [low, high]), z)
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Arc::new(Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() })
}

pub(crate) fn fog(absorption: Rgb, priority: Option<i64>) -> Spec {
    let spec = Spec::new("", "interface").with("absorption", absorption);
    priority.map_or(spec.clone(), |priority| spec.with("priority", Value::Integer(priority)))
}

/// A bright floor, seen from 6 m above.
pub(crate) fn bright_floor() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(-1.0, 3.0), diffuse(0.0f32).with("emission", 1.0f32));
    look(&mut builder, Vec3::new(0.01, 6.0, 0.02), Vec3::new(0.01, 0.0, 0.02), 1.0);
    let eye = &mut builder.cameras[0].spec;
    *eye = eye.clone().with("up", Vec3::X);
    builder
}

/// Light that each integrator sees.
pub(crate) fn seen(builder: &SceneBuilder, spp: u32) -> Vec<(&'static str, Rgb)> {
    let scene = built(builder);
    let of = |name| {
        let settings = RenderSettings { max_depth: 64, ..RenderSettings::new(8, 8, spp) };
        let pixels = shoot(&scene, &*integrator(name), &settings).film.to_rgb();
        (name, pixels.iter().fold(Rgb::BLACK, |sum, pixel| sum + *pixel) * (1.0 / 64.0))
    };
    ["path", "bdpt", "vcm"].map(of).into()
}

pub(crate) fn passed(lengths: &[(Rgb, f32)]) -> Rgb {
    let depth = |channel: usize| lengths.iter().map(|(sigma, length)| sigma[channel] * length).sum::<f32>();
    Rgb::new(exp(-depth(0)), exp(-depth(1)), exp(-depth(2)))
}

pub(crate) fn assert_seen(case: &str, builder: &SceneBuilder, wanted: Rgb) {
    for (name, found) in seen(builder, 4) {
        let is_near = |channel: usize| (found[channel] / wanted[channel] - 1.0).abs() < 2e-3;
        assert!((0..3).all(is_near), "{case}, {name}: {found:?}, not {wanted:?}");
    }
}

/// By Beer's law: 0.6 m of the inner medium, and 1.3 m of the one around it.
#[test]
fn the_inner_of_two_media_exists_whatever_their_order() {
    let wanted = passed(&[(OUTER, 1.3), (INNER, 0.6)]);
    let (large, small) = (block([4.0, 3.0], 0.1, 2.0), block([2.0, 2.5], 0.7, 1.3));
    for is_outer_first in [true, false] {
        for [outer, inner] in
            [[None, None], [Some(1), Some(1)], [Some(0), Some(1)], [Some(7), Some(7)], [None, Some(2)]]
        {
            let mut builder = bright_floor();
            let mut parts = [("outer", &large, fog(OUTER, outer)), ("inner", &small, fog(INNER, inner))];
            if !is_outer_first {
                parts.reverse();
            }
            parts
                .into_iter()
                .for_each(|(name, mesh, material)| put(&mut builder, name, mesh.clone(), material));
            assert_seen(&format!("{outer:?} and {inner:?}, outer first: {is_outer_first}"), &builder, wanted);
        }
    }
    // A higher priority outside is stated: there is nothing inside.
    let mut builder = bright_floor();
    put(&mut builder, "inner", small, fog(INNER, Some(1)));
    put(&mut builder, "outer", large, fog(OUTER, Some(2)));
    assert_seen("outer wins", &builder, passed(&[(OUTER, 1.9)]));
}

/// Blocks that stand somewhere else by themselves count where they are placed: there the inner one is inside the other.
#[test]
fn the_inner_of_two_placed_media_exists() {
    let wanted = passed(&[(OUTER, 1.3), (INNER, 0.6)]);
    for is_outer_first in [true, false] {
        let mut builder = bright_floor();
        // By itself the inner one is larger, and apart.
        put(&mut builder, "outer", block([0.4, 0.3], 10.01, 10.2), fog(OUTER, None));
        put(&mut builder, "inner", block([20.0, 25.0], -3.0, 3.0), fog(INNER, None));
        let place = |scale: f32, y: f32| {
            let moved = Transform::translate(Vec3::Y * y).unwrap();
            Motion::still(Transform::scale(Vec3::splat(scale)).unwrap().then(&moved))
        };
        builder.objects[1].motion = place(10.0, -100.0);
        builder.objects[2].motion = place(0.1, 1.0);
        if !is_outer_first {
            builder.objects.swap(1, 2);
        }
        assert_seen(&format!("outer first: {is_outer_first}"), &builder, wanted);
    }
}

/// An object that touches the bounds of the other from inside lies within it, too: an upright prism whose edges are in the middle
/// of a block's sides.
#[test]
fn what_fills_the_bounds_of_the_other_is_around_it() {
    let corner = |i: usize, y: f32| Vec3::new([1.0, 0.0, -1.0, 0.0][i], y, [0.0, -1.0, 0.0, 1.0][i]);
    let positions = (0..4).map(|i| corner(i, 0.7)).chain((0..4).map(|i| corner(i, 1.3))).collect();
    let sides = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4 + (i + 1) % 4], [i, 4 + (i + 1) % 4, 4 + i]]);
    let ends = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    let prism = Arc::new(Mesh { positions, triangles: sides.chain(ends).collect(), ..Mesh::default() });
    for is_outer_first in [true, false] {
        let mut builder = bright_floor();
        put(&mut builder, "block", block([2.0, 2.0], 0.7, 1.3), fog(OUTER, None));
        put(&mut builder, "prism", prism.clone(), fog(INNER, None));
        if !is_outer_first {
            builder.objects.swap(1, 2);
        }
        assert_seen(&format!("outer first: {is_outer_first}"), &builder, passed(&[(INNER, 0.6)]));
    }
}

/// Of glass of an index of 1.5, all reflections between its faces summed: (1 - r) / (1 + r) with r = 0.04.
#[test]
fn glass_in_fog_of_the_same_priority_is_there() {
    let glass = Spec::new("", "dielectric").with("eta", 1.5f32).with("priority", Value::Integer(1));
    for is_fog_first in [true, false] {
        let mut builder = bright_floor();
        let mut parts = [
            ("fog", block([4.0, 3.0], 0.1, 2.0), fog(OUTER, None)),
            ("glass", block([2.0, 2.5], 0.7, 1.3), glass.clone()),
        ];
        if !is_fog_first {
            parts.reverse();
        }
        parts.into_iter().for_each(|(name, mesh, material)| put(&mut builder, name, mesh, material));
        // Light that is reflected between the glass and nothing else finds no way back.
        let wanted = passed(&[(OUTER, 1.3)]) * (0.96 / 1.04);
        for (name, found) in seen(&builder, 4) {
            let error = (found.r / wanted.r - 1.0).abs();
            assert!(error < 0.03, "fog first: {is_fog_first}, {name}: {found:?}, not {wanted:?}");
        }
    }
}

/// As many media inside each other as there may be, and one more.
#[test]
fn media_in_media_are_all_there_or_counted() {
    let onion = |count: usize| {
        let mut builder = bright_floor();
        let mut wanted = Vec::new();
        for i in 0..count {
            let (absorption, low) = (Rgb::new(0.1, 0.2, 0.05) * (i + 1) as f32, 0.1 + 0.1 * i as f32);
            let side = 4.0 - 0.3 * i as f32;
            put(
                &mut builder,
                &format!("layer {i}"),
                block([side, side], low, 2.5 - low),
                fog(absorption, None),
            );
            let inner = if i + 1 == count { 2.5 - 2.0 * low } else { 0.2 };
            wanted.push((absorption, inner));
        }
        // Not in the order of their sizes.
        let objects = &mut builder.objects;
        objects[1..].reverse();
        objects.swap(1, 2);
        (builder, passed(&wanted))
    };
    for count in [5, MAX_NESTED] {
        let (builder, wanted) = onion(count);
        assert_seen(&format!("{count} media"), &builder, wanted);
    }
    let error =
        onion(MAX_NESTED + 1).0.build(&AccelChoice::default(), [0.0; 2], 1.0).err().unwrap().to_string();
    assert!(error.contains("'layer 8' lies within 8 other media"), "{error}");
}

/// Fog around the camera is there whatever stands behind what the camera sees: cards, and boxes of other fog.
#[test]
fn fog_around_the_camera_is_known_past_any_number_of_surfaces() {
    for (cards, boxes) in [(0, 0), (200, 0), (0, 100), (40, 50)] {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "fog", block([900.0, 900.0], -900.0, 30.0), fog(OUTER, None));
        put(&mut builder, "wall", floor(-2.0, 3.0), diffuse(0.0f32).with("emission", 1.0f32));
        for i in 0..cards {
            put(&mut builder, "card", floor(-4.0 - 0.5 * i as f32, 3.0), diffuse(0.5f32));
        }
        for i in 0..boxes {
            let top = -4.0 - 2.0 * i as f32;
            put(&mut builder, "box", block([3.0, 2.0], top - 1.0, top), fog(INNER, None));
        }
        look(&mut builder, Vec3::new(0.01, 0.0, 0.02), Vec3::new(0.01, -1.0, 0.02), 1.0);
        let eye = &mut builder.cameras[0].spec;
        *eye = eye.clone().with("up", Vec3::X);
        assert_seen(&format!("{cards} cards and {boxes} boxes"), &builder, passed(&[(OUTER, 2.0)]));
    }
}
