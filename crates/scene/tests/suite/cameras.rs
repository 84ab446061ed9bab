//! Cameras of the table, asked of the world: whether a square pixel is square, whether the middle of a calibrated picture stays the
//! middle, whether rays meet where the camera is focused, and whether all that has keyframes moves between them.

use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::{DVec2, DVec3, Vec2, Vec3};
use bilux_scene::cameras::{CameraSpec, build};
use bilux_scene::{CAMERAS, Camera, CameraSample, Parameters, Spec, Value};
use std::sync::Arc;

fn camera(spec: &Spec, aspect: f32) -> Arc<dyn Camera> {
    build(&CameraSpec::new(spec.clone()), aspect).unwrap()
}

/// Layouts of the two eyes of stereo in a picture: columns and rows of parts, and the values of the parameter.
const LAYOUTS: [(&str, [f64; 2]); 5] = [
    ("none", [1.0, 1.0]),
    ("left", [1.0, 1.0]),
    ("right", [1.0, 1.0]),
    ("side-by-side", [2.0, 1.0]),
    ("over-under", [1.0, 2.0]),
];

/// Separation of the rays of two points of the film: an angle, and a distance for parallel rays.
fn between(camera: &dyn Camera, film: DVec2, step: DVec2) -> f64 {
    let [a, b] = [film - step * 0.5, film + step * 0.5].map(|film| camera.ray_f64(film, 0.0).unwrap());
    a[1].cross(b[1]).length() + (a[0] - b[0]).length()
}

/// Every camera, eye by eye, at the middle of its part: as much lies across a pixel as along it. Pictures have as many pixels to
/// the metre in both directions; that of a panorama is all around, which takes a shape of its own.
#[test]
fn square_pixels_are_square() {
    for row in CAMERAS {
        let has_eyes = row.entry.parameters.iter().any(|parameter| parameter.name == "stereo");
        for (stereo, [columns, rows]) in if has_eyes { &LAYOUTS[..] } else { &LAYOUTS[..1] } {
            for (width, height) in [(640.0, 480.0), (480.0, 640.0), (600.0, 200.0)] {
                let is_all_around = row.entry.name == "panorama";
                let (width, height) =
                    if is_all_around { (400.0 * columns, 200.0 * rows) } else { (width, height) };
                let mut spec = Spec::new("", row.entry.name);
                if has_eyes {
                    // The eyes of a panorama turn with their rays, and add a distance to the angle.
                    spec = spec
                        .with("stereo", *stereo)
                        .with("eye_distance", if is_all_around { 1e-6f32 } else { 0.1 });
                }
                let camera = camera(&spec, (width / height) as f32);
                for eye in 0..(columns * rows) as usize {
                    let part = DVec2::new(
                        if *columns > 1.0 { eye as f64 } else { 0.0 },
                        if *rows > 1.0 { eye as f64 } else { 0.0 },
                    );
                    let film = (part + 0.5) / DVec2::new(*columns, *rows);
                    let across = between(&*camera, film, DVec2::new(1.0 / width, 0.0));
                    let along = between(&*camera, film, DVec2::new(0.0, 1.0 / height));
                    assert!(
                        (across / along - 1.0).abs() < 1e-4,
                        "{} {stereo}, {width} x {height}, eye {eye}: {across} across, {along} along",
                        row.entry.name
                    );
                }
            }
        }
    }
}

/// Pictures that show all as it is, whatever the window: twice as wide as high for all around, and as many times for two eyes.
#[test]
fn panoramas_have_a_shape_of_their_own() {
    let shape = |settings: &[(&str, Value)]| {
        let mut spec = Spec::new("", "panorama");
        settings.iter().for_each(|(key, value)| spec.parameters.set(key, value.clone()));
        camera(&spec, 1.0).shape().unwrap()
    };
    let [both, above] = ["side-by-side", "over-under"].map(|stereo| ("stereo", Value::from(stereo)));
    let wide = [("fov_x", number(180.0)), ("fov", number(60.0))];
    for (settings, expected) in [
        (&[][..], 2.0),
        (&[both], 4.0),
        (&[above], 1.0),
        (&[("mapping", Value::from("cube"))], 6.0),
        (&wide, 3.0),
    ] {
        assert!((shape(settings) - expected).abs() < 1e-9, "{settings:?}: {}", shape(settings));
    }
    assert!(
        CAMERAS.iter().filter(|row| camera(&Spec::new("", row.entry.name), 1.0).shape().is_some()).count()
            == 1
    );
}

/// The middle of the picture looks forward, whatever its size; and what a calibrated camera sees at a pixel is at the same place of
/// a picture that is twice as large: 2 u + 1/2, since pixels have their centres at whole numbers.
#[test]
fn the_middle_of_a_picture_stays_the_middle() {
    for row in CAMERAS {
        let spec = Spec::new("", row.entry.name)
            .with("position", Vec3::new(1.0, 2.0, 5.0))
            .with("look_at", Vec3::new(0.5, 1.0, -3.0))
            .with("up", Vec3::new(0.1, 1.0, 0.2));
        for aspect in [0.7, 4.0 / 3.0, 3.0] {
            let camera = camera(&spec, aspect);
            let [position, ahead] = camera.ray_f64(DVec2::splat(0.5), 0.0).unwrap();
            let forward = (DVec3::new(0.5, 1.0, -3.0) - DVec3::new(1.0, 2.0, 5.0)).normalize();
            assert!(ahead.dot(forward) > 1.0 - 1e-6, "{} {aspect}: {ahead}", row.entry.name);
            assert!((position - DVec3::new(1.0, 2.0, 5.0)).length() < 1e-6, "{}", row.entry.name);
        }
        if !row.entry.parameters.iter().any(|parameter| parameter.name == "fx") {
            continue;
        }
        let (width, height, [cx, cy]) = (500.0, 300.0, [260.0, 140.0]);
        let calibrated = [("width", 500), ("height", 300)];
        let spec = calibrated.into_iter().fold(spec, |spec, (key, side)| spec.with(key, side));
        let numbers = [("fx", 400.0f32), ("fy", 380.0), ("cx", cx as f32), ("cy", cy as f32), ("k1", 0.02)];
        let spec = numbers.into_iter().fold(spec, |spec, (key, number)| spec.with(key, number));
        let camera = camera(&spec, width / height);
        // Of pixel u in a picture `scale` times as large: (u + 1/2) / (scale width).
        let film = |u: f64, v: f64, scale: f64| {
            DVec2::new(u + 0.5, v + 0.5) / (DVec2::new(f64::from(width), f64::from(height)) * scale)
        };
        for [u, v] in [[cx, cy], [17.0, 250.0]] {
            let one = camera.ray_f64(film(u, v, 1.0), 0.0).unwrap()[1];
            let two = camera.ray_f64(film(2.0 * u + 0.5, 2.0 * v + 0.5, 2.0), 0.0).unwrap()[1];
            assert!((one - two).length() < 1e-12, "{}", row.entry.name);
        }
        let on_axis = camera.ray_f64(film(cx, cy, 1.0), 0.0).unwrap()[1];
        let forward = (DVec3::new(0.5, 1.0, -3.0) - DVec3::new(1.0, 2.0, 5.0)).normalize();
        assert!(
            on_axis.dot(forward) > 1.0 - 1e-6,
            "{}: the principal point looks along the axis",
            row.entry.name
        );
    }
}

/// Two keyframes of a camera.
fn moving(kind: &str, all: &[(&str, Value)], keys: [&[(&str, Value)]; 2]) -> CameraSpec {
    let mut spec = Spec::new("", kind);
    all.iter().for_each(|(key, value)| spec.parameters.set(key, value.clone()));
    let key = |(time, changes): (f32, &&[(&str, Value)])| {
        let mut parameters = Parameters::default();
        changes.iter().for_each(|(key, value)| parameters.set(key, value.clone()));
        (time, parameters)
    };
    CameraSpec { spec, keyframes: [0.0, 2.0].into_iter().zip(&keys).map(key).collect() }
}

fn number(x: f32) -> Value {
    Value::from(x)
}

/// Maximum distance, at a depth along the axis, between the ray of a point of the film through the middle of the lens and
/// its other rays.
fn focus_of(camera: &dyn Camera, film: Vec2, time: f32, depth: f32) -> f32 {
    let discs = [[0.0, 0.0], [0.9, 0.1], [-0.7, 0.6], [0.1, -0.95], [-0.3, -0.4]].map(Vec2::from);
    let forward = camera.forward(time);
    let at_depth = |lens: Vec2| {
        let ray = camera.ray(&CameraSample { film, lens, time });
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        let middle = Vec3::from(camera.ray(&CameraSample { film, lens: Vec2::ZERO, time }).origin);
        origin + direction * ((depth - (origin - middle).dot(forward)) / direction.dot(forward))
    };
    let middle = at_depth(Vec2::ZERO);
    discs.iter().map(|lens| at_depth(*lens).distance(middle)).fold(0.0, f32::max)
}

/// Half-way between two keyframes a camera is focused half-way between their distances: on those that are given, and on what it
/// looks at.
#[test]
fn rays_meet_at_the_focus_between_keyframes() {
    let mut lenses = 0;
    for row in CAMERAS.iter().filter(|row| row.entry.parameters.iter().any(|p| p.name == "aperture")) {
        lenses += 1;
        let towards = |z: f32| Value::from(Vec3::new(0.0, 0.0, z));
        let of_focus: [&[(&str, Value)]; 2] = [&[("focus", number(2.0))], &[("focus", number(6.0))]];
        let of_place: [&[(&str, Value)]; 2] = [&[("look_at", towards(3.0))], &[("look_at", towards(-1.0))]];
        for (keys, blades) in [(of_focus, 0), (of_focus, 6), (of_place, 0)] {
            let all =
                [("aperture", number(0.2)), ("blades", Value::from(blades)), ("position", towards(5.0))];
            let camera = build(&moving(row.entry.name, &all, keys), 1.5).unwrap();
            for (time, focus) in [(0.0, 2.0), (0.5, 3.0), (1.0, 4.0), (1.5, 5.0), (2.0, 6.0), (9.0, 6.0)] {
                for film in [Vec2::splat(0.5), Vec2::new(0.1, 0.8)] {
                    let apart = focus_of(&*camera, film, time, focus);
                    assert!(apart < 1e-5 * focus, "{}, blades {blades}, {time} s: {apart}", row.entry.name);
                    for other in [focus - 0.5, focus + 0.5] {
                        assert!(
                            focus_of(&*camera, film, time, other) > 0.01,
                            "{time} s: {other} m is out of focus"
                        );
                    }
                }
            }
        }
    }
    assert!(lenses > 0);
}

/// Two values of a parameter, and what else it takes to see them; `None` if it chooses a kind of picture.
fn two_values(parameter: &Parameter) -> Option<[Value; 2]> {
    let vector = |x: f32, y: f32, z: f32| Value::from(Vec3::new(x, y, z));
    Some(match parameter.name {
        "position" => [vector(0.0, 0.0, 5.0), vector(1.0, 0.5, 7.0)],
        "look_at" => [vector(0.0, 0.0, 0.0), vector(0.7, -0.4, -1.0)],
        "up" => [vector(0.0, 1.0, 0.0), vector(0.5, 1.0, 0.0)],
        "fov" => [number(60.0), number(90.0)],
        "fov_x" => [number(120.0), number(200.0)],
        "focus" => [number(2.0), number(6.0)],
        "aperture" => [number(0.1), number(0.3)],
        "eye_distance" => [number(0.1), number(0.4)],
        "convergence" => [number(2.0), number(6.0)],
        "pixel_aspect" => [number(1.0), number(1.5)],
        "principal_x" | "principal_y" => [number(0.5), number(0.8)],
        "fx" | "fy" => [number(500.0), number(700.0)],
        "cx" | "cy" => [number(200.0), number(300.0)],
        "blades_rotation" | "focus_tilt_x" | "focus_tilt_y" => [number(5.0), number(25.0)],
        "height" if matches!(parameter.kind, ParameterKind::Number { .. }) => [number(2.0), number(3.0)],
        _ => match parameter.kind {
            ParameterKind::Number { .. } if parameter.name != "frame" => [number(0.01), number(0.03)],
            _ => return None,
        },
    })
}

/// Rays of a camera at a time, with a lens.
fn rays(camera: &dyn Camera, time: f32) -> Vec<f32> {
    let films = [[0.5, 0.5], [0.3, 0.6], [0.75, 0.55]].map(Vec2::from);
    let lens = Vec2::new(0.6, -0.5);
    let ray = |film: Vec2| {
        let ray = camera.ray(&CameraSample { film, lens, time });
        [ray.origin, ray.direction].concat()
    };
    films.into_iter().flat_map(ray).collect()
}

/// Every parameter that is a number or a place changes between its keyframes, bit by bit, or keyframes of it are refused: what
/// stays as it was at the first keyframe would be noticed, and what jumps at the second.
#[test]
fn all_that_has_keyframes_moves_between_them() {
    let mut wrong = Vec::new();
    for row in CAMERAS {
        for parameter in row.entry.parameters {
            let Some([first, last]) = two_values(parameter) else { continue };
            let has = |name: &str| row.entry.parameters.iter().any(|parameter| parameter.name == name);
            let mut all = Vec::new();
            let mut add = |key: &'static str, value: Value| {
                if has(key) && parameter.name != key {
                    all.push((key, value));
                }
            };
            add("aperture", number(0.1));
            add("blades", Value::from(5));
            add("focus", number(3.0));
            if ["eye_distance", "convergence"].contains(&parameter.name) {
                add("stereo", Value::from("left"));
            }
            let keys: [&[(&str, Value)]; 2] = [&[(parameter.name, first)], &[(parameter.name, last)]];
            let Ok(camera) = build(&moving(row.entry.name, &all, keys), 4.0 / 3.0) else {
                continue;
            };
            let at = [0.0, 0.9, 1.1, 2.0].map(|time| rays(&*camera, time));
            let apart =
                |a: usize, b: usize| at[a].iter().zip(&at[b]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let whole = apart(0, 3);
            let name = format!("{} of {}", parameter.name, row.entry.name);
            let parts = [apart(0, 1), apart(1, 2), apart(2, 3)];
            let moves = |part: &f32| *part > 0.02 * whole && *part < 0.9 * whole;
            if whole <= 1e-4 || !parts.iter().all(moves) {
                wrong.push(format!("{name}: {parts:?} of {whole}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Both precisions mean the same, of pictures as they are and mirrored: away from the middle, and back along the ray.
#[test]
fn points_are_seen_in_the_same_place_by_both_precisions() {
    for row in CAMERAS {
        let can_mirror = row.entry.parameters.iter().any(|parameter| parameter.name == "mirrored");
        for mirrored in if can_mirror { &[false, true][..] } else { &[false] } {
            let mut spec = Spec::new("", row.entry.name);
            if can_mirror {
                spec = spec.with("mirrored", *mirrored);
            }
            let camera = camera(&spec, 1.5);
            let Some([origin, direction]) = camera.ray_f64(DVec2::new(0.3, 0.6), 0.0) else { continue };
            let p = origin + direction * 3.0;
            let places = [camera.project_f64(p, 0.0), camera.project(p.as_vec3(), 0.0).map(Vec2::as_dvec2)];
            for film in places.into_iter().flatten() {
                let off = film.distance(DVec2::new(0.3, 0.6));
                assert!(off < 1e-4, "{}, mirrored {mirrored}: {film}", row.entry.name);
            }
        }
    }
}
