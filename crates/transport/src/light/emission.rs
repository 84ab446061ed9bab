//! Starts of light subpaths: at a light chosen by its power, along a ray as that light emits it. Most of these rays
//! may go where no camera sees anything of them. Once a guide has found out which of them matter, most light subpaths
//! begin like those and the rest as before, so that none is left out and none gets too large a weight.

use crate::light::choice::{pick, sums, weights};
use crate::techniques::NO_LIGHT;
use bilux_math::{Vec2, Vec3};
use bilux_scene::{EmissionSample, Scene};
use std::sync::Arc;

/// Sampling of the starts of light subpaths, and their density.
pub struct Emission {
    /// The probability of each light, by power.
    probabilities: Vec<f32>,
    /// Their cumulative sums.
    cdf: Vec<f32>,
    guide: Option<Arc<Guide>>,
    /// [`Start::cell`] is the index of the light.
    pub(crate) names_lights: bool,
}

/// Probabilities with which light subpaths are aimed at each cell of each light, in a grid on the unit square of
/// [`bilux_scene::LightTracing::aim`].
#[derive(Clone, Debug)]
pub struct Guide {
    /// Cells along each side of a light's square.
    side: usize,
    /// The probability of each cell, row by row and light by light.
    shares: Vec<f32>,
    cdf: Vec<f32>,
    /// The fraction of light subpaths that are not aimed.
    unaimed: f32,
}

/// The start of a light subpath.
#[derive(Clone, Copy)]
pub(crate) struct Start {
    pub(crate) light: usize,
    /// The ray; its `pdf_emission` is that of all choices together.
    pub(crate) ray: EmissionSample,
    /// The cell of the guide that the ray belongs to; 0 without a guide. Where light is sorted by lights, the index of
    /// the light instead.
    pub(crate) cell: u16,
}

/// Number that stands for a light where light is sorted by lights; all lights from index 65534 on are one, and none is
/// [`NO_LIGHT`].
pub(crate) fn light_number(light: usize) -> u16 {
    light.min(usize::from(NO_LIGHT) - 1) as u16
}

impl Start {
    /// The factor by which the first vertex of a light subpath, here, would sample its start more often than assumed so far.
    pub(crate) fn light_sampling_ratio(&self, scene: &Scene, from: Vec3) -> f32 {
        let light = &scene.lights()[self.light].light;
        // No surface samples what light sampling leaves out.
        if self.ray.pdf_direct > 0.0 { light.direct_pdf(&self.ray, from) / self.ray.pdf_direct } else { 1.0 }
    }
}

impl Emission {
    /// Starts by power, aimed if there is a guide.
    pub(crate) fn new(scene: &Scene, guide: Option<Arc<Guide>>) -> Emission {
        let bounds = scene.bounds();
        let probabilities = weights(scene.lights().iter().map(|l| l.light.power(&bounds)));
        Emission { cdf: sums(&probabilities), probabilities, guide, names_lights: false }
    }

    /// Samples a light, and a ray from it.
    pub(crate) fn sample(
        &self,
        scene: &Scene,
        time: f32,
        u_light: f32,
        (u_point, u_direction): (Vec2, Vec2),
    ) -> Option<Start> {
        let bounds = scene.bounds();
        let unaimed = self.guide.as_ref().map_or(1.0, |guide| guide.unaimed);
        let (light, ray) = match &self.guide {
            Some(guide) if u_light >= unaimed => {
                let cell = pick(&guide.cdf, (u_light - unaimed) / (1.0 - unaimed))?;
                let (light, corner) = guide.place(cell);
                let source = &scene.lights()[light].light;
                let (u_aim, u) =
                    if source.is_infinite() { (u_point, u_direction) } else { (u_direction, u_point) };
                (light, source.sample_le_aimed(&bounds, time, u, (corner + u_aim) / guide.side as f32)?)
            }
            _ => {
                let light = pick(&self.cdf, u_light / unaimed)?;
                if self.probabilities[light] == 0.0 {
                    return None;
                }
                (light, scene.lights()[light].light.sample_le(&bounds, time, u_point, u_direction)?)
            }
        };
        let cell = self.guide.as_ref().and_then(|guide| guide.cell(scene, light, ray.p, ray.direction));
        let pdf_emission = self.pdf_through(cell, scene, light, ray.pdf_direct, ray.direction, ray.cos());
        let ray = EmissionSample { pdf_emission, ..ray };
        let cell = if self.names_lights { light_number(light) } else { cell.unwrap_or(0) as u16 };
        (pdf_emission > 0.0).then_some(Start { light, ray, cell })
    }

    /// The probability that an unaimed light subpath begins at a light.
    #[cfg(test)]
    pub(crate) fn probability(&self, light: usize) -> f32 {
        self.probabilities[light]
    }

    /// The density with which a light subpath begins at a light, along a line through `p`; the other parameters are
    /// those of
    /// [`bilux_scene::LightTracing::emission_pdf`].
    pub(crate) fn pdf(
        &self,
        scene: &Scene,
        light: usize,
        p: Vec3,
        pdf_start: f32,
        direction: Vec3,
        cos: f32,
    ) -> f32 {
        let cell = self.guide.as_ref().and_then(|guide| guide.cell(scene, light, p, direction));
        self.pdf_through(cell, scene, light, pdf_start, direction, cos)
    }

    /// Density of [`Emission::pdf`] for a line through this cell of the guide.
    fn pdf_through(
        &self,
        cell: Option<usize>,
        scene: &Scene,
        light: usize,
        pdf_start: f32,
        direction: Vec3,
        cos: f32,
    ) -> f32 {
        let (bounds, source) = (scene.bounds(), &scene.lights()[light].light);
        let unaimed = source.emission_pdf(&bounds, pdf_start, direction, cos) * self.probabilities[light];
        let Some(guide) = &self.guide else { return unaimed };
        let share = cell.map_or(0.0, |cell| guide.shares[cell]);
        if share == 0.0 {
            return unaimed * guide.unaimed;
        }
        let in_cell = source.aim_pdf(&bounds) * (guide.side * guide.side) as f32;
        let aimed = share * in_cell * source.unaimed_pdf(&bounds, pdf_start, direction, cos);
        unaimed * guide.unaimed + aimed * (1.0 - guide.unaimed)
    }
}

/// Maximum number of cells of all lights; where there are so many lights that each would have none, there is no guide.
const MAX_CELLS: usize = 1 << 14;
const MAX_SIDE: usize = 32;

/// The fraction of light subpaths that begin as if there were no guide: it has learned from only a few.
const UNAIMED: f32 = 0.25;

impl Guide {
    /// A guide that distinguishes cells but aims at none of them.
    pub(crate) fn untrained(scene: &Scene) -> Option<Guide> {
        let lights = scene.lights().len();
        let side = ((MAX_CELLS / lights.max(1)) as f64).sqrt() as usize;
        let side = side.min(MAX_SIDE);
        (side > 0 && lights > 0).then(|| Guide {
            side,
            shares: vec![0.0; lights * side * side],
            cdf: Vec::new(),
            unaimed: 1.0,
        })
    }

    /// Probability that a light subpath begins in a cell, given the probability that an unaimed one does.
    pub(crate) fn probability(&self, cell: usize, unaimed: f64) -> f64 {
        f64::from(self.unaimed) * unaimed + f64::from(1.0 - self.unaimed) * f64::from(self.shares[cell])
    }

    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        self.shares.len()
    }

    /// A guide that aims at cells in proportion to the worth of each, and a little around them; `None` where nothing is
    /// worth anything.
    pub(crate) fn trained(self, worth: &[f64]) -> Option<Guide> {
        let worth = self.blurred(worth);
        let all: f64 = worth.iter().sum();
        let shares: Vec<f32> = worth.iter().map(|cell| (cell / all) as f32).collect();
        (all > 0.0 && all.is_finite()).then(|| Guide { cdf: sums(&shares), shares, unaimed: UNAIMED, ..self })
    }

    /// Blurs the grid of each light: half of the weight stays in the cell along either axis.
    fn blurred(&self, worth: &[f64]) -> Vec<f64> {
        let side = self.side as i64;
        let blur = |light: &[f64], x: i64, y: i64| -> f64 {
            let weight = |d: i64| if d == 0 { 0.5 } else { 0.25 };
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
            let within =
                |(dx, dy): &(i64, i64)| (0..side).contains(&(x + dx)) && (0..side).contains(&(y + dy));
            around
                .filter(within)
                .map(|(dx, dy)| weight(dx) * weight(dy) * light[((y + dy) * side + x + dx) as usize])
                .sum()
        };
        worth
            .chunks_exact(self.side * self.side)
            .flat_map(|light| (0..side * side).map(move |i| blur(light, i % side, i / side)))
            .collect()
    }

    /// The light of a cell, and the cell's lower corner in units of cells.
    fn place(&self, cell: usize) -> (usize, Vec2) {
        let (light, cell) = (cell / (self.side * self.side), cell % (self.side * self.side));
        (light, Vec2::new((cell % self.side) as f32, (cell / self.side) as f32))
    }

    /// The cell of a light ray; `None` where it passes through none.
    fn cell(&self, scene: &Scene, light: usize, p: Vec3, direction: Vec3) -> Option<usize> {
        let aim = scene.lights()[light].light.aim(&scene.bounds(), p, direction);
        let is_within = |x: f32| (0.0..=1.0).contains(&x);
        let of = |x: f32| ((x * self.side as f32) as usize).min(self.side - 1);
        (is_within(aim.x) && is_within(aim.y))
            .then(|| (light * self.side + of(aim.y)) * self.side + of(aim.x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::techniques::Contribution;
    use bilux_math::Rgb;

    #[test]
    fn no_number_of_a_light_is_that_of_none() {
        let none = Contribution::<1>::only(Rgb::BLACK);
        assert_eq!((none.origin, none.light_index()), (NO_LIGHT, None));
        for (light, index) in
            [(0, 0), (7, 7), (65_533, 65_533), (65_534, 65_534), (65_535, 65_534), (90_000, 65_534)]
        {
            let found = Contribution { origin: light_number(light), ..none };
            assert_eq!(found.light_index(), Some(index), "{light}");
        }
    }
}
