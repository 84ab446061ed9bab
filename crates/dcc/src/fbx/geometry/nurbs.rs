//! NURBS surfaces as polygons. [Farin 2002]

use crate::fbx::tree::{Node, Value};
use bilux_import::FormatError;
use bilux_import::geometry::b_spline::{Basis, Weights};
use bilux_import::meshes::polygon_mesh::{Layer, Mapping, PolygonMesh, Polygons, Workshop};
use bilux_math::{DVec3, Vec2, Vec3};

/// Polygons along a piece between two knots; fewer if there would be more than [`MOST`] in all.
const STEPS: usize = 16;
const MOST: usize = 1 << 20;

/// The surface at a node of the file; `None`, with a note, if its numbers make none.
pub(super) fn read(
    node: Node,
    name: String,
    workshop: &mut Workshop,
) -> Result<Option<PolygonMesh>, FormatError> {
    let spent = workshop.budget.spent();
    let Some(surface) = Surface::read(node, workshop)? else {
        workshop
            .diagnostics
            .note("a NURBS surface is not one: its knots or points do not fit its orders", || node.at());
        return Ok(None);
    };
    let held = workshop.budget.spent() - spent;
    let mesh = surface.polygons(node, name, workshop)?;
    workshop.budget.release(held);
    if mesh.positions.iter().any(|p| !p.is_finite()) {
        workshop.diagnostics.note("a NURBS surface goes beyond all bounds, and is left out", || node.at());
        return Ok(None);
    }
    Ok(Some(mesh))
}

/// A surface of control points in rows.
struct Surface {
    directions: [Direction; 2],
    /// Position and weight; along u first.
    points: Vec<[f64; 4]>,
    is_flipped: bool,
}

/// One direction of a surface.
struct Direction {
    basis: Basis,
    /// Control points of the file; the curve begins again with the first if it needs more.
    points: usize,
}

impl Surface {
    fn read(node: Node, workshop: &mut Workshop) -> Result<Option<Surface>, FormatError> {
        let pair = |name: &str| {
            let number = |i: usize| usize::try_from(node.child(name)?.value(i)?.integer()?).ok();
            Some([number(0)?, number(1)?])
        };
        let (Some(orders), Some(counts)) = (pair("NurbsSurfaceOrder"), pair("Dimensions")) else {
            return Ok(None);
        };
        let mut list = |name: &str| match node.child(name) {
            Some(list) => list.numbers::<f64>(workshop.budget),
            None => Ok(Vec::new()),
        };
        let [u, v, points] = [list("KnotVectorU")?, list("KnotVectorV")?, list("Points")?];
        let points: Vec<[f64; 4]> = points.as_chunks::<4>().0.to_vec();
        workshop.budget.take::<[f64; 4]>(points.len(), node.file())?;
        let directions = [Direction::new(orders[0], u, counts[0]), Direction::new(orders[1], v, counts[1])];
        let [Some(u), Some(v)] = directions else { return Ok(None) };
        let is_flipped = node.child_value("FlipNormals").and_then(Value::integer) == Some(1);
        let is_whole = counts[0].checked_mul(counts[1]) == Some(points.len());
        Ok(is_whole.then_some(Surface { directions: [u, v], points, is_flipped }))
    }

    fn at(&self, u: &Weights, v: &Weights) -> DVec3 {
        let [along_u, along_v] = &self.directions;
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for (j, of_v) in v.values[..=along_v.basis.degree].iter().enumerate() {
            let row = (v.first + j) % along_v.points * along_u.points;
            for (i, of_u) in u.values[..=along_u.basis.degree].iter().enumerate() {
                let [x, y, z, weight] = self.points[row + (u.first + i) % along_u.points];
                let share = of_u * of_v * weight;
                sum += DVec3::new(x, y, z) * share;
                total += share;
            }
        }
        sum / total
    }

    fn polygons(
        &self,
        node: Node,
        name: String,
        workshop: &mut Workshop,
    ) -> Result<PolygonMesh, FormatError> {
        let pieces = self.directions.each_ref().map(|direction| direction.basis.pieces());
        let all = pieces[0] * pieces[1];
        let steps = (1..=STEPS).rev().find(|steps| all * steps * steps <= MOST).unwrap_or(1);
        let counts = pieces.map(|pieces| pieces * steps + 1);
        let count = counts[0] * counts[1];
        // For each vertex a position, coordinates, and four corners with an index and an end.
        let needed = count * (size_of::<Vec3>() + size_of::<Vec2>() + 4 * 8 + 4)
            + (counts[0] + counts[1]) * size_of::<Weights>();
        workshop.budget.take_bytes(needed as u64, node.file())?;
        let [u, v] = self.directions.each_ref().map(|direction| direction.places(steps));
        let mut positions: Vec<Vec3> = Vec::with_capacity(count);
        let mut uvs: Vec<Vec2> = Vec::with_capacity(count);
        for (j, at_v) in v.iter().enumerate() {
            for (i, at_u) in u.iter().enumerate() {
                positions.push(self.at(at_u, at_v).as_vec3());
                uvs.push(Vec2::new(i as f32 / (counts[0] - 1) as f32, j as f32 / (counts[1] - 1) as f32));
            }
        }
        let mut polygons = Polygons::with_capacity(4 * count, count);
        let mut of_corner = Vec::with_capacity(4 * count);
        let same = Same::of(&positions, counts);
        for (i, j) in (1..counts[1]).flat_map(|j| (1..counts[0]).map(move |i| (i, j))) {
            let mut corners = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)];
            if self.is_flipped {
                corners.reverse();
            }
            let start = polygons.corners.len();
            for (i, j) in corners {
                let point = same.point(i, j);
                if !polygons.corners[start..].contains(&point) {
                    polygons.corners.push(point);
                    of_corner.push((j * counts[0] + i) as i32);
                }
            }
            if polygons.corners.len() - start < 3 {
                polygons.corners.truncate(start);
                of_corner.truncate(start);
                continue;
            }
            polygons.end(start, true, || node.at(), workshop, node.file())?;
        }
        let uvs = [Layer::indexed(uvs, of_corner, Mapping::ByCorner), Layer::default()];
        Ok(PolygonMesh { name, positions, polygons, uvs, ..PolygonMesh::default() })
    }
}

impl Direction {
    fn new(order: usize, knots: Vec<f64>, points: usize) -> Option<Direction> {
        let needed = knots.len().checked_sub(order)?;
        // A closed curve has its first point again at its end, and a periodic one as many as its degree.
        let fits = points > 0 && (points..points.saturating_add(order)).contains(&needed);
        let basis = Basis::new(order.checked_sub(1)?, knots).filter(|_| fits)?;
        Some(Direction { basis, points })
    }

    /// Values and slopes of the basis functions at the parameters that divide each piece into so many steps.
    fn places(&self, steps: usize) -> Vec<Weights> {
        let ends = self.basis.ends();
        let within = |pair: &[f64]| {
            let [from, to] = [pair[0], pair[1]];
            (0..steps).map(move |i| from + (to - from) * i as f64 / steps as f64)
        };
        let all = ends.windows(2).flat_map(within).chain(ends.last().copied());
        all.map(|t| self.basis.at(t)).collect()
    }
}

/// Points of a grid that are at one place: a pole, or where the surface meets itself.
struct Same {
    counts: [usize; 2],
    /// Whether all points of the first and the last row are one, and of the first and the last column.
    is_pole: [[bool; 2]; 2],
    /// Whether the last column is the first, and the last row the first.
    is_closed: [bool; 2],
}

impl Same {
    fn of(positions: &[Vec3], counts: [usize; 2]) -> Same {
        let [nu, nv] = counts;
        let at = |i: usize, j: usize| positions[j * nu + i];
        let size = positions.iter().fold(0.0f32, |size, p| size.max(p.abs().max_element()));
        let near = |a: Vec3, b: Vec3| a.distance(b) <= 1e-6 * size;
        let row = |j: usize| (0..nu).all(|i| near(at(i, j), at(0, j)));
        let column = |i: usize| (0..nv).all(|j| near(at(i, j), at(i, 0)));
        Same {
            counts,
            is_pole: [[row(0), row(nv - 1)], [column(0), column(nu - 1)]],
            is_closed: [
                (0..nv).all(|j| near(at(0, j), at(nu - 1, j))),
                (0..nu).all(|i| near(at(i, 0), at(i, nv - 1))),
            ],
        }
    }

    /// The number of the point that stands for one of the grid.
    fn point(&self, mut i: usize, mut j: usize) -> u32 {
        let [nu, nv] = self.counts;
        let [[first_row, last_row], [first_column, last_column]] = self.is_pole;
        if (j == 0 && first_row) || (j == nv - 1 && last_row) {
            i = 0;
        }
        if (i == 0 && first_column) || (i == nu - 1 && last_column) {
            j = 0;
        }
        if i == nu - 1 && self.is_closed[0] {
            i = 0;
        }
        if j == nv - 1 && self.is_closed[1] {
            j = 0;
        }
        (j * nu + i) as u32
    }
}
