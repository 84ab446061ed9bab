//! `bilux convert --heat-map`: one channel of a picture, in false colours or as a table of numbers; and what a plan adds up to.

use super::contours::drawn;
use crate::arguments::assignments::from_flag;
use crate::arguments::converting::Convert;
use crate::process::{output, usage};
use anyhow::anyhow;
use bilux::math::photometry::LUMENS_PER_WATT;
use bilux::metadata::{IRRADIANCE, MEASURES};
use bilux::pictures::metrics::false_colours;
use bilux::pictures::{Channel, ColourSpace, Picture, label};
use bilux::scene::SceneError;

/// The channel that every picture with colours has, besides those of its file.
const LUMINANCE: &str = "luminance";

/// The values of a channel, or of light in a photometric unit.
pub struct Plan<'a> {
    name: String,
    size: (usize, usize),
    values: Vec<f32>,
    /// Their standard errors, if the picture has them.
    errors: Option<Vec<f32>>,
    unit: Option<&'a str>,
    arguments: &'a Convert,
}

impl Plan<'_> {
    /// Values of the channel of this name, or of the first of the layer of this name; with `--unit` in photometric units.
    ///
    /// # Errors
    /// If there is no such channel, or it has no such unit.
    pub fn of<'a>(picture: &Picture, name: &str, arguments: &'a Convert) -> anyhow::Result<Plan<'a>> {
        let size = (picture.width(), picture.height());
        let unit = arguments.unit.as_deref();
        let Some(given) = unit else {
            let (name, values) = channel(picture, name)?;
            return Ok(Plan { name, size, values, errors: None, unit, arguments });
        };
        let factor = arguments.maintenance_factor.unwrap_or(1.0);
        let scaled = |mut values: Vec<f32>| {
            values.iter_mut().for_each(|value| *value *= factor);
            values
        };
        let lumens = Lumens::of(picture, name, given)?;
        let errors = lumens.errors(picture).map(scaled);
        let name = format!("{LUMINANCE} in {given}");
        Ok(Plan { name, size, values: scaled(lumens.values), errors, unit, arguments })
    }

    fn finite(&self) -> impl Iterator<Item = (usize, f32)> {
        self.values.iter().copied().enumerate().filter(|(_, value)| value.is_finite())
    }

    /// The value that is pale yellow.
    fn most(&self) -> f32 {
        let own = self.finite().map(|(_, value)| value).fold(0.0, f32::max);
        let rounded = if self.unit.is_some() { round(own) } else { own };
        self.arguments.heat_max.unwrap_or(rounded)
    }

    /// Says what the colours mean, and of a photometric plan what it adds up to.
    pub fn explain(&self) {
        let own = self.finite().map(|(_, value)| value).fold(0.0, f32::max);
        let most = self.most();
        output::eprint(format_args!(
            "{}: black is 0, pale yellow is {most} and more; the maximum is {own}",
            self.name
        ));
        if let Some(text) = self.summary() {
            output::eprint(text);
        }
    }

    /// Mean, minimum, maximum and uniformity, by the names of EN 12464-1, with standard errors where the picture has them.
    fn summary(&self) -> Option<String> {
        let unit = self.unit?;
        let symbol = if unit == "lx" { "E" } else { "L" };
        let count = self.finite().count();
        let least = self.finite().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let largest = self.finite().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mean = self.finite().map(|(_, value)| f64::from(value)).sum::<f64>() / count as f64;
        let error_of = |index: usize| self.errors.as_ref().map(|errors| f64::from(errors[index]));
        let of_mean = self.errors.as_ref().map(|errors| {
            let squares = self.finite().map(|(i, _)| f64::from(errors[i]) * f64::from(errors[i]));
            squares.sum::<f64>().sqrt() / count as f64
        });
        let value = |name: &str, value: f64, error: Option<f64>| {
            let error = error.map_or_else(String::new, |error| format!(" ± {}", significant(error, 2)));
            format!("{symbol}{name} {}{error} {unit}", significant(value, 3))
        };
        let uniformity = if mean > 0.0 { f64::from(least.1) / mean } else { 0.0 };
        let factor = self.arguments.maintenance_factor;
        let maintained =
            factor.map_or_else(String::new, |factor| format!("; with the maintenance factor {factor}"));
        let unknown = if self.errors.is_none() { "; errors are known with --aov variance" } else { "" };
        Some(format!(
            "{}, {}, {}, U0 {uniformity:.3}{maintained}{unknown}",
            value("m", mean, of_mean),
            value("min", f64::from(least.1), error_of(least.0)),
            value("max", f64::from(largest.1), error_of(largest.0)),
        ))
    }

    /// In false colours up to `--heat-max`, or to its own maximum, with the contours that are asked for; with `--unit` above a
    /// scale.
    ///
    /// # Errors
    /// If memory is short.
    pub fn picture(&self) -> anyhow::Result<Picture> {
        let (most, levels) = (self.most(), &self.arguments.contours);
        let picture = match self.unit {
            Some(unit) => with_scale(self.values.clone(), self.size, most, unit)?,
            None => false_colours(self.size, &self.values, most)?,
        };
        Ok(if levels.is_empty() { picture } else { drawn(picture, self.size, &self.values, levels)? })
    }

    /// A line for each row of pixels, from the top, of numbers separated by commas.
    pub fn table(&self) -> String {
        let line = |row: &[f32]| row.iter().map(f32::to_string).collect::<Vec<_>>().join(",") + "\n";
        self.values.chunks(self.size.0.max(1)).map(line).collect()
    }
}

/// A number with so many digits, but no fewer than those before the point.
fn significant(value: f64, digits: i32) -> String {
    let mut decimals = digits;
    let mut power = 1.0;
    while decimals > 0 && value.abs() >= power {
        (decimals, power) = (decimals - 1, power * 10.0);
    }
    let mut scaled = value.abs() * 10.0;
    while value != 0.0 && decimals >= digits && decimals < 12 && scaled < 1.0 {
        (decimals, scaled) = (decimals + 1, scaled * 10.0);
    }
    format!("{value:.*}", decimals as usize)
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

/// Light in a photometric unit, and what it was found by.
struct Lumens {
    values: Vec<f32>,
    /// Of each pixel, the unit over the light of each channel, its part of the luminance included.
    per_channel: Vec<[f32; 3]>,
}

impl Lumens {
    /// The luminance of a picture in cd/m², or the illuminance in lx where its surfaces are matt.
    fn of(picture: &Picture, name: &str, unit: &str) -> anyhow::Result<Lumens> {
        let wrong = |message: &str| Err(usage::wrong(anyhow!("--unit {unit}: {message}")));
        if name != LUMINANCE {
            return wrong("only luminance has photometric units: write --heat-map luminance");
        }
        if picture.colour_space != ColourSpace::LinearRec709 {
            return wrong(
                "a picture for displays does not say how bright it was: render an .exr, .hdr or .pfm",
            );
        }
        let Some(light) = picture.to_rgb() else { return wrong("the picture has no colours") };
        let parts = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|channel| bilux::math::Rgb::from_array(channel).luminance() * LUMENS_PER_WATT);
        let evenly = |factor: f32| vec![parts.map(|part| part * factor); light.len()];
        let per_channel = if unit != "lx" {
            evenly(1.0)
        } else if picture.metadata.get(MEASURES).is_some_and(|measured| measured == IRRADIANCE) {
            evenly(std::f32::consts::PI)
        } else {
            let albedo = ["R", "G", "B"].map(|name| picture.channel(&format!("albedo.{name}")));
            let [Some(r), Some(g), Some(b)] = albedo else {
                return wrong(
                    "illuminance is found by how much of it surfaces reflect: render with --aov albedo, or with the camera \
                     irradiance",
                );
            };
            // A matt surface reflects its albedo of the light that it receives, over π in each direction.
            let received = |part: f32, albedo: f32| {
                if albedo > 0.0 { part * std::f32::consts::PI / albedo } else { 0.0 }
            };
            (0..light.len())
                .map(|i| [received(parts[0], r[i]), received(parts[1], g[i]), received(parts[2], b[i])])
                .collect()
        };
        let value = |(light, per): (&bilux::math::Rgb, &[f32; 3])| {
            light.to_array().iter().zip(per).map(|(light, per)| light * per).sum()
        };
        Ok(Lumens { values: light.iter().zip(&per_channel).map(value).collect(), per_channel })
    }

    /// Standard errors, if the picture has the layer `variance`: those of its channels add up, since they are of the same samples.
    fn errors(&self, picture: &Picture) -> Option<Vec<f32>> {
        let [r, g, b] = ["R", "G", "B"].map(|name| picture.channel(&format!("variance.{name}")));
        let (r, g, b) = (r?, g?, b?);
        let error = |(i, per): (usize, &[f32; 3])| {
            [r[i], g[i], b[i]].iter().zip(per).map(|(variance, per)| variance.max(0.0).sqrt() * per).sum()
        };
        Some(self.per_channel.iter().enumerate().map(error).collect())
    }
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
