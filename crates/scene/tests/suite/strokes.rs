//! Points and lines: rays hit them in the right place, with the colours of their vertices, wherever their object is.

use bilux_math::{DMat4, DVec3, Motion, MotionKey, Rgb, Transform, Vec3};
use bilux_scene::{AccelChoice, Mesh, Object, Ray, Scene, SceneBuilder, Spec, StrokeWidths, Tracer};
use std::sync::Arc;

const RED: Rgb = Rgb::new(1.0, 0.0, 0.0);
const BLUE: Rgb = Rgb::new(0.0, 0.0, 1.0);

/// A point at -x, and a line from the origin to +x.
fn mesh() -> Mesh {
    Mesh {
        positions: vec![Vec3::NEG_X * 3.0, Vec3::ZERO, Vec3::X * 4.0],
        vertex_kd: vec![BLUE, RED, BLUE],
        vertex_ks: vec![RED, Rgb::grey(0.8), Rgb::grey(0.4)],
        points: vec![0],
        lines: vec![[1, 2]],
        ..Mesh::default()
    }
}

fn scene(object: impl FnOnce(Object) -> Object) -> Scene {
    let mut builder = SceneBuilder {
        stroke_widths: StrokeWidths { points: 1.0, lines: 0.5 },
        materials: vec![Spec::new("", "diffuse")],
        ..SceneBuilder::default()
    };
    builder.objects.push(object(Object::new("", Arc::new(mesh()), 0)));
    builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
}

fn from_above(scene: &Scene, x: f32, z: f32) -> Option<bilux_scene::Surface> {
    Tracer::new(scene, false).closest(&Ray::new([x, 10.0, z], [0.0, -1.0, 0.0]))
}

#[test]
fn points_are_balls_and_lines_are_tubes_with_colours_between_their_ends() {
    let still = scene(|o| o);
    let hit = from_above(&still, -3.0, 0.0).unwrap();
    assert_eq!((hit.p, hit.n_geom, hit.vertex_kd), (Vec3::new(-3.0, 0.5, 0.0), Vec3::Y, Some(BLUE)));
    let hit = from_above(&still, 1.0, 0.0).unwrap();
    assert_eq!((hit.p, hit.n_geom), (Vec3::new(1.0, 0.25, 0.0), Vec3::Y));
    let kd = hit.vertex_kd.unwrap();
    assert!((kd.r - 0.75).abs() < 1e-6 && (kd.b - 0.25).abs() < 1e-6, "{kd:?}");
    let ks = hit.vertex_ks.unwrap();
    assert!((ks.r - 0.7).abs() < 1e-6 && (ks.b - 0.7).abs() < 1e-6, "{ks:?}");
    assert!(from_above(&still, 1.0, 0.26).is_none() && from_above(&still, -3.0, 0.51).is_none());
    // A round end.
    assert!(from_above(&still, 4.2, 0.0).is_some() && from_above(&still, 4.26, 0.0).is_none());
    // A ray that leaves a point or line does not hit it again.
    let mut tracer = Tracer::new(&still, false);
    for hit in [from_above(&still, -2.8, 0.3).unwrap(), from_above(&still, 2.0, 0.2).unwrap()] {
        assert!(tracer.closest(&hit.spawn(hit.n_geom)).is_none());
        assert!(tracer.closest(&hit.spawn(-hit.n_geom)).is_some_and(|far| far.t > 0.1));
    }
}

#[test]
fn stroke_widths_are_in_world_space() {
    let matrix = DMat4::from_scale_rotation_translation(
        DVec3::splat(2.0),
        bilux_math::glam::DQuat::from_rotation_y(0.5),
        DVec3::new(0.0, 1.0, 3.0),
    );
    let place = Transform::from_matrix(matrix).unwrap();
    let key = |time_seconds| MotionKey {
        time_seconds,
        translation: Vec3::new(0.0, 1.0 + time_seconds, 3.0),
        rotation: bilux_math::glam::Quat::from_rotation_y(0.5),
        scale: Vec3::splat(2.0),
    };
    let moving = Motion::from_keys(vec![key(0.0), key(1.0)]).unwrap();
    let scenes = [
        scene(|o| o.placed(place)),
        scene(|o| Object { instanced: true, ..o.placed(place) }),
        scene(|o| Object { motion: moving, ..o }),
    ];
    for scene in &scenes {
        let middle = place.point(Vec3::X * 2.0);
        let hit = from_above(scene, middle.x, middle.z).unwrap();
        assert!((hit.p - (middle + Vec3::Y * 0.25)).length() < 1e-5, "{}", hit.p);
        assert!((hit.n_geom - Vec3::Y).length() < 1e-5);
        assert!((hit.vertex_kd.unwrap().r - 0.5).abs() < 1e-5);
        let ball = place.point(Vec3::NEG_X * 3.0);
        let hit = from_above(scene, ball.x, ball.z).unwrap();
        assert!((hit.p.y - (ball.y + 0.5)).abs() < 1e-5);
        assert!(Tracer::new(scene, false).closest(&hit.spawn(Vec3::Y)).is_none());
    }
}

#[test]
fn invalid_vertex_indices_are_rejected() {
    let mut builder = SceneBuilder { materials: vec![Spec::new("", "diffuse")], ..SceneBuilder::default() };
    let bad = Mesh { points: vec![7], ..mesh() };
    builder.objects.push(Object::new("dots", Arc::new(bad), 0));
    let message = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).err().unwrap().to_string();
    assert!(message.contains("vertex 7, but only 3 vertices"), "{message}");
}

#[test]
fn doubling_the_resolution_halves_stroke_widths() {
    let mut builder = SceneBuilder::default();
    let positions: Vec<Vec3> =
        (0..100_000).map(|i| Vec3::new((i % 317) as f32, (i / 317) as f32, 0.0)).collect();
    let (points, lines) = ((0..100_000).collect(), vec![[0, 1]]);
    builder.objects.push(Object::new("", Arc::new(Mesh { positions, points, lines, ..Mesh::default() }), 0));
    bilux_scene::presets::complete(&mut builder, &Default::default());
    let widths = |side: u32| {
        let mut scene = builder.clone();
        bilux_scene::presets::set_stroke_widths(&mut scene, "0", [side; 2], 0.0);
        scene.stroke_widths
    };
    let (small, large) = (widths(128), widths(256));
    assert!((small.lines / large.lines - 2.0).abs() < 1e-4, "{small:?} {large:?}");
    // One point per millimetre: points cover the space between neighbours, and no more than a few pixels.
    let huge = widths(4096);
    assert!(huge.points > 1.0 && huge.points < 2.0, "{huge:?}");
    assert!(small.points >= large.points && small.points < 20.0, "{small:?}");
}

#[test]
fn lines_without_a_colour_are_dark_on_the_pale_ground_and_dense_clouds_are_clay() {
    let kd_of = |mesh: Mesh| {
        let mut builder = SceneBuilder { materials: vec![Spec::new("", "phong")], ..SceneBuilder::default() };
        builder.objects.push(Object::new("", Arc::new(mesh), 0));
        bilux_scene::presets::complete(&mut builder, &Default::default());
        format!("{:?}", builder.materials[0].parameters.find("kd").map(|(value, _)| value.clone()))
    };
    let bare = |mesh: Mesh| Mesh { vertex_kd: Vec::new(), ..mesh };
    let positions: Vec<Vec3> = (0..6000).map(|i| Vec3::new((i % 80) as f32, (i / 80) as f32, 0.0)).collect();
    let cloud = Mesh { positions, points: (0..6000).collect(), ..Mesh::default() };
    let (line, cloud) = (kd_of(bare(mesh())), kd_of(cloud));
    assert!(line.contains("Number(0.059") && cloud.contains("Number(0.62"), "{line} {cloud}");
}
