//! Emission that varies across a surface.

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

    /// The mean over a triangle, from the centres of its sixteen sub-triangles.
    fn mean(&self, triangle: usize) -> Rgb {
        let mut sum = Rgb::BLACK;
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            // Every second sub-triangle is upside down.
            let (i, j, third) = if i + j < 4 { (i, j, 1.0 / 3.0) } else { (7 - i - j, j, 2.0 / 3.0) };
            let (u, v) = ((i as f32 + third) / 4.0, (j as f32 + third) / 4.0);
            sum += self.at(triangle, [1.0 - u - v, u, v]);
        }
        sum / 16.0
    }
}

/// The minimum brightness of a triangle, relative to the mean: a few points may miss the bright parts of a triangle.
const MIN_SHARE: f64 = 0.1;

/// The mean radiance over all triangles, and the unnormalised probability of each.
pub(super) fn weights_by_brightness(picture: &Picture, areas: &[f64]) -> (Rgb, Vec<f64>) {
    let total: f64 = areas.iter().sum();
    let means: Vec<Rgb> = (0..areas.len()).map(|i| picture.mean(i)).collect();
    let mean: Rgb = means.iter().zip(areas).map(|(mean, area)| *mean * (area / total) as f32).sum();
    let least = MIN_SHARE * f64::from(mean.luminance());
    let weight = |(mean, area): (&Rgb, &f64)| area * (f64::from(mean.luminance()) + least);
    let weights = if least > 0.0 { means.iter().zip(areas).map(weight).collect() } else { areas.to_vec() };
    (mean, weights)
}
