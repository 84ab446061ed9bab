//! The contract of every BSDF, as checks that run on any of them: `docs/trust.md` lists what each check finds.

use crate::SUITE;
use crate::chi_square::{p_value, uniforms};
use crate::tally::Tally;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use bilux_scene::bsdf::{Bsdf, Lobe};
use bilux_scene::{BsdfSample, TransportMode};
use std::sync::LazyLock;

/// A BSDF as its three functions, so that a bug can be planted in any of them. Directions are local, with the normal as
/// z.
pub struct Scatterer {
    /// f·|cosθi|.
    pub eval: Box<dyn Fn(Vec3, Vec3, TransportMode) -> Rgb>,
    /// Density of `sample`.
    pub pdf: Box<dyn Fn(Vec3, Vec3, TransportMode) -> f32>,
    /// Samples a direction.
    pub sample: SampleFn,
    /// The geometric normal, where it differs from the shading normal.
    pub n_geom: Vec3,
}

/// `wo`, a random number for the choice of lobe, two for the direction, and the mode.
pub type SampleFn = Box<dyn Fn(Vec3, f32, Vec2, TransportMode) -> Option<BsdfSample>>;

impl From<Lobe> for Scatterer {
    fn from(lobe: Lobe) -> Scatterer {
        Scatterer {
            eval: Box::new(move |wo, wi, mode| lobe.eval(wo, wi, mode)),
            pdf: Box::new(move |wo, wi, _| lobe.pdf_solid_angle(wo, wi)),
            sample: Box::new(move |wo, choice, u, mode| lobe.sample(wo, choice, u, mode)),
            n_geom: Vec3::Z,
        }
    }
}

impl From<Bsdf> for Scatterer {
    fn from(bsdf: Bsdf) -> Scatterer {
        Scatterer {
            eval: Box::new(move |wo, wi, mode| bsdf.eval(wo, wi, mode)),
            pdf: Box::new(move |wo, wi, mode| bsdf.pdf_solid_angle(wo, wi, mode)),
            sample: Box::new(move |wo, choice, u, mode| bsdf.sample(wo, choice, u, mode)),
            n_geom: Vec3::Z,
        }
    }
}

/// Promises of a BSDF beyond the contract that holds for all.
#[derive(Clone, Copy, Debug)]
pub struct Promise {
    /// eval(a, b)·|cos a| = eval(b, a)·|cos b|.
    pub reciprocal: bool,
    /// A white one loses no energy.
    pub lossless: bool,
}

/// The checks, by name.
pub const CHECKS: [(&str, Check); 7] = [
    ("samples follow the pdf", samples_follow_the_density),
    ("weight times pdf is eval", weight_times_density_is_eval),
    ("reciprocity, or else the adjoint", reciprocity_or_adjoint),
    ("radiance and importance agree", the_same_from_both_ends),
    ("energy", energy),
    ("eval and pdf exclude delta lobes", delta_lobes_hide),
    ("lobes with zero probability give no samples", samples_are_sound),
];

/// Checks of many samples, whose verdicts are remembered.
const OF_MANY_SAMPLES: [&str; 3] = ["samples follow the pdf", "radiance and importance agree", "energy"];

/// One check; an error describes what is wrong.
pub type Check = fn(&Scatterer, Promise) -> Result<(), String>;

/// Runs some of the checks: those of many samples by the record of this case, where the first of their samples are as they were.
///
/// # Errors
/// What the first check says that fails, after its name.
pub fn keeps(case: &str, names: &[&str], s: &Scatterer, promise: Promise) -> Result<(), String> {
    let named = CHECKS.into_iter().filter(|(name, _)| names.contains(name));
    let (many, few): (Vec<_>, Vec<_>) = named.partition(|(name, _)| OF_MANY_SAMPLES.contains(name));
    let run = |checks: &[(&str, Check)]| {
        let mut checks = checks.iter();
        checks.try_for_each(|(name, run)| run(s, promise).map_err(|wrong| format!("{name}: {wrong}")))
    };
    run(&few)?;
    let names: Vec<&str> = many.iter().map(|(name, _)| *name).collect();
    let asked = format!("{} of {SAMPLES} samples, p > {SIGNIFICANCE}, {promise:?}", names.join(", "));
    if many.is_empty() {
        Ok(())
    } else {
        SUITE.check(case, &asked, || first_samples(s, &names), || run(&many))
    }
}

/// The first of the samples that these checks draw, and densities all around.
fn first_samples(s: &Scatterer, names: &[&str]) -> Vec<f32> {
    const FIRST: u64 = SAMPLES / 16;
    let mut numbers = Vec::new();
    let mut add = |sample: Option<BsdfSample>| {
        let Some(x) = sample else { return numbers.push(f32::NAN) };
        numbers.extend(x.wi.to_array().into_iter().chain(x.weight.to_array()));
        numbers.extend([
            x.pdf_solid_angle,
            f32::from(u8::from(x.is_delta)),
            f32::from(u8::from(x.transmits)),
        ]);
    };
    let streams = [("samples follow the pdf", 0, RADIANCE), ("energy", 300, IMPORTANCE)];
    for (_, stream, mode) in streams.into_iter().filter(|(name, ..)| names.contains(name)) {
        for (i, wo) in (stream..).zip(known_directions()) {
            (0..FIRST).for_each(|k| add(draw(s, wo, i, k, mode)));
        }
    }
    for (end, mode) in [RADIANCE, IMPORTANCE].into_iter().enumerate() {
        let known = ENDS[end][..FIRST as usize].iter();
        known.for_each(|known| add((s.sample)(known.direction, known.choice, known.u, mode)));
    }
    for wo in known_directions().into_iter().filter(|_| names.contains(&streams[0].0)) {
        let around = (0..FIRST).map(|k| warp::sample_sphere(uniforms(604, k).1));
        numbers.extend(around.map(|wi| (s.pdf)(wo, wi, RADIANCE)));
    }
    numbers
}

const RADIANCE: TransportMode = TransportMode::Radiance;
const IMPORTANCE: TransportMode = TransportMode::Importance;
/// Samples of each χ² test and of each mean.
const SAMPLES: u64 = 60_000;
/// Probability of a false alarm of one suite over all its directions, divided evenly among them.
const SIGNIFICANCE: f64 = 1e-4;
/// Number of directions tested.
const DIRECTIONS_TESTED: usize = 5;

/// Test directions: above and below the surface, steep and grazing.
fn known_directions() -> [Vec3; DIRECTIONS_TESTED] {
    static DIRECTIONS: LazyLock<[Vec3; DIRECTIONS_TESTED]> = LazyLock::new(|| {
        let at = |degrees: f32, turn: f32| {
            let (sin, cos) = sin_cos(degrees.to_radians());
            let (y, x) = sin_cos(turn);
            Vec3::new(sin * x, sin * y, cos)
        };
        [at(5.0, 0.3), at(35.0, 2.0), at(62.0, 4.0), at(80.0, 5.5), -at(40.0, 1.0)]
    });
    *DIRECTIONS
}

/// χ² test of `sample` against `pdf`; delta samples are compared with their probabilities instead.
pub fn samples_follow_the_density(s: &Scatterer, _promise: Promise) -> Result<(), String> {
    let directions = known_directions();
    let bound = SIGNIFICANCE / directions.len() as f64;
    for (i, &wo) in directions.iter().enumerate() {
        let deltas =
            (0..64).filter_map(|k| draw(s, wo, i as u64, k, RADIANCE)).filter(|x| x.is_delta).count();
        if deltas > 0 {
            shares_follow(s, wo, i as u64)?;
            continue;
        }
        let sample = |choice, u| (s.sample)(wo, choice, u, RADIANCE).map(|x| x.wi);
        let p = p_value(SAMPLES, i as u64, sample, |wi| (s.pdf)(wo, wi, RADIANCE));
        if p < bound {
            return Err(format!("χ² at wo {wo}: p = {p:.2e} < {bound:.2e}"));
        }
    }
    Ok(())
}

fn draw(s: &Scatterer, wo: Vec3, stream: u64, i: u64, mode: TransportMode) -> Option<BsdfSample> {
    let (choice, u) = uniforms(stream, i);
    (s.sample)(wo, choice, u, mode)
}

/// Each delta direction is sampled as often as its probability states, within five standard deviations.
fn shares_follow(s: &Scatterer, wo: Vec3, stream: u64) -> Result<(), String> {
    for transmits in [false, true] {
        let of_side: Vec<f64> = (0..SAMPLES)
            .filter_map(|i| draw(s, wo, stream, i, RADIANCE))
            .filter(|x| x.is_delta && x.transmits == transmits)
            .map(|x| f64::from(x.pdf_solid_angle))
            .collect();
        let Some(&probability) = of_side.first() else { continue };
        let n = SAMPLES as f64;
        let deviation = (of_side.len() as f64 - n * probability).abs();
        if deviation > 5.0 * (n * probability * (1.0 - probability)).sqrt() + 1.0 {
            let drawn = of_side.len() as f64 / n;
            return Err(format!("delta at wo {wo}: drawn {drawn:.4}, said {probability:.4}"));
        }
    }
    Ok(())
}

/// The weight and the density of a sample agree with `eval` and `pdf` for its direction.
pub fn weight_times_density_is_eval(s: &Scatterer, _promise: Promise) -> Result<(), String> {
    let directions = known_directions().into_iter().enumerate();
    let both_modes = directions.flat_map(|(i, wo)| [(i, wo, RADIANCE), (i, wo, IMPORTANCE)]);
    for (i, wo, mode) in both_modes {
        for x in (0..2000).filter_map(|k| draw(s, wo, 100 + i as u64, k, mode)).filter(|x| !x.is_delta) {
            let (f, pdf) = ((s.eval)(wo, x.wi, mode), (s.pdf)(wo, x.wi, mode));
            let said = x.weight * x.pdf_solid_angle;
            let far = |a: f32, b: f32| (a - b).abs() > 2e-3 * a.abs().max(b.abs()).max(1e-6);
            if far(pdf, x.pdf_solid_angle) {
                return Err(format!("wo {wo}, wi {}: pdf {pdf}, sampled with {}", x.wi, x.pdf_solid_angle));
            }
            if (0..3).any(|c| far(f[c], said[c])) {
                return Err(format!("wo {wo}, wi {}: eval {f:?}, weight times pdf {said:?}", x.wi));
            }
        }
    }
    Ok(())
}

/// Helmholtz reciprocity where promised; otherwise refracted radiance is importance over the square of the relative
/// index, and importance is radiance with the directions exchanged.
pub fn reciprocity_or_adjoint(s: &Scatterer, promise: Promise) -> Result<(), String> {
    for (i, wo) in known_directions().into_iter().enumerate() {
        for k in 0..500 {
            if promise.reciprocal {
                let (_, u) = uniforms(200 + i as u64, k);
                let wi = warp::sample_sphere(u);
                let there = (s.eval)(wo, wi, RADIANCE) * wo.z.abs();
                let back = (s.eval)(wi, wo, RADIANCE) * wi.z.abs();
                if (0..3).any(|c| (there[c] - back[c]).abs() > 1e-3 * there[c].max(back[c]).max(1e-5)) {
                    return Err(format!("wo {wo}, wi {wi}: {there:?} there, {back:?} back"));
                }
            } else if let (Some(r), Some(t)) =
                (draw(s, wo, 200 + i as u64, k, RADIANCE), draw(s, wo, 200 + i as u64, k, IMPORTANCE))
            {
                // Snell's law, about the normal of the surface or of the microfacet between the directions.
                let sin = |d: Vec3| (1.0 - d.z * d.z).max(0.0).sqrt();
                let eta = if r.transmits && r.is_delta { sin(wo) / sin(r.wi) } else { r.eta };
                let exchanged = (s.eval)(r.wi, wo, IMPORTANCE).luminance() * r.wi.z.abs();
                let there = (s.eval)(wo, r.wi, RADIANCE).luminance() * wo.z.abs();
                if (exchanged - there).abs() > 2e-3 * there.max(1e-5) {
                    return Err(format!(
                        "wo {wo}, wi {}: radiance {there}, importance {exchanged} back",
                        r.wi
                    ));
                }
                let (radiance, importance) = (r.weight.luminance() * eta * eta, t.weight.luminance());
                if (radiance - importance).abs() > 1e-2 * importance {
                    return Err(format!("wo {wo}: radiance·η² {radiance}, importance {importance}"));
                }
            }
        }
    }
    Ok(())
}

/// Values of broad shapes about each of the known directions: of what measures, and of what shines.
fn shapes(d: Vec3) -> [f64; DIRECTIONS_TESTED] {
    known_directions().map(|about| {
        let x = f64::from(1.0 + d.dot(about));
        x * x
    })
}

/// A direction from which a path comes, the same for all that is tested, and the random numbers for what follows.
#[derive(Clone, Copy)]
struct Known {
    direction: Vec3,
    shapes: [f64; DIRECTIONS_TESTED],
    choice: f32,
    u: Vec2,
}

/// For radiance, and for importance.
static ENDS: LazyLock<[Vec<Known>; 2]> = LazyLock::new(|| {
    [0, 1].map(|end| {
        let known = |k| {
            let direction = warp::sample_sphere(uniforms(600 + end, k).1);
            let (choice, u) = uniforms(602 + end, k);
            Known { direction, shapes: shapes(direction), choice, u }
        };
        (0..SAMPLES).map(known).collect()
    })
});

/// ⟨g, S h⟩ = ⟨S* g, h⟩: incident light `h` that is measured with `g` gives the same, whether directions are sampled
/// for radiance from the measuring side or for importance from the incident side. [Veach 1997, 4.4]
pub fn the_same_from_both_ends(s: &Scatterer, _promise: Promise) -> Result<(), String> {
    let pairs = DIRECTIONS_TESTED * DIRECTIONS_TESTED;
    let mut tallies = vec![[Tally::default(); 2]; pairs];
    for k in 0..SAMPLES as usize {
        for (end, mode) in [RADIANCE, IMPORTANCE].into_iter().enumerate() {
            let Known { direction, shapes: at_known, choice, u } = ENDS[end][k];
            let sample = (s.sample)(direction, choice, u, mode);
            let cos = direction.dot(s.n_geom).abs();
            let weight = sample.map_or(0.0, |x| f64::from(x.weight.luminance() * cos));
            let at_found = sample.map_or(at_known, |x| shapes(x.wi));
            let (measured, incident) =
                if mode == RADIANCE { (at_known, at_found) } else { (at_found, at_known) };
            let measured = measured.map(|g| g * weight);
            for (tally, i) in tallies.iter_mut().zip(0..) {
                tally[end].add(measured[i % DIRECTIONS_TESTED] * incident[i / DIRECTIONS_TESTED]);
            }
        }
    }
    for (i, [radiance, importance]) in tallies.iter().enumerate() {
        let p = radiance.p_value(importance);
        if p < SIGNIFICANCE / pairs as f64 {
            let (r, t) = (radiance.mean(), importance.mean());
            return Err(format!("pair {i}: radiance {r:.5}, importance {t:.5}, p = {p:.2e}"));
        }
    }
    Ok(())
}

/// In no channel does more light leave than arrived; all of it leaves where promised.
pub fn energy(s: &Scatterer, promise: Promise) -> Result<(), String> {
    for (i, wo) in known_directions().into_iter().enumerate() {
        let weights: Vec<Rgb> = (0..SAMPLES)
            .map(|k| draw(s, wo, 300 + i as u64, k, IMPORTANCE).map_or(Rgb::BLACK, |x| x.weight))
            .collect();
        let n = weights.len() as f64;
        for channel in 0..3 {
            let weights = || weights.iter().map(|weight| f64::from(weight[channel]));
            let mean = weights().sum::<f64>() / n;
            let variance = weights().map(|w| (w - mean) * (w - mean)).sum::<f64>() / (n - 1.0);
            let error = 5.0 * (variance / n).sqrt() + 1e-5;
            if mean > 1.0 + error {
                return Err(format!("wo {wo}: gives out {mean:.5} of the light"));
            }
            if promise.lossless && mean < 1.0 - error {
                return Err(format!("wo {wo}: keeps only {mean:.5} of the light, and promised all"));
            }
        }
    }
    Ok(())
}

/// A delta direction has no density that `eval` or `pdf` could return.
pub fn delta_lobes_hide(s: &Scatterer, _promise: Promise) -> Result<(), String> {
    for (i, wo) in known_directions().into_iter().enumerate() {
        let samples: Vec<BsdfSample> =
            (0..64).filter_map(|k| draw(s, wo, 400 + i as u64, k, RADIANCE)).collect();
        if !samples.is_empty() && samples.iter().all(|x| x.is_delta) {
            for x in &samples {
                if (s.pdf)(wo, x.wi, RADIANCE) != 0.0 || !(s.eval)(wo, x.wi, RADIANCE).is_black() {
                    return Err(format!("wo {wo}: a delta direction shows in eval or pdf"));
                }
            }
        }
    }
    Ok(())
}

/// Directions have unit length, weights are finite and not negative, densities are positive, and sides are as stated.
pub fn samples_are_sound(s: &Scatterer, _promise: Promise) -> Result<(), String> {
    for (i, wo) in known_directions().into_iter().enumerate() {
        for x in (0..2000).filter_map(|k| draw(s, wo, 500 + i as u64, k, RADIANCE)) {
            let unit = (x.wi.length() - 1.0).abs() < 1e-4;
            let light = x.weight.is_finite() && (0..3).all(|c| x.weight[c] >= 0.0);
            let side = (wo.z * x.wi.z < 0.0) == x.transmits;
            if !(unit && light && side && x.pdf_solid_angle > 0.0) {
                return Err(format!("wo {wo}: unsound sample {x:?}"));
            }
        }
    }
    Ok(())
}
