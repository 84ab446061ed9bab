//! Surfaces as instances describe them.

use super::elementary::{Cone, Plane, Sphere, Torus};
use super::spline::SplineSurface;
use super::surface::Surface;
use super::swept::{Extrusion, Offset, Revolution};
use crate::curves::{curve, spline_form};
use crate::part21::Table;
use crate::structure::axes::{Axes, axes, point, vector};
use bilux_import::geometry::b_spline::{Basis, weighted};
use bilux_math::DVec3;

/// Surfaces of surfaces end here.
const MAX_DEPTH: usize = 8;

/// Unit and size with which surfaces are read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// The unit of angles, in radians.
    pub(crate) angle: f64,
    /// A distance that no part of the model is beyond.
    pub(crate) size: f64,
}

/// A surface; `None` if it is of another kind, or wrong.
pub(crate) fn surface(table: &Table, id: u64, scale: Scale) -> Option<Box<dyn Surface>> {
    at_depth(table, id, scale, 0)
}

/// A plane.
pub(crate) fn plane(axes: Axes) -> Box<dyn Surface> {
    Box::new(Plane(axes))
}

fn at_depth(table: &Table, id: u64, scale: Scale, depth: usize) -> Option<Box<dyn Surface>> {
    if depth > MAX_DEPTH {
        return None;
    }
    if let Some(spline) = spline(table, id) {
        return Some(Box::new(spline));
    }
    let values = table.simple(id)?;
    let axes = || axes(table, values.reference(1)?);
    let positive = |index: usize| values.number(index).filter(|&number| number > 0.0);
    Some(match table.kind(id) {
        b"PLANE" => Box::new(Plane(axes()?)),
        b"CYLINDRICAL_SURFACE" => Box::new(Cone::new(axes()?, positive(2)?, 0.0)?),
        b"CONICAL_SURFACE" => {
            Box::new(Cone::new(axes()?, values.number(2)?, values.number(3)? * scale.angle)?)
        }
        b"SPHERICAL_SURFACE" => Box::new(Sphere { axes: axes()?, radius: positive(2)? }),
        b"TOROIDAL_SURFACE" | b"DEGENERATE_TOROIDAL_SURFACE" => {
            let (major, minor) = (values.number(2)?, positive(3)?);
            let is_outer = values.flag(4).unwrap_or(true);
            // A ring of radius 0 is a sphere.
            (major >= 0.0).then_some(())?;
            match major {
                0.0 => Box::new(Sphere { axes: axes()?, radius: minor }),
                _ => Box::new(Torus { axes: axes()?, major, minor, is_outer }),
            }
        }
        b"SURFACE_OF_LINEAR_EXTRUSION" => {
            let (curve, along) =
                (curve(table, values.reference(1)?, scale.angle)?, vector(table, values.reference(2)?)?);
            (along != DVec3::ZERO).then_some(())?;
            Box::new(Extrusion { curve, along, size: scale.size })
        }
        b"SURFACE_OF_REVOLUTION" => {
            let curve = curve(table, values.reference(1)?, scale.angle)?;
            let axis = crate::structure::axes::axes(table, values.reference(2)?)?;
            Box::new(Revolution { curve, axes: axis, size: scale.size })
        }
        b"OFFSET_SURFACE" => {
            let basis = at_depth(table, values.reference(1)?, scale, depth + 1)?;
            Box::new(Offset { basis, distance: values.number(2)? })
        }
        // The boundary of the face trims once more.
        b"RECTANGULAR_TRIMMED_SURFACE" | b"CURVE_BOUNDED_SURFACE" => {
            return at_depth(table, values.reference(1)?, scale, depth + 1);
        }
        _ => return None,
    })
}

fn spline(table: &Table, id: u64) -> Option<SplineSurface> {
    let form = spline_form(table, id, "SURFACE", 7)?;
    let (base, at) = form.base;
    let degrees = [base.count_at(at)?, base.count_at(at + 1)?];
    let rows = base.list(at + 2)?;
    let row = rows.list(0)?.len();
    let mut points: Vec<DVec3> = Vec::new();
    for i in 0..rows.len() {
        let before = points.len();
        for id in rows.list(i)?.references() {
            points.push(point(table, id)?);
        }
        (points.len() - before == row).then_some(())?;
    }
    let counts = [rows.len(), row];
    let basis = |axis: usize| match form.knots {
        Some((values, at)) => {
            let (times, knots) = (values.list(at + axis)?.counts()?, values.list(at + 2 + axis)?.numbers()?);
            Basis::of_multiple(degrees[axis], counts[axis], &knots, &times)
        }
        None if form.is_bezier => Basis::bezier(degrees[axis], counts[axis]),
        None => Basis::uniform(degrees[axis], counts[axis], form.is_clamped),
    };
    let bases = [basis(0)?, basis(1)?];
    let weights = match form.weights {
        Some(rows) => {
            let mut all = Vec::with_capacity(points.len());
            for i in 0..rows.len() {
                all.extend(rows.list(i)?.numbers()?);
            }
            (all.len() == points.len()).then_some(all)?
        }
        None => vec![1.0; points.len()],
    };
    let all_positive = weights.iter().all(|&weight| weight > 0.0);
    let points = points.iter().zip(&weights).map(|(&p, &weight)| weighted(p, weight)).collect();
    all_positive.then(|| SplineSurface::new(bases, points))
}
