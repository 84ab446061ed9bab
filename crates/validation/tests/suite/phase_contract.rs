//! Every registered phase function keeps its contract, media sample the distances that they say, and every check can fail.

use bilux_math::transcendental::exp_f64;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Medium;
use bilux_scene::media::{Droplets, FreePath, HenyeyGreenstein, PHASES, Phase};
use bilux_validation::chi_square::uniforms;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::TAU;

/// Samples of each χ² test.
const SAMPLES: u64 = 60_000;
/// Probability of a false alarm of one test.
const SIGNIFICANCE: f64 = 1e-6;

/// A phase function as its functions, so that a bug can be planted.
struct Scatterer<'a> {
    at: &'a dyn Fn(f32) -> f32,
    sample: &'a dyn Fn(Vec3, f32, Vec2) -> Vec3,
    mean_cosine: f32,
}

/// Midpoints over one minus the cosine of the turn and their widths, closest together where functions are sharp: straight on and
/// straight back.
fn midpoints() -> Vec<(f64, f64)> {
    const STEPS: u32 = 100_000;
    let half = (0..STEPS).map(|i| {
        let x = (f64::from(i) + 0.5) / f64::from(STEPS);
        (x * x * x * x, 4.0 * x * x * x / f64::from(STEPS))
    });
    let mut all: Vec<(f64, f64)> = half.collect();
    all.extend(all.clone().into_iter().rev().map(|(turn, width)| (2.0 - turn, width)));
    all
}

/// Equally likely ranges of turns in the χ² test.
const RANGES: usize = 64;

fn check(s: &Scatterer) -> Result<(), String> {
    let part = |(turn, width): (f64, f64)| TAU * f64::from((s.at)(turn as f32)) * width;
    let total: f64 = midpoints().into_iter().map(part).sum();
    if (total - 1.0).abs() > 2e-4 {
        return Err(format!("integrates to {total}"));
    }
    let mean: f64 = midpoints().into_iter().map(|at| part(at) * (1.0 - at.0)).sum();
    if (mean - f64::from(s.mean_cosine)).abs() > 2e-4 {
        return Err(format!("has the mean cosine {mean}, not {}", s.mean_cosine));
    }
    let (mut ends, mut sum) = (Vec::new(), 0.0);
    for at in midpoints() {
        sum += part(at);
        if sum >= (ends.len() + 1) as f64 / RANGES as f64 && ends.len() + 1 < RANGES {
            ends.push(at.0 + 0.5 * at.1);
        }
    }
    let expected = SAMPLES as f64 / RANGES as f64;
    for (stream, wo) in [Vec3::Z, Vec3::new(0.6, -0.48, 0.64), Vec3::NEG_Y].into_iter().enumerate() {
        let mut counts = [[0.0; RANGES]; 2];
        let across = bilux_math::Frame::from_normal(wo);
        for i in 0..SAMPLES {
            let (choice, u) = uniforms(stream as u64, i);
            let wi = (s.sample)(wo, choice, u);
            let turn = 0.5 * (wi + wo).as_dvec3().length_squared();
            counts[0][ends.partition_point(|end| *end < turn)] += 1.0;
            // Around the direction of travel all angles are as likely.
            let local = across.to_local(wi);
            let angle = f64::from(bilux_math::transcendental::atan2(local.y, local.x)) / TAU + 0.5;
            counts[1][((angle * RANGES as f64) as usize).min(RANGES - 1)] += 1.0;
        }
        for counts in counts {
            let deviation =
                counts.iter().map(|count| (count - expected) * (count - expected) / expected).sum();
            let p = ChiSquared::new((RANGES - 1) as f64).unwrap().sf(deviation);
            if p < SIGNIFICANCE {
                return Err(format!("χ² at wo {wo}: p = {p:.2e}"));
            }
        }
    }
    Ok(())
}

fn checked(phase: Phase) -> Result<(), String> {
    check(&Scatterer {
        at: &|turn| phase.at(turn),
        sample: &|wo, choice, u| phase.sample(wo, choice, u).wi,
        mean_cosine: phase.mean_cosine(),
    })
}

#[test]
fn every_registered_phase_function_keeps_its_contract() {
    for row in PHASES {
        for (case, phase) in (row.cases)() {
            assert_eq!(checked(phase), Ok(()), "{} ({case})", row.entry.name);
            for i in 0..500 {
                let (choice, u) = uniforms(7, i);
                let wo = bilux_math::warp::sample_sphere(uniforms(8, i).1);
                let sample = phase.sample(wo, choice, u);
                assert_eq!(
                    sample.pdf_solid_angle,
                    phase.eval(wo, sample.wi),
                    "{case}: a weight other than 1"
                );
                assert_eq!(phase.eval(wo, sample.wi), phase.eval(sample.wi, wo), "{case}");
                assert!((sample.wi.length() - 1.0).abs() < 1e-5 && sample.pdf_solid_angle > 0.0, "{case}");
            }
        }
    }
}

/// The fit's own numbers, from four public copies of it. [Jendersie 2023]
#[test]
fn droplets_scatter_by_their_size() {
    for (diameter, mean) in [(5.0, 0.84342), (10.0, 0.86416), (20.0, 0.87931), (40.0, 0.88903)] {
        let found = Phase::Droplets(Droplets::new(diameter)).mean_cosine();
        assert!((found - mean).abs() < 2e-5, "{diameter} µm: {found}");
    }
}

#[test]
fn mistakes_in_phase_functions_are_noticed() {
    let phase = Phase::HenyeyGreenstein(HenyeyGreenstein { g: 0.4 });
    let right = |wo: Vec3, choice: f32, u: Vec2| phase.sample(wo, choice, u).wi;
    let turned = |wo: Vec3, choice: f32, u: Vec2| -phase.sample(wo, choice, u).wi;
    let at = |turn: f32| phase.at(turn);
    let bright = |turn: f32| 1.01 * phase.at(turn);
    let back = |turn: f32| phase.at(2.0 - turn);
    assert_eq!(check(&Scatterer { at: &at, sample: &right, mean_cosine: 0.4 }), Ok(()));
    assert!(check(&Scatterer { at: &at, sample: &turned, mean_cosine: 0.4 }).unwrap_err().contains("χ²"));
    assert!(
        check(&Scatterer { at: &bright, sample: &right, mean_cosine: 0.4 })
            .unwrap_err()
            .contains("integrates")
    );
    assert!(
        check(&Scatterer { at: &back, sample: &right, mean_cosine: 0.4 }).unwrap_err().contains("cosine")
    );
}

/// The part of walks that come beyond each of some distances, by sampling, against what the medium says of itself.
fn survives(medium: &Medium, sigma_t: Rgb, channel: usize) -> Result<(), String> {
    const WALKS: u64 = 200_000;
    let distances: Vec<f32> = (0..WALKS)
        .map(|i| {
            let (_, u) = uniforms(3, i);
            medium.sample_distance(channel, u.x)
        })
        .collect();
    for limit in [0.05, 0.3, 1.0, 3.0, 20.0] {
        let beyond = distances.iter().filter(|distance| **distance > limit).count() as f64 / WALKS as f64;
        let FreePath { survival, hazards: [_, hazard], transmittance, survivals } =
            medium.free_path(limit, channel);
        let wanted = f64::from(survival);
        let error = 5.0 * (wanted * (1.0 - wanted) / WALKS as f64).sqrt() + 1e-6;
        if (beyond - wanted).abs() > error {
            return Err(format!("{beyond} of walks come beyond {limit}, not {wanted}"));
        }
        // The density is the derivative of the survival.
        let step = 1e-3 * limit;
        let survival_at = |distance| medium.free_path(distance, channel).survival;
        let slope = f64::from(survival_at(limit - step) - survival_at(limit + step));
        assert_eq!(survivals[channel], survival);
        let density = f64::from(survival * hazard);
        if (slope / f64::from(2.0 * step) - density).abs() > 2e-3 * density + 1e-4 {
            return Err(format!("the density at {limit} is {density}"));
        }
        let beer = |sigma: f32| exp_f64(-f64::from(sigma) * f64::from(limit));
        for (found, sigma) in transmittance.to_array().into_iter().zip(sigma_t.to_array()) {
            if (f64::from(found) - beer(sigma)).abs() > 1e-5 {
                return Err(format!("the transmittance over {limit} is {found}"));
            }
        }
    }
    Ok(())
}

#[test]
fn distances_between_events_are_those_of_the_medium() {
    let (sigma_a, sigma_s) = (Rgb::new(0.1, 0.0, 2.0), Rgb::new(0.4, 0.0, 1.0));
    let medium = Medium { sigma_a, sigma_s, ..Medium::VACUUM };
    for channel in 0..3 {
        assert_eq!(survives(&medium, sigma_a + sigma_s, channel), Ok(()));
    }
    // Scattering in place of extinction.
    let wrong = Medium { sigma_a: Rgb::BLACK, ..medium };
    assert!(survives(&wrong, sigma_a + sigma_s, 2).is_err());
    // What only absorbs has no events.
    let FreePath { survival, hazards: [_, hazard], .. } = Medium::absorbing(sigma_a).free_path(1.0, 0);
    assert_eq!((survival, hazard), (1.0, 0.0));
}
