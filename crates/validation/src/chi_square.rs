//! Pearson's χ² test of a sampling routine against the density that it claims.

use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::transcendental::{acos, atan2, sin_cos};
use bilux_math::{Vec2, Vec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f32::consts::{PI, TAU};
use std::sync::LazyLock;

/// Cells of the sphere: bands of equal angle, since sharp lobes crowd around the poles too, times sectors.
const BANDS: usize = 24;
const SECTORS: usize = 24;
/// Directions along each side of a cell at which the density is summed: where it is smooth, and elsewhere. The error of
/// midpoints falls with the square of their distance: 8 along a side are good to a thousandth if the density varies by no more
/// than its mean, which adds 0.06 to the χ² of 60,000 samples in some hundreds of cells.
const COARSE: usize = 8;
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

/// The integral of the density over one cell, by midpoints, of which cells with edges and peaks get more.
fn integral(cell: usize, pdf: &impl Fn(Vec3) -> f32) -> f64 {
    static GRIDS: LazyLock<[Grid; 2]> =
        LazyLock::new(|| [COARSE, FINE].map(|side| Grid::new(&midpoints(side))));
    // Just within the sides of each cell, where an edge may lie that is beyond all coarse midpoints.
    static BORDERS: LazyLock<Grid> =
        LazyLock::new(|| Grid::new(&[midpoints(FINE)[0], midpoints(FINE)[FINE - 1]]));
    let [coarse, fine] = &*GRIDS;
    let inner = Sum::of(cell, coarse, coarse, pdf);
    let sides = [Sum::of(cell, coarse, &BORDERS, pdf), Sum::of(cell, &BORDERS, coarse, pdf)];
    let least = sides.iter().fold(inner.least, |least, side| least.min(side.least));
    let most = sides.iter().fold(inner.most, |most, side| most.max(side.most));
    let is_smooth = f64::from(most - least) <= inner.mean;
    if is_smooth { inner.integral } else { Sum::of(cell, fine, fine, pdf).integral }
}

/// Places of midpoints along the side of a cell.
fn midpoints(count: usize) -> Vec<f32> {
    (0..count).map(|i| (i as f32 + 0.5) / count as f32).collect()
}

/// Directions in all cells, as the coordinates of their bands and sectors.
struct Grid {
    /// Along each side of a cell.
    side: usize,
    /// Distance from the axis, and height.
    bands: Vec<(f32, f32)>,
    /// Sine and cosine of the turn about the axis.
    turns: Vec<(f32, f32)>,
}

impl Grid {
    /// From places along the side of each cell.
    fn new(places: &[f32]) -> Grid {
        let angles = |cells: usize, whole: f32| {
            let of_cell = |cell| places.iter().map(move |place| (cell as f32 + place) / cells as f32 * whole);
            (0..cells).flat_map(of_cell).map(sin_cos).collect()
        };
        Grid { side: places.len(), bands: angles(BANDS, PI), turns: angles(SECTORS, TAU) }
    }
}

/// Integral of the density over a cell, and its variation there.
struct Sum {
    integral: f64,
    mean: f64,
    least: f32,
    most: f32,
}

impl Sum {
    fn of(cell: usize, bands: &Grid, turns: &Grid, pdf: &impl Fn(Vec3) -> f32) -> Sum {
        let mut sum = Sum { integral: 0.0, mean: 0.0, least: f32::INFINITY, most: 0.0 };
        for (r, z) in &bands.bands[cell / SECTORS * bands.side..][..bands.side] {
            for (sin, cos) in &turns.turns[cell % SECTORS * turns.side..][..turns.side] {
                let density = pdf(Vec3::new(r * cos, r * sin, *z));
                (sum.least, sum.most) = (sum.least.min(density), sum.most.max(density));
                sum.integral += f64::from(density * r);
                sum.mean += f64::from(density);
            }
        }
        let points = (bands.side * turns.side) as f64;
        sum.integral *= 2.0 * f64::from(PI) * f64::from(PI) / (points * (BANDS * SECTORS) as f64);
        sum.mean /= points;
        sum
    }
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
