//! The triangles of one face.

use super::corner::{Corner, bounds};
use super::fill::{Filled, fill};
use super::globe::Globe;
use super::inner::inner;
use super::outline::outline;
use super::steps::steps;
use crate::curves::Accuracy;
use crate::surfaces::Surface;
use bilux_math::{DVec2, DVec3};

/// Triangles with normals.
#[derive(Debug, Default)]
pub(crate) struct Patch {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Memory that the surface took, in bytes, which is charged too: many faces may share a large one.
    pub(crate) surface_bytes: usize,
}

/// A face: a surface, the lines around it, and whether its normal is that of the surface.
pub(super) struct Trimmed<'a> {
    pub(super) surface: &'a dyn Surface,
    pub(super) lines: Vec<Vec<DVec3>>,
    pub(super) is_same: bool,
    /// The size of the model.
    pub(super) size: f64,
}

impl Trimmed<'_> {
    /// Triangles of the face; `None` if its boundary encloses nothing.
    pub(super) fn patch(mut self, accuracy: Accuracy) -> Option<Patch> {
        let globe = self.surface.sphere().filter(|_| !self.lines.is_empty());
        // A swept circle may have its front inside of the sphere.
        if let Some((centre, _)) = globe {
            let p = *self.lines.iter().flatten().next()?;
            let uv = self.surface.parameters(p, None);
            let middle = uv + DVec2::new(0.0, 1e-3);
            self.is_same ^= self.surface.normal(middle).dot(self.surface.point(middle) - centre) < 0.0;
        }
        // From now on, the face is on the left of its lines where the surface is seen from its own front.
        if !self.is_same {
            self.lines.iter_mut().for_each(|line| line.reverse());
        }
        let (filled, normals) = match globe {
            Some((centre, radius)) => {
                let filled = Globe { centre, radius, lines: &self.lines }.filled(accuracy)?;
                let normals = filled.corners.iter().map(|corner| (corner.point - centre).normalize_or_zero());
                let normals = normals.collect();
                (filled, normals)
            }
            None => self.filled(accuracy)?,
        };
        self.finished(filled, normals)
    }

    fn filled(&self, accuracy: Accuracy) -> Option<(Filled, Vec<DVec3>)> {
        let loops = outline(self.surface, &self.lines, self.size)?;
        let within = bounds(&loops);
        let step = steps(self.surface, within, accuracy);
        let point = |at: DVec2| self.surface.point(at);
        let places = if self.surface.is_plane() { Vec::new() } else { inner(&loops, step) };
        let corners = places.into_iter().map(|at| Corner { at, point: point(at) }).collect();
        let filled = fill(&loops, corners, step, point)?;
        let middle = within[0].midpoint(within[1]);
        let normal = |corner: &Corner| {
            let found = self.surface.normal(corner.at);
            // Next to a pole there is a normal, if there is none at it.
            let inwards = corner.at + (middle - corner.at) * 1e-4;
            if found == DVec3::ZERO { self.surface.normal(inwards) } else { found }
        };
        let normals = filled.corners.iter().map(normal).collect();
        Some((filled, normals))
    }

    /// Leaves out triangles without area, and turns them all if the face's normal is not that of the surface.
    fn finished(&self, filled: Filled, mut normals: Vec<DVec3>) -> Option<Patch> {
        let positions: Vec<DVec3> = filled.corners.iter().map(|corner| corner.point).collect();
        let mut triangles = filled.triangles;
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|i| positions[i as usize]);
            a != b && b != c && c != a
        });
        if !self.is_same {
            triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
            normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        let is_sound = positions.iter().all(|p| p.is_finite()) && !triangles.is_empty();
        is_sound.then_some(Patch { positions, normals, triangles, surface_bytes: 0 })
    }
}
