//! The box with two spheres: `path` against Mitsuba's, and our bidirectional integrators.

use super::cornell::{self, MAX_DEPTH, SIDE};
use super::measurement::{Context, Measurement};
use super::mitsuba::{Mitsuba, Scratch};
use super::row::{Goal, Row};
use super::shots::Plan;
use crate::median;
use crate::render::relmse;
use bilux::Error;
use bilux::math::Rgb;

pub(super) const PATH: Measurement =
    Measurement { name: "box", summary: "path in a Cornell box, one thread, against Mitsuba's", run: path };

pub(super) const BIDIRECTIONAL: Measurement = Measurement {
    name: "bidirectional",
    summary: "bdpt and vcm in the same box, one thread",
    run: bidirectional,
};

/// The first of the seeds, far from those of the reference.
const FIRST_SEED: u32 = 40_001;
/// The error for which times are compared.
const TARGET: f64 = 0.01;

/// Times of one side's pictures, and to the target error.
#[derive(Default)]
struct Side {
    seconds: Vec<f64>,
    seconds_to_target: Vec<f64>,
}

impl Side {
    fn push(&mut self, seconds: f64, picture: &[Rgb], reference: &[Rgb]) {
        self.seconds.push(seconds);
        // The error is inversely proportional to the number of samples.
        self.seconds_to_target.push(seconds * relmse(picture, reference) / TARGET);
    }
}

fn plan(context: &Context, integrator: &'static str, samples: u32) -> Plan {
    let samples = context.options.part_of(samples);
    Plan { integrator, side: SIDE, samples, seed: FIRST_SEED, threads: 1, max_depth: MAX_DEPTH }
}

fn path(context: &Context) -> Result<Vec<Row>, Error> {
    let (scene, reference) = (cornell::scene(), cornell::reference()?.pixels);
    let plan = plan(context, "path", 256);
    let scratch = Scratch::new("box")?;
    let mut mitsuba = Mitsuba::start(context.options, &scratch, &cornell::for_mitsuba(&scratch)?);
    if let Ok(mitsuba) = &mut mitsuba {
        context.say("box: Mitsuba compiles its kernels");
        mitsuba.render(plan.samples, 1)?;
    }
    let (mut ours, mut theirs) = (Side::default(), Side::default());
    for round in context.rounds() {
        let plan = Plan { seed: FIRST_SEED + round, ..plan };
        context.say(&format!("box: path, round {}", round + 1));
        let shot = plan.shoot(&scene)?;
        ours.push(shot.cpu_seconds, &shot.pixels, &reference);
        if let Ok(mitsuba) = &mut mitsuba {
            context.say(&format!("box: Mitsuba's path, round {}", round + 1));
            let shot = mitsuba.render(plan.samples, plan.seed)?;
            theirs.push(shot.cpu_seconds, &shot.pixels, &reference);
        }
    }
    let speed = Row::new(
        "path in the box, one thread: M samples/s",
        plan.millions() / median(ours.seconds),
        Goal::RatioAtLeast(1.5),
    );
    let time = Row::new(
        "path in the box, one thread: CPU seconds to relMSE 0.01",
        median(ours.seconds_to_target),
        Goal::RatioAtMost(0.5),
    );
    Ok(match mitsuba {
        Ok(mitsuba) => vec![
            speed.against(plan.millions() / median(theirs.seconds)).with_note(mitsuba.name()),
            time.against(median(theirs.seconds_to_target)).with_note(mitsuba.name()),
        ],
        Err(why) => vec![speed.with_note(why.clone()), time.with_note(why)],
    })
}

/// A goal for the seconds of `bdpt`: LuxCore's bidirectional engine has to take six times as long.
const LUXCORE: &str = "our side only: LuxCore's bidirectional engine has to take 6 times as long, and is not started from \
                       here";
/// A goal for a sample of `vcm`.
const SMALL_VCM: &str = "our side only: the goal is at most 0.8 of SmallVCM's time, which is not started from here; our own scenes of its \
     boxes are not built in, so this is the box with two spheres";

fn bidirectional(context: &Context) -> Result<Vec<Row>, Error> {
    let (scene, reference) = (cornell::scene(), cornell::reference()?.pixels);
    let plans = [plan(context, "bdpt", 32), plan(context, "vcm", 24)];
    let mut sides = [Side::default(), Side::default()];
    for round in context.rounds() {
        for (plan, side) in plans.iter().zip(&mut sides) {
            context.say(&format!("box: {}, round {}", plan.integrator, round + 1));
            let shot = Plan { seed: FIRST_SEED + round, ..*plan }.shoot(&scene)?;
            side.push(shot.cpu_seconds, &shot.pixels, &reference);
        }
    }
    let [bdpt, vcm] = sides;
    Ok(vec![
        Row::new(
            "bdpt in the box, one thread: CPU seconds to relMSE 0.01",
            median(bdpt.seconds_to_target),
            Goal::RatioAtMost(0.167),
        )
        .with_note(LUXCORE),
        Row::new(
            "vcm in the box, one thread: µs a sample",
            median(vcm.seconds) / plans[1].millions(),
            Goal::RatioAtMost(0.8),
        )
        .with_note(SMALL_VCM),
    ])
}
