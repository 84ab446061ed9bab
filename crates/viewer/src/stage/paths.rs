//! The paths of light that reach a pixel, as the page draws them into the picture.

use bilux::light_path::{LightPath, PathSegment};
use bilux::transport::{Event, VertexKind};
use bilux::{Error, Job};
use serde_json::{Value, json};

/// The path of one sample of a pixel.
///
/// # Errors
/// If the pixel is outside the picture.
pub(super) fn path(job: &Job, [x, y]: [u32; 2], sample: u32) -> Result<Value, Error> {
    let path = LightPath::of(job, x, y, sample)?;
    let events = path.replay.events.iter().zip(&path.places);
    Ok(json!({
        "sample": sample,
        "light": path.replay.radiance.to_array(),
        "rays": path.replay.rays,
        "events": events.map(|(event, place)| shown_event(event, *place)).collect::<Vec<_>>(),
        "segments": path.segments.iter().map(shown_segment).collect::<Vec<_>>(),
    }))
}

fn shown_event(event: &Event, at: Option<[f32; 2]>) -> Value {
    let vertex = event
        .vertex
        .map(|vertex| json!({ "kind": name(vertex.kind), "at": at, "light": vertex.light.to_array() }));
    json!({ "depth": event.depth, "what": event.what, "vertex": vertex })
}

fn shown_segment(segment: &PathSegment) -> Value {
    json!({
        "kind": name(segment.kind), "depth": segment.depth, "from": segment.ends[0], "to": segment.ends[1],
        "light": segment.light.to_array(), "from_camera": segment.from_camera,
    })
}

/// Name of a kind of vertex on the page.
fn name(kind: VertexKind) -> &'static str {
    match kind {
        VertexKind::Surface => "surface",
        VertexKind::Reflection => "reflection",
        VertexKind::Transmission => "transmission",
        VertexKind::Absorption => "absorption",
        VertexKind::Medium => "medium",
        VertexKind::Emitter => "emitter",
        VertexKind::Escape => "escape",
        VertexKind::LightSample => "light sample",
        VertexKind::DistantLight => "distant light",
        VertexKind::LightPath => "light path",
    }
}
