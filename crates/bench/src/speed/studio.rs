//! A model in the studio with nothing said, as a user renders it: read, lit, rendered, denoised and written.

use super::measurement::{Context, Measurement};
use super::mitsuba::Scratch;
use super::model::{NO_MODEL, name_of};
use super::row::{Goal, Row};
use super::shots::{UserPicture, as_a_user};
use crate::median;
use bilux::Error;
use bilux::formats::ReadOptions;
use bilux::pictures::denoise::preload;
use bilux::scene::{Parameters, Value};
use std::path::Path;
use std::time::Instant;

pub(super) const MEASUREMENT: Measurement = Measurement {
    name: "studio",
    summary: "a model in the studio with nothing said, all cores: samples a pixel in 5 s and in 1 s",
    run,
};

/// The limit of seconds that stands for one.
const SHORT: f32 = 1.0;

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let goals = [Goal::AtLeast(40.0), Goal::AtLeast(8.0), Goal::AtMost(1.05)];
    let file = context.options.model.as_deref();
    let model = file.map_or_else(|| "a model".to_owned(), name_of);
    let whats = [
        format!("{model} in the studio, nothing said, all cores: samples a pixel"),
        format!("{model} in the studio, time limit of 1 s: samples a pixel"),
        format!("{model} in the studio, time limit of 1 s: seconds"),
    ];
    let Some(file) = file else {
        let rows = whats.into_iter().zip(goals);
        return Ok(rows.map(|(what, goal)| Row::skipped(what, goal, NO_MODEL)).collect());
    };
    let scratch = Scratch::new("studio")?;
    let output = scratch.path("picture.png");
    let (mut long, mut short) = (Vec::new(), Vec::new());
    for round in context.rounds() {
        context.say(&format!("studio: nothing said, round {}", round + 1));
        long.push(render(file, &output, &context.options.read, None)?);
        context.say(&format!("studio: a limit of 1 s, round {}", round + 1));
        short.push(render(file, &output, &context.options.read, Some(SHORT))?);
    }
    let samples = |pictures: &[Picture]| median(pictures.iter().map(|p| f64::from(p.samples)).collect());
    let seconds = |pictures: &[Picture]| median(pictures.iter().map(|p| p.seconds).collect());
    let note = |pictures: &[Picture]| {
        format!("{} pixels, {:.2} s with reading, denoising and writing", pictures[0].size, seconds(pictures))
    };
    let [a, b, c] = whats;
    Ok(vec![
        Row::new(a, samples(&long), goals[0]).with_note(note(&long)),
        Row::new(b, samples(&short), goals[1]).with_note(note(&short)),
        Row::new(c, seconds(&short), goals[2]),
    ])
}

/// A picture, and the seconds from the start to the written file.
struct Picture {
    samples: u32,
    seconds: f64,
    size: String,
}

fn render(file: &Path, output: &Path, read: &ReadOptions, limit: Option<f32>) -> Result<Picture, Error> {
    let begun = Instant::now();
    // As the command line does while it reads the scene.
    preload(0);
    let scene = bilux::load(file, read)?;
    let mut user = Parameters::default();
    if let Some(limit) = limit {
        user.set("time_limit", limit);
        user.set("spp", Value::Integer(0));
    }
    let UserPicture { samples, size } = as_a_user(&scene, user, begun, output)?;
    Ok(Picture { samples, seconds: begun.elapsed().as_secs_f64(), size })
}
