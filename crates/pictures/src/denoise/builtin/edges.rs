//! Reconstructs pixels on edges of geometry and textures. No neighbour of such a pixel shows the same mixture of
//! surfaces, so averaging leaves it as noisy as before, and edges look jagged. But its albedo, normal and depth have
//! far less noise than its light, and light is nearly linear in these features within a few pixels. A first-order fit
//! to the denoised pixels around it predicts the light of the mixture ([`fits`](super::fits)).
//!
//! Two rounds: where edges are dense, most pixels of a fit are on edges too, and in the second they have less noise.

use super::fits::{Fits, RADIUS};
use super::guides::{ALBEDO, Guides, INVERSE, NORMAL};
use super::lanes::{LANES, Lanes};
use super::planes::{MARGIN, Planes};
use crate::PictureError;
use crate::limits::reserved;
use bilux_math::CpuLevel;
use bilux_math::cpu_level::{Stage, run_at};
use bilux_math::parallel::for_each;

/// Number of times that edges are reconstructed.
const ROUNDS: usize = 2;

/// Groups of pixels that one thread rebuilds at a time.
const GROUPS: usize = 16;
/// The distance over which one pixel affects another.
pub(super) const REACH: usize = ROUNDS * RADIUS;

/// Squared difference from which on neighbours show different surfaces.
const APART: f32 = 0.01;
/// Weight of squared differences of normals, and of inverse depths, relative to those of albedo.
const OF_NORMALS: f32 = 0.25;
const OF_DEPTHS: f32 = 9.0;

/// Reconstructs the edge pixels of a picture of three planes, with the variance of each pixel in a fourth.
///
/// # Errors
/// Returns an error when the machine has no memory left.
pub(super) fn rebuild(colours: &mut Planes, guides: &Guides, level: CpuLevel) -> Result<(), PictureError> {
    let is_edge = edges(guides);
    let mut pixels = reserved("denoising", is_edge.iter().filter(|is_edge| **is_edge).count())?;
    pixels.extend((0..is_edge.len()).filter(|&i| is_edge[i]));
    for _ in 0..ROUNDS {
        colours.pad();
        let mut rebuilt = vec![[[0.0; LANES]; 4]; pixels.len().div_ceil(LANES)];
        let around = Around { colours, guides };
        let groups = rebuilt.chunks_mut(GROUPS).zip(pixels.chunks(GROUPS * LANES));
        for_each(groups, |(rebuilt, pixels)| run_at(level, Rebuild { around: &around, pixels, rebuilt }));
        for (pixels, rebuilt) in pixels.chunks(LANES).zip(rebuilt) {
            for (plane, lanes) in colours.planes.iter_mut().zip(rebuilt) {
                pixels.iter().zip(lanes).for_each(|(&i, light)| plane[i] = light);
            }
        }
    }
    Ok(())
}

/// Input of fits.
struct Around<'a> {
    colours: &'a Planes,
    guides: &'a Guides,
}

/// Fits around pixels, in groups of [`LANES`], with the instructions of a level.
struct Rebuild<'a> {
    around: &'a Around<'a>,
    pixels: &'a [usize],
    rebuilt: &'a mut [[Lanes; 4]],
}

impl Stage for Rebuild<'_> {
    #[inline(always)]
    fn run(self) {
        let Around { colours, guides } = self.around;
        for (pixels, rebuilt) in self.pixels.chunks(LANES).zip(self.rebuilt) {
            // What is missing at the end is the first pixel once more.
            let lanes = std::array::from_fn(|lane| *pixels.get(lane).unwrap_or(&pixels[0]));
            *rebuilt = Fits::around(colours, guides, lanes).blended(colours, lanes);
        }
    }
}

/// Marks the pixels that have a neighbour with another surface; the result includes the margin around the picture,
/// where no pixel is marked.
fn edges(guides: &Guides) -> Vec<bool> {
    let planes = &guides.planes;
    let (stride, width) = (planes.stride(), planes.width);
    let mut edges = vec![false; planes.planes[ALBEDO].len()];
    let (first, last) = (planes.index(0, 0) - MARGIN, planes.index(0, planes.height) - MARGIN);
    for_each(edges[first..last].chunks_mut(stride).enumerate(), |(y, row)| {
        let p = planes.index(0, y);
        for offset in [1, stride - 1, stride, stride + 1] {
            for q in [p - offset, p + offset] {
                apart(guides, p, q, &mut row[MARGIN..MARGIN + width]);
            }
        }
    });
    edges
}

/// In a row of pixels that starts at `p`, marks those whose surface differs from that of the pixels starting at `q`.
fn apart(guides: &Guides, p: usize, q: usize, row: &mut [bool]) {
    let pair = |plane: usize| {
        let plane = &guides.planes.planes[plane];
        (&plane[p..p + row.len()], &plane[q..q + row.len()])
    };
    let [ar, ag, ab] = [0, 1, 2].map(|c| pair(ALBEDO + c));
    let [nx, ny, nz] = [0, 1, 2].map(|c| pair(NORMAL + c));
    let z = pair(INVERSE);
    for (x, is_edge) in row.iter_mut().enumerate() {
        let square = |(p, q): (&[f32], &[f32])| (p[x] - q[x]) * (p[x] - q[x]);
        let albedo = square(ar) + square(ag) + square(ab);
        let normal = square(nx) + square(ny) + square(nz);
        let greater = if z.0[x] > z.1[x] { z.0[x] } else { z.1[x] };
        // The relative difference of depth, without a division.
        let differs =
            albedo + OF_NORMALS * normal > APART || OF_DEPTHS * square(z) > APART * greater * greater;
        *is_edge |= differs;
    }
}
