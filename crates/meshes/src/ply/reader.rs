//! State that the readers of all elements of a PLY file share.

use super::body::Body;
use super::header::{Element, Property};
use bilux_import::FormatError;
use bilux_import::bytes::text::{Places, quoted};
use bilux_import::geometry::colours::Stored;
use bilux_import::geometry::normals::Smoothing;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::meshes::indexed_faces::IndexedFaces;
use bilux_math::Vec2;
use std::collections::HashMap;

/// A file while its elements are read.
pub(super) struct Ply<'a, 'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) source: &'a Source<'a>,
    pub(super) places: &'a Places<'a>,
    pub(super) body: Body<'a>,
    pub(super) indexed: IndexedFaces,
    /// All triangles, if nothing has to be welded.
    pub(super) triangles: Option<Vec<[u32; 3]>>,
    /// Edges, as pairs of vertices.
    pub(super) edges: Vec<[u32; 2]>,
    /// The opacity and the width of each vertex that is a splat.
    pub(super) splats: Option<Splats>,
    /// Stored form of the colours of faces, if there are any.
    pub(super) face_colours: Option<Stored>,
    /// The number of each face's texture.
    pub(super) face_textures: Vec<u32>,
    pub(super) has_normals: bool,
    pub(super) has_uvs: bool,
    /// Distinct texture coordinates of corners, as opposed to vertices.
    pub(super) wedge_uvs: Vec<Vec2>,
    /// The index of each of these, by its bits.
    pub(super) wedges: HashMap<[u32; 2], u32>,
    /// The smoothing of faces without normals.
    pub(super) smoothing: Smoothing,
    pub(super) diagnostics: Diagnostics,
}

/// Attributes of splats that balls do not have, by vertex.
#[derive(Default)]
pub(super) struct Splats {
    pub(super) opacities: Vec<f32>,
    pub(super) widths: Vec<f32>,
    /// Whether they have plain colours, which are kept as stored until all are known.
    pub(super) are_plain: bool,
    /// The number of scales: flat splats have two.
    pub(super) scales: usize,
}

impl Ply<'_, '_, '_> {
    pub(super) fn skip(&mut self, property: &Property) -> Result<(), FormatError> {
        let count = match property.count {
            Some(scalar) => self.body.integer(scalar)?,
            None => 1,
        };
        self.body.skip(property.scalar, count)
    }

    /// Names the properties that the picture does not show.
    pub(super) fn report_unused(&mut self, element: &Element, is_used: impl Fn(usize) -> bool) {
        let places = self.places;
        for (_, unused) in element.properties.iter().enumerate().filter(|(p, _)| !is_used(*p)) {
            let what = format!("{} of each {}", quoted(unused.name.as_bytes()), element.name);
            self.diagnostics.not_used(&what, || places.at(element.offset));
        }
    }

    pub(super) fn end_row(&mut self, start: usize) {
        if self.body.end_row() {
            let places = self.places;
            self.diagnostics.note("a line has more values than the header declares", || places.at(start));
        }
    }
}
