//! Curves as instances describe them.

use super::conic::{Ellipse, Hyperbola, Line, Parabola};
use super::curve::Curve;
use super::spline::{Polyline, Spline};
use super::trimmed::{Composite, Trimmed};
use crate::part21::{Table, Values};
use crate::structure::axes::{axes, point, vector};
use bilux_import::geometry::b_spline::{Basis, weighted};
use bilux_math::DVec3;

/// Curves of curves end here.
const MAX_DEPTH: usize = 16;

/// The most curves that one consists of, together.
const MAX_PARTS: usize = 1 << 14;

/// A curve; `None` if it is of another kind, or wrong. `unit` is that of angles, in radians.
pub(crate) fn curve(table: &Table, id: u64, unit: f64) -> Option<Box<dyn Curve>> {
    at_depth(table, id, unit, 0, &mut 0)
}

fn at_depth(table: &Table, id: u64, unit: f64, depth: usize, parts: &mut usize) -> Option<Box<dyn Curve>> {
    *parts += 1;
    if depth > MAX_DEPTH || *parts > MAX_PARTS {
        return None;
    }
    if let Some(spline) = spline(table, id) {
        return Some(Box::new(spline));
    }
    let values = table.simple(id);
    let mut inner = |id: u64| at_depth(table, id, unit, depth + 1, parts);
    match table.kind(id) {
        b"LINE" => {
            let values = values?;
            let (origin, along) = (point(table, values.reference(1)?)?, vector(table, values.reference(2)?)?);
            (along != DVec3::ZERO).then(|| Box::new(Line { origin, along }) as _)
        }
        b"CIRCLE" => conic(table, values?, unit, false),
        b"ELLIPSE" => conic(table, values?, unit, true),
        b"PARABOLA" => {
            let (axes, focal) = (axes(table, values?.reference(1)?)?, values?.number(2)?);
            (focal > 0.0).then(|| Box::new(Parabola { axes, focal }) as _)
        }
        b"HYPERBOLA" => {
            let (axes, radii) =
                (axes(table, values?.reference(1)?)?, [values?.number(2)?, values?.number(3)?]);
            (radii[0] > 0.0 && radii[1] > 0.0).then(|| Box::new(Hyperbola { axes, radii }) as _)
        }
        b"POLYLINE" => {
            let points: Option<Vec<DVec3>> = values?.references_at(1).map(|id| point(table, id)).collect();
            points.filter(|points| points.len() > 1).map(|points| Box::new(Polyline(points)) as _)
        }
        // The curve in space; those in the parameters of surfaces are not used.
        b"SURFACE_CURVE" | b"SEAM_CURVE" | b"INTERSECTION_CURVE" | b"BOUNDED_SURFACE_CURVE" => {
            inner(values?.reference(1)?)
        }
        b"TRIMMED_CURVE" => trimmed(table, values?, inner(values?.reference(1)?)?),
        b"COMPOSITE_CURVE" | b"COMPOSITE_CURVE_ON_SURFACE" | b"BOUNDARY_CURVE" | b"OUTER_BOUNDARY_CURVE" => {
            let mut parts = Vec::new();
            for segment in values?.references_at(1) {
                let segment = table.part(segment, "COMPOSITE_CURVE_SEGMENT")?;
                let part = inner(segment.reference(2)?)?;
                part.range().iter().all(|t| t.is_finite()).then_some(())?;
                parts.push((part, segment.flag(1).unwrap_or(true)));
            }
            (!parts.is_empty()).then(|| Box::new(Composite { parts }) as _)
        }
        _ => match table.part(id, "SURFACE_CURVE") {
            Some(of_several) => inner(of_several.reference(0)?),
            None => None,
        },
    }
}

fn conic(table: &Table, values: Values, unit: f64, is_ellipse: bool) -> Option<Box<dyn Curve>> {
    let (axes, first) = (axes(table, values.reference(1)?)?, values.number(2)?);
    let second = if is_ellipse { values.number(3)? } else { first };
    (first > 0.0 && second > 0.0).then(|| Box::new(Ellipse { axes, radii: [first, second], unit }) as _)
}

/// A trimmed curve: each end is a parameter, a point, or both.
fn trimmed(table: &Table, values: Values, basis: Box<dyn Curve>) -> Option<Box<dyn Curve>> {
    let prefers_points = values.name(5) == Some(b"CARTESIAN");
    let end = |index: usize| {
        let list = values.list(index)?;
        let parameter = (0..list.len()).find_map(|i| list.number(i));
        let place = list.references().find_map(|id| point(table, id)).map(|p| basis.parameter(p));
        if prefers_points { place.or(parameter) } else { parameter.or(place) }
    };
    let (from, mut to) = (end(2)?, end(3)?);
    let is_forward = values.flag(4).unwrap_or(true);
    if let Some(period) = basis.period() {
        let turns = if is_forward {
            ((from - to) / period).floor() + 1.0
        } else {
            ((from - to) / period).ceil() - 1.0
        };
        // Ends at the same place are a whole turn.
        to += turns * period;
    }
    (from.is_finite() && to.is_finite() && from != to).then(|| Box::new(Trimmed { basis, from, to }) as _)
}

/// The parameters that B-spline curves and surfaces of all forms have.
pub(crate) struct SplineForm<'a> {
    /// The parameters of B_SPLINE_CURVE or B_SPLINE_SURFACE, from the degree on.
    pub(crate) base: (Values<'a>, usize),
    /// Multiplicities and knots begin here; `None` for forms without them.
    pub(crate) knots: Option<(Values<'a>, usize)>,
    pub(crate) weights: Option<Values<'a>>,
    pub(crate) is_bezier: bool,
    pub(crate) is_clamped: bool,
}

/// The form of a B-spline `CURVE` or `SURFACE`, whose base has so many parameters.
pub(crate) fn spline_form<'a>(
    table: &'a Table,
    id: u64,
    what: &str,
    base_count: usize,
) -> Option<SplineForm<'a>> {
    let name = |form: &str| format!("{form}_{what}");
    let is = |form: &str| table.is(id, &name(form));
    let with_knots = format!("B_SPLINE_{what}_WITH_KNOTS");
    let weights = table.part(id, &format!("RATIONAL_B_SPLINE_{what}"));
    let (is_bezier, is_clamped) = (is("BEZIER"), is("QUASI_UNIFORM"));
    if let Some(base) = table.part(id, &format!("B_SPLINE_{what}")).filter(|_| table.simple(id).is_none()) {
        let knots = table.part(id, &with_knots).map(|values| (values, 0));
        let weights = weights.and_then(|values| values.list(0));
        return Some(SplineForm { base: (base, 0), knots, weights, is_bezier, is_clamped });
    }
    // A simple instance has its name first, then all parameters in a row.
    let values = table.simple(id)?;
    let has_knots = table.kind(id) == with_knots.as_bytes();
    let is_known = has_knots || is_bezier || is_clamped || is("UNIFORM");
    let knots = has_knots.then_some((values, 1 + base_count));
    is_known.then_some(SplineForm { base: (values, 1), knots, weights: None, is_bezier, is_clamped })
}

fn spline(table: &Table, id: u64) -> Option<Spline> {
    let form = spline_form(table, id, "CURVE", 5)?;
    let (base, at) = form.base;
    let degree = base.count_at(at)?;
    let points: Option<Vec<DVec3>> = base.references_at(at + 1).map(|id| point(table, id)).collect();
    let points = points?;
    let basis = match form.knots {
        Some((values, at)) => Basis::of_multiple(
            degree,
            points.len(),
            &values.list(at + 1)?.numbers()?,
            &values.list(at)?.counts()?,
        )?,
        None if form.is_bezier => Basis::bezier(degree, points.len())?,
        None => Basis::uniform(degree, points.len(), form.is_clamped)?,
    };
    let weights = match form.weights {
        Some(weights) => weights.numbers().filter(|all| all.len() == points.len())?,
        None => vec![1.0; points.len()],
    };
    let all_positive = weights.iter().all(|&weight| weight > 0.0);
    let points = points.iter().zip(&weights).map(|(&p, &weight)| weighted(p, weight)).collect();
    all_positive.then(|| Spline::new(basis, points))
}
