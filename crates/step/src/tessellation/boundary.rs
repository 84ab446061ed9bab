//! The closed lines around a face.

use super::edges::vertex;
use crate::part21::Table;
use crate::structure::axes::point;
use bilux_math::DVec3;
use std::collections::HashMap;

/// The points of each edge, from its first vertex to its second.
pub(super) type EdgePoints = HashMap<u64, Vec<DVec3>>;

/// An edge that is followed one way or the other.
#[derive(Clone, Copy, Debug)]
struct Step {
    edge: u64,
    is_forward: bool,
}

/// The edges around a face, with what is not an edge.
pub(super) struct Bounds {
    loops: Vec<Vec<Step>>,
    /// Lines that are given by their points.
    polygons: Vec<Vec<DVec3>>,
    /// True if something around it cannot be read.
    pub(super) is_broken: bool,
}

impl Bounds {
    pub(super) fn read(table: &Table, face: u64) -> Option<Bounds> {
        let mut bounds = Bounds { loops: Vec::new(), polygons: Vec::new(), is_broken: false };
        for bound in table.simple(face)?.references_at(1) {
            if bounds.add(table, bound).is_none() {
                bounds.is_broken = true;
            }
        }
        Some(bounds)
    }

    fn add(&mut self, table: &Table, bound: u64) -> Option<()> {
        let values = table.simple(bound)?;
        let (line, is_forward) = (values.reference(1)?, values.flag(2).unwrap_or(true));
        match table.kind(line) {
            b"EDGE_LOOP" => {
                let mut steps = Vec::new();
                for edge in table.simple(line)?.references_at(1) {
                    let step = match table.part(edge, "ORIENTED_EDGE") {
                        Some(oriented) => Step {
                            edge: oriented.reference(3)?,
                            is_forward: oriented.flag(4).unwrap_or(true),
                        },
                        None => Step { edge, is_forward: true },
                    };
                    steps.push(step);
                }
                if !is_forward {
                    steps.reverse();
                    steps.iter_mut().for_each(|step| step.is_forward = !step.is_forward);
                }
                self.loops.push(steps);
            }
            b"POLY_LOOP" => {
                let points: Option<Vec<DVec3>> =
                    table.simple(line)?.references_at(1).map(|id| point(table, id)).collect();
                let mut points = points?;
                if !is_forward {
                    points.reverse();
                }
                self.polygons.push(points);
            }
            // A face without edges, such as a whole sphere, has a single point.
            b"VERTEX_LOOP" => _ = vertex(table, table.simple(line)?.reference(1)?)?,
            _ => return None,
        }
        Some(())
    }

    /// The numbers of all edges.
    pub(super) fn edges(&self) -> impl Iterator<Item = u64> {
        self.loops.iter().flatten().map(|step| step.edge)
    }

    /// The points of all lines. Seams, which are followed both ways, are left out: no surface ends there. `None` if an edge is missing.
    pub(super) fn lines(&self, points: &EdgePoints) -> Option<Vec<Vec<DVec3>>> {
        let mut count: HashMap<u64, [usize; 2]> = HashMap::new();
        for step in self.loops.iter().flatten() {
            count.entry(step.edge).or_default()[usize::from(step.is_forward)] += 1;
        }
        let is_seam = |step: &Step| count[&step.edge] == [1, 1];
        let mut lines = self.polygons.clone();
        for steps in &self.loops {
            let mut runs: Vec<Vec<DVec3>> = Vec::new();
            let mut goes_on = false;
            for step in steps {
                if is_seam(step) {
                    goes_on = false;
                    continue;
                }
                let edge = points.get(&step.edge)?;
                if !goes_on {
                    runs.push(Vec::new());
                }
                goes_on = true;
                let run = runs.last_mut()?;
                let along: Vec<DVec3> =
                    if step.is_forward { edge.clone() } else { edge.iter().rev().copied().collect() };
                // The end of one edge is the start of the next.
                let is_joined = run.last().is_some_and(|last| last == &along[0]);
                run.extend(along.into_iter().skip(usize::from(is_joined)));
            }
            let is_whole = steps.iter().all(|step| !is_seam(step));
            if is_whole { lines.extend(runs) } else { lines.extend(linked(runs)) }
        }
        lines.iter_mut().for_each(close);
        lines.retain(|line| line.len() > 1);
        Some(lines)
    }
}

/// Leaves out points that repeat the one before, and the last that repeats the first.
fn close(line: &mut Vec<DVec3>) {
    line.dedup();
    while line.len() > 1 && line.first() == line.last() {
        line.pop();
    }
}

/// Connects pieces between seams to closed lines, each with the one whose start is nearest to its end.
fn linked(mut runs: Vec<Vec<DVec3>>) -> Vec<Vec<DVec3>> {
    /// More pieces are connected in their order.
    const MOST: usize = 256;
    let mut lines = Vec::new();
    if runs.len() > MOST {
        return runs;
    }
    while let Some(mut line) = runs.pop() {
        loop {
            let end = line[line.len() - 1];
            let own = end.distance_squared(line[0]);
            let next = (0..runs.len()).min_by(|&a, &b| {
                runs[a][0].distance_squared(end).total_cmp(&runs[b][0].distance_squared(end))
            });
            match next {
                Some(next) if runs[next][0].distance_squared(end) < own => line.extend(runs.remove(next)),
                _ => break,
            }
        }
        lines.push(line);
    }
    lines
}
