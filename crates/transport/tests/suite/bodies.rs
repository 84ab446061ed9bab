//! Bodies that media are in, as a scene knows them before a path is traced.

use crate::common::media::{grid_in, smoke};
use crate::common::{along, ball, built, put};
use crate::nesting::{block, fog};
use bilux_math::transcendental::sin_cos;
use bilux_math::{DMat3, DMat4, DVec3, Motion, Rgb, Transform, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Mesh, SceneBuilder, Spec, Tracer};
use std::f32::consts::TAU;
use std::sync::Arc;

fn still(matrix: DMat4) -> Motion {
    Motion::still(Transform::from_matrix(matrix).unwrap())
}

/// A disk of this many triangles, with a radius of 1 m, that faces +z in its own space.
fn disk(count: u32) -> Arc<Mesh> {
    let edge = |i: u32| {
        let (sin, cos) = sin_cos(i as f32 / count as f32 * TAU);
        Vec3::new(cos, sin, 0.0)
    };
    let positions = std::iter::once(Vec3::ZERO).chain((0..count).map(edge)).collect();
    let triangles = (0..count).map(|i| [0, i + 1, (i + 1) % count + 1]).collect();
    Arc::new(Mesh { positions, triangles, ..Mesh::default() })
}

fn with_camera(mut builder: SceneBuilder) -> SceneBuilder {
    let spec = Spec::new("", "perspective").with("position", Vec3::Z * 9.0);
    builder.cameras = vec![CameraSpec { spec, keyframes: Vec::new() }];
    builder
}

/// Open sheets of one material bound one body together, but a grid fills each body on its own.
#[test]
fn sheets_share_a_body_but_grids_do_not() {
    let [min, max] = [Vec3::splat(-1.0), Vec3::splat(1.0)];
    let grid = grid_in(min, max, [2, 2, 2], |[x, _, _]| x as f32 + 0.5);
    for (material, second) in [(fog(Rgb::grey(0.5), None), 0), (smoke(1.0f32, 0.5f32, grid), 1)] {
        let mut builder = with_camera(SceneBuilder::default());
        put(&mut builder, "a", disk(4), material);
        let mut other = builder.objects[0].clone();
        other.motion = still(DMat4::from_translation(DVec3::new(5.0, 0.0, 0.0)));
        builder.objects.push(other);
        let scene = built(&builder);
        assert_eq!([scene.body(0), scene.body(1)], [0, second]);
    }
}

/// Two sheets of one body, the second turned away and with most of the triangles: whether a point is behind them follows from where they stand,
/// at the moment that is asked for.
#[test]
fn what_is_behind_an_open_boundary_follows_from_the_places_of_its_sheets() {
    let mut builder = with_camera(SceneBuilder::default());
    put(&mut builder, "small", disk(3), fog(Rgb::grey(0.5), None));
    let mut large = builder.objects[0].clone();
    large.mesh = disk(24);
    // It faces +x, 4 m to the right.
    let turned = DMat4::from_mat3(DMat3::from_cols(-DVec3::Z, DVec3::Y, DVec3::X));
    large.motion = still(DMat4::from_translation(DVec3::new(4.0, 0.0, -4.0)) * turned);
    builder.objects.push(large);
    let scene = built(&builder);
    let mut tracer = Tracer::new(&scene, false);
    assert_eq!(scene.body(1), 0);
    // Before the first and behind the second, and the other way round.
    for (p, wanted) in [(Vec3::new(0.0, 0.0, 2.0), &[0u32][..]), (Vec3::new(9.0, 0.0, -4.0), &[])] {
        assert_eq!(tracer.behind_open_boundaries(p, 0.0), wanted, "{p}");
    }
    // One that moves past a point.
    let mut builder = with_camera(SceneBuilder::default());
    put(&mut builder, "curtain", disk(6), fog(Rgb::grey(0.5), None));
    builder.objects[0].motion = along(Vec3::Z * -1.0, Vec3::Z * 1.0);
    let scene = builder.build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    let mut tracer = Tracer::new(&scene, false);
    for (time, wanted) in [(0.0, &[][..]), (1.0, &[0u32]), (0.25, &[]), (0.75, &[0])] {
        assert_eq!(tracer.behind_open_boundaries(Vec3::ZERO, time), wanted, "{time} s");
    }
}

/// A ball that fills the bounds of a block lies within it, however large the ball's own mesh is before it is scaled.
#[test]
fn volumes_are_those_in_the_scene() {
    for (radius, is_ball_first) in [(10.0, true), (10.0, false), (0.1, true), (0.1, false)] {
        let mut builder = with_camera(SceneBuilder::default());
        put(&mut builder, "block", block([2.0, 2.0], -1.0, 1.0), fog(Rgb::grey(0.5), None));
        put(&mut builder, "ball", ball(Vec3::ZERO, radius, 12, false), fog(Rgb::grey(2.0), None));
        builder.objects[1].motion = still(DMat4::from_scale(DVec3::splat(1.0 / f64::from(radius))));
        if is_ball_first {
            builder.objects.swap(0, 1);
        }
        let scene = built(&builder);
        let ranks = [0, 1].map(|object| scene.nesting(object));
        assert!((ranks[0] > ranks[1]) == is_ball_first, "radius {radius}: {ranks:?}");
    }
}
