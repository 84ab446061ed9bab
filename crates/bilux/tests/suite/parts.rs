//! A picture from many parts is the picture of one machine, to the bit, however it is divided and in whatever order its
//! parts come back.

use bilux::math::hash::hash_words;
use bilux::parts;
use bilux::prelude::*;
use bilux::scene::texture::Texture;
use bilux::transport::aovs::Aov;
use bilux::transport::integrators::INTEGRATORS;
use bilux::transport::{Division, Film, Gathering, Part};
use std::sync::Arc;
use std::time::Duration;

/// A small box with glossy and textured things in it, lit by a lamp.
fn scene() -> SceneBuilder {
    let mut scene = bilux::generate(&Spec::new("", "cornell")).unwrap();
    let texels = (0..64).map(|i| Rgb::grey((i % 7) as f32 / 6.0)).collect();
    scene.textures.push(Arc::new(Texture::new("", 8, 8, texels, false)));
    scene.materials[0].parameters.set("reflectance", Value::Texture(0));
    scene
}

fn settings(pairs: &[(&str, Value)]) -> Parameters {
    let mut settings = Parameters::default();
    settings.set("size", "24x40");
    pairs.iter().for_each(|(key, value)| settings.set(key, value.clone()));
    settings
}

fn job(settings: &Parameters) -> Job {
    Job::new(&scene(), JobRequest::from(settings).denoised(Denoised::ForDisplay)).unwrap()
}

fn division(workers: u32, may_crop: bool) -> Division {
    Division { workers, threads: 1, may_crop }
}

/// Renders what a gathering gives out by other jobs, and adds some of it late, twice, or never.
fn gathered(settings: &Parameters, workers: u32) -> Outcome {
    let driver = job(settings);
    // A job that came by way of bytes, as on another machine.
    let encoded = bilux::encoding::encode(&scene()).unwrap();
    let blobs: Vec<_> = encoded.blobs.iter().map(|(hash, blob)| (*hash, blob.bytes())).collect();
    let find = |hash| blobs.iter().find(|(known, _)| *known == hash).map(|(_, bytes)| &**bytes);
    let sent = bilux::encoding::decode(&encoded.document, &find).unwrap();
    let worker = Job::new(&sent, settings).unwrap();
    let mut gathering =
        parts::gathering(&driver, division(workers, parts::may_crop(&worker).unwrap())).unwrap();
    let mut flying: Vec<Part> = Vec::new();
    let mut round = 0u64;
    while !gathering.is_done() {
        while flying.len() < workers as usize
            && let Some(part) = gathering.next_part()
        {
            flying.push(part);
        }
        round += 1;
        let part = flying.swap_remove(hash_words([round, 5]) as usize % flying.len());
        let done = parts::render(&worker, &part, &Quiet).unwrap();
        let film = Film::from_bytes(&done.film.to_bytes()).unwrap();
        gathering.add(&part, film.clone(), done.rays).unwrap();
        gathering.add(&part, film, done.rays).unwrap();
    }
    assert!(gathering.next_part().is_none());
    parts::gathered(&driver, gathering, &Quiet).unwrap()
}

fn assert_same(settings: &Parameters, what: &str, numbers: &[u32]) {
    let local = job(settings).render(&Quiet).unwrap();
    for &workers in numbers {
        let other = gathered(settings, workers);
        assert!(other.rendered.film == local.rendered.film, "{what}: the films of {workers} workers differ");
        assert_eq!(other.rendered.reached, local.rendered.reached, "{what}, {workers} workers");
        assert!(
            other.rendered.batch_means == local.rendered.batch_means,
            "{what}: the batches of {workers} workers differ"
        );
        assert!(
            other.surfaces.features == local.surfaces.features,
            "{what}: the features of {workers} workers differ"
        );
        assert_eq!(other.picture().unwrap(), local.picture().unwrap(), "{what}, {workers} workers");
    }
}

#[test]
fn every_integrator_gives_the_same_picture_in_parts() {
    for row in INTEGRATORS {
        for spp in [1, 13] {
            let settings = settings(&[("integrator", row.entry.name.into()), ("spp", Value::Integer(spp))]);
            assert_same(&settings, row.entry.name, &[1, 3, 9]);
        }
    }
}

#[test]
fn noise_ends_the_picture_at_the_same_sample() {
    for (integrator, noise) in [("auto", 0.05), ("path", 0.08), ("vcm", 0.05)] {
        let settings = settings(&[("integrator", integrator.into()), ("noise", Value::Number(noise))]);
        let reached = job(&settings).render(&Quiet).unwrap().rendered.reached.unwrap();
        assert!(reached.spp > 16, "{integrator}: {} samples are too few to go wrong", reached.spp);
        assert_same(&settings, integrator, &[4]);
    }
}

#[test]
fn denoised_and_transparent_pictures_are_the_same() {
    let spp = ("spp", Value::Integer(11));
    assert_same(&settings(&[("denoise", "builtin".into()), spp.clone()]), "denoised", &[2, 7]);
    assert_same(&settings(&[("background", "transparent".into()), spp]), "transparent", &[2]);
}

#[test]
fn time_ends_the_picture_with_all_that_came_back() {
    let settings = settings(&[("time_limit", Value::Number(0.3)), ("denoise", "off".into())]);
    let outcome = gathered(&settings, 2);
    let spp = outcome.rendered.reached.unwrap().spp;
    assert!(spp > 0 && !outcome.rendered.cancelled);
    assert!((0..24).all(|x| outcome.rendered.film.samples(x, 7) == spp));
}

#[test]
fn a_picture_that_is_stopped_keeps_what_came_back() {
    let job = job(&settings(&[("spp", Value::Integer(40)), ("integrator", "path".into())]));
    let mut gathering = parts::gathering(&job, division(4, false)).unwrap();
    let parts: Vec<Part> = (0..3).filter_map(|_| gathering.next_part()).collect();
    let done = parts::render(&job, &parts[1], &Quiet).unwrap();
    gathering.add(&parts[1], done.film, done.rays).unwrap();
    assert_eq!(gathering.so_far().unwrap().samples(3, 3), parts[1].samples.len() as u32);
    let outcome = parts::gathered(&job, gathering, &Quiet).unwrap();
    assert!(outcome.rendered.cancelled);
    assert_eq!(outcome.rendered.film.fingerprint, job.fingerprint());
}

#[test]
fn wrong_parts_are_refused() {
    let job_of = |seed| job(&settings(&[("spp", Value::Integer(8)), ("seed", Value::Integer(seed))]));
    let (job, other) = (job_of(0), job_of(1));
    let mut gathering: Gathering = parts::gathering(&job, division(2, false)).unwrap();
    let (first, second) = (gathering.next_part().unwrap(), gathering.next_part().unwrap());
    let message = |gathering: &mut Gathering, part: &Part, film: Film| {
        gathering.add(part, film, 0).unwrap_err().to_string()
    };
    let film = parts::render(&job, &second, &Quiet).unwrap().film;
    assert!(message(&mut gathering, &first, film).contains("it should hold the samples 0..1"));
    let film = parts::render(&other, &first, &Quiet).unwrap().film;
    assert!(message(&mut gathering, &first, film).contains("different scenes or settings"));
    gathering.add(&first, parts::render(&job, &first, &Quiet).unwrap().film, 0).unwrap();
    let request = JobRequest::from(&settings(&[("spp", Value::Integer(8))])).layers(&[Aov::Interval]);
    let interval = Job::new(&scene(), request).unwrap();
    assert!(
        parts::gathering(&interval, division(2, false))
            .is_err_and(|error| error.to_string().contains("'interval'"))
    );
}

#[test]
fn a_limit_that_has_passed_still_gives_one_pass() {
    let settings = settings(&[("time_limit", Value::Number(0.001)), ("denoise", "off".into())]);
    std::thread::sleep(Duration::from_millis(2));
    assert!(gathered(&settings, 4).rendered.reached.unwrap().spp >= 1);
}
