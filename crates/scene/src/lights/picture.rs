//! Emission that varies across a surface.

use super::pieces::{Piece, Pieces};
use crate::mesh::Mesh;
use crate::texture::{ColourMap, NumberMap, UvPair};
use bilux_math::Rgb;
use std::sync::Arc;

/// The emission of a light across its surface.
pub struct Picture {
    /// Emission by texture coordinates.
    pub map: ColourMap,
    /// The opacity mask, if any. Light sampling scales the emission by it; a ray that hits the light has already passed
    /// the opacity test.
    pub opacity: Option<NumberMap>,
    /// The texture coordinates of each triangle's corners.
    pub uvs: Vec<[UvPair; 3]>,
    /// The mesh, whose vertices may have factors on emission and opacity.
    pub mesh: Arc<Mesh>,
    /// Into how many pieces its triangles may be cut.
    pub max_pieces: usize,
}

impl Picture {
    pub(super) fn at(&self, triangle: usize, weights: [f32; 3]) -> Rgb {
        let uv = UvPair::between(self.uvs[triangle], weights);
        let opacity = self.opacity.as_ref().map_or(1.0, |opacity| opacity.at(uv));
        let corners = self.mesh.triangles[triangle];
        self.map.at(uv)
            * self.mesh.emission_factor(corners, weights)
            * self.mesh.opacity(opacity, corners, weights)
    }

    /// The mean over a piece of a triangle, from the centres of its sixteen pieces.
    fn mean(&self, triangle: usize, piece: Piece) -> Rgb {
        let sixteenths = Pieces::up_to(16, 1);
        let centre = |i| piece.weights(sixteenths.piece(i).weights([1.0 / 3.0; 3]));
        (0..16).map(|i| self.at(triangle, centre(i))).sum::<Rgb>() / 16.0
    }
}

/// The minimum brightness of a piece, relative to the mean: a few points may miss its bright parts.
const MIN_SHARE: f64 = 0.1;

/// The pieces of one picture are no more than these: each takes a few bytes and microseconds.
const MAX_PIECES: usize = 1024;

/// Triangles are cut where the brightness within them has a standard deviation of more than this, relative to the mean.
const UNEVEN: f64 = 0.25;

/// Pieces of the triangles of these areas, the mean radiance over all of them, and the unnormalised probability of each piece, whose
/// mean is about the piece's area.
pub(super) fn pieces_by_brightness(picture: &Picture, areas: &[f64]) -> (Pieces, Rgb, Vec<f64>) {
    let mut pieces = Pieces::up_to(picture.max_pieces.min(MAX_PIECES), areas.len());
    let mean_of = |i| picture.mean(pieces.triangle(i), pieces.piece(i));
    let mut means: Vec<Rgb> = (0..areas.len() * pieces.of_each()).map(mean_of).collect();
    let of_triangle = |means: &[Rgb]| means.iter().copied().sum::<Rgb>() / means.len() as f32;
    let wholes: Vec<Rgb> = means.chunks(pieces.of_each()).map(of_triangle).collect();
    let total: f64 = areas.iter().sum();
    let mean: Rgb = wholes.iter().zip(areas).map(|(mean, area)| *mean * (area / total) as f32).sum();
    let brightness = f64::from(mean.luminance());
    let square = |x: f64| x * x;
    let relative = |mean: &Rgb| f64::from(mean.luminance()) / brightness;
    let spread = |((means, whole), area): ((&[Rgb], &Rgb), &f64)| {
        let squares: f64 = means.iter().map(|mean| square(relative(mean) - relative(whole))).sum();
        squares / means.len() as f64 * area / total
    };
    let spreads = means.chunks(pieces.of_each()).zip(&wholes).zip(areas).map(spread);
    let is_uneven = spreads.sum::<f64>() > square(UNEVEN);
    if !is_uneven {
        (pieces, means) = (Pieces::WHOLE, wholes);
    }
    let count = pieces.of_each();
    let weight = |(i, mean)| areas[i / count] / count as f64 * (relative(mean) + MIN_SHARE);
    let weights: Vec<f64> = means.iter().enumerate().map(weight).collect();
    let is_usable = weights.iter().all(|weight| weight.is_finite());
    if is_usable { (pieces, mean, weights) } else { (Pieces::WHOLE, mean, areas.to_vec()) }
}
