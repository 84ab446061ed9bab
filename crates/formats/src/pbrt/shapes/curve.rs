//! `curve`: hair and grass as tubes of triangles, and ribbons as strips.

use super::super::document::ShapeGeometry;
use super::super::names::unknown;
use super::super::parameters::ParameterList;
use super::maker::{ShapeMaker, needed_points};
use crate::FormatError;
use bilux_math::glam::DVec3;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use std::f64::consts::TAU;

/// Subdivisions along and around a segment if there are few curves.
const FINE: (u32, u32) = (16, 8);
/// The same if there are many curves.
const COARSE: (u32, u32) = (4, 3);
/// The number of curves from which on `COARSE` applies.
const MANY: usize = 2000;

pub(super) fn make(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let points: Vec<DVec3> = needed_points(list)?.iter().map(|p| p.as_dvec3()).collect();
    let segments = segments(list, &points)?;
    let width = list.finite("width", 1.0)?;
    let widths = [list.finite("width0", width)?, list.finite("width1", width)?].map(f64::from);
    list.has("splitdepth");
    let kind = list.text("type")?.unwrap_or("flat");
    let normals = list.triples("N")?;
    let kinds = ["flat", "cylinder", "ribbon"];
    if !kinds.contains(&kind) {
        return Err(unknown("type of curves", kind, kinds, &list.place("type")));
    }
    let is_ribbon = kind == "ribbon" && normals.len() == segments.len() + 1;
    if kind == "ribbon" && !is_ribbon {
        let what = "a ribbon needs a normal at each end of its segments; without them it is rendered as a round curve";
        maker.loader.note(what, || list.place("N"));
    }
    if kind == "flat" {
        maker
            .loader
            .note("flat curves that face the viewer are rendered as round curves", || list.at.clone());
    }
    maker.cache.curves += 1;
    let (along, around) = if maker.cache.curves > MANY { COARSE } else { FINE };
    let rows = segments.len() * along as usize + 1;
    maker.loader.reading.budget.take::<[f32; 14]>(rows * (around as usize + 1), &list.at.file)?;
    let spine = spine(&segments, along);
    let mesh = if is_ribbon { strip(&spine, widths, &normals) } else { tube(&spine, widths, around) };
    maker.finished(mesh, list)
}

/// The cubic Bézier segments of a curve of any basis and degree.
fn segments(list: &ParameterList, p: &[DVec3]) -> Result<Vec<[DVec3; 4]>, FormatError> {
    let degree = list.integer("degree")?.unwrap_or(3);
    let basis = list.text("basis")?.unwrap_or("bezier");
    let bases = ["bezier", "bspline"];
    if !bases.contains(&basis) {
        return Err(unknown("basis of curves", basis, bases, &list.place("basis")));
    }
    let wrong = |wanted: String| Err(FormatError::malformed(wanted, list.place("P")));
    let step = match degree {
        2 => 2,
        3 => 3,
        other => {
            let message = format!("a curve cannot have degree {other}: write 2 or 3");
            return Err(FormatError::malformed(message, list.place("degree")));
        }
    };
    if basis == "bspline" {
        if p.len() < step + 1 {
            return wrong(format!(
                "a curve of degree {degree} has at least {} points, not {}",
                step + 1,
                p.len()
            ));
        }
        return Ok(p.windows(step + 1).map(of_bspline).collect());
    }
    if p.len() < step + 1 || !(p.len() - 1).is_multiple_of(step) {
        let message = format!(
            "a curve of degree {degree} has {} points plus a multiple of {step}, not {}",
            step + 1,
            p.len()
        );
        return wrong(message);
    }
    let first = |segment: usize| &p[segment * step..=(segment + 1) * step];
    Ok((0..(p.len() - 1) / step).map(|s| raised(first(s))).collect())
}

/// Raises a curve of degree 2 to degree 3.
fn raised(p: &[DVec3]) -> [DVec3; 4] {
    match *p {
        [a, b, c] => [a, a.lerp(b, 2.0 / 3.0), c.lerp(b, 2.0 / 3.0), c],
        [a, b, c, d] => [a, b, c, d],
        _ => [DVec3::ZERO; 4],
    }
}

/// The Bézier segment of uniform B-spline points. [Farin 2002, 8]
fn of_bspline(p: &[DVec3]) -> [DVec3; 4] {
    match *p {
        [a, b, c] => raised(&[a.midpoint(b), b, b.midpoint(c)]),
        [a, b, c, d] => {
            let (b1, b2) = (b.lerp(c, 1.0 / 3.0), b.lerp(c, 2.0 / 3.0));
            [a.lerp(b, 2.0 / 3.0).midpoint(b1), b1, b2, b2.midpoint(c.lerp(d, 1.0 / 3.0))]
        }
        _ => [DVec3::ZERO; 4],
    }
}

/// Points along a curve with unit tangents.
fn spine(segments: &[[DVec3; 4]], pieces: u32) -> Vec<(DVec3, DVec3)> {
    let mut spine: Vec<(DVec3, DVec3)> = Vec::with_capacity(segments.len() * pieces as usize + 1);
    for (s, [a, b, c, d]) in segments.iter().enumerate() {
        for i in u32::from(s > 0)..=pieces {
            let t = f64::from(i) / f64::from(pieces);
            let (ab, bc, cd) = (a.lerp(*b, t), b.lerp(*c, t), c.lerp(*d, t));
            let (abc, bcd) = (ab.lerp(bc, t), bc.lerp(cd, t));
            let before = spine.last().map_or(DVec3::Z, |(_, direction)| *direction);
            let direction = (bcd - abc).try_normalize().or((*d - *a).try_normalize()).unwrap_or(before);
            spine.push((abc.lerp(bcd, t), direction));
        }
    }
    spine
}

fn width_at(widths: [f64; 2], i: usize, count: usize) -> (f64, f64) {
    let t = i as f64 / (count - 1).max(1) as f64;
    (t, widths[0] + (widths[1] - widths[0]) * t)
}

/// Rings around the spine, with rotation-minimising frames. [Bishop 1975]
fn tube(spine: &[(DVec3, DVec3)], widths: [f64; 2], around: u32) -> Mesh {
    let mut mesh = Mesh { name: "curve".to_owned(), ..Mesh::default() };
    let mut side = spine.first().map_or(DVec3::X, |(_, direction)| direction.any_orthonormal_vector());
    for (i, (p, direction)) in spine.iter().enumerate() {
        let flat = side - *direction * direction.dot(side);
        side = flat.try_normalize().unwrap_or_else(|| direction.any_orthonormal_vector());
        let across = direction.cross(side);
        let (t, width) = width_at(widths, i, spine.len());
        for k in 0..=around {
            let (sin, cos) = sin_cos_f64(TAU * f64::from(k % around) / f64::from(around));
            let n = side * cos + across * sin;
            mesh.positions.push((*p + n * (0.5 * width)).as_vec3());
            mesh.normals.push(n.as_vec3());
            mesh.uvs.push(Vec2::new(t as f32, k as f32 / around as f32));
        }
    }
    rows(&mut mesh, spine.len() as u32, around + 1);
    // Makes the surface face outwards.
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// A flat ribbon perpendicular to its normals.
fn strip(spine: &[(DVec3, DVec3)], widths: [f64; 2], normals: &[Vec3]) -> Mesh {
    let mut mesh = Mesh { name: "curve".to_owned(), ..Mesh::default() };
    for (i, (p, direction)) in spine.iter().enumerate() {
        let (t, width) = width_at(widths, i, spine.len());
        let place = t as f32 * (normals.len() - 1) as f32;
        let k = (place as usize).min(normals.len().saturating_sub(2));
        let n = normals[k].lerp(normals[(k + 1).min(normals.len() - 1)], place - k as f32).as_dvec3();
        let across =
            n.cross(*direction).try_normalize().unwrap_or_else(|| direction.any_orthonormal_vector());
        for (v, half) in [(0.0, -0.5), (1.0, 0.5)] {
            mesh.positions.push((*p + across * (half * width)).as_vec3());
            mesh.normals.push(direction.cross(across).as_vec3());
            mesh.uvs.push(Vec2::new(t as f32, v));
        }
    }
    rows(&mut mesh, spine.len() as u32, 2);
    mesh
}

/// Connects rows of `width` points with triangles.
fn rows(mesh: &mut Mesh, count: u32, width: u32) {
    for (row, i) in (0..count.saturating_sub(1)).flat_map(|row| (0..width - 1).map(move |i| (row, i))) {
        let at = |dr: u32, di: u32| (row + dr) * width + i + di;
        let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_tube_faces_outwards() {
        let line = raised(&[DVec3::ZERO, DVec3::Z, DVec3::Z * 2.0]);
        let mesh = tube(&spine(&[line], 4), [1.0, 0.5], 8);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let outwards = ((a + b + c) / 3.0) * Vec3::new(1.0, 1.0, 0.0);
            assert!((b - a).cross(c - a).dot(outwards) > 0.0);
        }
    }

    #[test]
    fn bsplines_of_even_points_are_lines() {
        let p: Vec<DVec3> = (0..4).map(|i| DVec3::X * f64::from(i)).collect();
        let [a, _, _, d] = of_bspline(&p);
        assert!((a - DVec3::X).length() < 1e-12 && (d - DVec3::X * 2.0).length() < 1e-12);
        let [a, _, _, d] = of_bspline(&p[..3]);
        assert!((a.x - 0.5).abs() < 1e-12 && (d.x - 1.5).abs() < 1e-12);
    }
}
