//! References: long renders by two unbiased integrators that must agree before they are averaged.

use super::errors::{block_means, mean};
use super::scenes::{SIZE, chosen_scenes, generated};
use super::timed_render::{calibrate, settings, shoot};
use crate::{ProgressFn, Report};
use bilux::Error;
use bilux::pictures::{Limits, Picture, WriteOptions, read_bytes, write};
use bilux::scene::SceneBuilder;
use bilux_math::Rgb;
use bilux_math::transcendental::powf_f64;
use serde_json::json;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::path::PathBuf;

/// The expected picture of a scene.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Linear light, in rows.
    pub pixels: Vec<Rgb>,
    /// Error of the reference itself, in the units of relMSE: errors close to it are meaningless.
    pub relmse: f64,
    /// Origin of the reference, in words.
    pub origin: String,
}

impl Reference {
    /// Reads a reference from its file.
    ///
    /// # Errors
    /// If the file is not a reference.
    pub fn read(bytes: &[u8]) -> Result<Reference, Error> {
        Reference::read_sized(bytes, SIZE)
    }

    /// Reads a reference of a width and a height from its file.
    pub(crate) fn read_sized(bytes: &[u8], size: (u32, u32)) -> Result<Reference, Error> {
        let picture = read_bytes(bytes, Some("exr"), &Limits::default())?;
        let text = |key: &str| picture.metadata.get(key).cloned().unwrap_or_default();
        let of_size = (picture.width(), picture.height()) == (size.0 as usize, size.1 as usize);
        match (picture.to_rgb(), text("relmse").parse()) {
            (Some(pixels), Ok(relmse)) if of_size => Ok(Reference { pixels, relmse, origin: text("origin") }),
            _ => Err(Error::Settings("this is not a reference file: make it again".to_owned())),
        }
    }

    /// The mean over pixels and channels.
    pub fn mean(&self) -> f64 {
        mean(&self.pixels)
    }
}

/// Options for making references.
#[derive(Clone, Debug)]
pub struct ReferenceOptions {
    /// The folder for the files.
    pub folder: PathBuf,
    /// The scenes; if empty, all of them.
    pub scenes: Vec<String>,
    /// The CPU seconds of each of the two integrators on a scene.
    pub seconds: f64,
    /// The number of threads; 0 for all cores.
    pub threads: u32,
}

/// Integrators that find all light in every scene, in different ways.
const REFERENCE_INTEGRATORS: [&str; 2] = ["path", "bdpt"];

/// The number of pictures per integrator, each with its own seed, from which the variance is estimated.
const PARTS: u64 = 16;

/// The first of the seeds, which no measurement uses.
const FIRST_SEED: u64 = 1 << 32;

/// The side of the blocks whose means are compared: large enough for the means to be nearly normal, as Welch's test
/// assumes, even where few paths find the light.
const SIDE: usize = 32;

/// Two integrators agree if the minimum p-value over all blocks, corrected for their number, is above this.
const AGREE: f64 = 1e-3;

/// Makes the files of references. If the integrators disagree, no file is written.
///
/// # Errors
/// If a scene is unknown, or a file cannot be written.
pub fn make_references(making: &ReferenceOptions, progress: ProgressFn) -> Result<Report, Error> {
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (name, _) in chosen_scenes(&making.scenes)? {
        let mut found = Vec::new();
        for integrator in REFERENCE_INTEGRATORS {
            progress(&format!("{name}: {integrator}"));
            found.push(ReferenceRender::ask(&generated(name)?, integrator, making)?);
        }
        let [a, b] = &found[..] else { continue };
        let p = a.agreement(b);
        let reference = a.joined(b);
        let agrees = p > AGREE;
        if agrees {
            write_reference(making, name, &reference)?;
        }
        let errors = [a, b].map(|w| w.error_relative_to(&reference.pixels));
        lines.push(format!(
            "{name}: {}; errors {:.2e} and {:.2e}, together {:.2e}; means {:.5} and {:.5}; least p {p:.3}{}",
            reference.origin,
            errors[0],
            errors[1],
            reference.relmse,
            mean(&a.mean()),
            mean(&b.mean()),
            if agrees { "" } else { ": THEY DISAGREE, nothing written" }
        ));
        progress(lines.last().map_or("", |line| line));
        rows.push(json!({
            "scene": name, "origin": reference.origin, "relmse": reference.relmse, "p": p, "agrees": agrees,
            "mean": reference.mean(),
        }));
    }
    Ok(Report { rows, text: lines.join("\n"), ..Report::default() })
}

/// Makes the reference of any scene; also returns the minimum p-value if the integrators disagree.
pub(super) fn make_reference(
    name: &str,
    scene: &SceneBuilder,
    making: &ReferenceOptions,
    progress: ProgressFn,
) -> Result<(Reference, Option<f64>), Error> {
    let ask = |integrator| {
        progress(&format!("{name}: {integrator}, for the reference"));
        ReferenceRender::ask(scene, integrator, making)
    };
    let [a, b] = REFERENCE_INTEGRATORS.map(ask);
    let (a, b) = (a?, b?);
    let p = a.agreement(&b);
    Ok((a.joined(&b), (p <= AGREE).then_some(p)))
}

/// One integrator's pictures of a scene.
struct ReferenceRender {
    name: &'static str,
    /// Samples per pixel in each part.
    samples: u32,
    parts: Vec<Vec<Rgb>>,
}

impl ReferenceRender {
    fn ask(
        scene: &SceneBuilder,
        integrator: &'static str,
        making: &ReferenceOptions,
    ) -> Result<ReferenceRender, Error> {
        let budget = making.seconds / PARTS as f64;
        let speed = calibrate(scene, integrator, &[budget], making.threads)?;
        let samples = ((speed * budget).round() as u32).max(1);
        let part =
            |k| Ok(shoot(scene, &settings(integrator, samples, FIRST_SEED + k, making.threads))?.picture);
        let parts = (0..PARTS).map(part).collect::<Result<_, Error>>()?;
        Ok(ReferenceRender { name: integrator, samples, parts })
    }

    fn mean(&self) -> Vec<Rgb> {
        let count = self.parts.len() as f64;
        let pixel = |i: usize| {
            let sum = |c: usize| self.parts.iter().map(|part| f64::from(part[i][c])).sum::<f64>();
            Rgb::from_array([0, 1, 2].map(|c| (sum(c) / count) as f32))
        };
        (0..self.parts[0].len()).map(pixel).collect()
    }

    /// The relMSE of the mean, estimated from how much its parts differ.
    fn error_relative_to(&self, reference: &[Rgb]) -> f64 {
        let (mean, count) = (self.mean(), self.parts.len() as f64);
        let error = |i: usize, c: usize| {
            let m = f64::from(mean[i][c]);
            let spread: f64 =
                self.parts.iter().map(|p| (f64::from(p[i][c]) - m) * (f64::from(p[i][c]) - m)).sum();
            let r = f64::from(reference[i][c]);
            spread / (count - 1.0) / count / (r * r + 0.01)
        };
        let all: f64 =
            (0..mean.len()).flat_map(|i| (0..3).map(move |c| (i, c))).map(|(i, c)| error(i, c)).sum();
        all / (3 * mean.len()) as f64
    }

    /// The probability that two integrators with equal means differ by as much in any block: the minimum p-value of
    /// Welch's tests over all blocks and channels, corrected for their number. [Welch 1947; Šidák 1967]
    fn agreement(&self, other: &ReferenceRender) -> f64 {
        let blocks = |w: &ReferenceRender| -> Vec<Vec<f64>> {
            w.parts.iter().map(|p| block_means(p, SIZE.0 as usize, SIDE)).collect()
        };
        let (a, b) = (blocks(self), blocks(other));
        let of =
            |parts: &[Vec<f64>], block: usize| -> Vec<f64> { parts.iter().map(|part| part[block]).collect() };
        let least = (0..a[0].len()).map(|block| welch(&of(&a, block), &of(&b, block))).fold(1.0, f64::min);
        1.0 - powf_f64(1.0 - least, a[0].len() as f64)
    }

    /// Averages both, each weighted according to its error over the whole picture.
    fn joined(&self, other: &ReferenceRender) -> Reference {
        let (a, b) = (self.mean(), other.mean());
        let (error_a, error_b) = (self.error_relative_to(&a), other.error_relative_to(&a));
        let all = (error_a + error_b).max(f64::MIN_POSITIVE);
        let (of_a, of_b) = (error_b / all, error_a / all);
        let pixels = a.iter().zip(&b).map(|(a, b)| (*a * of_a as f32 + *b * of_b as f32).map(shortened));
        let pixels: Vec<Rgb> = pixels.collect();
        let [e, f] = [self, other].map(|w| w.error_relative_to(&pixels));
        let reported = |w: &ReferenceRender| {
            format!("{} {} samples a pixel", w.name, u64::from(w.samples) * w.parts.len() as u64)
        };
        Reference {
            relmse: of_a * of_a * e + of_b * of_b * f,
            origin: format!("{} and {}", reported(self), reported(other)),
            pixels,
        }
    }
}

/// Keeps eight significant bits of a sample. What is lost is a millionth as relMSE, spread uniformly, and the file is
/// half as long.
fn shortened(x: f32) -> f32 {
    f32::from_bits((x.to_bits() + 0x8000) & !0xffff)
}

fn welch(a: &[f64], b: &[f64]) -> f64 {
    let estimate = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        (mean, values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0) / n)
    };
    let ((mean_a, va), (mean_b, vb)) = (estimate(a), estimate(b));
    if va + vb == 0.0 {
        return f64::from(u8::from(mean_a == mean_b));
    }
    let freedom =
        (va + vb) * (va + vb) / (va * va / (a.len() as f64 - 1.0) + vb * vb / (b.len() as f64 - 1.0));
    let t = (mean_a - mean_b).abs() / (va + vb).sqrt();
    StudentsT::new(0.0, 1.0, freedom).map_or(0.0, |students| 2.0 * students.sf(t))
}

fn write_reference(making: &ReferenceOptions, name: &str, reference: &Reference) -> Result<(), Error> {
    let path = making.folder.join(format!("{name}.exr"));
    let mut picture = Picture::from_rgb(SIZE.0 as usize, SIZE.1 as usize, reference.pixels.clone())?;
    let texts = [("relmse", format!("{:.3e}", reference.relmse)), ("origin", reference.origin.clone())];
    picture.metadata.extend(texts.map(|(key, text)| (key.to_owned(), text)));
    Ok(write(path, &picture, &WriteOptions::default())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    /// Parts of noise around a mean.
    fn reference_render(kind: u64, mean: f32) -> ReferenceRender {
        let pixels = u64::from(SIZE.0 * SIZE.1);
        let noise = |part: u64, i: u64| unit_f32(hash_words([kind, part, i]) as u32) - 0.5;
        let part = |part| (0..pixels).map(|i| Rgb::grey(mean + noise(part, i))).collect();
        ReferenceRender { name: "noise", samples: 4, parts: (0..PARTS).map(part).collect() }
    }

    #[test]
    fn equal_means_agree_and_others_do_not() {
        let (a, b, c) = (reference_render(1, 1.0), reference_render(2, 1.0), reference_render(3, 1.05));
        assert!(a.agreement(&b) > 0.05, "{}", a.agreement(&b));
        assert!(a.agreement(&c) < AGREE, "{}", a.agreement(&c));
    }

    #[test]
    fn a_reference_knows_its_error() {
        let (a, b) = (reference_render(4, 1.0), reference_render(5, 1.0));
        let reference = a.joined(&b);
        // Uniform noise of width 1 over 32 parts.
        let wanted = 1.0 / 12.0 / (2.0 * PARTS as f64) / 1.01;
        assert!((reference.relmse / wanted - 1.0).abs() < 0.05, "{} for {wanted}", reference.relmse);
        let truth = vec![Rgb::grey(1.0); reference.pixels.len()];
        let real = crate::render::relmse(&reference.pixels, &truth);
        assert!((real / wanted - 1.0).abs() < 0.05, "{real} for {wanted}");
        assert_eq!(reference.origin, "noise 64 samples a pixel and noise 64 samples a pixel");
    }

    #[test]
    fn shortened_samples_are_within_half_a_step() {
        for x in [1.0f32, 1.375, 0.1, 1234.5, 0.0, 1e-20] {
            let y = shortened(x);
            assert!((y - x).abs() <= x / 256.0 && y.to_bits() & 0xffff == 0, "{x} became {y}");
        }
    }
}
