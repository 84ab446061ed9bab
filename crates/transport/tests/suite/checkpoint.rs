//! A render that is stopped at any moment, as often as one likes, and goes on from its last checkpoint, gives the film of one
//! that is not.

use crate::common::{built, effort, integrator, mixed, shoot};
use bilux_math::hash::hash_words;
use bilux_scene::Scene;
use bilux_transport::integrators::INTEGRATORS;
use bilux_transport::{
    Checkpoint, Observer, Progress, RenderError, RenderSettings, Rendered, Silent, Standing, Stop,
    Unobserved, Window, render_from,
};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
use std::time::Duration;

/// Ends a render after some questions whether it should: by a checkpoint after which all is lost, or as Ctrl-C does.
struct Killer {
    questions_left: AtomicI64,
    by_interrupt: bool,
    is_dead: AtomicBool,
    saved: Mutex<Option<Vec<u8>>>,
}

impl Killer {
    fn after(questions: i64, by_interrupt: bool) -> Killer {
        let (questions_left, is_dead) = (AtomicI64::new(questions), AtomicBool::new(false));
        Killer { questions_left, by_interrupt, is_dead, saved: Mutex::new(None) }
    }

    fn is_time(&self) -> bool {
        self.questions_left.fetch_sub(1, Ordering::Relaxed) <= 0
    }
}

impl Observer for Killer {
    fn wants_checkpoint(&self) -> bool {
        !self.by_interrupt && !self.is_dead.load(Ordering::Relaxed) && self.is_time()
    }

    fn keep(&self, standing: &Standing) {
        let mut saved = self.saved.lock().unwrap();
        if saved.is_none() {
            let mut bytes = Vec::new();
            standing.write(&mut bytes).unwrap();
            *saved = Some(bytes);
        }
        self.is_dead.store(true, Ordering::Relaxed);
    }
}

impl Progress for Killer {
    fn advance(&self, _samples: u64, _rays: u64) {}

    fn is_cancelled(&self) -> bool {
        self.is_dead.load(Ordering::Relaxed) || self.by_interrupt && self.is_time()
    }
}

/// Renders with many deaths, and returns the picture and their number.
fn with_deaths(scene: &Scene, name: &str, settings: &RenderSettings, seed: u64) -> (Rendered, u32) {
    let (camera, integrator) = (&*scene.cameras()[0].1, &*integrator(name));
    let (mut from, mut deaths) = (None, 0);
    loop {
        let random = hash_words([seed, u64::from(deaths)]);
        let killer = Killer::after(2 + (random % 17) as i64, random >> 32 & 1 == 1);
        // Checkpoints do not depend on threads.
        let settings = RenderSettings { threads: 1 + (random >> 40) as usize % 3, ..settings.clone() };
        let rendered =
            render_from(from.take(), scene, camera, integrator, &settings, &killer, &killer).unwrap();
        if !rendered.cancelled {
            return (rendered, deaths);
        }
        let bytes = killer.saved.into_inner().unwrap().expect("it dies with a checkpoint");
        from = Some(Checkpoint::from_bytes(&bytes).unwrap());
        deaths += 1;
        assert!(deaths < 1000, "{name}: no progress");
    }
}

fn small(spp: u32) -> RenderSettings {
    RenderSettings { threads: 2, ..RenderSettings::new(41, 35, spp) }
}

fn assert_same(scene: &Scene, name: &str, settings: &RenderSettings, seed: u64) {
    let whole = shoot(scene, &*integrator(name), settings);
    let (rest, deaths) = with_deaths(scene, name, settings, seed);
    assert!(deaths >= 1, "{name}: nothing was interrupted");
    let mut places = (0..settings.height).flat_map(|y| (0..settings.width).map(move |x| (x, y)));
    let has_splats = places.any(|(x, y)| !whole.film.splatted(x, y).is_black());
    assert!(has_splats || !["light", "bdpt", "vcm"].contains(&name), "{name}: no light from light paths");
    assert!(rest.film == whole.film, "{name}, {settings:?}: another film after {deaths} deaths");
    assert!(rest.batch_means == whole.batch_means, "{name}, {settings:?}: another variance");
    assert!(rest.interval == whole.interval, "{name}, {settings:?}: other intervals");
    if settings.stop.time_limit.is_none() {
        assert!(rest.reached == whole.reached, "{name}: {:?}, but {:?}", rest.reached, whole.reached);
    }
}

#[test]
fn every_integrator_goes_on_to_the_same_film() {
    let scene = built(&mixed());
    for (i, row) in INTEGRATORS.iter().enumerate() {
        assert_same(&scene, row.entry.name, &small(7), i as u64);
    }
}

#[test]
fn limits_crops_ranges_variance_and_intervals_go_on_too() {
    let scene = built(&mixed());
    for (seed, name) in
        [(102, "vcm"), (103, "auto"), (100, "path"), (101, "bdpt")][..effort(1, 4)].iter().copied()
    {
        let noise = Stop { noise: Some(0.4), time_limit: None };
        assert_same(&scene, name, &RenderSettings { stop: noise, ..small(4000) }, seed);
        let of_part = RenderSettings {
            crop: Some(Window { x: 3, y: 2, width: 20, height: 19 }),
            samples: 2..9,
            ..small(12)
        };
        assert_same(&scene, name, &of_part, seed);
        assert_same(&scene, name, &RenderSettings { batch_means: true, ..small(9) }, seed);
        let both = RenderSettings { batch_means: true, stop: noise, ..small(4000) };
        assert_same(&scene, name, &both, seed);
        assert_same(&scene, name, &RenderSettings { interval: true, ..small(9) }, seed);
        // The clock does not end it.
        let time_limit = Some(Duration::from_secs(1000));
        assert_same(
            &scene,
            name,
            &RenderSettings { stop: Stop { noise: None, time_limit }, ..small(6) },
            seed,
        );
    }
}

fn checkpoint(scene: &Scene, name: &str, settings: &RenderSettings, questions: i64) -> Vec<u8> {
    let killer = Killer::after(questions, false);
    let camera = &*scene.cameras()[0].1;
    let rendered = render_from(None, scene, camera, &*integrator(name), settings, &killer, &killer).unwrap();
    assert!(rendered.cancelled);
    killer.saved.into_inner().unwrap().unwrap()
}

#[test]
fn an_altered_sum_is_seen_in_the_film() {
    let (scene, settings) = (built(&mixed()), small(7));
    let whole = shoot(&scene, &*integrator("path"), &settings).film;
    let go_on = |bytes: &[u8]| {
        let (from, camera) = (Checkpoint::from_bytes(bytes).unwrap(), &*scene.cameras()[0].1);
        let path = integrator("path");
        render_from(Some(from), &scene, camera, &*path, &settings, &Silent, &Unobserved).unwrap().film
    };
    let mut bytes = checkpoint(&scene, "path", &settings, 20);
    assert!(go_on(&bytes) == whole);
    // The lowest byte of the first sum: after the head, the film's own head, and the text of its coverage.
    let coverage = bytes[76 + 52..76 + 56].try_into().unwrap();
    bytes[76 + 56 + u32::from_le_bytes(coverage) as usize] ^= 1;
    assert!(go_on(&bytes) != whole, "nothing would notice a wrong checkpoint");
}

#[test]
fn more_samples_may_follow_and_fewer_may_not() {
    let scene = built(&mixed());
    let camera = &*scene.cameras()[0].1;
    let bytes = checkpoint(&scene, "bdpt", &small(6), 25);
    let go_on = |settings: &RenderSettings| {
        let from = Some(Checkpoint::from_bytes(&bytes).unwrap());
        render_from(from, &scene, camera, &*integrator("bdpt"), settings, &Silent, &Unobserved)
    };
    let more = go_on(&small(11)).unwrap();
    assert!(more.film == shoot(&scene, &*integrator("bdpt"), &small(11)).film);
    assert!(matches!(go_on(&small(2)), Err(RenderError::CheckpointBeyond { .. })));
    let noise = Stop { noise: Some(0.4), time_limit: None };
    let lacks = go_on(&RenderSettings { stop: noise, ..small(4000) });
    assert!(matches!(lacks, Err(RenderError::CheckpointLacks { .. })));
    let lacks = go_on(&RenderSettings { batch_means: true, ..small(9) });
    assert!(matches!(lacks, Err(RenderError::CheckpointLacks { .. })));
    for other in [
        RenderSettings { threads: 2, ..RenderSettings::new(40, 35, 6) },
        RenderSettings { crop: Some(Window { x: 0, y: 0, width: 4, height: 4 }), ..small(6) },
        RenderSettings { interval: true, ..small(6) },
        RenderSettings { samples: 1..6, ..small(6) },
    ] {
        assert!(matches!(go_on(&other), Err(RenderError::OtherCheckpoint { .. })), "{other:?}");
    }
}

#[test]
fn time_that_was_spent_before_counts() {
    let scene = built(&mixed());
    let camera = &*scene.cameras()[0].1;
    let limit = |seconds: u64| {
        let time_limit = Some(Duration::from_secs(seconds));
        RenderSettings { stop: Stop { noise: None, time_limit }, ..small(100_000) }
    };
    let mut bytes = checkpoint(&scene, "path", &limit(1000), 40);
    // As if it had taken a thousand seconds: after the length of the section and twelve letters.
    let nanoseconds = 1_000_000_000_000u64;
    bytes[20..28].copy_from_slice(&nanoseconds.to_le_bytes());
    let from = Checkpoint::from_bytes(&bytes).unwrap();
    let begun = from.samples();
    let rest =
        render_from(Some(from), &scene, camera, &*integrator("path"), &limit(900), &Silent, &Unobserved)
            .unwrap();
    let spp = rest.reached.unwrap().spp;
    assert!(f64::from(spp) < begun + 32.0, "{spp} samples after {begun}");
    let counts: Vec<u32> = (0..41).map(|x| rest.film.samples(x, 7)).collect();
    assert!(counts.iter().all(|&count| count == spp), "what was begun is completed: {counts:?}");
}

#[test]
fn damaged_bytes_give_an_error_or_a_picture() {
    let scene = built(&mixed());
    let camera = &*scene.cameras()[0].1;
    let stop = Stop { noise: Some(0.02), time_limit: None };
    for (name, settings) in [
        ("bdpt", RenderSettings { stop, batch_means: true, ..RenderSettings::new(9, 7, 64) }),
        ("vcm", RenderSettings { interval: true, ..RenderSettings::new(9, 7, 6) }),
    ] {
        let bytes = checkpoint(&scene, name, &settings, 3);
        assert!((0..bytes.len()).step_by(11).all(|end| Checkpoint::from_bytes(&bytes[..end]).is_err()));
        for round in 0..effort(80, 400) {
            let mut flipped = bytes.clone();
            let random = hash_words([round, 7]) as usize;
            flipped[random % bytes.len()] ^= 1 << (random >> 32 & 7);
            if let Ok(from) = Checkpoint::from_bytes(&flipped) {
                let _ = render_from(
                    Some(from),
                    &scene,
                    camera,
                    &*integrator(name),
                    &settings,
                    &Silent,
                    &Unobserved,
                );
            }
        }
    }
}
