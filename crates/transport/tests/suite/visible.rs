//! What compositors are told of visible surfaces, where it is known without rendering.

use crate::common::{ball, built, diffuse, floor, integrator, look, put, quad, still_life};
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::transcendental::tan;
use bilux_math::{Quat, Vec2, Vec3};
use bilux_scene::{Scene, SceneBuilder};
use bilux_transport::visible::{MIN_SAMPLES, Moment, Wanted};
use bilux_transport::{RenderSettings, Silent, Visible, Window, features, visible};

fn seen(scene: &Scene, settings: &RenderSettings, wanted: &Wanted) -> Visible {
    let camera = &*scene.cameras()[0].1;
    let samples = settings.spp;
    visible(scene, camera, &*integrator("path"), settings, wanted, samples, &Silent).unwrap().unwrap()
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

/// The same camera a second later, higher by 0.2 m: a point of the floor moves down by what the projection says.
#[test]
fn motion_counts_where_the_camera_is_at_either_time() {
    let scene = crate::common::moving().build(&Default::default(), [0.0, 0.5], 1.0).unwrap();
    let camera = &*scene.cameras()[0].1;
    let settings = RenderSettings::new(40, 40, 1);
    let moment = Moment { scene: &scene, camera, time: 1.0 };
    let wanted = Wanted { position: true, motion: Some(moment), ..Wanted::default() };
    let found = seen(&scene, &settings, &wanted);
    let floor = 30 * 40 + 8;
    let p = found.position[floor];
    assert!(p.y.abs() < 1e-5, "{p}");
    // A perspective projection by hand: the camera looks from (0, y, 4) to the origin, 50 degrees high.
    let project = |height: f32| {
        let eye = Vec3::new(0.0, height, 4.0);
        let forward = -eye.normalize();
        let (right, up) = (Vec3::X, Vec3::X.cross(forward));
        let away = p - eye;
        let scale = 20.0 / (away.dot(forward) * tan(25f32.to_radians()));
        Vec2::new(away.dot(right), away.dot(up)) * scale
    };
    let expected = project(4.1) - project(3.9);
    assert!(expected.length() > 0.3, "{expected}");
    assert!(found.motion[floor].distance(expected) < 1e-3, "{} for {expected}", found.motion[floor]);
}

/// All labels of a pixel are of the surface that the ray through its centre hits: the nearest that is opaque or at least half
/// so. The scene knows it too: three panes of different opacity, one behind the other, in front of a wall.
#[test]
fn all_labels_of_a_pixel_are_of_one_surface() {
    let mut builder = SceneBuilder::default();
    let pane = |opacity: f32| diffuse(0.5f32).with("opacity", opacity);
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-9.0, -9.0, -5.0), Vec3::X * 18.0, Vec3::Y * 18.0),
        diffuse(0.5f32),
    );
    // Covers the left two thirds, 1 m in front of the camera at z = 5, and is looked through.
    put(&mut builder, "faint", quad(Vec3::new(-3.0, -3.0, 4.0), Vec3::X * 3.2, Vec3::Y * 6.0), pane(0.49));
    // Tilted, so that no two of its points are equally far.
    let up = Vec3::new(0.0, 2.0, 1.0);
    put(&mut builder, "half", quad(Vec3::new(-0.7, -1.0, 0.0), Vec3::X * 1.1, up), pane(0.5));
    put(
        &mut builder,
        "card",
        quad(Vec3::new(0.1, -1.3, -1.0), Vec3::X * 1.7, Vec3::Y * 2.0),
        diffuse(0.5f32),
    );
    let spec = bilux_scene::Spec::new("eye", "perspective").with("position", Vec3::Z * 5.0);
    let spec = spec.with("look_at", Vec3::ZERO).with("fov", 40.0f32).with("aperture", 0.1f32);
    builder.cameras.push(bilux_scene::cameras::CameraSpec { spec, keyframes: Vec::new() });
    let scene = built(&builder);
    let camera = &*scene.cameras()[0].1;
    const SIZE: u32 = 48;
    let both = |seed: u64, spp: u32| {
        let settings = RenderSettings { seed, ids: true, ..RenderSettings::new(SIZE, SIZE, spp) };
        let wanted = Wanted { position: true, uv: true, ..Wanted::default() };
        let features = features(&scene, camera, &*integrator("path"), &settings, None, &Silent);
        (features.unwrap().unwrap(), seen(&scene, &settings, &wanted))
    };
    let (labels, points) = both(0, 1);
    let (others, same_points) = both(7, 16);
    assert!(labels.object == others.object && labels.depth == others.depth && points == same_points);
    assert!(
        labels.normal == others.normal && labels.mean_depth != others.mean_depth,
        "means do depend on the seed"
    );
    let half = tan(20f32.to_radians());
    let mut counts = [0; 5];
    for y in 0..SIZE {
        for x in 0..SIZE {
            // The ray through the pixel's centre, and the planes in order.
            let film = |i: u32| (i as f32 + 0.5) / SIZE as f32 * 2.0 - 1.0;
            let d = Vec3::new(film(x) * half, -film(y) * half, -1.0);
            let at = |t: f32| Vec3::Z * 5.0 + d * t;
            // z = (y + 1) / 2 on the tilted pane.
            let t = (5.0 - 0.5) / (1.0 + 0.5 * d.y);
            let on_half = at(t).x > -0.7 && at(t).x < 0.4 && at(t).y > -1.0 && at(t).y < 1.0;
            let on_card = at(6.0).x > 0.1 && at(6.0).x < 1.8 && at(6.0).y > -1.3 && at(6.0).y < 0.7;
            let (object, t, n) = match (on_half, on_card) {
                (true, _) => (3, t, Vec3::new(0.0, -1.0, 2.0).normalize()),
                (_, true) => (4, 6.0, Vec3::Z),
                _ => (1, 10.0, Vec3::Z),
            };
            let i = (y * SIZE + x) as usize;
            assert_eq!((labels.object[i], labels.material[i]), (object, object), "at {x}, {y}");
            assert!((labels.depth[i] - t * d.length()).abs() < 1e-4, "at {x}, {y}: {}", labels.depth[i]);
            assert!(points.position[i].distance(at(t)) < 1e-4, "at {x}, {y}: {}", points.position[i]);
            assert!(labels.normal[i].distance(n) < 1e-5, "at {x}, {y}: {}", labels.normal[i]);
            counts[object as usize] += 1;
        }
    }
    assert!(counts[1] > 100 && counts[3] > 100 && counts[4] > 100, "{counts:?}");
}

/// Where the faces of two media coincide, the label is that of the medium that light meets there, whichever face rounding puts
/// first, also among faces of the same distance.
#[test]
fn labels_of_coincident_faces_are_of_the_stronger_medium() {
    let mut builder = SceneBuilder::default();
    let medium = |priority: i64| {
        bilux_scene::Spec::new("", "dielectric").with("priority", bilux_scene::Value::Integer(priority))
    };
    put(&mut builder, "weaker", quad(Vec3::new(-9.0, -7.0, 0.1), Vec3::X * 17.0, Vec3::Y * 19.0), medium(1));
    put(
        &mut builder,
        "stronger",
        quad(Vec3::new(-8.0, -8.0, 0.1), Vec3::X * 16.0, Vec3::Y * 16.0),
        medium(2),
    );
    look(&mut builder, Vec3::new(0.4, 0.7, 3.0), Vec3::new(0.0, 0.0, 0.1), 40.0);
    let scene = built(&builder);
    let settings = RenderSettings { ids: true, ..RenderSettings::new(40, 40, 1) };
    let camera = &*scene.cameras()[0].1;
    let features = features(&scene, camera, &*integrator("path"), &settings, None, &Silent).unwrap().unwrap();
    assert!(features.object.iter().all(|object| *object == 2), "{:?}", features.object);
    assert!(features.material.iter().all(|material| *material == 2));
    // Motion is of the same surface.
    let mut moved = builder.clone();
    moved.objects[1].motion = Motion::still(bilux_math::Transform::translate(Vec3::X * 0.5).unwrap());
    let moved = built(&moved);
    let moment = Moment { scene: &moved, camera, time: 0.0 };
    let found = seen(&scene, &settings, &Wanted { motion: Some(moment), ..Wanted::default() });
    assert!(found.motion.iter().all(|motion| motion.x > 2.0), "{:?}", found.motion);
}

/// A fraction of each pixel of a column lies beyond the edge of a wall, where there is nothing.
#[test]
fn coverage_beside_nothing_is_the_area_of_the_pixel() {
    let mut builder = SceneBuilder::default();
    // 20 pixels of a tenth: the wall ends 0.3 into the column 10.
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-5.0, -5.0, 0.0), Vec3::X * 5.03, Vec3::Y * 10.0),
        diffuse(0.5f32),
    );
    let spec = bilux_scene::Spec::new("eye", "orthographic").with("position", Vec3::Z * 5.0);
    let spec = spec.with("look_at", Vec3::ZERO).with("height", 2.0f32);
    builder.cameras.push(bilux_scene::cameras::CameraSpec { spec, keyframes: Vec::new() });
    let scene = built(&builder);
    let filter = bilux_transport::Filter::from_name("box").unwrap();
    let settings = RenderSettings { filter, ..RenderSettings::new(20, 20, 128) };
    let found = seen(&scene, &settings, &Wanted { ids: vec![vec![7]], ..Wanted::default() });
    let column = |x: usize| (0..20).map(|y| found.mattes[0][y * 20 + x][0].1).sum::<f32>() / 20.0;
    assert_eq!((column(9), column(11)), (1.0, 0.0));
    // 2,560 samples: a standard error of 0.009 if they were random.
    assert!((column(10) - 0.3).abs() < 0.03, "{}", column(10));
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

/// While the shutter is open for a second the ball rises by a metre: labels are of where it is at first.
#[test]
fn labels_are_of_the_moment_when_the_shutter_opens() {
    let scene = rising().build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    let wanted = Wanted { position: true, ..Wanted::default() };
    let found = seen(&scene, &RenderSettings::new(41, 41, 1), &wanted);
    let metre = 41.0 / (2.0 * 7.5 * tan(20f32.to_radians()));
    let (middle, above) = (20 * 41 + 20, (20 - metre as usize) * 41 + 20);
    assert!((found.position[middle].length() - 0.5).abs() < 0.01, "{}", found.position[middle]);
    assert_eq!(found.position[above], Vec3::ZERO, "it is not there yet");
}
