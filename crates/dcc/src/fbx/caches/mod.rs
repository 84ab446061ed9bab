//! Caches of points: files beside the scene that say where the points of a mesh are over time. They replace all other
//! deformations, as in the SDK's viewer.

mod around;
mod chunks;
mod description;
mod file;
mod maya;
mod pc2;

use super::document::{Index, display_name};
use super::posed::Posed;
use super::tree::Node;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_math::Vec3;
use file::{CacheFile, Counts};

/// Positions and normals from the caches of a mesh, at a time.
#[derive(Default)]
pub(super) struct Cached {
    /// For each control point.
    pub(super) positions: Vec<Vec3>,
    /// For each control point or for each corner, or none.
    pub(super) normals: Vec<Vec3>,
}

impl Cached {
    /// Cached positions and normals of a mesh, if there are any. A cache that cannot be read is left out, with a warning.
    pub(super) fn read(
        geometry: Index,
        posed: &Posed,
        reading: &mut Reading,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<Cached>, FormatError> {
        let document = posed.document;
        let deformers = document.sources_of_class(geometry, "Deformer");
        let mut found: Option<Cached> = None;
        for deformer in deformers.filter(|&index| document.object(index).kind == b"VertexCacheDeformer") {
            let properties = posed.properties(deformer);
            if properties.integer("Active") == Some(0) {
                continue;
            }
            let node = document.object(deformer).node;
            let channel = properties.text("ChannelName").map(display_name).unwrap_or_default();
            let read = counts(document.object(geometry).node)
                .and_then(|counts| channel_of(deformer, &channel, counts, posed, reading));
            match read {
                Ok((true, normals)) => found.get_or_insert_default().normals = normals,
                Ok((false, positions)) => found.get_or_insert_default().positions = positions,
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => {
                    let what = format!("a cache of points is left out: {}", error.without_place());
                    diagnostics.note(&what, || node.at());
                }
            }
        }
        let found = found.filter(|cached| !cached.positions.is_empty());
        if found.iter().flat_map(|cached| &cached.positions).any(|p| !p.is_finite()) {
            let what = "a cache of points has numbers that are infinite or not numbers (NaN); they are kept";
            diagnostics.note(what, || document.object(geometry).node.at());
        }
        Ok(found)
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        (size_of_val(&self.positions[..]) + size_of_val(&self.normals[..])) as u64
    }
}

fn counts(mesh: Node) -> Result<Counts, FormatError> {
    let count = |name: &str| mesh.child(name).map_or(Ok(0), |list| list.most_numbers());
    Ok(Counts { points: count("Vertices")? / 3, corners: count("PolygonVertexIndex")? })
}

/// The vectors of a deformer's channel at the time, and whether they are normals.
fn channel_of(
    deformer: Index,
    channel: &str,
    counts: Counts,
    posed: &Posed,
    reading: &mut Reading,
) -> Result<(bool, Vec<Vec3>), FormatError> {
    let document = posed.document;
    let node = document.object(deformer).node;
    let Some(cache) = document.sources_of_class(deformer, "Cache").next() else {
        return Err(node.error("it names no file"));
    };
    let properties = document.properties(cache);
    let stated = ["CacheFileName", "CacheAbsoluteFileName"].map(|name| properties.text(name));
    let names: Vec<String> =
        stated.into_iter().flatten().map(display_name).filter(|n| !n.is_empty()).collect();
    let path = reading.locator.locate_any(document.folder, &names, &node.at())?;
    let mut file = CacheFile::open(&path, node.at(), reading)?;
    let mut head = [0; pc2::SIGNATURE.len()];
    file.fill(&mut head)?;
    let seconds = posed.pose.seconds;
    if &head == pc2::SIGNATURE {
        let frame = seconds * document.settings.frames_per_second;
        return Ok((false, pc2::read(file, frame, counts.points, reading)?));
    }
    maya::read(&path, channel, seconds, counts, &node.at(), reading)
}
