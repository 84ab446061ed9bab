//! Labels of pixels, where they are known without rendering.

use crate::common::labelled::Labelled;
use crate::common::{ball, built, diffuse, floor, integrator, look, put, quad, still_life};
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::transcendental::tan;
use bilux_math::{Quat, Transform, Vec2, Vec3};
use bilux_scene::{Scene, SceneBuilder, Visibility};
use bilux_transport::labels::{Moment, silhouettes};
use bilux_transport::{RenderSettings, Silent, Window, features};

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
    let found = Labelled::between(&scene, &settings, [Some(moment), None]);
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
    let found = Labelled::between(&here, &RenderSettings::new(41, 41, 1), [Some(moment), None]);
    let metre = 41.0 / (2.0 * 7.5 * tan(20f32.to_radians()));
    let middle = found.motion[20 * 41 + 20];
    assert!(middle.distance(Vec2::new(-0.1 * metre, 0.0)) < 0.05, "{middle}: it moves to the left");
}

/// A point of the floor moves down by what the projection says when the camera, a second later, is higher by 0.2 m.
#[test]
fn motion_counts_where_the_camera_is_at_either_time() {
    let scene = crate::common::moving().build(&Default::default(), [0.0, 0.5], 1.0).unwrap();
    let camera = &*scene.cameras()[0].1;
    let settings = RenderSettings::new(40, 40, 1);
    let moment = Moment { scene: &scene, camera, time: 1.0 };
    let found = Labelled::between(&scene, &settings, [Some(moment), None]);
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
        let settings = RenderSettings { seed, ..RenderSettings::new(SIZE, SIZE, spp) };
        let features = features(&scene, camera, &*integrator("path"), &settings, None, &Silent);
        (features.unwrap().unwrap(), Labelled::of(&scene, &settings))
    };
    let (means, labels) = both(0, 1);
    let (other_means, others) = both(7, 16);
    assert!(labels == others && means.mean_depth != other_means.mean_depth, "means do depend on the seed");
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
            assert!(labels.position[i].distance(at(t)) < 1e-4, "at {x}, {y}: {}", labels.position[i]);
            assert!((labels.z_depth[i] - t).abs() < 1e-4, "at {x}, {y}: {}", labels.z_depth[i]);
            assert!(labels.camera_normal[i].distance(n) < 1e-5, "the camera's axes are those of the world");
            assert!(labels.normal[i].distance(n) < 1e-5, "at {x}, {y}: {}", labels.normal[i]);
            counts[object as usize] += 1;
        }
    }
    assert!(counts[1] > 100 && counts[3] > 100 && counts[4] > 100, "{counts:?}");
}

/// Labels of coincident faces of two media are those of the medium that light meets there, whichever face rounding puts
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
    let settings = RenderSettings::new(40, 40, 1);
    let camera = &*scene.cameras()[0].1;
    let labels = Labelled::of(&scene, &settings);
    assert!(labels.object.iter().all(|object| *object == 2), "{:?}", labels.object);
    assert!(labels.material.iter().all(|material| *material == 2));
    // Motion is of the same surface.
    let mut moved = builder.clone();
    moved.objects[1].motion = Motion::still(bilux_math::Transform::translate(Vec3::X * 0.5).unwrap());
    let moved = built(&moved);
    let moment = Moment { scene: &moved, camera, time: 0.0 };
    let found = Labelled::between(&scene, &settings, [Some(moment), None]);
    assert!(found.motion.iter().all(|motion| motion.x > 2.0), "{:?}", found.motion);
}

/// While the shutter is open for a second the ball rises by a metre: labels are of where it is at first.
#[test]
fn labels_are_of_the_moment_when_the_shutter_opens() {
    let scene = rising().build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    let found = Labelled::of(&scene, &RenderSettings::new(41, 41, 1));
    let metre = 41.0 / (2.0 * 7.5 * tan(20f32.to_radians()));
    let (middle, above) = (20 * 41 + 20, (20 - metre as usize) * 41 + 20);
    assert!((found.position[middle].length() - 0.5).abs() < 0.01, "{}", found.position[middle]);
    assert_eq!(found.position[above], Vec3::ZERO, "it is not there yet");
}

fn at_time(scene: &Scene, time: f32) -> Moment<'_> {
    Moment { scene, camera: &*scene.cameras()[0].1, time }
}

/// A card that slides to the right past a wall, and a camera that does not move: flow by hand to 1e-4 pixels in both directions, and
/// what the card hides at the other moment is what its shadow from the eye covers there.
#[test]
fn flow_and_what_it_hides_are_those_of_known_poses() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-9.0, -9.0, -5.0), Vec3::X * 18.0, Vec3::Y * 18.0),
        diffuse(0.5f32),
    );
    put(&mut builder, "card", quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X, Vec3::Y * 2.0), diffuse(0.5f32));
    let at = |x: f32| MotionKey {
        time_seconds: x,
        translation: Vec3::X * x,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    builder.objects[1].motion = Motion::from_keys(vec![at(-1.0), at(1.0)]).unwrap();
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 40.0);
    const SIZE: u32 = 64;
    let settings = RenderSettings::new(SIZE, SIZE, 1);
    let of = |time: f32| builder.build(&Default::default(), [time; 2], 1.0).unwrap();
    let (scene, next, previous) = (of(0.0), of(0.25), of(-0.5));
    let others = [Some(at_time(&next, 0.25)), Some(at_time(&previous, -0.5))];
    let found = Labelled::between(&scene, &settings, others);
    let half = f64::from(tan(20f32.to_radians()));
    let pixels_per_metre = |z: f64| f64::from(SIZE) / (2.0 * half * (5.0 - z));
    let mut counts = [0; 4];
    for y in 0..SIZE {
        for x in 0..SIZE {
            let i = (y * SIZE + x) as usize;
            let film = |i: u32| (f64::from(i) + 0.5) / f64::from(SIZE) * 2.0 - 1.0;
            let (u, v) = (film(x) * half, -film(y) * half);
            // Where the ray meets the plane of the card.
            let (on_x, on_y) = (5.0 * u, 5.0 * v);
            let covers = |shift: f64| on_x > shift - 1.0 && on_x < shift && on_y.abs() < 1.0;
            let is_card = covers(0.0);
            let moves = |shift: f64| if is_card { shift * pixels_per_metre(0.0) } else { 0.0 };
            for (motion, shift) in [(found.motion[i], 0.25), (found.backward_motion[i], -0.5)] {
                assert!(
                    (f64::from(motion.x) - moves(shift)).abs() < 1e-4 && motion.y == 0.0,
                    "{x}, {y}: {motion}"
                );
            }
            let hidden = [0.25, -0.5].map(|shift| !is_card && covers(shift));
            assert_eq!(found.occluded[i].to_array().map(|hidden| hidden == 1.0), hidden, "{x}, {y}");
            counts[usize::from(is_card)] += 1;
            counts[2] += usize::from(hidden[0]);
            counts[3] += usize::from(hidden[1]);
        }
    }
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
}

/// A point that moves out of the picture is not visible there either; what stands still while nothing moves always is.
#[test]
fn what_leaves_the_picture_counts_as_hidden() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-99.0, -99.0, 0.0), Vec3::X * 198.0, Vec3::Y * 198.0),
        diffuse(0.5f32),
    );
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 40.0);
    let here = built(&builder);
    builder.cameras.clear();
    look(&mut builder, Vec3::new(1.0, 0.0, 5.0), Vec3::X, 40.0);
    let there = built(&builder);
    let settings = RenderSettings::new(32, 32, 1);
    let moved = Moment { scene: &there, camera: &*there.cameras()[0].1, time: 0.0 };
    let same = Moment { scene: &here, camera: &*here.cameras()[0].1, time: 0.1 };
    let found = Labelled::between(&here, &settings, [Some(moved), Some(same)]);
    // A metre is this many pixels.
    let metre = 32.0 / (2.0 * 5.0 * tan(20f32.to_radians()));
    for i in 0..32 * 32 {
        let is_out = (i % 32) as f32 + 0.5 < metre;
        assert_eq!(found.occluded[i], Vec2::new(f32::from(u8::from(is_out)), 0.0), "{i}");
    }
}

/// A triangle's corners weighted by the labels are the position, whether the object is instanced, moves or stands still.
#[test]
fn barycentric_labels_give_the_position() {
    let mut builder = still_life();
    for (i, object) in builder.objects.iter_mut().enumerate() {
        object.instanced = i % 2 == 1;
    }
    let scene = built(&builder);
    let found = Labelled::of(&scene, &RenderSettings::new(40, 30, 1));
    let mut seen = 0;
    for (i, object) in found.object.iter().enumerate().filter(|(_, object)| **object > 0) {
        let Some(object) = builder.objects.get(*object as usize - 1) else { continue };
        let corners = object.mesh.triangles[found.primitive[i] as usize - 1];
        let [a, b, c] = corners.map(|v| object.motion.at(0.0).point(object.mesh.positions[v as usize]));
        let Vec2 { x: u, y: v } = found.barycentric[i];
        let p = a * (1.0 - u - v) + b * u + c * v;
        assert!(p.distance(found.position[i]) < 1e-4, "{p} is not {}", found.position[i]);
        seen += 1;
    }
    assert!(seen > 600, "{seen}");
}

#[test]
fn labels_are_the_same_for_any_number_of_threads_and_any_part() {
    let scene = built(&still_life());
    let base = RenderSettings::new(40, 30, 8);
    let all = Labelled::of(&scene, &RenderSettings { threads: 1, ..base.clone() });
    assert!(Labelled::of(&scene, &RenderSettings { threads: 3, ..base.clone() }) == all);
    assert!(Labelled::of(&scene, &RenderSettings { samples: 3..5, seed: 7, ..base.clone() }) == all);
    let crop = Window { x: 7, y: 5, width: 20, height: 11 };
    let part = Labelled::of(&scene, &RenderSettings { crop: Some(crop), ..base });
    for i in 0..crop.pixels() {
        let (x, y) = crop.position(i);
        let whole = (y * 40 + x) as usize;
        assert_eq!((part.position[i], part.uv[i]), (all.position[whole], all.uv[whole]));
        assert_eq!((part.object[i], part.depth[i]), (all.object[whole], all.depth[whole]));
    }
}

/// Two cards, one in front of the other, and both beyond the picture's edge: each silhouette is that of the card alone.
#[test]
fn silhouettes_are_those_of_each_object_alone() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "back",
        quad(Vec3::new(-4.0, -0.5, -1.0), Vec3::X * 5.0, Vec3::Y * 1.5),
        diffuse(0.5f32),
    );
    put(&mut builder, "front", quad(Vec3::new(-0.5, -3.0, 0.0), Vec3::X, Vec3::Y * 6.0), diffuse(0.5f32));
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 40.0);
    let settings = RenderSettings::new(48, 48, 1);
    let scene = built(&builder);
    let camera = &*scene.cameras()[0].1;
    let groups = [Some(0), Some(1)];
    let margin = 10;
    let both = silhouettes(&scene, camera, &settings, &groups, 2, margin, &Silent).unwrap().unwrap();
    let together = Labelled::of(&scene, &settings);
    for (object, found) in both.iter().enumerate() {
        let mut alone = builder.clone();
        alone.objects[1 - object].visibility = Visibility::Hidden;
        let alone = built(&alone);
        let labels = Labelled::of(&alone, &settings);
        let mask = decoded(&found.whole.runs, 68);
        let visible = decoded(&found.visible.runs, 68);
        for y in 0..48 {
            for x in 0..48 {
                let (i, at) = (y * 48 + x, (x + 10) * 68 + y + 10);
                assert_eq!(mask[at], labels.object[i] == object as u32 + 1, "{object}: {x}, {y}");
                assert_eq!(visible[at], together.object[i] == object as u32 + 1, "{object}: {x}, {y}");
            }
        }
        assert_eq!(found.whole.pixels, mask.iter().filter(|inside| **inside).count() as u64);
        assert_eq!(found.visible.pixels, visible.iter().filter(|inside| **inside).count() as u64);
    }
    let [left, top, width, height] = both[0].whole.bounds.unwrap();
    let metre = 48.0 / (2.0 * 6.0 * tan(20f32.to_radians()));
    // It is cut off by the margin on the left, and complete elsewhere.
    assert_eq!(left, -10);
    assert!((width as f32 - (34.0 + metre)).abs() <= 1.0 && (height as f32 - 1.5 * metre).abs() <= 1.0);
    assert!((top as f32 - (24.0 - metre)).abs() <= 1.0, "{top}");
    assert_eq!(both[1].visible.bounds.unwrap()[1], 0, "what is visible ends with the picture");
}

/// Bounds are those of the pixels inside: of what leans to either side, whose ends are not in the first and the last column, with a margin and
/// without.
#[test]
fn bounds_of_silhouettes_hold_all_of_their_pixels() {
    let mut builder = SceneBuilder::default();
    for (name, leans) in [("right", 1.5), ("left", -1.5)] {
        let strip = quad(Vec3::new(-0.2, -1.0, 0.0), Vec3::new(0.3, 0.0, 0.0), Vec3::new(leans, 2.0, 0.0));
        put(&mut builder, name, strip, diffuse(0.5f32));
    }
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 40.0);
    let (scene, settings) = (built(&builder), RenderSettings::new(40, 30, 1));
    let groups = [Some(0), Some(1)];
    for margin in [0, 7] {
        let camera = &*scene.cameras()[0].1;
        let found = silhouettes(&scene, camera, &settings, &groups, 2, margin, &Silent).unwrap().unwrap();
        for mask in found.iter().flat_map(|one| [&one.whole, &one.visible]) {
            let rows = 30 + 2 * i64::from(margin);
            let inside = decoded(&mask.runs, rows as usize);
            let places = (0..).zip(&inside).filter(|(_, inside)| **inside).map(|(i, _)| [i / rows, i % rows]);
            let places: Vec<[i64; 2]> = places.collect();
            let side = |axis: usize| {
                let along = || places.iter().map(|place| place[axis]);
                let (first, last) = (along().min().unwrap(), along().max().unwrap());
                [first - i64::from(margin), last - first + 1]
            };
            let ([left, width], [top, height]) = (side(0), side(1));
            assert_eq!(mask.bounds, Some([left, top, width, height]), "with a margin of {margin}");
        }
    }
}

/// Pixels that runs of columns of this height cover.
fn decoded(runs: &[u32], height: usize) -> Vec<bool> {
    let pixels: Vec<bool> =
        runs.iter().enumerate().flat_map(|(i, run)| std::iter::repeat_n(i % 2 == 1, *run as usize)).collect();
    assert_eq!(pixels.len() % height, 0);
    pixels
}

/// The camera does not see it, but the wall behind it; a mirror sees both.
#[test]
fn what_the_camera_does_not_see_has_no_label() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-9.0, -9.0, -5.0), Vec3::X * 18.0, Vec3::Y * 18.0),
        diffuse(0.5f32),
    );
    put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 12, true), diffuse(0.5f32));
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 40.0);
    let settings = RenderSettings::new(33, 33, 4);
    let middle = 16 * 33 + 16;
    let seen = |visibility: Visibility, moves: bool| {
        let mut builder = builder.clone();
        builder.objects[1].visibility = visibility;
        if moves {
            builder.objects[1].motion = Motion::still(Transform::translate(Vec3::X * 1e-3).unwrap());
            builder.objects[1].instanced = true;
        }
        let scene = built(&builder);
        let found = features(&scene, &*scene.cameras()[0].1, &*integrator("path"), &settings, None, &Silent);
        (Labelled::of(&scene, &settings).object[middle], found.unwrap().unwrap().mean_depth[middle])
    };
    for moves in [false, true] {
        assert_eq!(seen(Visibility::Full, moves).0, 2);
        for hidden in [Visibility::NoCamera, Visibility::Hidden] {
            let (object, depth) = seen(hidden, moves);
            assert_eq!(object, 1);
            assert!((depth - 10.0).abs() < 0.1, "{depth}");
        }
    }
}
