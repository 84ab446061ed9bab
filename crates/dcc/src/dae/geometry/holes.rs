//! Polygons with holes become polygons without, by bridges to the holes.

use bilux_math::{DVec2, DVec3, Vec3};

/// The most corners of a polygon with holes whose bridges are looked for.
const MAX_CORNERS: usize = 2048;

/// Number of bridges from a hole's corner that are tried, the shortest first.
const MAX_TRIED: usize = 64;

/// The corners of a polygon that runs around an outline and, over bridges, around its holes, as numbers of corners:
/// first those of the outline, then those of each hole. `None` if there are too many.
pub(super) fn bridged(outline: &[Vec3], holes: &[Vec<Vec3>]) -> Option<Vec<usize>> {
    let count = outline.len() + holes.iter().map(Vec::len).sum::<usize>();
    if count > MAX_CORNERS {
        return None;
    }
    let normal = newell(outline);
    let flat: Vec<DVec2> =
        outline.iter().chain(holes.iter().flatten()).map(|p| flattened(p.as_dvec3(), normal)).collect();
    let mut around: Vec<usize> = (0..outline.len()).collect();
    let mut rings = Vec::new();
    let mut first = outline.len();
    for hole in holes {
        let mut ring: Vec<usize> = (first..first + hole.len()).collect();
        first += hole.len();
        // A hole runs the other way round than its outline.
        if area(&ring, &flat) > 0.0 {
            ring.reverse();
        }
        rings.push(ring);
    }
    // Holes to the right first: bridges to them do not cross the others.
    let right = |ring: &[usize]| ring.iter().map(|&i| flat[i].x).fold(f64::NEG_INFINITY, f64::max);
    rings.sort_by(|a, b| right(b).total_cmp(&right(a)));
    while let Some(ring) = rings.first().cloned() {
        rings.remove(0);
        let start = (0..ring.len()).max_by(|&a, &b| flat[ring[a]].x.total_cmp(&flat[ring[b]].x))?;
        let from = flat[ring[start]];
        let mut ends: Vec<usize> = (0..around.len()).collect();
        ends.sort_by(|&a, &b| {
            let far = |i: usize| (flat[around[i]] - from).length_squared();
            far(a).total_cmp(&far(b))
        });
        let is_free = |&&end: &&usize| {
            let to = flat[around[end]];
            let loops = rings.iter().chain([&ring, &around]);
            loops.into_iter().all(|ring| !crosses(from, to, ring, &flat))
        };
        let end = ends.iter().take(MAX_TRIED).find(is_free).or(ends.first()).copied()?;
        let inside = (0..=ring.len()).map(|i| ring[(start + i) % ring.len()]);
        let bridge: Vec<usize> = inside.chain([around[end]]).collect();
        around.splice(end + 1..end + 1, bridge);
    }
    Some(around)
}

/// Twice the area of a polygon times its normal.
fn newell(points: &[Vec3]) -> DVec3 {
    bilux_import::geometry::normals::newell(points.iter().copied())
}

/// A point as seen along a normal, so that the outline is counter-clockwise.
fn flattened(p: DVec3, normal: DVec3) -> DVec2 {
    let size = normal.abs();
    if size.x >= size.y && size.x >= size.z {
        DVec2::new(p.y, p.z * normal.x.signum())
    } else if size.y >= size.z {
        DVec2::new(p.z, p.x * normal.y.signum())
    } else {
        DVec2::new(p.x, p.y * normal.z.signum())
    }
}

/// Twice the area that a ring encloses; negative if it runs clockwise.
fn area(ring: &[usize], flat: &[DVec2]) -> f64 {
    (0..ring.len()).map(|i| flat[ring[i]].perp_dot(flat[ring[(i + 1) % ring.len()]])).sum()
}

/// True if a segment crosses an edge of a ring other than at their ends.
fn crosses(from: DVec2, to: DVec2, ring: &[usize], flat: &[DVec2]) -> bool {
    (0..ring.len()).any(|i| {
        let (a, b) = (flat[ring[i]], flat[ring[(i + 1) % ring.len()]]);
        let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
        side(from, to, a) * side(from, to, b) < 0.0 && side(a, b, from) * side(a, b, to) < 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(at: f32, size: f32) -> Vec<Vec3> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| Vec3::new(at + size * x, at + size * y, 0.0))
            .to_vec()
    }

    #[test]
    fn the_area_of_holes_is_missing() {
        for turned in [false, true] {
            let outline = square(0.0, 10.0);
            let mut holes = vec![square(1.0, 2.0), square(5.0, 3.0)];
            if turned {
                holes.iter_mut().for_each(|hole| hole.reverse());
            }
            let around = bridged(&outline, &holes).unwrap();
            let all: Vec<Vec3> = outline.iter().chain(holes.iter().flatten()).copied().collect();
            let polygon: Vec<Vec3> = around.iter().map(|&corner| all[corner]).collect();
            assert_eq!(newell(&polygon), DVec3::new(0.0, 0.0, 2.0 * (100.0 - 4.0 - 9.0)));
            let mut triangles = Vec::new();
            bilux_import::geometry::polygon::Triangulator::default()
                .triangulate(polygon.iter().copied(), |t| triangles.push(t))
                .unwrap();
            let cover: f64 =
                triangles.iter().map(|t| newell(&t.map(|corner| polygon[corner as usize])).length()).sum();
            assert_eq!(cover, 2.0 * 87.0, "no triangle covers a hole");
        }
    }
}
