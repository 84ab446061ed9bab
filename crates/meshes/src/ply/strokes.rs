//! Vertices without faces: lines along edges, or a point cloud.

use super::header::Element;
use super::reader::Ply;
use bilux_import::FormatError;
use bilux_import::input::reading::plain_material;
use bilux_import::meshes::indexed_faces::NONE;
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::sync::Arc;

/// The names of an edge's properties.
const ENDS: [&str; 2] = ["vertex1", "vertex2"];

pub(super) fn has_both_ends(element: &Element) -> bool {
    ENDS.iter().all(|end| element.properties.iter().any(|p| p.name == *end && p.count.is_none()))
}

impl Ply<'_, '_, '_> {
    /// Reads pairs of vertices, `vertex1` and `vertex2`.
    pub(super) fn edges(&mut self, element: &Element) -> Result<(), FormatError> {
        self.report_unused(element, |p| ENDS.contains(&&*element.properties[p].name));
        for _ in 0..element.count {
            let start = self.body.offset();
            let mut ends = [NONE; 2];
            for property in &element.properties {
                let which = ENDS.iter().position(|end| *end == property.name);
                match which.filter(|_| property.count.is_none()) {
                    // An invalid index becomes one that no file has.
                    Some(end) => {
                        ends[end] = u32::try_from(self.body.integer(property.scalar)?).unwrap_or(NONE);
                    }
                    None => self.skip(property)?,
                }
            }
            self.end_row(start);
            self.reading.budget.take::<[u32; 2]>(1, self.source.name)?;
            self.edges.push(ends);
        }
        Ok(())
    }

    /// Builds a scene without faces: lines if there are edges, else a point cloud.
    pub(super) fn finish_strokes(mut self, mut scene: SceneBuilder) -> Result<SceneBuilder, FormatError> {
        let (indexed, mut lines) = (std::mem::take(&mut self.indexed), std::mem::take(&mut self.edges));
        let known = indexed.positions.len();
        if known == 0 {
            return Err(FormatError::malformed("it contains no faces and no vertices", self.places.whole()));
        }
        let given = lines.len();
        lines.retain(|ends| ends.iter().all(|&end| (end as usize) < known));
        if lines.len() < given {
            let places = self.places;
            let what = "some edges refer to vertices that the file does not have; they are left out";
            self.diagnostics.note(what, || places.whole());
        }
        self.reading.budget.take_bytes(known as u64 * 4, self.source.name)?;
        let points = if lines.is_empty() { (0..known as u32).collect() } else { Vec::new() };
        let material =
            scene.add_material(plain_material(!indexed.colours.is_empty(), !indexed.specular.is_empty()));
        let splats = self.splats.take().unwrap_or_default();
        let mesh = Mesh {
            vertex_opacity: splats.opacities,
            point_widths: splats.widths,
            name: self.source.stem(),
            positions: indexed.positions,
            uvs: indexed.uvs,
            vertex_kd: indexed.colours,
            vertex_ks: indexed.specular,
            points,
            lines,
            ..Mesh::default()
        };
        scene.objects.push(Object::new(&self.source.stem(), Arc::new(mesh), material));
        self.diagnostics.into_warnings(&mut scene);
        Ok(scene)
    }
}
