//! Deformers of meshes: blend shapes, and skins on bones; or a cache in place of both.

mod shapes;
mod skin;

use super::caches::Cached;
use super::document::{Document, Index, display_name};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_import::meshes::polygon_mesh::{Layer, Mapping, PolygonMesh, Workshop};

/// The deformers of a mesh.
pub(super) struct Deformers<'d> {
    skins: Vec<Index>,
    cached: Option<Cached>,
    shapes: Vec<shapes::Channel<'d>>,
}

impl<'d> Deformers<'d> {
    /// Deformers of a mesh.
    pub(super) fn of(
        geometry: Index,
        posed: &Posed<'d>,
        reading: &mut Reading,
        diagnostics: &mut Diagnostics,
    ) -> Result<Deformers<'d>, FormatError> {
        let document = posed.document;
        let cached = Cached::read(geometry, posed, reading, diagnostics)?;
        if cached.is_some() {
            return Ok(Deformers { skins: Vec::new(), shapes: Vec::new(), cached });
        }
        let of_kind = |kind: &'static [u8]| {
            let deformers = document.sources_of_class(geometry, "Deformer");
            deformers.filter(move |&index| document.object(index).kind == kind)
        };
        let mut channels: Vec<shapes::Channel> =
            of_kind(b"BlendShape").flat_map(|shape| shapes::channels(shape, posed)).collect();
        channels.extend(shapes::old_channels(geometry, posed));
        channels.retain(|channel| channel.percent != 0.0);
        Ok(Deformers { skins: of_kind(b"Skin").collect(), shapes: channels, cached })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.skins.is_empty() && self.shapes.is_empty() && self.cached.is_none()
    }

    /// The memory of what is cached.
    pub(super) fn bytes(&self) -> u64 {
        self.cached.as_ref().map_or(0, Cached::bytes)
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
        if let Some(cached) = &self.cached {
            return put(cached, geometry, workshop, posed.document.file());
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
                workshop.diagnostics.not_shown("second skins of meshes", || at.at());
            }
            skin::bend(first, geometry, placed, posed, graph, workshop)?;
        }
        Ok(())
    }
}

/// Puts a mesh where its cache says.
fn put(
    cached: &Cached,
    geometry: &mut PolygonMesh,
    workshop: &mut Workshop,
    file: &str,
) -> Result<(), FormatError> {
    geometry.positions.iter_mut().zip(&cached.positions).for_each(|(to, from)| *to = *from);
    let count = cached.normals.len();
    if count == 0 {
        return geometry.renew_normals(workshop, file);
    }
    workshop.budget.take_bytes(size_of_val(&cached.normals[..]) as u64, file)?;
    let is_of_points = count == geometry.positions.len() && count != geometry.polygons.corners.len();
    let mapping = if is_of_points { Mapping::ByPosition } else { Mapping::ByCorner };
    geometry.normals = Layer::indexed(cached.normals.clone(), Vec::new(), mapping);
    Ok(())
}

/// The names of the skins of a document.
pub(super) fn skin_names(document: &Document) -> Vec<String> {
    let skins = document
        .indices()
        .filter(|&index| document.class(index) == b"Deformer" && document.object(index).kind == b"Skin");
    skins.map(|index| display_name(document.object(index).name)).collect()
}
