//! Paths that leave the scene: infinite lights are looked up for many of them at a time.

use super::lanes::LANES;
use super::paths::Paths;
use crate::path_tracing::PathTracing;
use crate::sampling::task::Context;
use bilux_math::{Rgb, Vec3};

/// The rays of some of them, and what they find.
#[derive(Default)]
pub(super) struct Escapes {
    rays: Vec<(Option<Vec3>, Vec3)>,
    found: Vec<(Rgb, f32)>,
    sums: Vec<Rgb>,
}

impl Paths {
    /// Ends the paths that have escaped, as [`PathTracing::escape`] does.
    pub(super) fn end_escaped(&mut self, e: &mut Escapes, tracing: &PathTracing, context: &Context) {
        let escaped = std::mem::take(&mut self.escaped);
        for chunk in escaped.chunks(LANES) {
            e.rays.clear();
            e.rays.extend(chunk.iter().map(|&index| {
                let path = &self.paths[index as usize].path;
                (path.last.map(|last| last.p), Vec3::from(path.walk.ray.direction))
            }));
            e.sums.clear();
            e.sums.resize(chunk.len(), Rgb::BLACK);
            for light in context.scene.infinite_lights() {
                light.1.le_and_pdf_each(&e.rays, &mut e.found);
                for ((&index, sum), &found) in chunk.iter().zip(&mut e.sums).zip(&e.found) {
                    *sum += tracing.seen_of(context, &self.paths[index as usize].path, light, found);
                }
            }
            for (&index, &sum) in chunk.iter().zip(&e.sums) {
                let one = &mut self.paths[index as usize];
                one.path.light += one.path.walk.seen(&one.state) * sum;
            }
        }
        self.escaped = escaped;
    }
}
