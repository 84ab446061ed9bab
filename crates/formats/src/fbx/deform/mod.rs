//! What deforms meshes: blend shapes, and skins on bones.

mod shapes;
mod skin;

use super::document::{Document, Index, display_name};

use super::graph::{Graph, Placed};
use super::posed::Posed;
use crate::FormatError;
use crate::polygon_mesh::{PolygonMesh, Workshop};

/// The deformers of a mesh.
pub(super) struct Deformers<'d> {
    skins: Vec<Index>,
    /// Files with the positions of points over time, which are not read.
    caches: Vec<Index>,
    shapes: Vec<shapes::Channel<'d>>,
}

impl<'d> Deformers<'d> {
    /// Those of a mesh.
    pub(super) fn of(geometry: Index, posed: &Posed<'d>) -> Deformers<'d> {
        let document = posed.document;
        let of_kind = |kind: &'static [u8]| {
            let deformers = document.sources_of_class(geometry, "Deformer");
            deformers.filter(move |&index| document.object(index).kind == kind)
        };
        let mut channels: Vec<shapes::Channel> =
            of_kind(b"BlendShape").flat_map(|shape| shapes::channels(shape, posed)).collect();
        channels.extend(shapes::old_channels(geometry, posed));
        channels.retain(|channel| channel.percent != 0.0);
        Deformers {
            skins: of_kind(b"Skin").collect(),
            caches: of_kind(b"VertexCacheDeformer").collect(),
            shapes: channels,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.skins.is_empty() && self.shapes.is_empty()
    }

    /// True if a skin moves the mesh to world space.
    pub(super) fn has_skin(&self) -> bool {
        !self.skins.is_empty()
    }

    /// Deforms a mesh as it is on a node.
    pub(super) fn apply(
        &self,
        geometry: &mut PolygonMesh,
        placed: &Placed,
        posed: &Posed,
        graph: &Graph,
        workshop: &mut Workshop,
    ) -> Result<(), FormatError> {
        for &cache in &self.caches {
            let at = posed.document.object(cache).node;
            workshop.oddities.not_shown("caches of points", || at.at());
        }
        let mut turns = Vec::new();
        for channel in &self.shapes {
            channel.add(geometry, &mut turns, workshop)?;
        }
        if !turns.is_empty() {
            let file = posed.document.file();
            geometry.turn_normals(workshop, file, |normal, vertex| {
                (normal + turns[vertex]).normalize_or_zero()
            })?;
        }
        if let Some(&first) = self.skins.first() {
            if self.skins.len() > 1 {
                let at = posed.document.object(first).node;
                workshop.oddities.not_shown("second skins of meshes", || at.at());
            }
            skin::bend(first, geometry, placed, posed, graph, workshop)?;
        }
        Ok(())
    }
}

/// The names of the skins of a document.
pub(super) fn skin_names(document: &Document) -> Vec<String> {
    let skins = document
        .indices()
        .filter(|&index| document.class(index) == b"Deformer" && document.object(index).kind == b"Skin");
    skins.map(|index| display_name(document.object(index).name)).collect()
}
