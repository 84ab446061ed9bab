//! Triangles within closed lines of a plane.

use super::corner::{Corner, bounds, contain};
use bilux_math::DVec2;
use bilux_pictures::guarded_decoding;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::collections::HashMap;

/// Corners, and triangles of them that are counter-clockwise.
pub(super) struct Filled {
    pub(super) corners: Vec<Corner>,
    pub(super) triangles: Vec<[u32; 3]>,
}

struct Site {
    position: Point2<f64>,
    corner: u32,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

type Mesh = ConstrainedDelaunayTriangulation<Site>;

/// A vertex that was made where lines cross.
const CROSSING: u32 = u32::MAX;

/// Crossings of lines that are too many, and comparisons of faces with lines.
const CROSSINGS: usize = 1024;
const COMPARISONS: usize = 1 << 28;

/// The triangles within closed lines, by the even-odd rule, with more corners inside. Distances are compared in units of `step`.
/// `place` gives the point of a place where lines cross. `None` if there is nothing inside, or the library fails.
pub(super) fn fill(
    loops: &[Vec<Corner>],
    inner: Vec<Corner>,
    step: DVec2,
    place: impl Fn(DVec2) -> bilux_math::DVec3,
) -> Option<Filled> {
    let [low, high] = bounds(loops);
    let middle = low.midpoint(high);
    let is_sound =
        middle.is_finite() && loops.iter().flatten().all(|c| c.at.is_finite() && c.point.is_finite());
    if !is_sound {
        return None;
    }
    let filled = guarded_decoding(|| filled(loops, inner, step, middle)).flatten();
    let mut filled = filled?;
    for corner in &mut filled.corners {
        if !corner.point.is_finite() {
            corner.point = place(corner.at);
        }
    }
    Some(filled)
}

fn filled(loops: &[Vec<Corner>], inner: Vec<Corner>, step: DVec2, middle: DVec2) -> Option<Filled> {
    let mut mesh = Mesh::new();
    let mut corners: Vec<Corner> = loops.iter().flatten().copied().collect();
    corners.extend(inner);
    let mut sites = Vec::with_capacity(corners.len());
    for (i, corner) in corners.iter().enumerate() {
        let at = (corner.at - middle) / step;
        // The library refuses numbers that are next to zero.
        let [x, y] = at.to_array().map(|x| if x.abs() < 1e-100 { 0.0 } else { x });
        sites.push(mesh.insert(Site { position: Point2::new(x, y), corner: i as u32 }).ok()?);
    }
    let (mut odd, mut has_crossings) = (HashMap::new(), false);
    let mut first = 0;
    for line in loops {
        let ends: Vec<FixedVertexHandle> = sites[first..first + line.len()].to_vec();
        first += line.len();
        for (i, &from) in ends.iter().enumerate() {
            let to = ends[(i + 1) % ends.len()];
            if from == to {
                continue;
            }
            let edges = mesh.try_add_constraint(from, to);
            if edges.is_empty() {
                has_crossings = true;
                if mesh.num_vertices() > CROSSINGS + 2 * corners.len() {
                    return None;
                }
                mesh.add_constraint_and_split(from, to, |position| Site { position, corner: CROSSING });
            }
            for edge in edges {
                let is_odd: &mut bool = odd.entry(edge.as_undirected()).or_default();
                *is_odd = !*is_odd;
            }
        }
    }
    let mut crossing_corners: HashMap<FixedVertexHandle, u32> = HashMap::new();
    for vertex in mesh.vertices().filter(|vertex| vertex.data().corner == CROSSING) {
        let at = DVec2::new(vertex.position().x, vertex.position().y) * step + middle;
        crossing_corners.insert(vertex.fix(), corners.len() as u32);
        corners.push(Corner { at, point: bilux_math::DVec3::NAN });
    }
    if has_crossings && mesh.num_all_faces().saturating_mul(first) > COMPARISONS {
        return None;
    }
    let is_inside =
        if has_crossings { by_centres(&mesh, loops, step, middle) } else { by_edges(&mesh, &odd) };
    let mut triangles = Vec::new();
    for face in mesh.inner_faces().filter(|face| is_inside[face.fix().index()]) {
        triangles.push(face.vertices().map(|vertex| match vertex.data().corner {
            CROSSING => crossing_corners.get(&vertex.fix()).copied().unwrap_or(0),
            corner => corner,
        }));
    }
    (!triangles.is_empty()).then_some(Filled { corners, triangles })
}

/// For each face whether it is inside: every line changes the side.
fn by_edges(mesh: &Mesh, odd: &HashMap<spade::handles::FixedUndirectedEdgeHandle, bool>) -> Vec<bool> {
    let mut known: Vec<Option<bool>> = vec![None; mesh.num_all_faces()];
    let outer = mesh.outer_face();
    known[outer.fix().index()] = Some(false);
    let mut rest: Vec<_> = mesh.convex_hull().map(|edge| (edge.fix(), false)).collect();
    while let Some((edge, is_inside)) = rest.pop() {
        // From the face of an edge to the one on its other side.
        let edge = mesh.directed_edge(edge);
        let is_odd = odd.get(&edge.as_undirected().fix()).copied().unwrap_or(false);
        let other = edge.rev();
        let face = other.face();
        if known[face.fix().index()].is_some() {
            continue;
        }
        let is_inside = is_inside != is_odd;
        known[face.fix().index()] = Some(is_inside);
        for next in [other.next(), other.prev()] {
            rest.push((next.fix(), is_inside));
        }
    }
    known.into_iter().map(|is_inside| is_inside.unwrap_or(false)).collect()
}

/// For each face whether its middle is inside, for lines that cross.
fn by_centres(mesh: &Mesh, loops: &[Vec<Corner>], step: DVec2, middle: DVec2) -> Vec<bool> {
    let mut inside = vec![false; mesh.num_all_faces()];
    for face in mesh.inner_faces() {
        let centre = face.center();
        let p = DVec2::new(centre.x, centre.y) * step + middle;
        inside[face.fix().index()] = contain(loops.iter().map(|line| &line[..]), p);
    }
    inside
}
