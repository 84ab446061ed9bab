//! Presets: the framed model is visible, missing parts are added, and existing ones are kept.

use bilux_math::motion::Motion;
use bilux_math::transcendental::asin;
use bilux_math::{DMat4, DVec3, Transform, Vec2, Vec3};
use bilux_scene::cameras::{self, CameraSpec};
use bilux_scene::mesh::shapes;

use bilux_scene::lights::{LIGHTS, surrounds};
use bilux_scene::presets::{Ground, PRESETS, Studio, apply, complete};
use bilux_scene::{AccelChoice, Axis, CameraSample, Mesh, Object, SceneBuilder, Spec, UpHint, Value};
use std::sync::Arc;

fn scene_of(mesh: Mesh) -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(Spec::new("", "diffuse"));
    scene.objects.push(Object::new("it", Arc::new(mesh), material));
    scene
}

fn points(positions: &[[f32; 3]]) -> SceneBuilder {
    let positions: Vec<Vec3> = positions.iter().map(|&p| Vec3::from(p)).collect();
    let triangles = (0..positions.len() as u32).map(|i| [i, i, i]).collect();
    scene_of(Mesh { positions, triangles, ..Mesh::default() })
}

/// A round body, longer to one side than to the other, which stands on the plane y = 0.
fn pot() -> SceneBuilder {
    let mut mesh = shapes::blob(Vec3::ZERO, 3, |d| 1.6 + 0.9 * d.x * d.x + 0.4 * d.x);
    let lowest = mesh.bounds().min.y;
    mesh.positions.iter_mut().for_each(|p| p.y -= lowest);
    scene_of(mesh)
}

/// Position at which the scene's camera sees a point, -1..=1 within a square image; derived from the camera's own rays.
fn seen_at(scene: &SceneBuilder, p: Vec3) -> Option<Vec2> {
    seen_in(scene, p, 1.0)
}

/// Position at which a point is seen, from -1 to 1, in an image `aspect` times as wide as high.
fn seen_in(scene: &SceneBuilder, p: Vec3, aspect: f32) -> Option<Vec2> {
    let camera = cameras::build(&scene.cameras[0], aspect).unwrap();
    let ray = |x: f32, y: f32| {
        let ray = camera.ray(&CameraSample { film: Vec2::new(x, y), lens: Vec2::ZERO, time: 0.0 });
        (Vec3::from(ray.origin).as_dvec3(), Vec3::from(ray.direction).as_dvec3())
    };
    let (eye, forward) = ray(0.5, 0.5);
    let on_film = |(_, d): (DVec3, DVec3)| d / d.dot(forward) - forward;
    let (right, up) = (on_film(ray(1.0, 0.5)), on_film(ray(0.5, 0.0)));
    let to = p.as_dvec3() - eye;
    let depth = to.dot(forward);
    let at = to / depth;
    (depth > 0.0).then(|| {
        DVec3::new(at.dot(right) / right.length_squared(), at.dot(up) / up.length_squared(), 0.0)
            .truncate()
            .as_vec2()
    })
}

/// The maximum distance from the centre, on either axis, of any visible vertex except for the studio's floor.
fn reach(scene: &SceneBuilder) -> f32 {
    reach_in(scene, 1.0)
}

fn reach_in(scene: &SceneBuilder, aspect: f32) -> f32 {
    let model = scene.objects.iter().filter(|o| o.name != "studio floor");
    let vertices = model.flat_map(|o| {
        let to_world = o.motion.at(0.0);
        o.mesh.positions.iter().map(move |&p| to_world.point(p))
    });
    let seen = vertices.map(|p| seen_in(scene, p, aspect).map_or(f32::INFINITY, |q| q.abs().max_element()));
    seen.fold(0.0, f32::max)
}

fn builds(scene: &SceneBuilder) {
    let built = scene.build(&AccelChoice::default(), [0.0, 0.0], 1.0);
    assert!(built.is_ok(), "{:?}", built.err());
}

#[test]
fn a_bare_model_is_framed_whole_and_fills_the_picture() {
    let mut scene = pot();
    complete(&mut scene, &Studio::default());
    builds(&scene);
    let reach = reach(&scene);
    assert!((0.85..0.9).contains(&reach), "{reach}");
    // A long model fills a wide image, and a broad one a narrow image.
    for aspect in [0.4, 1.5, 3.0] {
        let mut scene = points(&[[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
        complete(&mut scene, &Studio { aspect: Some(aspect), ..Studio::default() });
        let reach = reach_in(&scene, aspect);
        assert!((0.85..0.9).contains(&reach), "{aspect}: {reach}");
    }
}

#[test]
fn framing_handles_degenerate_files() {
    let cases: [&[[f32; 3]]; 10] = [
        &[],
        &[[0.0; 3]],
        &[[5.0, -3.0, 1e6]],
        &[[0.0; 3], [0.0, 1.0, 0.0]],
        &[[-1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]],
        &[[0.0, -1.0, -1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]],
        &[[1e-20, 0.0, 0.0], [0.0, 2e-20, 0.0], [0.0, 0.0, -1e-20]],
        &[[1e15, 0.0, 0.0], [0.0, -1e15, 3e14], [0.0, 0.0, 1e15]],
        &[[1e6, 1e6, 1e6], [1e6, 1e6 + 100.0, 1e6]],
        &[[f32::NAN, 0.0, 0.0], [1.0, 1.0, 1.0], [0.0, 0.0, f32::INFINITY]],
    ];
    for case in cases {
        let mut scene = points(case);
        complete(&mut scene, &Studio::default());
        builds(&scene);
        if case.iter().flatten().all(|c| c.is_finite()) {
            let reach = reach(&scene);
            assert!(reach <= 0.9, "{case:?}: {reach}");
        }
    }
    for far in [1e30, 3e38] {
        let mut scene = points(&[[far, 0.0, 0.0], [-far, far, 0.0]]);
        complete(&mut scene, &Studio::default());
        builds(&scene);
    }
}

#[test]
fn a_bare_model_gets_clay_and_a_floor() {
    let mut scene = points(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    scene.materials[0] = Spec::new("default", "phong");
    complete(&mut scene, &Studio::default());
    assert!(scene.materials[0].parameters.find("kd").is_some());
    assert_eq!(scene.objects.len(), 2);
    let floor = &scene.objects[1].mesh.positions;
    let lowest = floor.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    assert!(lowest < 0.0 && lowest > -0.01);
    // The rising part is the wall behind the model.
    let away = |p: &Vec3| Vec2::new(p.x - 0.5, p.z).dot(Vec2::new(-0.447, -0.894));
    assert!(floor.iter().all(|p| p.y == lowest || away(p) > 2.0));
    let mut reported = points(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    reported.materials[0] = Spec::new("mine", "phong").with("kd", 0.1f32);
    let mine = reported.materials[0].clone();
    complete(&mut reported, &Studio::default());
    assert_eq!(reported.materials[0], mine);
}

#[test]
fn only_missing_parts_are_added() {
    let mut lit = pot();
    lit.lights.push(Spec::new("mine", "point"));
    complete(&mut lit, &Studio::default());
    assert_eq!((lit.lights.len(), lit.cameras.len(), lit.objects.len()), (1, 1, 1));

    let mut luminous = pot();
    luminous.materials[0].parameters.set("emission", 1.0f32);
    complete(&mut luminous, &Studio::default());
    assert_eq!((luminous.lights.len(), luminous.cameras.len()), (0, 1));
    for emission in ["emission", "medium_emission"] {
        let mut dark = pot();
        dark.materials[0].parameters.set(emission, Value::triple([0.0; 3]));
        complete(&mut dark, &Studio::default());
        assert_eq!((dark.lights.len(), dark.cameras.len()), (3, 1), "{emission}");
        // Fire is light, however dim.
        dark.lights.clear();
        dark.materials[0].parameters.set(emission, Value::triple([0.0, 0.01, 0.0]));
        complete(&mut dark, &Studio::default());
        assert_eq!(dark.lights.len(), 0, "{emission}");
    }

    let mut seen = pot();
    let mine = CameraSpec { spec: Spec::new("mine", "orthographic"), keyframes: Vec::new() };
    seen.cameras.push(mine.clone());
    complete(&mut seen, &Studio::default());
    // The light behind the model would be in view.
    let lights: Vec<_> = seen.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!((seen.cameras, lights), (vec![mine], vec!["key", "room"]));
}

#[test]
fn every_preset_gives_a_scene_that_builds() {
    for row in PRESETS {
        for mut scene in [pot(), points(&[]), points(&[[1.0; 3]])] {
            apply(row.entry.name, &mut scene).unwrap();
            builds(&scene);
        }
        let mut moving = pot();
        let key = |time_seconds: f32| bilux_math::MotionKey {
            time_seconds,
            translation: Vec3::X * time_seconds,
            rotation: bilux_math::Quat::IDENTITY,
            scale: Vec3::ONE,
        };
        moving.objects[0].motion = Motion::from_keys(vec![key(0.0), key(1.0)]).unwrap();
        apply(row.entry.name, &mut moving).unwrap();
        builds(&moving);
    }
    let error = apply("curse", &mut pot()).err().unwrap().to_string();
    assert!(error.contains("did you mean 'course'?"), "{error}");
}

#[test]
fn the_course_camera_is_left_handed() {
    let mut scene = pot();
    apply("course", &mut scene).unwrap();
    // From (-10, 5, -10) towards the origin, y × z points along (1, 0, -1).
    assert!(seen_at(&scene, Vec3::new(0.5, 0.0, -0.5)).unwrap().x > 0.0);
    assert!(seen_at(&scene, Vec3::Y * 0.5).unwrap().y > 0.0);
    // The foot of the pot, computed by hand: the origin maps to (0, -3.25, 3.5).
    assert_eq!(scene.objects[0].motion.at(0.0).point(Vec3::ZERO), Vec3::new(0.0, -3.25, 3.5));
}

#[test]
fn the_paper_looks_from_minus_one_through_a_screen_of_two_by_two() {
    let mut scene = pot();
    let wide = Transform::from_matrix(DMat4::from_scale(DVec3::new(1.0, 3.0, 1.0))).unwrap();
    scene.objects[0].motion = Motion::still(wide);
    apply("paper", &mut scene).unwrap();
    for corner in [Vec2::ONE, Vec2::NEG_ONE, Vec2::new(1.0, -1.0)] {
        let on_screen = seen_at(&scene, corner.extend(0.0)).unwrap();
        assert!(on_screen.distance(corner) < 1e-5, "{on_screen} for {corner}");
    }
    assert!(reach(&scene) < 1.0);
    assert!(scene.bounds(0.0).min.z > -0.6, "{:?}", scene.bounds(0.0));
}

#[test]
fn studio_options_are_applied() {
    // From the right, at mid-height, through a long lens: framed whole, as large as with any other.
    let asked = Studio {
        ground: Some(Ground::Mirror),
        orbit: Some([90.0, 0.0]),
        focal: Some(135.0),
        ..Studio::default()
    };
    let mut scene = pot();
    complete(&mut scene, &asked);
    builds(&scene);
    assert!((0.85..0.9).contains(&reach(&scene)), "{}", reach(&scene));
    let camera = cameras::build(&scene.cameras[0], 1.0).unwrap();
    let ray = camera.ray(&CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 });
    let direction = Vec3::from(ray.direction);
    assert!((direction - Vec3::NEG_X).length() < 1e-5, "{direction}");
    assert_eq!(scene.materials.last().map(|m| m.kind.as_str()), Some("mirror"));
    // The user's choices override the file's, and the rest of the file is kept.
    let mut seen = pot();
    seen.cameras.push(CameraSpec { spec: Spec::new("mine", "orthographic"), keyframes: Vec::new() });
    seen.lights.push(Spec::new("mine", "point"));
    complete(&mut seen, &Studio { orbit: Some([0.0, 30.0]), ..Studio::default() });
    let names: Vec<_> = seen.cameras.iter().map(|camera| camera.spec.name.as_str()).collect();
    assert_eq!((names, seen.lights.len(), seen.objects.len()), (vec!["studio", "mine"], 1, 1));
    // From below, a floor would hide the model.
    let mut below = pot();
    complete(&mut below, &Studio { orbit: Some([0.0, -40.0]), ..Studio::default() });
    assert_eq!(below.objects.len(), 1);
}

/// Surroundings of a model have no place in its coordinates, which a format may turn and scale; a lamp has.
#[test]
fn surroundings_do_not_keep_a_model_from_standing_upright() {
    let bare = SceneBuilder { up: UpHint::Is(Axis::Z), unit: 0.001, ..pot() };
    let placed = |light: Option<Spec>| {
        let mut scene = bare.clone();
        scene.lights.extend(light);
        complete(&mut scene, &Studio::default());
        format!("{:?}", scene.objects[0].motion.at(0.0).matrix())
    };
    let (upright, as_it_is) = (placed(None), format!("{:?}", bare.objects[0].motion.at(0.0).matrix()));
    assert_ne!(upright, as_it_is);
    for row in LIGHTS {
        let kind = row.entry.name;
        let spec = match kind {
            "rect" | "sphere" => Spec::new("it", kind).with("intensity", 3.0f32),
            _ => Spec::new("it", kind),
        };
        let alone = SceneBuilder { lights: vec![spec.clone()], ..SceneBuilder::default() };
        let alone = alone.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let is_around = alone.lights().iter().any(|one| one.light.is_infinite() && !one.light.is_delta());
        assert_eq!(surrounds(kind), is_around, "{kind}");
        let wanted = if is_around || kind == "ambient" { &upright } else { &as_it_is };
        assert_eq!(&placed(Some(spec)), wanted, "{kind}");
    }
    assert_eq!(placed(Some(Spec::new("behind", "environment").with("backdrop", true))), upright);
}

#[test]
fn cut_outs_get_no_cove_and_backdrops_are_not_lights() {
    let mut scene = pot();
    complete(&mut scene, &Studio { cut_out: true, ..Studio::default() });
    assert_eq!((scene.objects.len(), scene.lights.len()), (1, 3));
    let mut scene = pot();
    scene.lights.push(Spec::new("behind", "environment").with("backdrop", true));
    complete(&mut scene, &Studio::default());
    assert_eq!((scene.objects.len(), scene.lights.len()), (1, 4));
    // It is present nevertheless if the user asks for it.
    let mut scene = pot();
    complete(&mut scene, &Studio { cut_out: true, ground: Some(Ground::Shadow), ..Studio::default() });
    assert_eq!(scene.objects.len(), 2);
}

#[test]
fn lights_of_formats_without_environments_get_the_studio_environment() {
    let names = |scene: &SceneBuilder| -> Vec<String> {
        let mut scene = scene.clone();
        complete(&mut scene, &Studio::default());
        scene.lights.into_iter().map(|light| light.name).collect()
    };
    let mut scene = pot();
    scene.lights.push(Spec::new("mine", "directional"));
    assert_eq!(names(&scene), ["mine"], "other formats could have said it");
    scene.environment_unspecified = true;
    assert_eq!(names(&scene), ["mine", "room"]);
    scene.lights.push(Spec::new("sky", "environment"));
    assert_eq!(names(&scene), ["mine", "sky"]);
    scene.lights.pop();
    scene.materials[0].parameters.set("emission", 5.0f32);
    assert_eq!(names(&scene), ["mine"], "what glows is seen by its own light");
}

#[test]
fn dim_emitters_are_not_lights_where_surroundings_cannot_be_described() {
    for (emission, lights) in [(0.6f32, 3), (1.0, 0), (20.0, 0)] {
        let mut scene = SceneBuilder { environment_unspecified: true, ..pot() };
        scene.materials[0].parameters.set("emission", Value::triple([0.0, emission, 0.0]));
        complete(&mut scene, &Studio::default());
        assert_eq!(scene.lights.len(), lights, "{emission}");
    }
}

/// A scene with light of its own gets no other, however dim it is, and one that describes all of its light none.
#[test]
fn described_light_is_all_the_light() {
    let lights = |scene: &SceneBuilder| {
        let mut scene = scene.clone();
        complete(&mut scene, &Studio::default());
        scene.lights.len()
    };
    assert_eq!(lights(&pot()), 3, "nothing is said of light");
    for emission in [Value::Number(1e-3), Value::triple([0.0, 0.9, 0.0]), Value::Texture(0)] {
        let mut scene = pot();
        scene.materials[0].parameters.set("emission", emission.clone());
        assert_eq!(lights(&scene), 0, "{emission:?}");
        // No object is made of it.
        scene.add_material(Spec::new("", "diffuse"));
        scene.objects[0].material = 1;
        assert_eq!(lights(&scene), 3, "unused: {emission:?}");
    }
    assert_eq!(lights(&SceneBuilder { describes_all_light: true, ..pot() }), 0, "black, as in pbrt");
}

#[test]
fn the_key_light_is_on_the_side_of_an_existing_camera() {
    let mut seen = pot();
    let spec = Spec::new("mine", "perspective")
        .with("position", Vec3::new(-6.0, 2.0, -5.0))
        .with("look_at", Vec3::ZERO);
    seen.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    complete(&mut seen, &Studio::default());
    let Some((Value::List(position), _)) = seen.lights[0].parameters.find("position") else { panic!() };
    let number = |value: &Value| if let Value::Number(x) = value { *x as f32 } else { panic!() };
    let light_position = Vec3::new(number(&position[0]), number(&position[1]), number(&position[2]));
    let from = Vec3::new(-6.0, 2.0, -5.0).normalize();
    // On the camera's side of the model, and out of its view.
    assert!(light_position.dot(from) > 0.0, "{light_position}");
    let at = seen_at(&seen, light_position);
    assert!(at.is_none_or(|at| at.abs().max_element() > 1.0), "{light_position}: {at:?}");
}

/// A box on the ground, as triangles between all of its corners.
fn cuboid(size: [f32; 3]) -> SceneBuilder {
    let [x, y, z] = size;
    let corners = [0.0, 1.0].into_iter().flat_map(|a| {
        [0.0, 1.0].into_iter().flat_map(move |b| [0.0, 1.0].map(|c| [(a - 0.5) * x, b * y, (c - 0.5) * z]))
    });
    points(&corners.collect::<Vec<_>>())
}

/// The position of the first camera.
fn eye(scene: &SceneBuilder) -> Vec3 {
    let camera = cameras::build(&scene.cameras[0], 1.0).unwrap();
    Vec3::from(camera.ray(&CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 }).origin)
}

#[test]
fn a_turntable_keeps_its_distance_and_its_axis() {
    let long = || cuboid([4.0, 1.0, 1.0]);
    let turned = |turn: f32| {
        let mut scene = long();
        complete(&mut scene, &Studio { turn: Some(turn), ..Studio::default() });
        scene
    };
    let first = turned(0.0);
    let distance = |scene: &SceneBuilder| Vec2::new(eye(scene).x, eye(scene).z).length();
    let mut farthest = 0.0f32;
    for i in 0..36 {
        let scene = turned(i as f32 / 36.0);
        assert!((distance(&scene) - distance(&first)).abs() < 1e-4, "frame {i}: {}", distance(&scene));
        assert!((eye(&scene).y - eye(&first).y).abs() < 1e-4);
        let axis = [0.0, 1.0].map(|y| seen_at(&scene, Vec3::Y * y).unwrap());
        assert!(axis.iter().all(|p| p.x.abs() < 1e-4), "frame {i}: the axis is in the middle");
        farthest = farthest.max(reach(&scene));
    }
    assert!((0.85..0.89).contains(&farthest), "{farthest}");
}

#[test]
fn flat_models_are_seen_from_farther_above_and_centred() {
    let elevation = |size: [f32; 3]| {
        let mut scene = cuboid(size);
        complete(&mut scene, &Studio::default());
        let camera = cameras::build(&scene.cameras[0], 1.0).unwrap();
        let ray = camera.ray(&CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 });
        let seen = (0..8).map(|i| scene.objects[0].mesh.positions[i]).map(|p| seen_at(&scene, p).unwrap().y);
        let (low, high) = seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
        (asin(-Vec3::from(ray.direction).y).to_degrees(), low + high)
    };
    for ordinary in [[1.0, 1.0, 1.0], [4.0, 0.85, 4.0], [1.0, 3.0, 0.1]] {
        let (above, _) = elevation(ordinary);
        assert!((above - Studio::ORBIT[1]).abs() < 1e-3, "{ordinary:?}: {above}");
    }
    for flat in [[1.0, 0.02, 1.0], [4.0, 0.0, 1.5]] {
        let (above, off_centre) = elevation(flat);
        assert!((above - 40.0).abs() < 1e-3, "{flat:?}: {above}");
        assert!(off_centre.abs() < 2e-3, "{flat:?}: {off_centre}");
    }
    let (between, _) = elevation([4.0, 0.6, 4.0]);
    assert!(between > 20.0 && between < 38.0, "{between}");
}

#[test]
fn pale_points_and_lines_stand_on_dark_ground() {
    let ground = |kd: f32, has_face: bool| {
        let mut scene = points(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        scene.materials[0] = Spec::new("ink", "phong").with("kd", kd);
        let mesh = Arc::make_mut(&mut scene.objects[0].mesh);
        mesh.triangles.truncate(usize::from(has_face));
        mesh.points = vec![0, 1];
        mesh.lines = vec![[0, 1], [1, 2]];
        complete(&mut scene, &Studio::default());
        let floor = scene.objects.last().unwrap();
        let material = scene.materials[floor.material].clone();
        let reflectance = material.parameters.find("reflectance").unwrap().0.clone();
        let Value::List(colour) = reflectance else { panic!("{reflectance:?}") };
        let Value::Number(green) = colour[1] else { panic!("{colour:?}") };
        green
    };
    assert!(ground(1.0, false) < 0.1, "white on dark");
    assert!(ground(0.05, false) > 0.6 && ground(1.0, true) > 0.6, "ink, or surfaces, on paper");
}
