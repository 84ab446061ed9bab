//! Curves with a radius at each point, in a file of lines: x, y, z and the radius; an empty line begins another curve.

use super::maker::{Piece, ShapeMaker};
use crate::mitsuba::plugin::Plugin;
use crate::mitsuba::values::numbers;
use bilux_import::FormatError;
use bilux_import::geometry::tessellation::tubes::{of_bspline, spine, tube_of_widths};
use bilux_math::DMat4;
use bilux_math::glam::DVec3;
use bilux_scene::Mesh;
use std::rc::Rc;

/// Subdivisions along and around a segment if there are few segments, and if there are many.
const FINE: (u32, u32) = (8, 12);
const COARSE: (u32, u32) = (2, 4);
const MANY: usize = 5000;

/// The control points of a curve, each with its radius.
type Strand = Vec<(DVec3, f64)>;

pub(super) fn bspline(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    make(maker, plugin, 3)
}

pub(super) fn linear(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    make(maker, plugin, 1)
}

/// Hair of version 0.5: straight pieces of one radius.
pub(super) fn hair(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    plugin.ignore(&["angle_threshold", "reduction"]);
    make(maker, plugin, 1)
}

fn make(maker: &mut ShapeMaker, plugin: &Rc<Plugin>, degree: usize) -> Result<Vec<Piece>, FormatError> {
    let (name, at) = plugin.file()?;
    let even = plugin.number_or("radius", 0.025)?;
    let (path, _) = maker.maker.files().locate(name, &at, maker.maker.reading)?;
    let reading = &mut *maker.maker.reading;
    let bytes = reading.load_text(&path)?;
    if bytes.starts_with(b"BINARY_HAIR") || bytes.starts_with(b"HAIR") {
        let message = format!("'{name}' is a binary file of hair, which is not read: export it as text");
        return Err(FormatError::malformed(message, at));
    }
    reading.budget.take_bytes(8 * bytes.len() as u64, &at.file)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut strands: Vec<Strand> = vec![Vec::new()];
    for line in text.lines() {
        let words = numbers(line.split('#').next().unwrap_or_default(), "filename", &at)?;
        match *words.as_slice() {
            [] => strands.push(Vec::new()),
            [x, y, z] => strands.last_mut().unwrap_or(&mut Vec::new()).push((DVec3::new(x, y, z), even)),
            [x, y, z, r] => strands.last_mut().unwrap_or(&mut Vec::new()).push((DVec3::new(x, y, z), r)),
            ref other => {
                let message =
                    format!("a line of '{name}' has {} numbers: it takes x, y, z and a radius", other.len());
                return Err(FormatError::malformed(message, at));
            }
        }
    }
    drop(text);
    // Radii are those of the world.
    let mut placement = plugin.placement("to_world")?.as_deref().cloned().unwrap_or_default();
    if placement.0.len() == 1 {
        let matrix = std::mem::take(&mut placement).start();
        strands.iter_mut().flatten().for_each(|(point, _)| *point = matrix.transform_point3(*point));
    }
    reading.release(bytes);
    let count: usize = strands.iter().map(Vec::len).sum();
    let (along, around) = if count > MANY { COARSE } else { FINE };
    let along = if degree == 1 { 1 } else { along };
    let vertices = (2 * count * along as usize + strands.len()) * (around as usize + 1);
    reading.budget.take::<[f32; 14]>(vertices, &at.file)?;
    let mut mesh = Mesh { name: "curves".to_owned(), ..Mesh::default() };
    for strand in strands.iter().filter(|strand| strand.len() > degree) {
        if degree == 1 {
            // Each piece is round up to its ends.
            strand.windows(2).for_each(|ends| append(&mut mesh, tube_of(ends, degree, along, around)));
        } else {
            append(&mut mesh, tube_of(strand, degree, along, around));
        }
    }
    let flips = plugin.flag("flip_normals", false)?;
    let mesh = maker.finished(mesh, flips, plugin)?;
    Ok(maker.placed_by(plugin, vec![mesh], &DMat4::IDENTITY, placement))
}

fn tube_of(strand: &[(DVec3, f64)], degree: usize, along: u32, around: u32) -> Mesh {
    let point = |i: usize| strand[i].0;
    let segments: Vec<[DVec3; 4]> = match degree {
        1 => (1..strand.len()).map(|i| straight(point(i - 1), point(i))).collect(),
        _ => strand.windows(4).map(|w| of_bspline(&[w[0].0, w[1].0, w[2].0, w[3].0])).collect(),
    };
    let width = |i: usize| {
        let place = i as f64 / f64::from(along);
        let (k, t) = (place.floor() as usize, place.fract());
        if degree == 1 {
            let next = strand[(k + 1).min(strand.len() - 1)].1;
            return 2.0 * (strand[k].1 + (next - strand[k].1) * t);
        }
        // The radius follows the same spline as the points. [Farin 2002, 8]
        let k = k.min(strand.len() - 4);
        let t = place - k as f64;
        let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
        let weights = [s * s * s, 3.0 * t3 - 6.0 * t2 + 4.0, -3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0, t3];
        (0..4).map(|j| weights[j] * strand[k + j].1).sum::<f64>() / 3.0
    };
    tube_of_widths(&spine(&segments, along), width, around)
}

fn straight(a: DVec3, b: DVec3) -> [DVec3; 4] {
    [a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b]
}

fn append(mesh: &mut Mesh, more: Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(more.positions);
    mesh.normals.extend(more.normals);
    mesh.uvs.extend(more.uvs);
    mesh.triangles.extend(more.triangles.into_iter().map(|t| t.map(|i| i + first)));
}
