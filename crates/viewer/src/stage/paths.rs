//! The paths of light that reach a pixel, drawn into the picture: where their vertices are on it, and what each brings.

use bilux::math::{Vec2, Vec3};
use bilux::transport::{Event, PathVertex, VertexKind};
use bilux::{Error, Job};
use serde_json::{Value, json};

/// How many places of a segment are tried to find the part of it that the camera sees.
const STEPS: u32 = 48;

/// The path of one sample of a pixel.
///
/// # Errors
/// If the pixel is outside the picture.
pub(super) fn path(job: &Job, [x, y]: [u32; 2], sample: u32) -> Result<Value, Error> {
    let story = job.replay(x, y, sample)?;
    let place = Drawing { job, time: story.ray.time };
    let events: Vec<Value> = story.events.iter().map(|event| place.event(event)).collect();
    Ok(json!({
        "sample": sample,
        "light": story.radiance.to_array(),
        "rays": story.rays,
        "events": events,
        "segments": place.segments(story.ray.origin.into(), &story.events),
    }))
}

/// Draws in the picture of a job at a time.
struct Drawing<'a> {
    job: &'a Job,
    time: f32,
}

impl Drawing<'_> {
    fn event(&self, event: &Event) -> Value {
        let vertex = event.vertex.map(|vertex| {
            let at = (!is_direction(vertex.kind)).then(|| self.on_film(vertex.at)).flatten();
            json!({ "kind": name(vertex.kind), "at": at, "light": vertex.light.to_array() })
        });
        json!({ "depth": event.depth, "what": event.what, "vertex": vertex })
    }

    /// The parts of the path that the camera sees, each from one vertex to the next.
    fn segments(&self, origin: Vec3, events: &[Event]) -> Vec<Value> {
        // The last vertex at each depth: those of the camera's path and those of the light's.
        let (mut camera, mut light): (Vec<Vec3>, Vec<Vec3>) = (vec![origin], Vec::new());
        let mut segments = Vec::new();
        for event in events {
            let Some(vertex) = event.vertex else { continue };
            let depth = event.depth as usize;
            let chain = if vertex.kind == VertexKind::LightPath { &mut light } else { &mut camera };
            // A connection starts at the vertex of its own depth, and everything else at the one before.
            let is_connection = matches!(vertex.kind, VertexKind::LightSample | VertexKind::DistantLight);
            let from = match vertex.kind {
                VertexKind::LightPath => depth.checked_sub(1).and_then(|before| chain.get(before).copied()),
                _ if is_connection => surface_at(events, event.depth),
                _ => chain.get(depth).or(chain.last()).copied(),
            };
            let to = self.end(&vertex, from.unwrap_or(origin));
            if let Some((from, [a, b])) = from.and_then(|from| Some((from, self.visible(from, to)?))) {
                segments.push(json!({
                    "kind": name(vertex.kind), "depth": depth, "from": a, "to": b,
                    "light": vertex.light.to_array(), "from_camera": from == origin,
                }));
            }
            if !is_connection && !is_direction(vertex.kind) {
                let place = depth + usize::from(vertex.kind != VertexKind::LightPath);
                chain.truncate(place);
                chain.resize(place, to);
                chain.push(to);
            }
        }
        segments
    }

    /// Where a segment to a vertex ends.
    fn end(&self, vertex: &PathVertex, from: Vec3) -> Vec3 {
        match is_direction(vertex.kind) {
            true => from + vertex.at * (4.0 * self.job.scene().bounds().radius()),
            false => vertex.at,
        }
    }

    /// The ends of the part of a segment that is on the film.
    fn visible(&self, a: Vec3, b: Vec3) -> Option<[[f32; 2]; 2]> {
        let at = |t: f32| self.on_film(a.lerp(b, t));
        // The film sees a convex part of space, so what it sees of a segment is one piece.
        let seen = (0..=STEPS).map(|i| i as f32 / STEPS as f32).filter(|&t| at(t).is_some());
        let (first, last) = seen.fold(None, |ends, t| match ends {
            None => Some((t, t)),
            Some((first, _)) => Some((first, t)),
        })?;
        let limit = |inside: f32, outside: f32| {
            let halve = |(inside, outside): (f32, f32), _| {
                let middle = 0.5 * (inside + outside);
                if at(middle).is_some() { (middle, outside) } else { (inside, middle) }
            };
            (0..12).fold((inside, outside), halve).0
        };
        let step = 1.0 / STEPS as f32;
        Some([at(limit(first, (first - step).max(0.0)))?, at(limit(last, (last + step).min(1.0)))?])
    }

    /// Where a point is on the film, as fractions of its width and height.
    fn on_film(&self, p: Vec3) -> Option<[f32; 2]> {
        Some(self.job.camera().connect(p, Vec2::ZERO, self.time)?.film.to_array())
    }
}

/// The surface of the camera's path at a depth. Connections from it are recorded before it is.
fn surface_at(events: &[Event], depth: u32) -> Option<Vec3> {
    let is_there = |kind: VertexKind| {
        matches!(kind, VertexKind::Reflection | VertexKind::Transmission | VertexKind::Absorption)
    };
    let vertices = events.iter().filter(|event| event.depth == depth).filter_map(|event| event.vertex);
    vertices.into_iter().find(|vertex| is_there(vertex.kind)).map(|vertex| vertex.at)
}

/// True for what is infinitely far away.
fn is_direction(kind: VertexKind) -> bool {
    matches!(kind, VertexKind::Escape | VertexKind::DistantLight)
}

/// What the page calls a kind of vertex.
fn name(kind: VertexKind) -> &'static str {
    match kind {
        VertexKind::Surface => "surface",
        VertexKind::Reflection => "reflection",
        VertexKind::Transmission => "transmission",
        VertexKind::Absorption => "absorption",
        VertexKind::Emitter => "emitter",
        VertexKind::Escape => "escape",
        VertexKind::LightSample => "light sample",
        VertexKind::DistantLight => "distant light",
        VertexKind::LightPath => "light path",
    }
}
