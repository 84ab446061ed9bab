//! After any edit, a session's picture is that of a fresh job, byte for byte; only what changed is built; and an edit that
//! changes no sample keeps those that were taken.

use bilux::math::Motion;
use bilux::math::transcendental::{atan, tan};
use bilux::prelude::*;
use bilux::scene::{LIGHTS, TreeWork};
use bilux::transport::Progress;
use bilux::transport::aovs::Aov;
use bilux::{Budget, Edit, Session};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn settings(pairs: &[(&str, Value)]) -> Parameters {
    let mut all = Parameters::default();
    all.set("size", "24x20");
    all.set("spp", Value::Integer(5));
    pairs.iter().for_each(|(key, value)| all.set(key, value.clone()));
    all
}

fn at(x: f32, y: f32, z: f32) -> Motion {
    Motion::still(Transform::translate(Vec3::new(x, y, z)).unwrap())
}

fn cornell() -> SceneBuilder {
    bilux::generate(&Spec::new("", "cornell")).unwrap()
}

fn bytes(picture: &Picture) -> Vec<u8> {
    let pixels = |i: usize| picture.channels()[i].samples.iter().flat_map(|x| x.to_le_bytes());
    (0..picture.channels().len()).flat_map(pixels).collect()
}

fn finished(session: &mut Session) -> Vec<u8> {
    while !session.is_done() {
        session.step(Budget::Samples(2), &Quiet).unwrap();
    }
    bytes(&session.picture().unwrap().unwrap())
}

fn fresh(scene: &SceneBuilder, user: &Parameters) -> Vec<u8> {
    bytes(&Job::new(scene, user).unwrap().render(&Quiet).unwrap().picture().unwrap())
}

#[test]
fn after_every_edit_the_picture_is_that_of_a_fresh_job() {
    for integrator in ["auto", "path", "vcm", "whitted"] {
        let user = settings(&[("integrator", integrator.into())]);
        let mut session = Session::new(cornell(), &user).unwrap();
        let ball = Arc::new(Mesh::sphere(Vec3::new(0.0, 0.3, 0.0), 0.2, 12));
        let sky = Spec::new("", "environment").with("radiance", Rgb::new(0.2, 0.3, 0.5));
        let camera = CameraSpec::new(Spec::new("", "perspective").with("position", Vec3::new(0.1, 0.9, 3.0)));
        let edits = [
            Edit::Add(Object::new("ball", ball.clone(), 0)),
            Edit::Place(0, at(0.0, 0.05, 0.0)),
            Edit::Place(0, at(0.0, 0.07, 0.0)),
            Edit::Material(0, Spec::new("", "conductor")),
            Edit::AssignMaterial(1, 2),
            Edit::Camera(0, camera),
            Edit::Environment(Some(sky)),
            Edit::Environment(None),
            Edit::Mesh(1, ball),
            Edit::Remove(1),
            Edit::Set("max_depth".to_owned(), Value::Integer(2)),
        ];
        let mut user = user.clone();
        for edit in edits {
            if let Edit::Set(key, value) = &edit {
                user.set(key, value.clone());
            }
            // Some samples before the edit: none of them may be left in the picture.
            session.step(Budget::Samples(1), &Quiet).unwrap();
            let name = format!("{integrator}: {edit:?}");
            assert!(session.apply(edit).unwrap() && session.samples() == 0, "{name}");
            let fresh = fresh(session.scene(), &user);
            assert!(finished(&mut session) == fresh, "{name}");
        }
    }
}

/// An environment takes the place of what is around the scene, of whatever kind, and without another one nothing is.
#[test]
fn an_environment_takes_the_place_of_every_kind_of_sky() {
    for row in LIGHTS.iter().filter(|row| row.surrounds) {
        let mut scene = cornell();
        scene.add_light(Spec::new("around", row.entry.name));
        let mut session = Session::new(scene, &Parameters::default()).unwrap();
        let others = session.scene().lights.len() - 1;
        for (environment, count) in [(Some(Spec::new("new", "environment")), 1), (None, 0)] {
            session.apply(Edit::Environment(environment)).unwrap();
            let lights = &session.scene().lights;
            assert!(lights.iter().all(|light| light.name != "around"), "{}", row.entry.name);
            assert_eq!(lights.len(), others + count, "{}", row.entry.name);
        }
    }
}

/// The layers after an edit are those of a fresh job: not those from before it, and not missing.
#[test]
fn layers_follow_every_edit() {
    let wanted = [Aov::Albedo, Aov::Normal, Aov::Depth, Aov::Ids];
    let user = settings(&[("integrator", "path".into())]);
    let mut session = Session::new(cornell(), &user).unwrap();
    session.with_layers(&wanted).unwrap();
    let sphere = Arc::new(Mesh::sphere(Vec3::new(0.0, 0.3, 0.6), 0.4, 12));
    let camera = CameraSpec::new(Spec::new("", "perspective").with("position", Vec3::new(0.1, 0.9, 3.0)));
    let mut seen = Vec::new();
    let edits = [
        vec![],
        vec![Edit::Add(Object::new("ball", sphere, 0))],
        vec![Edit::Material(0, Spec::new("", "diffuse").with("reflectance", Rgb::new(0.1, 0.2, 0.9)))],
        vec![Edit::Camera(0, camera)],
        vec![Edit::Set("exposure".to_owned(), Value::Number(1.0))],
        vec![Edit::Remove(0), Edit::Place(0, at(0.1, 0.0, 0.0))],
    ];
    for edit in edits {
        let what = format!("{edit:?}");
        session.apply_all(edit).unwrap();
        finished(&mut session);
        let layers = session.outcome().unwrap().layered(&wanted).unwrap();
        let job = Job::new(session.scene(), JobRequest::from(&user).layers(&wanted)).unwrap();
        let alone = job.render(&Quiet).unwrap().layered(&wanted).unwrap();
        assert_eq!(layers.channels().len(), 3 + 3 + 3 + 1, "{what}");
        assert!(layers == alone, "{what}");
        seen.push(layers);
    }
    let differ = |i: usize, j: usize| seen[i] != seen[j];
    assert!(
        differ(0, 1) && differ(1, 2) && differ(2, 3) && !differ(3, 4) && differ(4, 5),
        "the edits are seen"
    );
}

#[test]
fn models_in_the_studio_are_edited_too() {
    // Neither a camera nor a light: the studio completes it, with a ground that is made anew each time.
    let mut scene = SceneBuilder::default();
    let clay = scene.add_material(Spec::new("", "diffuse"));
    for x in 0..3 {
        let ball = Arc::new(Mesh::sphere(Vec3::X * x as f32, 0.4, 24));
        scene.objects.push(Object::new("", ball, clay));
    }
    for background in ["surroundings", "transparent"] {
        let user = settings(&[("background", background.into()), ("ground", "shadow".into())]);
        let mut session = Session::new(scene.clone(), &user).unwrap();
        let mut user = user.clone();
        // At first the ground is in one tree with the model.
        session.apply(Edit::Set("orbit".to_owned(), "5,5".into())).unwrap();
        for orbit in ["10,20", "30,40"] {
            user.set("orbit", orbit);
            let before = session.tree_work();
            assert!(session.apply(Edit::Settings(user.clone())).unwrap());
            let TreeWork { triangles, .. } = session.tree_work();
            // The ground and the lights turn with the camera.
            assert!(triangles - before.triangles < 1000, "{triangles} {before:?}");
            assert!(finished(&mut session) == fresh(&scene, &user), "{background} {orbit}");
        }
    }
}

#[test]
fn only_what_changed_is_built() {
    let mut session = Session::new(cornell(), &settings(&[])).unwrap();
    let all = session.tree_work();
    assert_eq!(all.trees, 1);
    let camera = CameraSpec::new(Spec::new("", "perspective").with("position", Vec3::new(0.0, 1.0, 2.5)));
    let edits = [
        Edit::Camera(0, camera),
        Edit::Material(0, Spec::new("", "mirror")),
        Edit::Set("size".to_owned(), "30x20".into()),
        Edit::Set("exposure".to_owned(), Value::Number(1.0)),
    ];
    for edit in edits {
        session.apply(edit).unwrap();
        assert_eq!(session.tree_work(), all);
    }
    session.apply(Edit::Place(0, at(0.0, 0.1, 0.0))).unwrap();
    assert_eq!(session.tree_work().trees, 3, "the rest once, and what moved");
    session.apply(Edit::Place(0, at(0.0, 0.2, 0.0))).unwrap();
    assert_eq!(session.tree_work().trees, 4, "what moved");
}

#[test]
fn an_edit_that_changes_no_sample_keeps_them() {
    let mut session = Session::new(cornell(), &settings(&[("threads", Value::Integer(1))])).unwrap();
    session.step(Budget::Samples(3), &Quiet).unwrap();
    let same = session.scene().objects[0].motion.clone();
    let edits = [
        Edit::Set("exposure".to_owned(), Value::Number(-2.0)),
        Edit::Set("tonemap".to_owned(), "neutral".into()),
        Edit::Set("threads".to_owned(), Value::Integer(2)),
        Edit::Set("transfer".to_owned(), "linear".into()),
        Edit::Set("spp".to_owned(), Value::Integer(7)),
        Edit::Place(0, same),
    ];
    for edit in edits {
        assert!(!session.apply(edit).unwrap() && session.samples() == 3);
    }
    assert_eq!(session.job().write_options().unwrap().exposure, -2.0);
    let user = settings(&[("spp", Value::Integer(7)), ("transfer", "linear".into())]);
    assert!(finished(&mut session) == fresh(session.scene(), &user));
    assert_eq!(session.samples(), 7);
    // Who makes the picture again by what it says of itself gets the one that is shown.
    let mut shown = session.picture().unwrap().unwrap();
    session.job().describe(&mut shown, session.outcome().unwrap(), None);
    let said = &shown.metadata[bilux::description::SETTINGS];
    for part in ["exposure=-2", "tonemap=neutral", "transfer=linear", "spp=7"] {
        assert!(said.contains(part), "{part} in {said}");
    }
    assert!(session.apply(Edit::Set("spp".to_owned(), Value::Integer(4))).unwrap(), "fewer than there are");
}

#[test]
fn an_error_leaves_the_session_as_it_was() {
    let mut session = Session::new(cornell(), &settings(&[])).unwrap();
    session.step(Budget::Samples(2), &Quiet).unwrap();
    let wrong = [
        (vec![Edit::Place(99, Motion::REST)], "there is no object 99: the scene has"),
        (vec![Edit::Place(0, at(1.0, 0.0, 0.0)), Edit::AssignMaterial(0, 77)], "has material 77"),
        (vec![Edit::Material(0, Spec::new("", "difuse"))], "did you mean 'diffuse'"),
        (vec![Edit::Set("tonemap".to_owned(), "nutral".into())], "nutral"),
        (vec![Edit::Set("camera".to_owned(), "none".into())], "there is no camera 'none'"),
        (vec![Edit::Set("size".to_owned(), "0x0".into())], "is not a size"),
    ];
    for (edits, message) in wrong {
        let error = session.apply_all(edits).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
        assert_eq!(session.samples(), 2);
    }
    assert!(finished(&mut session) == fresh(&cornell(), &settings(&[])));
}

/// Stops what is stepped.
struct Stopped(AtomicBool);

impl Progress for Stopped {
    fn begin(&self, _: u64) {}
    fn advance(&self, _: u64, _: u64) {
        self.0.store(true, Ordering::Relaxed);
    }
    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

#[test]
fn steps_end_by_time_or_when_they_are_stopped() {
    let user = settings(&[("spp", Value::Integer(1000))]);
    let mut session = Session::new(cornell(), &user).unwrap();
    assert!(session.picture().unwrap().is_none() && session.outcome().is_none());
    assert!(session.step(Budget::Time(Duration::ZERO), &Quiet).unwrap() == 1, "one sample at least");
    let many = session.step(Budget::Time(Duration::from_millis(200)), &Quiet).unwrap();
    assert!(many > 1, "{many}");
    let before = bytes(&session.picture().unwrap().unwrap());
    let stopped = session.step(Budget::Samples(900), &Stopped(AtomicBool::new(false))).unwrap();
    assert_eq!(stopped, many, "a pass that was stopped is left out");
    assert!(bytes(&session.picture().unwrap().unwrap()) == before);
    assert_eq!(session.step(Budget::Samples(u32::MAX), &Quiet).unwrap(), 1000);
    assert_eq!(session.step(Budget::Samples(1), &Quiet).unwrap(), 1000, "there are no more");
    assert!(finished(&mut session) == fresh(&cornell(), &user));
}

#[test]
fn a_moved_camera_gives_the_picture_of_a_camera_that_stands_there() {
    let user = settings(&[("integrator", "path".into())]);
    let mut session = Session::new(cornell(), &user).unwrap();
    let (eye, look_at) = (Vec3::new(0.3, 1.2, 3.0), Vec3::new(0.0, 0.8, 0.0));
    let text = |p: Vec3| Value::Text(format!("{},{},{}", p.x, p.y, p.z));
    let set = |key: &str, value: Value| Edit::Set(key.to_owned(), value);
    let trees = session.tree_work().trees;
    let edits = vec![set("eye", text(eye)), set("look_at", text(look_at)), set("zoom", Value::Number(1.0))];
    assert!(session.apply_all(edits).unwrap());
    assert_eq!(session.tree_work().trees, trees, "only the camera moves");
    let mut there = cornell();
    let camera = &mut there.cameras[0].spec.parameters;
    camera.set("position", eye);
    camera.set("look_at", look_at);
    assert!(finished(&mut session) == fresh(&there, &user));
    assert!(session.apply(set("zoom", Value::Number(2.0))).unwrap());
    let fov = there.cameras[0].spec.number("fov").unwrap_or(40.0);
    let half = 2.0 * atan(tan(fov.to_radians() * 0.5) / 2.0).to_degrees();
    there.cameras[0].spec.parameters.set("fov", half);
    assert!(finished(&mut session) == fresh(&there, &user));
    assert!(session.apply(set("eye", "1,2".into())).is_err(), "two numbers are no point");
    assert!(session.apply(set("look_at", text(eye))).is_err(), "a camera cannot look at itself");
}

#[test]
fn moving_the_studios_camera_keeps_its_light_and_builds_no_tree() {
    let mut scene = SceneBuilder::default();
    let clay = scene.add_material(Spec::new("", "diffuse"));
    scene.objects.push(Object::new("", Arc::new(Mesh::sphere(Vec3::ZERO, 0.4, 24)), clay));
    let mut session = Session::new(scene.clone(), &settings(&[])).unwrap();
    let trees = session.tree_work().trees;
    for eye in ["1,1,2", "-1,0.5,2"] {
        assert!(session.apply(Edit::Set("eye".to_owned(), eye.into())).unwrap());
        assert_eq!(session.tree_work().trees, trees);
        assert!(finished(&mut session) == fresh(&scene, &settings(&[("eye", eye.into())])), "{eye}");
    }
}

#[test]
fn the_interval_of_a_pixel_is_around_its_light() {
    let user = settings(&[("integrator", "path".into()), ("spp", Value::Integer(1024))]);
    let mut session = Session::new(cornell(), &user).unwrap();
    session.step(Budget::Samples(1024), &Quiet).unwrap();
    let picture = session.picture().unwrap().unwrap();
    // At the middle of the back wall, and of the left one. Intervals of 256 samples, for a mean of 1024.
    for [x, y] in [[12, 6], [3, 10]] {
        let estimates = session.job().estimate([x, y], 256).unwrap().unwrap();
        for (channel, estimate) in estimates.iter().enumerate() {
            let light = f64::from(picture.channels()[channel].samples[(y * 24 + x) as usize]);
            let away = (estimate.mean - light).abs();
            assert!(estimate.half_width > 0.0 && away < 2.0 * estimate.half_width, "{estimate:?} {light}");
        }
    }
    assert!(session.job().estimate([24, 0], 16).is_err());
    session.apply(Edit::Set("integrator".to_owned(), "vcm".into())).unwrap();
    assert!(session.job().estimate([12, 6], 16).unwrap().is_none());
}

/// The variance guides the denoiser: it is estimated from the same batches of samples, however the steps divide them.
#[test]
fn a_denoised_picture_is_that_of_a_fresh_job_whatever_the_steps() {
    for (integrator, spp) in [("path", 12), ("bdpt", 7)] {
        let user = settings(&[
            ("integrator", integrator.into()),
            ("spp", Value::Integer(spp)),
            ("denoise", "builtin".into()),
        ]);
        let request = JobRequest::from(&user).denoised(Denoised::ForDisplay);
        let job = Job::new(&cornell(), request).unwrap();
        let denoiser = job.denoiser().unwrap().unwrap();
        let expected = bytes(&job.render(&Quiet).unwrap().denoised(denoiser).unwrap());
        for steps in [&[1, 1, 1, 2, 100][..], &[5, 100], &[100]] {
            let mut session = Session::new(cornell(), &user).unwrap();
            session.with_layers(&[Aov::Albedo, Aov::Normal, Aov::Depth, Aov::Variance]).unwrap();
            for &samples in steps {
                session.step(Budget::Samples(samples), &Quiet).unwrap();
            }
            let cleaned = session.outcome().unwrap().denoised(denoiser).unwrap();
            assert!(bytes(&cleaned) == expected, "{integrator} in {steps:?}");
        }
    }
}

#[test]
fn sessions_that_share_what_is_built_build_no_tree_and_show_the_same() {
    let user = settings(&[("integrator", "path".into())]);
    let first = Session::new(cornell(), &user).unwrap();
    let built = first.tree_work();
    let other = settings(&[("integrator", "path".into()), ("eye", "0.2,0.9,3".into())]);
    let mut second = Session::sharing(first.scene().clone(), &other, first.built().clone()).unwrap();
    assert_eq!(second.tree_work(), built);
    assert!(finished(&mut second) == fresh(&cornell(), &other));
    // Another scene, with what was built of it elsewhere.
    let mut changed = cornell();
    changed.objects.pop();
    let third = Session::new(changed.clone(), &user).unwrap();
    second.replace(third.scene().clone(), &other, third.built().clone()).unwrap();
    assert_eq!(second.tree_work(), third.tree_work());
    assert!(finished(&mut second) == fresh(&changed, &other));
    // What is wrong leaves everything as it was.
    let wrong = settings(&[("integrator", "psychic".into())]);
    assert!(second.replace(cornell(), &wrong, first.built().clone()).is_err());
    assert!(finished(&mut second) == fresh(&changed, &other));
}
