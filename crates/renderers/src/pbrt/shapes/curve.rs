//! `curve`: hair and grass as tubes of triangles, and ribbons as strips.

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::{ShapeMaker, needed_points};
use bilux_import::FormatError;
use bilux_import::geometry::tessellation::tubes::{of_bspline, raised, spine, strip, tube};
use bilux_import::input::names::unknown;
use bilux_math::glam::DVec3;

/// Subdivisions along and around a segment if there are few curves.
const FINE: (u32, u32) = (16, 8);
/// Subdivisions along and around a segment if there are many curves.
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
