//! The edges of polygons, and which corners they join.

use std::collections::HashMap;

/// The edges of a list of polygons, numbered as the polygons name them first.
pub(super) struct Edges {
    pub(super) all: Vec<Edge>,
    /// For each corner, the edge from it to the next corner of its polygon.
    pub(super) of_corner: Vec<u32>,
    /// For each corner, the next one of its polygon.
    pub(super) next: Vec<u32>,
}

/// An edge between two points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Points of the edge, as its first polygon runs through them.
    pub(super) ends: [u32; 2],
    /// The corners of the first two polygons that begin it.
    pub(super) corners: [u32; 2],
    /// The number of its polygons.
    pub(super) polygons: u32,
}

impl Edge {
    /// The name of an edge, whichever way it runs.
    pub(super) fn key(a: u32, b: u32) -> [u32; 2] {
        [a.min(b), a.max(b)]
    }
}

impl Edges {
    /// Of polygons with these corners, which are indices of points, and the end of each polygon.
    pub(super) fn new(corners: &[u32], ends: &[u32]) -> Edges {
        let mut numbers: HashMap<[u32; 2], u32> = HashMap::with_capacity(corners.len() / 2 + 1);
        let mut edges = Edges {
            all: Vec::new(),
            of_corner: Vec::with_capacity(corners.len()),
            next: Vec::with_capacity(corners.len()),
        };
        let mut start = 0;
        for &end in ends {
            for corner in start..end {
                let next = if corner + 1 == end { start } else { corner + 1 };
                let [from, to] = [corners[corner as usize], corners[next as usize]];
                let number = *numbers.entry(Edge::key(from, to)).or_insert(edges.all.len() as u32);
                match edges.all.get_mut(number as usize) {
                    Some(edge) => {
                        if edge.polygons == 1 {
                            edge.corners[1] = corner;
                        }
                        edge.polygons += 1;
                    }
                    None => edges.all.push(Edge { ends: [from, to], corners: [corner; 2], polygons: 1 }),
                }
                edges.of_corner.push(number);
                edges.next.push(next);
            }
            start = end;
        }
        edges
    }

    /// Edges of a layer, whose corners have other points: an edge whose two polygons have different points there becomes two.
    pub(super) fn of_layer(&self, corners: &[u32]) -> Edges {
        let mut edges = Edges {
            all: Vec::with_capacity(self.all.len()),
            of_corner: Vec::with_capacity(corners.len()),
            next: self.next.clone(),
        };
        for (corner, &from) in (0u32..).zip(corners) {
            let to = corners[self.next[corner as usize] as usize];
            let [first, second] = self.all[self.of_corner[corner as usize] as usize].corners;
            if corner == second && first < second {
                let number = edges.of_corner[first as usize];
                let edge: &mut Edge = &mut edges.all[number as usize];
                if Edge::key(edge.ends[0], edge.ends[1]) == Edge::key(from, to) {
                    (edge.corners[1], edge.polygons) = (corner, 2);
                    edges.of_corner.push(number);
                    continue;
                }
            }
            edges.of_corner.push(edges.all.len() as u32);
            edges.all.push(Edge { ends: [from, to], corners: [corner; 2], polygons: 1 });
        }
        edges
    }
}
