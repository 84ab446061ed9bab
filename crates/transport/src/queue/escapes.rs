//! Paths that leave the scene: infinite lights are looked up for many of them at a time.

use super::lanes::LANES;
use super::paths::Paths;
use crate::integrators::path::Path;
use crate::task::Task;
use bilux_math::{Rgb, Vec3};

/// The rays of some of them, and what they find.
#[derive(Default)]
pub(super) struct Escapes {
    rays: Vec<(Option<Vec3>, Vec3)>,
    found: Vec<(Rgb, f32)>,
    sums: Vec<Rgb>,
}

impl Paths {
    /// Ends the paths that have escaped, as [`Path::escape`] does.
    pub(super) fn end_escaped(&mut self, e: &mut Escapes, path: &Path, task: &mut Task) {
        let escaped = std::mem::take(&mut self.escaped);
        for chunk in escaped.chunks(LANES) {
            e.rays.clear();
            e.rays.extend(chunk.iter().map(|&index| {
                let walk = &self.paths[index as usize].walk;
                (walk.last.map(|(from, _)| from), Vec3::from(walk.ray.direction))
            }));
            e.sums.clear();
            e.sums.resize(chunk.len(), Rgb::BLACK);
            for light in task.scene().infinite_lights() {
                light.1.le_and_pdf_each(&e.rays, &mut e.found);
                for ((&index, sum), &found) in chunk.iter().zip(&mut e.sums).zip(&e.found) {
                    *sum += path.seen_of(task, &self.paths[index as usize].walk, light, found);
                }
            }
            for (&index, &sum) in chunk.iter().zip(&e.sums) {
                let one = &mut self.paths[index as usize];
                task.wavelength = one.wavelength;
                one.walk.light += task.seen(one.walk.beta, one.walk.is_split) * sum;
            }
        }
        self.escaped = escaped;
    }
}
