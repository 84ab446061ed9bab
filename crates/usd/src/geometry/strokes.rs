//! Points, and curves as tubes.

use crate::geometry::primvars::{Interpolation, Place, Primvar};
use crate::stage::Stage;
use crate::stage::context::{Context, Worn};
use bilux_import::FormatError;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Vec3};
use bilux_scene::Mesh;
use std::f32::consts::TAU;

/// Sides of a tube.
const SIDES: u32 = 6;
/// Straight pieces of a cubic segment.
const PIECES: usize = 8;

/// Spheres of a prim `Points`.
pub(crate) fn points(
    stage: &Stage,
    prim: u32,
    worn: &Worn,
    scene: &mut Context,
) -> Result<Mesh, FormatError> {
    let budget = &mut scene.reading.budget;
    let Some(points) = stage.array(prim, "points", budget)? else { return Ok(Mesh::default()) };
    budget.take_bytes(36 * points.len() as u64, &stage.layers[0].name)?;
    let positions = crate::geometry::meshes::points(&points);
    let widths = widths(stage, prim, scene)?;
    let colours = colours(stage, prim, worn, scene)?;
    let place = |i: usize| Place { corner: i, vertex: i, face: 0 };
    let all = 0..positions.len();
    let width = |i: usize| widths.as_ref().map_or(1.0, |widths| widths.at::<1>(place(i))[0]);
    Ok(Mesh {
        point_widths: all.clone().map(width).collect(),
        vertex_kd: colours
            .iter()
            .flat_map(|c| all.clone().map(|i| Rgb::from_array(c.at::<3>(place(i)))))
            .collect(),
        points: all.map(|i| i as u32).collect(),
        positions,
        ..Mesh::default()
    })
}

fn widths(stage: &Stage, prim: u32, scene: &mut Context) -> Result<Option<Primvar>, FormatError> {
    let budget = &mut scene.reading.budget;
    let found = Primvar::read(stage, prim, "primvars:widths", Interpolation::Vertex, budget)?;
    let found = match found {
        Some(found) => Some(found),
        None => Primvar::read(stage, prim, "widths", Interpolation::Vertex, budget)?,
    };
    // One width is for all, whatever the file says.
    Ok(found.map(|widths| match widths.values.len() {
        1 => Primvar { interpolation: Interpolation::Constant, ..widths },
        _ => widths,
    }))
}

fn colours(
    stage: &Stage,
    prim: u32,
    worn: &Worn,
    scene: &mut Context,
) -> Result<Option<Primvar>, FormatError> {
    if !worn.uses_colours {
        return Ok(None);
    }
    let budget = &mut scene.reading.budget;
    Primvar::read(stage, prim, "primvars:displayColor", Interpolation::Constant, budget)
}

/// Weights of four control points at a parameter, by basis.
fn weights(basis: &str, t: f32) -> [f32; 4] {
    let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
    match basis {
        "bspline" => [
            s * s * s / 6.0,
            (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0,
            (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0,
            t3 / 6.0,
        ],
        "catmullRom" => [
            0.5 * (-t3 + 2.0 * t2 - t),
            0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
            0.5 * (-3.0 * t3 + 4.0 * t2 + t),
            0.5 * (t3 - t2),
        ],
        _ => [s * s * s, 3.0 * s * s * t, 3.0 * s * t2, t3],
    }
}

/// Course of the curves of a prim between their control points.
struct Curves {
    is_cubic: bool,
    basis: String,
    is_periodic: bool,
    is_pinned: bool,
}

/// Tubes of `BasisCurves`, and of `NurbsCurves` as polygons of their control points.
pub(crate) fn curves(
    stage: &Stage,
    prim: u32,
    worn: &Worn,
    scene: &mut Context,
) -> Result<Mesh, FormatError> {
    let budget = &mut scene.reading.budget;
    let mut mesh = Mesh::default();
    let Some(points) = stage.array(prim, "points", budget)? else { return Ok(mesh) };
    let Some(counts) = stage.array(prim, "curveVertexCounts", budget)? else { return Ok(mesh) };
    let is_nurbs = &*stage.prim(prim).type_name == "NurbsCurves";
    let is = |text: Option<_>, wanted: &str| text.as_deref().map(|t: &str| t == wanted);
    let wrap = stage.text(prim, "wrap", budget)?;
    let curves = Curves {
        is_cubic: !is_nurbs && is(stage.text(prim, "type", budget)?, "linear") != Some(true),
        basis: stage.text(prim, "basis", budget)?.as_deref().unwrap_or("bezier").to_owned(),
        is_periodic: is(wrap.clone(), "periodic") == Some(true),
        is_pinned: is(wrap, "pinned") == Some(true),
    };
    if is_nurbs {
        let what = "NURBS curves are drawn as straight lines between their control points";
        scene.sink.diagnostics.note(what, || stage.at(prim));
    }
    let widths = widths(stage, prim, scene)?;
    let colours = colours(stage, prim, worn, scene)?;
    let positions = crate::geometry::meshes::points(&points);
    let mut first = 0;
    for curve in 0..counts.len() {
        let count = counts.numbers.at(curve).max(0.0) as usize;
        let Some(controls) = positions.get(first..first + count) else { break };
        let line = curves.line(controls);
        let pieces = line.len() as u64 * u64::from(SIDES);
        scene.reading.budget.take_bytes(pieces * 60, &stage.layers[0].name)?;
        let place = |at: f32| {
            let vertex = first + (at.round() as usize).min(count.saturating_sub(1));
            Place { corner: vertex, vertex, face: curve }
        };
        let sides = |at: f32| widths.as_ref().map_or(1.0, |widths| widths.at::<1>(place(at))[0]);
        let colour = |at: f32| colours.as_ref().map(|list| Rgb::from_array(list.at::<3>(place(at))));
        tube(&line, &sides, &colour, &mut mesh);
        first += count;
    }
    Ok(mesh)
}

impl Curves {
    /// Points along a curve, each with its place among the control points.
    fn line(&self, controls: &[Vec3]) -> Vec<(Vec3, f32)> {
        let count = controls.len();
        if !self.is_cubic || count < 4 {
            let closing = self.is_periodic && count > 2;
            let all = controls.iter().enumerate().map(|(i, p)| (*p, i as f32));
            return all.chain(closing.then(|| (controls[0], 0.0))).collect();
        }
        let is_bezier = self.basis == "bezier";
        let step = if is_bezier { 3 } else { 1 };
        let at = |i: isize| -> Vec3 {
            let last = count as isize - 1;
            match i {
                _ if self.is_periodic => controls[i.rem_euclid(count as isize) as usize],
                // Pinned curves reach their ends by points beyond them.
                -1 => controls[0] * 2.0 - controls[1],
                i if i > last => controls[last as usize] * 2.0 - controls[last as usize - 1],
                i => controls[i.max(0) as usize],
            }
        };
        let start = if self.is_pinned && !is_bezier { -1 } else { 0 };
        let segments = match (self.is_periodic, is_bezier) {
            (true, _) => count / step,
            (false, true) => (count - 1) / 3,
            (false, false) if self.is_pinned => count - 1,
            (false, false) => count - 3,
        };
        let mut line = Vec::with_capacity(segments * PIECES + 1);
        for segment in 0..segments {
            let first = start + (segment * step) as isize;
            let controls = [0, 1, 2, 3].map(|k| at(first + k));
            let pieces = if segment + 1 == segments { PIECES + 1 } else { PIECES };
            for piece in 0..pieces {
                let t = piece as f32 / PIECES as f32;
                let sum = weights(&self.basis, t).into_iter().zip(controls).map(|(w, p)| p * w).sum();
                let middle = if is_bezier { 3.0 * t } else { 1.0 + t };
                line.push((sum, first as f32 + middle));
            }
        }
        line
    }
}

/// A tube along a line, open at its ends.
fn tube(
    line: &[(Vec3, f32)],
    width: &dyn Fn(f32) -> f32,
    colour: &dyn Fn(f32) -> Option<Rgb>,
    mesh: &mut Mesh,
) {
    let mut side = Vec3::ZERO;
    let first = mesh.positions.len() as u32;
    for (i, &(point, at)) in line.iter().enumerate() {
        let (before, after) = (line[i.saturating_sub(1)].0, line[(i + 1).min(line.len() - 1)].0);
        let along = (after - before).normalize_or(Vec3::Z);
        // The sides turn as little as they can.
        side = (side - along * side.dot(along))
            .try_normalize()
            .unwrap_or_else(|| along.any_orthonormal_vector());
        let other = along.cross(side);
        for k in 0..SIDES {
            let (sin, cos) = sin_cos(k as f32 / SIDES as f32 * TAU);
            let normal = side * cos + other * sin;
            mesh.positions.push(point + normal * (0.5 * width(at)));
            mesh.normals.push(normal);
            mesh.vertex_kd.extend(colour(at));
        }
    }
    for ring in 0..line.len().saturating_sub(1) as u32 {
        for k in 0..SIDES {
            let (this, next) = (first + ring * SIDES + k, first + ring * SIDES + (k + 1) % SIDES);
            mesh.triangles.extend([[this, next, next + SIDES], [this, next + SIDES, this + SIDES]]);
        }
    }
}
