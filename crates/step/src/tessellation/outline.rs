//! The part of a surface's parameters that a face covers.

use super::corner::{Corner, area, contain};
use super::cuts::Around;
use super::paths::Path;
use crate::surfaces::Surface;
use bilux_math::{DVec2, DVec3};

/// The closed lines around a face in the parameters of its surface, which lies on the left of each line of points. `None` if they do not
/// enclose any part of it. `size` is that of the model.
pub(super) fn outline(surface: &dyn Surface, lines: &[Vec<DVec3>], size: f64) -> Option<Vec<Vec<Corner>>> {
    const NEAR: f64 = 1e-7;
    /// More lines are not compared with each other.
    const MOST: usize = 8192;
    if lines.len() > MOST && surface.periods().iter().any(Option::is_some) {
        return None;
    }
    if lines.is_empty() {
        return whole(surface, DVec2::ZERO).map(|whole| vec![whole]);
    }
    let paths = lines.iter().filter_map(|line| Path::new(surface, line, NEAR * size));
    let (around, closed): (Vec<Path>, Vec<Path>) = paths.partition(|path| path.turn != DVec2::ZERO);
    let periods = surface.periods();
    let mut loops = match around.first() {
        Some(first) => {
            let axis = usize::from(first.turn.x == 0.0);
            // What goes around both ways encloses nothing.
            let is_same = |path: &Path| path.turn[1 - axis] == 0.0 && path.turn[axis] != 0.0;
            around.iter().all(is_same).then_some(())?;
            Around { axis, period: periods[axis]? }.joined(surface, around, &closed)?
        }
        None => {
            let largest =
                closed.iter().map(|path| area(&path.corners)).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            let is_complement = largest < 0.0 && periods.iter().all(Option::is_some);
            match is_complement {
                true => vec![around_holes(surface, &closed)?],
                false => Vec::new(),
            }
        }
    };
    nest(surface, &mut loops, closed);
    Some(loops)
}

/// Adds lines that do not go around, by whole periods within the largest line.
fn nest(surface: &dyn Surface, loops: &mut Vec<Vec<Corner>>, mut closed: Vec<Path>) {
    closed.sort_by(|a, b| area(&b.corners).abs().total_cmp(&area(&a.corners).abs()));
    let periods = surface.periods();
    for mut path in closed {
        let outer = loops.first();
        let shifts = |axis: usize| match periods[axis] {
            Some(period) => vec![0.0, period, -period, 2.0 * period, -2.0 * period],
            None => vec![0.0],
        };
        if let Some(outer) = outer.filter(|_| periods.iter().any(Option::is_some)) {
            let all =
                shifts(0).into_iter().flat_map(|u| shifts(1).into_iter().map(move |v| DVec2::new(u, v)));
            // Any corner may lie on the outer line: the middle of two does not.
            let start = path.corners[0].at.midpoint(path.corners[path.corners.len() / 2].at);
            let found = all.into_iter().find(|&shift| contain([&outer[..]], start + shift));
            path.shift(found.unwrap_or(DVec2::ZERO));
        }
        loops.push(path.corners);
    }
}

/// The whole of a closed surface, cut where no hole is.
fn around_holes(surface: &dyn Surface, holes: &[Path]) -> Option<Vec<Corner>> {
    let mut start = DVec2::ZERO;
    for axis in 0..2 {
        let all = holes.iter().flat_map(|path| path.corners.iter()).map(|corner| corner.at[axis]);
        let (low, high) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let gap = surface.periods()[axis]? - (high - low);
        (gap > 0.0).then_some(())?;
        start[axis] = high + 0.5 * gap;
    }
    whole(surface, start)
}

/// The line around a whole surface that is bounded by itself; closed directions begin at `start`.
fn whole(surface: &dyn Surface, start: DVec2) -> Option<Vec<Corner>> {
    const PIECES: usize = 32;
    let (periods, domain) = (surface.periods(), surface.domain());
    let poles = surface.poles();
    let range = |axis: usize| match periods[axis] {
        Some(period) => Some([start[axis], start[axis] + period]),
        // An open direction has to end in poles, or the surface has a boundary that the file does not state.
        None => {
            let ends = domain[axis];
            let is_bounded = ends.iter().all(|end| end.is_finite());
            is_bounded.then_some(ends)
        }
    };
    let [u, v] = [range(0)?, range(1)?];
    (periods.iter().any(Option::is_some) || !poles.is_empty()).then_some(())?;
    let mut corners = Vec::new();
    let place = |at: DVec2| {
        // Both sides of a seam have the same points.
        let mut same = at;
        for axis in 0..2 {
            if periods[axis].is_some() && at[axis] == [u, v][axis][1] {
                same[axis] = start[axis];
            }
        }
        let pole = poles.iter().find(|pole| pole.at == at[1 - pole.along]);
        Corner { at, point: pole.map_or_else(|| surface.point(same), |pole| pole.point) }
    };
    let share = |[from, to]: [f64; 2], i: usize| {
        if i == PIECES { to } else { from + (to - from) * i as f64 / PIECES as f64 }
    };
    corners.extend((0..PIECES).map(|i| place(DVec2::new(share(u, i), v[0]))));
    corners.extend((0..PIECES).map(|i| place(DVec2::new(u[1], share(v, i)))));
    corners.extend((0..PIECES).map(|i| place(DVec2::new(share(u, PIECES - i), v[1]))));
    corners.extend((0..PIECES).map(|i| place(DVec2::new(u[0], share(v, PIECES - i)))));
    Some(corners)
}
