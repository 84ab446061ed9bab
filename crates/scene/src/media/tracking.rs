//! Walks through media: where the next event is, and how much light passes.
//!
//! In a grid the density is not integrated: a walk meets events as often as the majorant says, and most of them are null
//! collisions, which change nothing. No step size, and no bias. [Woodcock 1965; Novák 2014]
//!
//! The path that a walk has found includes its null collisions, and so does what is compared in weights. Each of them is met with
//! the same density from both ends of a line, and by a connection along it. So all that weights need is the product of the
//! probabilities that the collisions met were null: R, which is also the estimate of the transmittance. [Miller 2019]

use super::medium::{FreePath, Medium, MediumLine, beer, mean, thickness};
use crate::grid::{Grid, GridLine};
use bilux_math::Rgb;
use bilux_math::hash::{mix64, unit_f32};

/// Result of a walk along a part of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Free path from the beginning of the walk to its end.
    pub path: FreePath,
    /// Event that ended the walk; `None` where it came to the end of the part.
    pub event: Option<MediumEvent>,
    /// The light that the medium emits back along it, over the density with which walks come to where it is emitted.
    pub emitted: Rgb,
}

/// The channel whose distances a walk has.
#[derive(Clone, Copy, Debug)]
pub struct WalkChannel {
    /// Index of the channel.
    pub index: usize,
    /// Probability that a walk in each channel has come this far, over the mean.
    pub odds: Rgb,
}

/// An event of a medium.
#[derive(Clone, Copy, Debug)]
pub struct MediumEvent {
    /// Distance on the line, in metres.
    pub distance: f32,
    /// The scattering coefficient there, per metre.
    pub sigma_s: Rgb,
    /// The extinction coefficient there, likewise.
    pub sigma_t: Rgb,
}

/// Transmittance below which an estimate goes on with a probability of 1 over `ONE_OF`.
const LITTLE: f32 = 0.05;
const ONE_OF: f32 = 4.0;

/// Random numbers for collisions that only pass: as many as there are, of a quality that suffices there.
#[derive(Clone, Debug)]
pub struct Draws(u64);

impl Draws {
    /// Random numbers of a seed.
    #[inline]
    pub fn new(seed: u64) -> Draws {
        Draws(seed)
    }

    /// The next one in `[0, 1)`.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        unit_f32((mix64(self.0) >> 32) as u32)
    }
}

impl Medium<'_> {
    /// Follows a walk along a line of this length in metres; `line` is the same in the voxels of its grids, if it has any.
    #[inline]
    pub fn walk(
        &self,
        line: Option<&MediumLine>,
        length: f32,
        channel: WalkChannel,
        mut draw: impl FnMut() -> f32,
    ) -> Flight {
        if let (Some(grid), Some(line)) = (self.density, line) {
            return self.walk_in_grid(grid, line, (length, channel), draw);
        }
        let WalkChannel { index, odds } = channel;
        let event = if self.scatters() {
            let distance = self.sample_distance(index, draw());
            (distance < length).then_some(MediumEvent {
                distance,
                sigma_s: self.sigma_s,
                sigma_t: self.sigma_t(),
            })
        } else {
            None
        };
        let path = self.free_path(event.map_or(length, |event| event.distance), index);
        let emitted = match self.glow {
            Some(_) => self.emitted(line, length, draw) / mean(odds),
            None => Rgb::BLACK,
        };
        Flight { path, event, emitted }
    }

    /// Free path along a line of this length in metres, for light that passes; in a grid an estimate of it.
    #[inline]
    pub fn passed(
        &self,
        line: Option<&MediumLine>,
        length: f32,
        channel: usize,
        draw: impl FnMut() -> f32,
    ) -> FreePath {
        match (self.density, line) {
            (Some(grid), Some(line)) => {
                self.passed_in_grid(grid, line, (length, channel), draw, |_, _, _| {})
            }
            _ => self.free_path(length, channel),
        }
    }

    /// The light that arrives of what is emitted along a line, where the density is the same everywhere: what a walk finds on average,
    /// wherever its event is. Of grids one point of each block is taken.
    #[cold]
    pub(super) fn emitted(
        &self,
        line: Option<&MediumLine>,
        length: f32,
        mut draw: impl FnMut() -> f32,
    ) -> Rgb {
        let Some(glow) = self.glow else { return Rgb::BLACK };
        let line = line.and_then(|line| line.glow.as_ref());
        let Some((grid, along)) = glow.grid().zip(line.and_then(|line| line.through_grid())) else {
            let absorbed = Rgb::WHITE - beer(self.sigma_t(), length);
            let share = |sigma_a: f32, sigma_t: f32, absorbed: f32| {
                if sigma_t > 0.0 { sigma_a / sigma_t * absorbed } else { 0.0 }
            };
            let [a, t, part] = [self.sigma_a, self.sigma_t(), absorbed];
            let share = Rgb::new(share(a.r, t.r, part.r), share(a.g, t.g, part.g), share(a.b, t.b, part.b));
            return glow.at(None, 0.0) * share;
        };
        let mut sum = Rgb::BLACK;
        grid.for_each_block(along, length, |begin, end, majorant| {
            if majorant > 0.0 {
                let t = begin + (end - begin) * draw();
                sum += glow.at(line, t) * self.sigma_a * beer(self.sigma_t(), t) * (end - begin);
            }
            true
        });
        sum
    }

    /// Delta tracking. Whether a collision is real is decided by the extinction in the walk's channel; the majorant is the same for
    /// all channels, so that all of them meet the same collisions.
    fn walk_in_grid(
        &self,
        grid: &Grid,
        line: &MediumLine,
        (length, channel): (f32, WalkChannel),
        mut draw: impl FnMut() -> f32,
    ) -> Flight {
        let WalkChannel { index, odds } = channel;
        let Some(along) = &line.density else {
            return Flight { path: FreePath::CLEAR, event: None, emitted: Rgb::BLACK };
        };
        let mut emitted = Rgb::BLACK;
        if !self.scatters() {
            let path = self.passed_in_grid(grid, line, (length, index), draw, |t, fraction, passed| {
                emitted += self.emitted_at(line, t) * fraction * (passed / mean(odds));
            });
            return Flight { path, event: None, emitted };
        }
        let sigma_t = self.sigma_t();
        let (mut passed, mut event) = (Rgb::WHITE, None);
        self.collide(grid, along, length, &mut draw, |draw, t, density, fraction| {
            if self.glow.is_some() {
                emitted += self.emitted_at(line, t) * fraction * (passed / mean(odds * passed));
            }
            if draw() < fraction[index] {
                event = Some((t, density));
                return false;
            }
            passed *= Rgb::WHITE - fraction;
            true
        });
        let path = |density_at_end: f32| FreePath {
            transmittance: passed,
            survival: passed[index],
            survivals: passed,
            hazards: [sigma_t[index] * grid.at(along, 0.0), sigma_t[index] * density_at_end],
        };
        match event {
            Some((distance, density)) => {
                let event =
                    MediumEvent { distance, sigma_s: self.sigma_s * density, sigma_t: sigma_t * density };
                Flight { path: path(density), event: Some(event), emitted }
            }
            None => Flight { path: path(grid.at(along, length)), event: None, emitted },
        }
    }

    /// The radiance of what is emitted at a collision, for each part of the light that it stops.
    pub(super) fn emitted_at(&self, line: &MediumLine, t: f32) -> Rgb {
        let Some(glow) = self.glow else { return Rgb::BLACK };
        let share =
            |sigma_a: f32, sigma_s: f32| if sigma_a > 0.0 { sigma_a / (sigma_a + sigma_s) } else { 0.0 };
        let [a, s] = [self.sigma_a, self.sigma_s];
        glow.at(line.glow.as_ref(), t) * Rgb::new(share(a.r, s.r), share(a.g, s.g), share(a.b, s.b))
    }

    /// Ratio tracking: every collision is null, and lets pass what it would not have stopped. [Novák 2014] Where little passes, most
    /// estimates end early as 0, and the others count for them; weights compare the same path, ended or not. `at_collision` gets
    /// the distance, what is stopped there, and what has come so far.
    fn passed_in_grid(
        &self,
        grid: &Grid,
        line: &MediumLine,
        (length, channel): (f32, usize),
        mut draw: impl FnMut() -> f32,
        mut at_collision: impl FnMut(f32, Rgb, Rgb),
    ) -> FreePath {
        let Some(along) = &line.density else { return FreePath::CLEAR };
        let (mut passed, mut counts_for) = (Rgb::WHITE, 1.0);
        self.collide(grid, along, length, &mut draw, |draw, t, _, fraction| {
            at_collision(t, fraction, passed * counts_for);
            passed *= Rgb::WHITE - fraction;
            if passed.max_channel() * counts_for < LITTLE {
                counts_for = if draw() * ONE_OF < 1.0 { counts_for * ONE_OF } else { 0.0 };
            }
            counts_for > 0.0
        });
        let transmittance = passed * counts_for;
        if !self.scatters() {
            return FreePath { transmittance, ..FreePath::CLEAR };
        }
        let sigma_t = self.sigma_t()[channel];
        let hazard_at = |t: f32| sigma_t * grid.at(along, t);
        let hazards = [hazard_at(0.0), hazard_at(length)];
        FreePath { transmittance, survival: passed[channel], survivals: passed, hazards }
    }

    /// Visits collisions along a line, as often as the majorant says: their distance, the density there, and the probability, for each
    /// channel, that they are real; until `visit` returns false.
    #[inline]
    fn collide<D: FnMut() -> f32>(
        &self,
        grid: &Grid,
        line: &GridLine,
        length: f32,
        draw: &mut D,
        mut visit: impl FnMut(&mut D, f32, f32, Rgb) -> bool,
    ) {
        let sigma_t = self.sigma_t();
        let largest = sigma_t.max_channel();
        if largest <= 0.0 {
            return;
        }
        let relative = sigma_t / largest;
        // The optical thickness, by the majorant, up to the next collision.
        let mut left = thickness(draw());
        grid.for_each_block(line, length, |begin, end, majorant| {
            let rate = majorant * largest;
            let mut t = begin;
            loop {
                let thickness_here = rate * (end - t);
                if left >= thickness_here {
                    left -= thickness_here;
                    return true;
                }
                t += left / rate;
                left = thickness(draw());
                // A value rounded up beyond its bound must not let more than everything stop.
                let density = grid.at(line, t);
                let fraction = relative * (density / majorant).min(1.0);
                if !visit(draw, t, density, fraction) {
                    return false;
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::glow::Glow;
    use super::*;
    use bilux_math::transcendental::exp_f64;
    use bilux_math::{Transform, Vec3};
    use std::sync::Arc;

    const SIGMA_A: Rgb = Rgb::new(0.02, 0.1, 0.3);
    const SIGMA_S: Rgb = Rgb::new(0.3, 0.1, 0.0);

    /// A column of voxels, a metre each.
    fn column() -> Grid {
        let values: Vec<f32> =
            (0..20u64).map(|i| if i.is_multiple_of(4) { 0.0 } else { (mix64(i) >> 62) as f32 }).collect();
        Grid::dense("", [1, 1, 20], &Transform::IDENTITY, &values).unwrap()
    }

    const FROM: Vec3 = Vec3::new(0.5, 0.5, 1.25);

    fn line(grid: &Grid) -> GridLine {
        grid.line(FROM, Vec3::Z)
    }

    fn medium_line(medium: &Medium) -> MediumLine {
        medium.line(|| Transform::IDENTITY, FROM, Vec3::Z).unwrap()
    }

    /// Each channel in turn, at the beginning of a walk.
    fn in_turn(i: usize) -> WalkChannel {
        WalkChannel { index: i % 3, odds: Rgb::WHITE }
    }

    /// The integral of the density along the line, by the midpoint rule.
    fn integral(grid: &Grid, length: f64) -> f64 {
        const STEPS: u32 = 20_000;
        let step = length / f64::from(STEPS);
        (0..STEPS).map(|i| f64::from(grid.at(&line(grid), ((f64::from(i) + 0.5) * step) as f32)) * step).sum()
    }

    /// Fails unless estimates of the transmittance have the mean that Beer's law says, the product of a walk's survival and of what it
    /// carries has the same, and walks end where their densities say.
    fn check(grid: &Grid, truth: &Grid) -> Result<(), String> {
        const WALKS: u64 = 60_000;
        let length = 15.0;
        let medium = Medium { sigma_a: SIGMA_A, sigma_s: SIGMA_S, density: Some(grid), ..Medium::VACUUM };
        let along = medium_line(&medium);
        let (mut ratio, mut walked) = ([[0.0f64; 2]; 3], [[0.0f64; 2]; 3]);
        let mut draws = Draws::new(7);
        for i in 0..WALKS {
            let channel = in_turn(i as usize);
            let passed = medium.passed(Some(&along), length, channel.index, || draws.next_1d());
            let flight = medium.walk(Some(&along), length, channel, || draws.next_1d());
            for channel in 0..3 {
                let weight = flight.path.transmittance[channel] / mean(flight.path.survivals);
                let walked_here = if flight.event.is_none() { weight } else { 0.0 };
                for (sums, value) in [(&mut ratio, passed.transmittance[channel]), (&mut walked, walked_here)]
                {
                    sums[channel][0] += f64::from(value);
                    sums[channel][1] += f64::from(value) * f64::from(value);
                }
            }
        }
        for channel in 0..3 {
            let sigma = f64::from((SIGMA_A + SIGMA_S)[channel]);
            let wanted = exp_f64(-sigma * integral(truth, f64::from(length)));
            for (what, sums) in [("ratio", &ratio), ("walks", &walked)] {
                let [mean, square] = sums[channel].map(|sum| sum / WALKS as f64);
                let error = ((square - mean * mean) / WALKS as f64).sqrt();
                if (mean - wanted).abs() > 4.5 * error + 1e-5 {
                    return Err(format!("{what} of channel {channel}: {mean} ± {error}, not {wanted}"));
                }
            }
        }
        Ok(())
    }

    #[test]
    fn what_passes_is_what_beer_says() {
        let grid = column();
        assert_eq!(check(&grid, &grid), Ok(()));
        assert!(
            check(&grid.with_majorants_scaled(0.5), &grid).is_err(),
            "majorants that are none are noticed"
        );
        assert_eq!(
            check(&grid.with_majorants_scaled(3.0), &grid),
            Ok(()),
            "more null collisions change nothing"
        );
    }

    /// Events get the same light, whatever lies behind them, and hazards are those of both ends.
    #[test]
    fn densities_at_both_ends_are_those_of_the_grid() {
        let grid = column();
        let medium = Medium { sigma_s: Rgb::grey(0.2), density: Some(&grid), ..Medium::VACUUM };
        let (mut draws, along) = (Draws::new(3), medium_line(&medium));
        let (mut events, mut sum) = (0, 0.0);
        for i in 0..2000 {
            let flight = medium.walk(Some(&along), 15.0, in_turn(i), || draws.next_1d());
            let end = flight.event.map_or(15.0, |event| event.distance);
            let [back, on] = flight.path.hazards;
            assert!((back - 0.2 * grid.at(&line(&grid), 0.0)).abs() < 1e-6);
            assert!((on - 0.2 * grid.at(&line(&grid), end)).abs() < 1e-6);
            if let Some(event) = flight.event {
                assert!((event.sigma_s.g - on).abs() < 1e-6 && on > 0.0);
                (events, sum) = (events + 1, sum + flight.path.transmittance.g / flight.path.survival);
            }
        }
        assert!(
            events > 1000 && (sum - f64::from(events) as f32).abs() < 1e-2,
            "grey walks carry everything"
        );
    }

    /// The light of a glowing column against the integral of what each part emits and what passes of it, whether it scatters or not, and
    /// where its density, its glow or both come from a grid.
    #[test]
    fn what_is_emitted_is_its_integral() {
        const WALKS: u32 = 60_000;
        const STEPS: u32 = 20_000;
        let grid = Arc::new(column());
        let scale = Transform::scale(Vec3::new(1.0, 1.0, 2.0)).unwrap();
        let flame = Arc::new(
            Grid::dense("", [1, 1, 10], &scale, &[0., 1., 2., 0., 0.5, 3., 1., 1., 0., 2.]).unwrap(),
        );
        for (sigma_s, density, factor) in [
            (SIGMA_S, true, true),
            (SIGMA_S, true, false),
            (Rgb::BLACK, true, true),
            (SIGMA_S, false, true),
            (SIGMA_S, false, false),
        ] {
            let radiance = Rgb::new(2.0, 1.0, 0.5);
            let glow = if factor { Glow::of(radiance, flame.clone()) } else { Glow::even(radiance) };
            let density = density.then_some(&*grid);
            let medium = Medium { sigma_a: SIGMA_A, sigma_s, density, glow: Some(&glow), ..Medium::VACUUM };
            let along = medium.line(|| Transform::IDENTITY, FROM, Vec3::Z);
            let mut draws = Draws::new(11);
            let (mut sums, mut squares) = ([0.0f64; 3], [0.0f64; 3]);
            for i in 0..WALKS {
                let channel = in_turn(i as usize);
                let emitted = medium.walk(along.as_ref(), 15.0, channel, || draws.next_1d()).emitted;
                for c in 0..3 {
                    sums[c] += f64::from(emitted[c]);
                    squares[c] += f64::from(emitted[c] * emitted[c]);
                }
            }
            let mut wanted = [0.0f64; 3];
            let (step, mut thickness) = (15.0 / f64::from(STEPS), 0.0);
            for i in 0..STEPS {
                let t = ((f64::from(i) + 0.5) * step) as f32;
                let d = density.map_or(1.0, |grid| grid.at(&line(grid), t));
                let f = if factor { flame.value(FROM + Vec3::Z * t) } else { 1.0 };
                thickness += 0.5 * f64::from(d) * step;
                for c in 0..3 {
                    let passes = exp_f64(-f64::from((SIGMA_A + sigma_s)[c]) * thickness);
                    wanted[c] += f64::from(SIGMA_A[c] * d * f * radiance[c]) * passes * step;
                }
                thickness += 0.5 * f64::from(d) * step;
            }
            for c in 0..3 {
                let mean = sums[c] / f64::from(WALKS);
                let error =
                    ((squares[c] / f64::from(WALKS) - mean * mean) / f64::from(WALKS)).max(0.0).sqrt();
                assert!(
                    (mean - wanted[c]).abs() < 4.5 * error + 1e-4,
                    "{mean} ± {error}, not {} ({c})",
                    wanted[c]
                );
            }
        }
    }
}
