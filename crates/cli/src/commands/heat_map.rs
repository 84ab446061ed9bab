//! `bilux convert --heat-map`: one channel of a picture in false colours.

use crate::assignments::from_flag;
use crate::converting::Convert;
use crate::{output, usage};
use anyhow::anyhow;
use bilux::math::photometry::LUMENS_PER_WATT;
use bilux::metadata::{IRRADIANCE, MEASURES};
use bilux::pictures::metrics::false_colours;
use bilux::pictures::{Channel, ColourSpace, Picture, label};
use bilux::scene::SceneError;

/// The channel that every picture with colours has, besides those of its file.
const LUMINANCE: &str = "luminance";

/// The channel of this name, or the first of the layer of this name, in false colours up to `--heat-max`, or to its own maximum; with
/// `--unit` in photometric units, with a scale.
///
/// # Errors
/// If there is no such channel, it has no such unit, or memory is short.
pub fn heat_map(picture: &Picture, name: &str, arguments: &Convert, quiet: bool) -> anyhow::Result<Picture> {
    let (named, samples) = match &arguments.unit {
        Some(unit) => (format!("{LUMINANCE} in {unit}"), photometric(picture, name, unit)?),
        None => channel(picture, name)?,
    };
    let finite = samples.iter().copied().filter(|sample| sample.is_finite());
    let own = finite.fold(0.0, f32::max);
    let rounded = if arguments.unit.is_some() { round(own) } else { own };
    let most = arguments.heat_max.unwrap_or(rounded);
    if !quiet {
        output::eprint(format_args!(
            "{named}: black is 0, pale yellow is {most} and more; the maximum is {own}"
        ));
    }
    let size = (picture.width(), picture.height());
    match &arguments.unit {
        Some(unit) => with_scale(samples, size, most, unit),
        None => Ok(false_colours(size, &samples, most)?),
    }
}

/// The name and the samples of a channel.
fn channel(picture: &Picture, name: &str) -> anyhow::Result<(String, Vec<f32>)> {
    let is_wanted =
        |channel: &str| channel == name || channel.split_once('.').is_some_and(|(l, _)| l == name);
    if let Some(found) = picture.channels().iter().find(|channel| is_wanted(&channel.name)) {
        return Ok((found.name.clone(), found.samples.clone()));
    }
    if name == LUMINANCE
        && let Some(colours) = picture.to_rgb()
    {
        return Ok((name.to_owned(), colours.iter().map(|colour| colour.luminance()).collect()));
    }
    let short = |channel: &Channel| match channel.name.split_once('.') {
        Some((layer, _)) if !name.contains('.') => layer.to_owned(),
        _ => channel.name.clone(),
    };
    let mut names: Vec<String> = picture.channels().iter().map(short).collect();
    names.dedup();
    let names = names.iter().map(String::as_str).chain([LUMINANCE]);
    Err(SceneError::unknown("channel", name, names, &from_flag("--heat-map")).into())
}

/// The luminance of a picture in cd/m², or the illuminance in lx where its surfaces are matt.
fn photometric(picture: &Picture, name: &str, unit: &str) -> anyhow::Result<Vec<f32>> {
    let wrong = |message: &str| Err(usage::wrong(anyhow!("--unit {unit}: {message}")));
    if name != LUMINANCE {
        return wrong("only luminance has photometric units: write --heat-map luminance");
    }
    if picture.colour_space != ColourSpace::LinearRec709 {
        return wrong("a picture for displays does not say how bright it was: render an .exr, .hdr or .pfm");
    }
    let Some(light) = picture.to_rgb() else { return wrong("the picture has no colours") };
    let in_lumens =
        |factor: f32| light.iter().map(|light| light.luminance() * (factor * LUMENS_PER_WATT)).collect();
    if unit != "lx" {
        return Ok(in_lumens(1.0));
    }
    if picture.metadata.get(MEASURES).is_some_and(|measured| measured == IRRADIANCE) {
        return Ok(in_lumens(std::f32::consts::PI));
    }
    let [Some(r), Some(g), Some(b)] = ["R", "G", "B"].map(|name| picture.channel(&format!("albedo.{name}")))
    else {
        return wrong(
            "illuminance is found by how much of it surfaces reflect: render with --aov albedo, or with the camera irradiance",
        );
    };
    // A matt surface reflects its albedo of the light that it receives, over π in each direction.
    let received =
        |light: f32, albedo: f32| if albedo > 0.0 { light * std::f32::consts::PI / albedo } else { 0.0 };
    let at = |i: usize| {
        let [red, green, blue] = light[i].to_array();
        bilux::math::Rgb::new(received(red, r[i]), received(green, g[i]), received(blue, b[i]))
    };
    Ok((0..light.len()).map(|i| at(i).luminance() * LUMENS_PER_WATT).collect())
}

/// The next number that is 1, 2, 3, 4, 5, 6 or 8 times a power of ten, but for rounding.
fn round(most: f32) -> f32 {
    if !(most > 0.0 && most.is_finite()) {
        return 1.0;
    }
    let mut power = 1.0f64;
    while power > f64::from(most) {
        power /= 10.0;
    }
    while power * 10.0 < f64::from(most) {
        power *= 10.0;
    }
    let steps = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    steps.map(|step| (step * power) as f32).into_iter().find(|step| *step >= most * 0.9999).unwrap_or(most)
}

/// Samples in false colours, above a bar of these with numbers.
fn with_scale(
    mut samples: Vec<f32>,
    (width, height): (usize, usize),
    most: f32,
    unit: &str,
) -> anyhow::Result<Picture> {
    const LETTER: [usize; 2] = [6, 8];
    let scale = if width >= 700 { 2 } else { 1 };
    let (bar, text) = (10 * scale, (LETTER[1] + 1) * scale);
    let share = |x: usize| x as f32 / width.saturating_sub(1).max(1) as f32;
    for _ in 0..bar {
        samples.extend((0..width).map(|x| most * share(x)));
    }
    samples.resize(samples.len() + text * width, 0.0);
    let mut shown = false_colours((width, height + bar + text), &samples, most)?;
    let last = format!("{most} {unit}");
    let room = |words: &str| (words.chars().count() * LETTER[0] + 1) * scale;
    let parts = if width > 6 * room(&last) { 4 } else { 1 };
    for i in 0..=parts {
        let words = if i == parts { last.clone() } else { format!("{}", most * i as f32 / parts as f32) };
        let middle = width * i / parts;
        let left = middle.saturating_sub(room(&words) / 2).min(width.saturating_sub(room(&words)));
        label(&mut shown, left, height + bar, &words, scale);
    }
    Ok(shown)
}
