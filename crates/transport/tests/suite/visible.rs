//! What compositors are told of visible surfaces, where it is known without rendering.

use crate::common::{ball, built, diffuse, floor, integrator, look, put, still_life};
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::transcendental::tan;
use bilux_math::{Quat, Vec2, Vec3};
use bilux_scene::{Scene, SceneBuilder};
use bilux_transport::visible::{MIN_SAMPLES, Moment, Wanted};
use bilux_transport::{RenderSettings, Silent, Visible, Window, visible};

fn seen(scene: &Scene, settings: &RenderSettings, wanted: &Wanted) -> Visible {
    let camera = &*scene.cameras()[0].1;
    let wanted = (wanted, settings.spp);
    visible(scene, camera, &*integrator("path"), settings, wanted, &Silent).unwrap().unwrap()
}

/// A ball that rises by a metre in a second, seen from 8 metres away, and the floor.
fn rising() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(-2.0, 40.0), diffuse(0.5f32));
    put(&mut builder, "ball", ball(Vec3::ZERO, 0.5, 12, true), diffuse(0.5f32));
    let key = |time_seconds: f32, y: f32| MotionKey {
        time_seconds,
        translation: Vec3::Y * y,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    builder.objects[1].motion = Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 1.0)]).unwrap();
    look(&mut builder, Vec3::new(0.0, 0.0, 8.0), Vec3::ZERO, 40.0);
    builder
}

#[test]
fn motion_is_in_pixels_to_the_right_and_upwards() {
    let scene = built(&rising());
    let settings = RenderSettings::new(41, 41, 1);
    let moment = Moment { scene: &scene, camera: &*scene.cameras()[0].1, time: 0.25 };
    let wanted = Wanted { position: true, motion: Some(moment), ..Wanted::default() };
    let found = seen(&scene, &settings, &wanted);
    let (middle, below) = (20 * 41 + 20, 38 * 41 + 20);
    // A quarter of a metre, a little nearer than 8 metres.
    let metre = 41.0 / (2.0 * 7.5 * tan(20f32.to_radians()));
    assert!(found.motion[middle].distance(Vec2::new(0.0, 0.25 * metre)) < 0.1, "{}", found.motion[middle]);
    assert_eq!(found.motion[below], Vec2::ZERO, "the floor does not move at all");
    assert!((found.position[below].y + 2.0).abs() < 1e-4);
    assert!((found.position[middle].length() - 0.5).abs() < 0.05);
}

#[test]
fn a_moving_camera_moves_everything() {
    let (here, mut builder) = (built(&rising()), rising());
    builder.cameras.clear();
    look(&mut builder, Vec3::new(0.1, 0.0, 8.0), Vec3::new(0.1, 0.0, 0.0), 40.0);
    let there = built(&builder);
    let moment = Moment { scene: &here, camera: &*there.cameras()[0].1, time: 0.0 };
    let wanted = Wanted { motion: Some(moment), ..Wanted::default() };
    let found = seen(&here, &RenderSettings::new(41, 41, 1), &wanted);
    let metre = 41.0 / (2.0 * 7.5 * tan(20f32.to_radians()));
    let middle = found.motion[20 * 41 + 20];
    assert!(middle.distance(Vec2::new(-0.1 * metre, 0.0)) < 0.05, "{middle}: it moves to the left");
    assert!(found.position.is_empty() && found.uv.is_empty(), "only what was asked for");
}

#[test]
fn coverage_is_exact_where_it_is_known() {
    let scene = built(&still_life());
    let objects = scene.geometry().objects().len() as u32;
    let ids: Vec<u32> = (1..=objects).collect();
    let wanted = Wanted { ids: vec![ids, vec![7; objects as usize]], ..Wanted::default() };
    let found = seen(&scene, &RenderSettings::new(40, 30, 32), &wanted);
    let mut edges = 0;
    for (each, together) in found.mattes[0].iter().zip(&found.mattes[1]) {
        let total: f32 = each.iter().map(|(_, share)| share).sum();
        assert!((together[0].1 - total).abs() < 1e-6 && together[1] == (0, 0.0));
        assert!(together[0].0 == if total > 0.0 { 7 } else { 0 });
        assert!(each.windows(2).all(|pair| pair[0].1 >= pair[1].1), "those that cover most come first");
        edges += u32::from(each[1].1 > 0.0);
    }
    assert!(edges > 20, "{edges}");
}

#[test]
fn the_same_for_any_number_of_threads_and_any_part() {
    let scene = built(&still_life());
    let ids = vec![(1..=scene.geometry().objects().len() as u32).collect()];
    let wanted = Wanted { position: true, uv: true, ids, ..Wanted::default() };
    let base = RenderSettings::new(40, 30, 8);
    let all = seen(&scene, &RenderSettings { threads: 1, ..base.clone() }, &wanted);
    assert!(seen(&scene, &RenderSettings { threads: 3, ..base.clone() }, &wanted) == all);
    assert!(seen(&scene, &RenderSettings { samples: 3..5, ..base.clone() }, &wanted) == all);
    let few = RenderSettings { spp: MIN_SAMPLES, samples: 0..1, ..base.clone() };
    assert!(seen(&scene, &few, &wanted) == all, "a picture of few samples has no rougher edges");
    let crop = Window { x: 7, y: 5, width: 20, height: 11 };
    let part = seen(&scene, &RenderSettings { crop: Some(crop), ..base }, &wanted);
    for i in 0..crop.pixels() {
        let (x, y) = crop.position(i);
        let whole = (y * 40 + x) as usize;
        assert_eq!((part.position[i], part.uv[i]), (all.position[whole], all.uv[whole]));
        assert_eq!(part.mattes[0][i], all.mattes[0][whole]);
    }
}
