//! Writes points and lines with their widths.

use super::attributes::{BY_VERTEX, colours, extent};
use super::document::Look;
use super::text::{Text, push_number};
use bilux_scene::{Mesh, SceneBuilder};

/// The points and the lines of a scene have these widths.
fn widths(scene: &SceneBuilder) -> [f32; 2] {
    let widths = scene.stroke_widths.for_size(scene.bounds(0.0).extent().length());
    [widths.points, widths.lines]
}

/// Writes the points of a mesh.
pub(super) fn points(scene: &SceneBuilder, mesh: &Mesh, look: &Look, text: &mut Text) {
    let of = |i: &u32| *i as usize;
    let mesh = &Mesh {
        positions: mesh.points.iter().filter_map(|i| mesh.positions.get(of(i)).copied()).collect(),
        vertex_kd: mesh.points.iter().filter_map(|i| mesh.vertex_kd.get(of(i)).copied()).collect(),
        point_widths: mesh.points.iter().filter_map(|i| mesh.point_widths.get(of(i)).copied()).collect(),
        points: (0..mesh.points.len() as u32).collect(),
        ..Mesh::default()
    };
    extent(mesh, text);
    text.tuples("point3f[] points", mesh.positions.iter().map(|p| p.to_array()), "");
    if mesh.point_widths.is_empty() {
        constant_width(widths(scene)[0], text);
    } else {
        text.list("float[] widths", mesh.point_widths.iter().copied(), push_number, BY_VERTEX);
    }
    colours(mesh, look, text);
}

/// Writes the lines of a mesh; lines that follow each other are one curve.
pub(super) fn lines(scene: &SceneBuilder, mesh: &Mesh, look: &Look, text: &mut Text) {
    let (mut counts, mut vertices) = (Vec::new(), Vec::new());
    for &[from, to] in &mesh.lines {
        if vertices.last() == Some(&from)
            && let Some(count) = counts.last_mut()
        {
            *count += 1;
        } else {
            vertices.push(from);
            counts.push(2);
        }
        vertices.push(to);
    }
    let of = |i: &u32| *i as usize;
    let mesh = &Mesh {
        positions: vertices.iter().filter_map(|i| mesh.positions.get(of(i)).copied()).collect(),
        vertex_kd: vertices.iter().filter_map(|i| mesh.vertex_kd.get(of(i)).copied()).collect(),
        points: (0..vertices.len() as u32).collect(),
        ..Mesh::default()
    };
    extent(mesh, text);
    text.integers("int[] curveVertexCounts", counts);
    text.tuples("point3f[] points", mesh.positions.iter().map(|p| p.to_array()), "");
    text.line("uniform token type = \"linear\"");
    constant_width(widths(scene)[1], text);
    colours(mesh, look, text);
}

fn constant_width(width: f32, text: &mut Text) {
    text.list("float[] widths", [width], push_number, " (\n        interpolation = \"constant\"\n    )");
}
