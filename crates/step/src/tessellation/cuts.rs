//! Joins lines that go around a closed surface to one that encloses the part between them.

use super::corner::Corner;
use super::paths::Path;
use crate::surfaces::Surface;
use bilux_math::DVec2;

/// The corners of a line at which a cut is tried.
const TRIED: usize = 48;

/// Largest distance of a cut from the surface, as a part of the way from one corner to the next, and the most halvings of a cut.
const BENT: f64 = 0.02;
const DEEPEST: usize = 7;

/// Corners along the line of a pole.
const PIECES: usize = 32;

/// The axis along which lines go around, with its period.
#[derive(Clone, Copy)]
pub(super) struct Around {
    pub(super) axis: usize,
    pub(super) period: f64,
}

impl Around {
    fn turn(self) -> DVec2 {
        let mut turn = DVec2::ZERO;
        turn[self.axis] = self.period;
        turn
    }

    /// Distance of a line to the left of one that goes forwards along the axis.
    fn height(self, path: &Path) -> f64 {
        let mean = path.mean(1 - self.axis);
        if self.axis == 0 { mean } else { -mean }
    }

    /// Pairs lines that go around, each with the next above it, or a single one with a pole, and joins them. `holes` are the lines that do not.
    pub(super) fn joined(
        self,
        surface: &dyn Surface,
        mut around: Vec<Path>,
        holes: &[Path],
    ) -> Option<Vec<Vec<Corner>>> {
        /// A face has two such lines, or a few if it is wrong.
        const MOST: usize = 16;
        let is_forward = |path: &Path| path.turn[self.axis] > 0.0;
        (around.len() <= MOST).then_some(())?;
        around.sort_by(|a, b| self.height(a).total_cmp(&self.height(b)));
        if let [low, high] = &around[..]
            && let Some(period) = surface.periods()[1 - self.axis]
            && is_forward(high)
            && !is_forward(low)
        {
            // Around the tube of a torus, what is below is above as well.
            let mut shift = DVec2::ZERO;
            shift[1 - self.axis] = if self.axis == 0 { period } else { -period };
            around[0].shift(shift);
            around.swap(0, 1);
        }
        if let [only] = &around[..] {
            let pole = self.pole(surface, only)?;
            let only = only.clone();
            let (low, high) = if is_forward(&only) { (only, pole) } else { (pole, only) };
            return Some(vec![self.join(surface, low, high, holes)]);
        }
        let mut loops = Vec::new();
        let mut rest = around.into_iter();
        while let Some(low) = rest.next() {
            let high = rest.next()?;
            // Lines whose directions are wrong enclose the same.
            let low = if is_forward(&low) { low } else { low.reversed() };
            let high = if is_forward(&high) { high.reversed() } else { high };
            loops.push(self.join(surface, low, high, holes));
        }
        Some(loops)
    }

    /// The line of the pole that closes a surface beyond a line, in the other direction.
    fn pole(self, surface: &dyn Surface, path: &Path) -> Option<Path> {
        let is_forward = path.turn[self.axis] > 0.0;
        let all = surface.poles().into_iter().filter(|pole| pole.along == self.axis);
        let mean = path.mean(1 - self.axis);
        let is_high = is_forward == (self.axis == 0);
        let mut all: Vec<_> = all.collect();
        // The one on the left, or if there is none, any.
        all.sort_by_key(|pole| (pole.at > mean) != is_high);
        let pole = *all.first()?;
        let start = path.corners[0].at[self.axis];
        let corner = |i: usize| {
            let mut at = DVec2::splat(pole.at);
            let share = i as f64 / PIECES as f64 * self.period;
            at[self.axis] = if is_forward { start + self.period - share } else { start + share };
            Corner { at, point: pole.point }
        };
        let turn = if is_forward { -self.turn() } else { self.turn() };
        Some(Path { corners: (0..PIECES).map(corner).collect(), turn })
    }

    /// Joins a line that goes forwards and one that goes back by a cut from one to the other, followed both ways.
    fn join(self, surface: &dyn Surface, low: Path, high: Path, holes: &[Path]) -> Vec<Corner> {
        let count = low.corners.len();
        let step = count.div_ceil(TRIED);
        let mut best: Option<(usize, f64, Vec<Corner>)> = None;
        for i in (0..count).step_by(step) {
            let end = low.corners[i].at[self.axis] + self.period;
            let offset = |corner: &Corner| {
                let d = (end - corner.at[self.axis]) / self.period;
                (d - d.round()) * self.period
            };
            let nearest = (0..high.corners.len())
                .min_by(|&a, &b| offset(&high.corners[a]).abs().total_cmp(&offset(&high.corners[b]).abs()));
            let Some(j) = nearest else { continue };
            let missed = offset(&high.corners[j]).abs();
            if best.as_ref().is_some_and(|best| best.0 == 0 && best.1 <= missed) {
                continue;
            }
            let mut shift = DVec2::ZERO;
            shift[self.axis] = end - offset(&high.corners[j]) - high.corners[j].at[self.axis];
            let mut line = rotated(&low, i);
            let cut = [line[count].at, high.corners[j].at + shift];
            let crossings = self.crossings(cut, holes) + own_crossings(cut, &line);
            let back = rotated(&high, j).into_iter().map(|corner| corner.moved(shift));
            line.extend(back);
            if best.as_ref().is_none_or(|best| (crossings, missed) < (best.0, best.1)) {
                best = Some((crossings, missed, line));
            }
        }
        best.map_or_else(Vec::new, |best| self.on_surface(surface, best.2, count))
    }

    /// The line with its cut on the surface, with the same points both ways. `end` is the corner at which the cut begins.
    fn on_surface(self, surface: &dyn Surface, line: Vec<Corner>, end: usize) -> Vec<Corner> {
        let mut cut = Vec::new();
        follow(surface, [line[end], line[end + 1]], DEEPEST, &mut cut);
        let back = cut.iter().rev().map(|corner| corner.moved(-self.turn()));
        let (low, high) = line.split_at(end + 1);
        low.iter().chain(&cut).chain(high).copied().chain(back).collect()
    }

    /// Number of times that holes cross a line, wherever they are found on the surface.
    fn crossings(self, cut: [DVec2; 2], holes: &[Path]) -> usize {
        let mut count = 0;
        for hole in holes {
            // The turns from the hole to the cut.
            let turns = ((cut[0][self.axis] - hole.corners[0].at[self.axis]) / self.period).round();
            for turn in [turns - 1.0, turns, turns + 1.0] {
                let back = cut.map(|at| at - self.turn() * turn);
                let next = |i: usize| hole.corners[(i + 1) % hole.corners.len()].at;
                count +=
                    (0..hole.corners.len()).filter(|&i| cross(back, [hole.corners[i].at, next(i)])).count();
            }
        }
        count
    }
}

/// Adds corners between two of them, until the lines from one to the next are next to the surface.
fn follow(surface: &dyn Surface, [a, b]: [Corner; 2], deepest: usize, into: &mut Vec<Corner>) {
    let at = |part: f64| a.at.lerp(b.at, part);
    let missed = |part: f64| surface.point(at(part)).distance(a.point.lerp(b.point, part));
    let farthest = [0.25, 0.5, 0.75].map(missed).into_iter().fold(0.0, f64::max);
    if deepest == 0 || farthest <= BENT * a.point.distance(b.point) {
        return;
    }
    let middle = Corner { at: at(0.5), point: surface.point(at(0.5)) };
    follow(surface, [a, middle], deepest - 1, into);
    into.push(middle);
    follow(surface, [middle, b], deepest - 1, into);
}

fn own_crossings(cut: [DVec2; 2], line: &[Corner]) -> usize {
    line.windows(2).filter(|pair| cross(cut, [pair[0].at, pair[1].at])).count()
}

/// The corners of a path from one on, up to the same one after a whole round.
fn rotated(path: &Path, first: usize) -> Vec<Corner> {
    let later = path.corners[..=first].iter().map(|corner| corner.moved(path.turn));
    path.corners[first..].iter().copied().chain(later).collect()
}

/// True if two lines cross within both.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
