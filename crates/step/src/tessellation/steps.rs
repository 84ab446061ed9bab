//! Distances between the points of a surface.

use crate::curves::Accuracy;
use crate::surfaces::Surface;
use bilux_math::transcendental::acos_f64;
use bilux_math::{DVec2, DVec3};

/// Intervals along each parameter that are looked at.
const SAMPLES: usize = 12;

/// The most pieces along a parameter, and of both together.
const MOST: f64 = 128.0;
const TOGETHER: f64 = 4096.0;

/// The largest steps of both parameters within a rectangle for which chords are accurate.
pub(super) fn steps(surface: &dyn Surface, [low, high]: [DVec2; 2], accuracy: Accuracy) -> DVec2 {
    let size = high - low;
    if surface.is_plane() {
        return DVec2::splat(size.max_element().max(f64::MIN_POSITIVE));
    }
    let interval = size / SAMPLES as f64;
    let at = |i: usize, j: usize| low + interval * DVec2::new(i as f64, j as f64);
    let grid: Vec<(DVec3, DVec3)> = (0..=SAMPLES)
        .flat_map(|i| (0..=SAMPLES).map(move |j| at(i, j)))
        .map(|uv| (surface.point(uv), surface.normal(uv)))
        .collect();
    let sample = |i: usize, j: usize| grid[i * (SAMPLES + 1) + j];
    let mut pieces = DVec2::ONE;
    for axis in 0..2 {
        for i in 0..=SAMPLES {
            let line: Vec<(DVec3, DVec3)> =
                (0..=SAMPLES).map(|j| if axis == 0 { sample(j, i) } else { sample(i, j) }).collect();
            pieces[axis] = pieces[axis].max(along(&line, accuracy));
        }
    }
    // Rounding must not make another piece of what is flat.
    let pieces =
        DVec2::new((pieces.x - 0.01).ceil(), (pieces.y - 0.01).ceil()).clamp(DVec2::ONE, DVec2::splat(MOST));
    let coarser = (TOGETHER / (pieces.x * pieces.y)).sqrt().min(1.0);
    let pieces = (pieces * coarser).max(DVec2::ONE);
    (size / pieces).max(DVec2::splat(f64::MIN_POSITIVE))
}

/// The pieces that a line of points with normals needs.
fn along(line: &[(DVec3, DVec3)], accuracy: Accuracy) -> f64 {
    let intervals = SAMPLES as f64;
    let angle = |a: DVec3, b: DVec3| {
        if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { acos_f64(a.dot(b).clamp(-1.0, 1.0)) }
    };
    let turns = line.windows(2).map(|pair| angle(pair[0].1, pair[1].1));
    let (sum, most) = turns.fold((0.0, 0.0_f64), |(sum, most), turn| (sum + turn, most.max(turn)));
    // A bend in one place needs no more pieces everywhere than four times those of the same bend spread evenly.
    let bent = (intervals * most).min(4.0 * sum) / accuracy.angle;
    // The chord over two intervals misses the middle by half of this.
    let missed =
        line.windows(3).map(|three| 0.5 * (three[0].0 - three[1].0 * 2.0 + three[2].0).dot(three[1].1).abs());
    let farthest = missed.fold(0.0, f64::max);
    let far = 0.5 * intervals * (farthest / accuracy.distance).sqrt();
    [bent, far].into_iter().filter(|count| count.is_finite()).fold(1.0, f64::max)
}
