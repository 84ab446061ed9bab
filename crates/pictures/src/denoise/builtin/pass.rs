//! One à-trous pass over all pixels: each becomes a weighted mean of 5 × 5 pixels that are `step` pixels apart.

use super::guides::{ALBEDO, DEPTH, Guides, NORMAL, SLOPE, TIGHTNESS, WITHIN};
use super::lanes::{COLUMNS, LANES, Lanes, add_products, add_scaled, lanes_at, product};
use super::linear::Moments;
use super::planes::{Light, MARGIN, Planes};
use bilux_math::CpuLevel;
use bilux_math::cpu_level::{Stage, run_at};
use bilux_math::parallel::for_each_with;

/// Rows of a tile. What it reads and computes stays in a core's caches.
const ROWS: usize = 8;

/// Weights of neighbours by their distance in steps, along each axis.
const NEAR: [f32; 5] = [0.7, 0.9, 1.0, 0.9, 0.7];
/// Tolerance for differences in light, in standard deviations of the noise, and the factor by which it grows from one pass to the
/// next: later passes see errors that their neighbours share, and so underestimate them.
const LIGHT: f32 = 1.4;
const LIGHT_GROWTH: f32 = 1.1;
/// Tolerances for differences in albedo and in normals.
const ALBEDO_APART: f32 = 0.05;
const NORMAL_APART: f32 = 0.2;
/// Relative increase of the tolerance for squared differences in fog and all else that is hazy. Its light has no edges, but few
/// samples find it, so that most pixels are too dark and do not know it.
const HAZY: f32 = 7.0;
/// Squared relative difference below which light counts as the same where there is no noise at all.
const SAME: f32 = 1e-5;

/// A neighbour that differs by more than this many of the pixel's own variances does not belong to the patch around it. This
/// keeps bright light out of sharp shadows, whose pixels have little noise, and does not keep a firefly from being smoothed.
const BEYOND: f32 = 2.0;

/// Up to this step, passes fit a slope to the light too. Neighbours farther away differ by more than the noise where there is a slope.
const LAST_LINEAR: usize = 4;

/// Applies one pass to the light, and stores the result in `smooth`, which has the same size.
pub(super) fn pass(light: &Light, guides: &Guides, step: usize, level: CpuLevel, smooth: &mut Light) {
    let width = light.planes.width;
    let window = Window::new(light, guides, step);
    let mut bands = smooth.planes.rows_mut();
    for_each_with(bands.chunks_mut(ROWS).enumerate(), Tile::new, |tile, (band, rows)| {
        for first in (0..width).step_by(COLUMNS) {
            let columns = COLUMNS.min(width - first);
            tile.compare(&window, [first, band * ROWS], level);
            for (row, planes) in rows.iter_mut().enumerate() {
                tile.smooth(&window, [first, band * ROWS], row, level);
                for (to, from) in planes.iter_mut().zip(&tile.smooth) {
                    to[first..first + columns].copy_from_slice(&from[..columns]);
                }
            }
        }
    });
    smooth.planes.pad();
}

/// A neighbour in the window around each pixel.
#[derive(Clone, Copy)]
struct Neighbour {
    /// Place beside the pixel, in steps.
    steps: [f32; 2],
    /// Distance in the planes.
    offset: isize,
    /// Weight that it has whatever it shows.
    share: f32,
}

/// Number of pixels in the window, and the place of the pixel itself among them.
const COUNT: usize = NEAR.len() * NEAR.len();
const ITSELF: usize = COUNT / 2;

/// The window around each pixel, and what is read there.
struct Window<'a> {
    light: &'a Planes,
    guides: &'a Planes,
    haze: Option<&'a [f32]>,
    step: usize,
    neighbours: [Neighbour; COUNT],
}

impl<'a> Window<'a> {
    fn new(light: &'a Light, guides: &'a Guides, step: usize) -> Window<'a> {
        let stride = light.planes.stride() as isize;
        let neighbours = std::array::from_fn(|k| {
            let (i, j) = (k % NEAR.len(), k / NEAR.len());
            let [dx, dy] = [i, j].map(|k| k as isize - 2);
            let offset = (dy * stride + dx) * step as isize;
            Neighbour { steps: [dx as f32, dy as f32], offset, share: NEAR[j] * NEAR[i] }
        });
        let haze = guides.haze.as_ref().map(|haze| &*haze.planes[0]);
        Window { light: &light.planes, guides: &guides.planes, haze, step, neighbours }
    }

    /// The weights of the pixels themselves: the fraction that is not background; one that is nothing else keeps its light.
    fn weigh_themselves(&self, first: usize, weights: &mut [f32; COLUMNS]) {
        let within = &self.guides.planes[WITHIN][first..first + COLUMNS];
        weights.iter_mut().zip(within).for_each(|(to, &own)| *to = if own > 0.0 { own } else { 1.0 });
    }
}

/// Pixels in a plane from index `p` on, and a neighbour of each.
fn pair<'a>(plane: &'a [f32], p: usize, neighbour: &Neighbour) -> Pair<'a> {
    [&plane[p..], &plane[p.wrapping_add_signed(neighbour.offset)..]]
}

/// Differences between a row of pixels and a neighbour, minus the differences expected from noise alone, in units of the
/// tolerance. [Rousselle 2012, eq. 3]
struct Compare<'a> {
    rows: &'a Compared<'a>,
    apart: &'a mut Apart,
}

/// Input of [`Compare`].
struct Compared<'a> {
    /// R, G, B and variance.
    light: [Pair<'a>; 4],
    haze: Option<Pair<'a>>,
    tolerance: f32,
}

/// Pixels of a row, and the neighbours of each.
type Pair<'a> = [&'a [f32]; 2];

/// As many as a tile has columns, so that the compiler knows how many.
#[inline(always)]
fn whole(rows: Pair<'_>) -> Pair<'_> {
    rows.map(|row| &row[..COLUMNS])
}

/// Differences of the pixels of a row of a tile, and of one more on each side.
type Apart = [f32; COLUMNS + LANES];

impl Stage for Compare<'_> {
    #[inline(always)]
    fn run(self) {
        let Compare { rows, apart } = self;
        let [r, g, b, v] = rows.light.map(|pair| pair.map(|row| &row[..apart.len()]));
        let tolerance = rows.tolerance;
        for (x, to) in apart.iter_mut().enumerate() {
            let (dr, dg, db) = (r[0][x] - r[1][x], g[0][x] - g[1][x], b[0][x] - b[1][x]);
            let (vp, vq) = (v[0][x], v[1][x]);
            let squared = dr * dr + dg * dg + db * db;
            let sum = (r[0][x] + g[0][x] + b[0][x]) * (r[1][x] + g[1][x] + b[1][x]);
            let noise = 3.0 * (vp + if vp < vq { vp } else { vq });
            *to = (squared - noise) / (tolerance * (vp + vq) + SAME * sum.abs() + 1e-12);
        }
        if let Some([p, q]) = rows.haze {
            for (to, (p, q)) in apart.iter_mut().zip(p.iter().zip(q)) {
                *to /= 1.0 + HAZY * if p < q { *p } else { *q };
            }
        }
    }
}

/// Weights of a neighbour of the pixels of a row.
struct Weigh<'a> {
    rows: &'a Weighed<'a>,
    weights: &'a mut [f32; COLUMNS],
}

/// Input of [`Weigh`].
struct Weighed<'a> {
    /// Differences of the rows above, of these pixels, and below.
    apart: [&'a Apart; 3],
    variance: Pair<'a>,
    albedo: [Pair<'a>; 3],
    normal: [Pair<'a>; 3],
    depth: Pair<'a>,
    slope: [&'a [f32]; 2],
    tightness: &'a [f32],
    within: &'a [f32],
    /// Place of the neighbour, in pixels.
    beside: [f32; 2],
    by_depth: f32,
    share: f32,
}

impl Stage for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        let Weigh { rows, weights } = self;
        let [by_albedo, by_normal] = [ALBEDO_APART, NORMAL_APART].map(|apart| 1.0 / (apart * apart));
        let ([ar, ag, ab], [nx, ny, nz]) = (rows.albedo.map(whole), rows.normal.map(whole));
        let (z, v) = (whole(rows.depth), whole(rows.variance));
        let [across, down] = rows.slope.map(|row| &row[..COLUMNS]);
        let [tight, within] = [rows.tightness, rows.within].map(|row| &row[..COLUMNS]);
        let ([fx, fy], by_depth, share, patch) = (rows.beside, rows.by_depth, rows.share, rows.apart);
        for (x, weight) in weights.iter_mut().enumerate() {
            let mut light = 0.0;
            for row in patch {
                light += row[x] + row[x + 1] + row[x + 2];
            }
            let square = |[p, q]: [&[f32]; 2]| (p[x] - q[x]) * (p[x] - q[x]);
            let albedo = square(ar) + square(ag) + square(ab);
            let normal = square(nx) + square(ny) + square(nz);
            let beside = (z[1][x] - z[0][x] - across[x] * fx - down[x] * fy) * tight[x];
            let own = 0.5 * patch[1][x + 1] * (v[0][x] + v[1][x]) / (v[0][x] + 1e-12) - BEYOND;
            let apart = (if light > 0.0 { light } else { 0.0 }) * (1.0 / 9.0)
                + (if own > 0.0 { own } else { 0.0 }) * 0.5
                + albedo * by_albedo
                + normal * by_normal
                + beside * beside * by_depth;
            // Approximates e to the minus `apart`, and is zero from 4 on.
            let near = 1.0 - 0.25 * apart;
            let near = if near > 0.0 { near } else { 0.0 };
            *weight = share * within[x] * (near * near) * (near * near);
        }
    }
}

/// Means over the neighbours of the pixels of a row, or fits if the light is `sloped`: R, G, B and their variance.
struct Mean<'a> {
    rows: &'a Averaged<'a>,
    smooth: &'a mut [[f32; COLUMNS]; 4],
}

/// Input of [`Mean`].
struct Averaged<'a> {
    window: &'a Window<'a>,
    /// Index of the first pixel.
    first: usize,
    /// Weights by neighbour.
    weights: &'a [[f32; COLUMNS]; COUNT],
    sloped: bool,
}

impl Stage for Mean<'_> {
    #[inline(always)]
    fn run(self) {
        let Averaged { window, first, weights, sloped } = *self.rows;
        for x in (0..COLUMNS).step_by(LANES) {
            let mut sums = Sums::NONE;
            for (k, (neighbour, weights)) in window.neighbours.iter().zip(weights).enumerate() {
                let q = (first + x).wrapping_add_signed(neighbour.offset);
                let light = [0, 1, 2, 3].map(|plane| lanes_at(&window.light.planes[plane], q));
                let steps = (sloped && k != ITSELF).then_some(neighbour.steps);
                sums.add(&lanes_at(weights, x), &light, steps);
            }
            for (to, from) in self.smooth.iter_mut().zip(sums.means(sloped)) {
                to[x..x + LANES].copy_from_slice(&from);
            }
        }
    }
}

/// Sums over the neighbours of some pixels, each in a cache line of its own.
#[repr(align(64))]
struct Sums {
    /// Weight · light, for R, G and B, and weight² · variance.
    light: [Lanes; 4],
    weights: Lanes,
    moments: Moments,
}

impl Sums {
    const NONE: Sums = Sums { light: [[0.0; LANES]; 4], weights: [0.0; LANES], moments: Moments::NONE };

    /// Adds pixels, given their R, G, B and variance; those whose `steps` are given count for slopes too.
    #[inline(always)]
    fn add(&mut self, weights: &Lanes, light: &[Lanes; 4], steps: Option<[f32; 2]>) {
        let [r, g, b, v] = light;
        for (sum, light) in self.light.iter_mut().zip([r, g, b]) {
            add_products(sum, weights, light);
        }
        add_products(&mut self.light[3], &product(weights, weights), v);
        add_scaled(&mut self.weights, weights, 1.0);
        if let Some(steps) = steps {
            self.moments.add(steps, weights, [r, g, b]);
        }
    }

    /// Means, or fits if the light is `sloped`: R, G, B and their variance.
    #[inline(always)]
    fn means(&self, sloped: bool) -> [Lanes; 4] {
        let one_over = self.weights.map(|weights| 1.0 / weights);
        let [r, g, b, v] = &self.light;
        let mut means = [r, g, b].map(|sum| product(sum, &one_over));
        let mut variance = product(v, &product(&one_over, &one_over));
        if sloped {
            let (fits, factors) = self.moments.fits(&means, &one_over);
            (means, variance) = (fits, product(&variance, &factors));
        }
        let [r, g, b] = means;
        [r, g, b, variance]
    }
}

/// Some pixels while they are smoothed.
struct Tile {
    /// Differences by neighbour, of all rows and one more on each side.
    apart: Vec<[Apart; ROWS + 2]>,
    /// Weights by neighbour, of one row.
    weights: Box<[[f32; COLUMNS]; COUNT]>,
    /// R, G, B and variance of one row.
    smooth: [[f32; COLUMNS]; 4],
}

impl Tile {
    fn new() -> Tile {
        Tile {
            apart: vec![[[0.0; COLUMNS + LANES]; ROWS + 2]; COUNT],
            weights: Box::new([[0.0; COLUMNS]; COUNT]),
            smooth: [[0.0; COLUMNS]; 4],
        }
    }

    /// Compares all pixels of the tile that begins at this column and row with their neighbours.
    fn compare(&mut self, window: &Window, [column, row]: [usize; 2], level: CpuLevel) {
        let growth = (0..window.step.trailing_zeros()).fold(LIGHT, |growth, _| growth * LIGHT_GROWTH);
        let tolerance = 3.0 * growth * growth;
        let below = (window.light.height - row).min(ROWS) + 2;
        for (k, neighbour) in window.neighbours.iter().enumerate().filter(|(k, _)| *k != ITSELF) {
            for (i, apart) in self.apart[k].iter_mut().enumerate().take(below) {
                let p = (row + i + MARGIN - 1) * window.light.stride() + column + MARGIN - 1;
                let light = [0, 1, 2, 3].map(|k| pair(&window.light.planes[k], p, neighbour));
                let haze = window.haze.map(|haze| pair(haze, p, neighbour));
                run_at(level, Compare { rows: &Compared { light, haze, tolerance }, apart });
            }
        }
    }

    /// Smooths a row of it.
    fn smooth(&mut self, window: &Window, [column, first_row]: [usize; 2], row: usize, level: CpuLevel) {
        let first = window.light.index(column, first_row + row);
        for (k, (neighbour, weights)) in window.neighbours.iter().zip(&mut *self.weights).enumerate() {
            if k == ITSELF {
                window.weigh_themselves(first, weights);
                continue;
            }
            let guide = |plane: usize| pair(&window.guides.planes[plane], first, neighbour);
            let rows = Weighed {
                apart: [0, 1, 2].map(|i| &self.apart[k][row + i]),
                variance: pair(&window.light.planes[3], first, neighbour),
                albedo: [0, 1, 2].map(|c| guide(ALBEDO + c)),
                normal: [0, 1, 2].map(|c| guide(NORMAL + c)),
                depth: guide(DEPTH),
                slope: [guide(SLOPE)[0], guide(SLOPE + 1)[0]],
                tightness: guide(TIGHTNESS)[0],
                within: guide(WITHIN)[1],
                beside: neighbour.steps.map(|steps| steps * window.step as f32),
                by_depth: 1.0 / (window.step * window.step) as f32,
                share: neighbour.share,
            };
            run_at(level, Weigh { rows: &rows, weights });
        }
        let sloped = window.step <= LAST_LINEAR;
        let rows = Averaged { window, first, weights: &self.weights, sloped };
        run_at(level, Mean { rows: &rows, smooth: &mut self.smooth });
    }
}
