//! Pearson's χ² test of a sampling routine against the density that it claims.

use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::transcendental::{acos, atan2, sin_cos};
use bilux_math::{Vec2, Vec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f32::consts::{PI, TAU};

/// Cells of the sphere: bands of equal angle, since sharp lobes crowd around the poles too, times sectors.
const BANDS: usize = 24;
const SECTORS: usize = 24;
/// Directions along each side of a cell at which the density is summed.
const FINE: usize = 24;
/// Cells are pooled until this many samples are expected in each. [Cochran 1954]
const MIN_EXPECTED: f64 = 5.0;

/// The `i`-th uniform number and uniform point of a stream.
pub fn uniforms(stream: u64, i: u64) -> (f32, Vec2) {
    let a = hash_words([stream, i, 0]);
    let b = hash_words([stream, i, 1]);
    (unit_f32(a as u32), Vec2::new(unit_f32((a >> 32) as u32), unit_f32(b as u32)))
}

/// The probability of a deviation at least as large as the observed one, if `sample` samples from `pdf` (over solid
/// angle). Samples that return `None` are compared with what the density lacks to 1.
pub fn p_value(
    samples: u64,
    stream: u64,
    sample: impl Fn(f32, Vec2) -> Option<Vec3>,
    pdf: impl Fn(Vec3) -> f32,
) -> f64 {
    let mut seen = vec![0u64; BANDS * SECTORS];
    let mut lost = 0u64;
    for i in 0..samples {
        let (choice, u) = uniforms(stream, i);
        match sample(choice, u) {
            Some(direction) => seen[cell_of(direction)] += 1,
            None => lost += 1,
        }
    }
    let mut expected: Vec<f64> = (0..BANDS * SECTORS).map(|c| integral(c, &pdf) * samples as f64).collect();
    let total: f64 = expected.iter().sum();
    expected.push((samples as f64 - total).max(0.0));
    seen.push(lost);
    compare(&seen, &expected)
}

fn cell_of(d: Vec3) -> usize {
    let band = (acos(d.z.clamp(-1.0, 1.0)) / PI * BANDS as f32) as usize;
    let turn = atan2(d.y, d.x) / TAU;
    let sector = ((if turn < 0.0 { turn + 1.0 } else { turn }) * SECTORS as f32) as usize;
    band.min(BANDS - 1) * SECTORS + sector.min(SECTORS - 1)
}

/// The integral of the density over one cell, by the midpoints of a fine grid.
fn integral(cell: usize, pdf: &impl Fn(Vec3) -> f32) -> f64 {
    let (band, sector) = (cell / SECTORS, cell % SECTORS);
    let mut sum = 0.0;
    for i in 0..FINE {
        let (r, z) = sin_cos((band as f32 + (i as f32 + 0.5) / FINE as f32) / BANDS as f32 * PI);
        for j in 0..FINE {
            let turn = (sector as f32 + (j as f32 + 0.5) / FINE as f32) / SECTORS as f32;
            let (sin, cos) = sin_cos(turn * TAU);
            sum += f64::from(pdf(Vec3::new(r * cos, r * sin, z)) * r);
        }
    }
    sum * 2.0 * f64::from(PI) * f64::from(PI) / (BANDS * SECTORS * FINE * FINE) as f64
}

fn compare(seen: &[u64], expected: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));
    let (mut statistic, mut pools) = (0.0, 0u32);
    let (mut pooled_seen, mut pooled_expected) = (0.0, 0.0);
    for i in order {
        pooled_seen += seen[i] as f64;
        pooled_expected += expected[i];
        if pooled_expected >= MIN_EXPECTED {
            let difference = pooled_seen - pooled_expected;
            statistic += difference * difference / pooled_expected;
            pools += 1;
            (pooled_seen, pooled_expected) = (0.0, 0.0);
        }
    }
    // Samples where next to nothing is expected cannot be pooled away.
    if pooled_seen > MIN_EXPECTED * 4.0 {
        return 0.0;
    }
    match ChiSquared::new(f64::from(pools.saturating_sub(1).max(1))) {
        Ok(distribution) => 1.0 - distribution.cdf(statistic),
        Err(_) => 0.0,
    }
}
