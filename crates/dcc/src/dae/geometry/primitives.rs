//! The forms in which files list polygons, each as corners that follow each other.

use super::builder::Builder;
use super::holes::bridged;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::Workshop;

/// A list of polygons with what its vertices refer to.
pub(super) struct Primitive<'d> {
    pub(super) element: Element<'d>,
    /// The number of indices of a vertex.
    pub(super) stride: usize,
}

/// The forms that have lines: pairs of vertices, and vertices in a row.
pub(super) const LINES: [&str; 2] = ["lines", "linestrips"];

/// The forms that have surfaces.
pub(super) const SURFACES: [&str; 5] = ["triangles", "polylist", "polygons", "trifans", "tristrips"];

impl Primitive<'_> {
    /// Adds its polygons to a mesh.
    pub(super) fn add(&self, builder: &mut Builder, workshop: &mut Workshop) -> Result<(), FormatError> {
        match self.element.name() {
            "triangles" => self.triangles(builder, workshop),
            "polylist" => self.polylist(builder, workshop),
            "trifans" | "tristrips" => self.strips(builder, workshop),
            _ => self.polygons(builder, workshop),
        }
    }

    /// The indices of one list.
    fn indices(&self, list: Element, workshop: &mut Workshop) -> Result<Vec<i32>, FormatError> {
        list.numbers(workshop.budget)
    }

    fn triangles(&self, builder: &mut Builder, workshop: &mut Workshop) -> Result<(), FormatError> {
        // Several lists are no standard, but their meaning is clear.
        for list in self.element.children_named("p") {
            let indices = self.indices(list, workshop)?;
            let whole = indices.chunks_exact(3 * self.stride);
            if !whole.remainder().is_empty() {
                let what = "a list of triangles ends within a triangle, which is left out";
                workshop.diagnostics.note(what, || list.at());
            }
            for triangle in whole {
                builder.polygon(triangle.chunks_exact(self.stride), list, workshop)?;
            }
            workshop.budget.release(4 * indices.len() as u64);
        }
        Ok(())
    }

    fn polylist(&self, builder: &mut Builder, workshop: &mut Workshop) -> Result<(), FormatError> {
        let Some(counts) = self.element.child("vcount") else { return Ok(()) };
        let counts: Vec<i32> = counts.numbers(workshop.budget)?;
        let Some(list) = self.element.child("p") else { return Ok(()) };
        let indices = self.indices(list, workshop)?;
        let mut rest = &indices[..];
        for &count in &counts {
            let needed = usize::try_from(count).ok().and_then(|count| count.checked_mul(self.stride));
            let Some((polygon, after)) = needed.and_then(|needed| rest.split_at_checked(needed)) else {
                let what = "a list of polygons has fewer indices than it says; the rest is left out";
                workshop.diagnostics.note(what, || list.at());
                break;
            };
            builder.polygon(polygon.chunks_exact(self.stride), list, workshop)?;
            rest = after;
        }
        workshop.budget.release(4 * (indices.len() + counts.len()) as u64);
        Ok(())
    }

    fn strips(&self, builder: &mut Builder, workshop: &mut Workshop) -> Result<(), FormatError> {
        let is_fan = self.element.name() == "trifans";
        for list in self.element.children_named("p") {
            let indices = self.indices(list, workshop)?;
            let vertices: Vec<&[i32]> = indices.chunks_exact(self.stride).collect();
            for i in 2..vertices.len() {
                let [a, b] = match (is_fan, i % 2) {
                    (true, _) => [0, i - 1],
                    // Every other triangle of a strip runs the other way round.
                    (false, 0) => [i - 2, i - 1],
                    _ => [i - 1, i - 2],
                };
                builder.polygon([a, b, i].map(|i| vertices[i]).into_iter(), list, workshop)?;
            }
            workshop.budget.release(4 * indices.len() as u64);
        }
        Ok(())
    }

    fn polygons(&self, builder: &mut Builder, workshop: &mut Workshop) -> Result<(), FormatError> {
        for list in self.element.children() {
            match list.name() {
                "p" => {
                    let indices = self.indices(list, workshop)?;
                    builder.polygon(indices.chunks_exact(self.stride), list, workshop)?;
                    workshop.budget.release(4 * indices.len() as u64);
                }
                "ph" => self.with_holes(list, builder, workshop)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn with_holes(
        &self,
        element: Element,
        builder: &mut Builder,
        workshop: &mut Workshop,
    ) -> Result<(), FormatError> {
        let Some(outline) = element.child("p") else { return Ok(()) };
        let outline = self.indices(outline, workshop)?;
        let mut holes = Vec::new();
        for hole in element.children_named("h") {
            workshop.budget.take::<Vec<i32>>(1, element.file())?;
            holes.push(self.indices(hole, workshop)?);
        }
        let points = |list: &[i32]| {
            list.chunks_exact(self.stride).map(|vertex| builder.position(vertex)).collect::<Option<Vec<_>>>()
        };
        let around = points(&outline).zip(holes.iter().map(|hole| points(hole)).collect::<Option<Vec<_>>>());
        let around = around.and_then(|(outline, holes)| bridged(&outline, &holes));
        let Some(around) = around else {
            let what =
                "the holes of a polygon are filled: it has too many corners, or some that do not exist";
            workshop.diagnostics.note(what, || element.at());
            return builder.polygon(outline.chunks_exact(self.stride), element, workshop);
        };
        let vertices: Vec<&[i32]> =
            [&outline].into_iter().chain(&holes).flat_map(|list| list.chunks_exact(self.stride)).collect();
        builder.polygon(around.into_iter().map(|corner| vertices[corner]), element, workshop)
    }
}
