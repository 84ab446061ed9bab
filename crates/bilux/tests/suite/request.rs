//! Requests in Rust types ask a job for the same as requests in text.

use bilux::JobRequest;
use bilux::math::Vec3;
use bilux::prelude::*;
use bilux::transport::aovs::Aov;

fn cornell() -> SceneBuilder {
    bilux::generate(&Spec::new("", "cornell")).unwrap()
}

/// The message of what is refused.
fn refused(request: JobRequest) -> String {
    Job::new(&cornell(), request).err().unwrap().to_string()
}

#[test]
fn typed_settings_are_those_of_the_command_line() {
    let typed = JobRequest::new()
        .size(24, 16)
        .integrator("path")
        .spp(3)
        .seed(7)
        .noise(0.25)
        .eye(Vec3::new(0.5, 1.0, 3.5))
        .orbit([30.0, -15.5])
        .early_out(false)
        .set("roulette_depth", 2);
    let mut text = Parameters::default();
    for (key, value) in [
        ("size", "24x16".into()),
        ("integrator", "path".into()),
        ("spp", Value::Integer(3)),
        ("seed", Value::Integer(7)),
        ("noise", Value::Number(0.25)),
        ("eye", "0.5,1,3.5".into()),
        ("orbit", "30,-15.5".into()),
        ("early_out", Value::Bool(false)),
        ("roulette_depth", Value::Integer(2)),
    ] {
        text.set(key, value);
    }
    let [typed, text] =
        [typed, JobRequest::from(&text)].map(|request| Job::new(&cornell(), request).unwrap());
    let shown = |job: &Job| {
        let mut settings = job.settings().clone();
        settings.given = Parameters::default();
        format!("{settings:?}")
    };
    assert_eq!(shown(&typed), shown(&text));
    assert_eq!(typed.fingerprint(), text.fingerprint());
}

#[test]
fn what_is_asked_for_is_checked() {
    let small = || JobRequest::new().size(8, 8);
    assert!(refused(small().seed(u64::MAX)).contains("seed"), "{}", refused(small().seed(u64::MAX)));
    assert!(refused(small().integrator("pathh")).contains("'path'"));
    // Not after the render, which would be lost.
    assert!(refused(small().set("tonemap", "agxx")).contains("'agx'"));
    assert!(refused(small().max_memory(1000)).contains("memory"));
    assert!(refused(small().integrator("whitted").layers(&[Aov::Interval])).contains("interval"));
    assert!(refused(small().set("exposre", 1.0f32)).contains("exposure"));
}

/// A number of samples that the user asks for counts, and not the scene's limits of noise and time; those of the user do, too.
#[test]
fn samples_of_the_user_take_precedence_over_limits_of_the_scene() {
    let ends = |request: JobRequest| {
        let mut scene = cornell();
        scene.settings.set("noise", 0.25f32);
        scene.settings.set("time_limit", 0.5f32);
        let job = Job::new(&scene, request.size(8, 8)).unwrap();
        (
            job.settings().spp,
            job.settings().stop.noise,
            job.settings().stop.time_limit.map(|limit| limit.as_secs_f32()),
        )
    };
    assert_eq!(ends(JobRequest::new().spp(48)), (48, None, None));
    assert_eq!(ends(JobRequest::new().spp(48).noise(0.125)), (48, Some(0.125), None));
    assert_eq!(ends(JobRequest::new().set("spp", 0).set("time_limit", 2.0f32)).1, Some(0.25));
    assert_eq!(ends(JobRequest::new()).1, Some(0.25));
}

/// Jobs that are made of a job leave it as it is.
#[test]
fn a_job_does_not_change() {
    let request = JobRequest::new().size(8, 8).integrator("path").spp(1);
    let job = Job::new(&cornell(), request).unwrap();
    let (fingerprint, picture) =
        (job.fingerprint().to_owned(), job.render(&Quiet).unwrap().picture().unwrap());
    let later = job.at_time(0.5);
    assert_ne!(later.fingerprint(), fingerprint);
    assert_eq!((job.settings().time, later.settings().time), (0.0, 0.5));
    assert_eq!(job.begun_at(std::time::Instant::now()).moving_to(&later).fingerprint(), fingerprint);
    assert_eq!(job.fingerprint(), fingerprint);
    assert!(job.render(&Quiet).unwrap().picture().unwrap() == picture);
}
