//! The path of a sample on the film: where its vertices and segments are in the picture, and what each brings.

use crate::job::Subject;
use crate::{Error, Job};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_transport::{Event, PathVertex, Replay, VertexKind};

/// Number of steps in which a segment is searched for the part of it that the camera sees.
const STEPS: u32 = 48;

/// A replayed sample with its path on the film. Places on the film are fractions of its width and height.
pub struct LightPath {
    /// The recorded sample.
    pub replay: Replay,
    /// The place of each event's vertex on the film; `None` for what is no vertex, infinitely far away or out of view.
    pub places: Vec<Option<[f32; 2]>>,
    /// The parts of the path that the camera sees, each from one vertex to the next.
    pub segments: Vec<PathSegment>,
}

/// A part of a path that the camera sees.
pub struct PathSegment {
    /// The vertex that it leads to.
    pub kind: VertexKind,
    /// Scattering events before that.
    pub depth: u32,
    /// The ends of the part on the film.
    pub ends: [[f32; 2]; 2],
    /// The light that its end adds to the sample.
    pub light: Rgb,
    /// True if it begins at the lens, so that the camera sees it end on.
    pub from_camera: bool,
}

impl LightPath {
    /// Path of one sample of a pixel, as the camera sees it.
    ///
    /// # Errors
    /// If the pixel is outside the picture.
    pub fn of(job: &Job, x: u32, y: u32, sample: u32) -> Result<LightPath, Error> {
        let replay = job.replay(x, y, sample)?;
        let view = View { subject: &job.subject, time: replay.ray.time };
        let place = |event: &Event| {
            let vertex = event.vertex.filter(|vertex| !is_direction(vertex.kind))?;
            view.on_film(vertex.at)
        };
        let places = replay.events.iter().map(place).collect();
        let segments = view.segments(replay.ray.origin.into(), &replay.events);
        Ok(LightPath { replay, places, segments })
    }
}

/// View of a job's camera at a time.
struct View<'a> {
    subject: &'a Subject,
    time: f32,
}

impl View<'_> {
    fn segments(&self, origin: Vec3, events: &[Event]) -> Vec<PathSegment> {
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
            if let Some((from, ends)) = from.and_then(|from| Some((from, self.visible(from, to)?))) {
                let from_camera = from == origin;
                let (kind, depth, light) = (vertex.kind, event.depth, vertex.light);
                segments.push(PathSegment { kind, depth, ends, light, from_camera });
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

    /// End of a segment to a vertex.
    fn end(&self, vertex: &PathVertex, from: Vec3) -> Vec3 {
        match is_direction(vertex.kind) {
            true => from + vertex.at * (4.0 * self.subject.scene.bounds().radius()),
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

    /// Place of a point on the film, if it is visible there.
    fn on_film(&self, p: Vec3) -> Option<[f32; 2]> {
        let seen = self.subject.camera.connect(p, Vec2::ZERO, self.time)?;
        seen.is_on_film().then(|| seen.film.to_array())
    }
}

/// The surface of the camera's path at a depth. Connections from it are recorded before it is.
fn surface_at(events: &[Event], depth: u32) -> Option<Vec3> {
    let is_there = |kind: VertexKind| {
        matches!(
            kind,
            VertexKind::Surface
                | VertexKind::Reflection
                | VertexKind::Transmission
                | VertexKind::Absorption
                | VertexKind::Medium
        )
    };
    let vertices = events.iter().filter(|event| event.depth == depth).filter_map(|event| event.vertex);
    vertices.into_iter().find(|vertex| is_there(vertex.kind)).map(|vertex| vertex.at)
}

/// True for what is infinitely far away.
fn is_direction(kind: VertexKind) -> bool {
    matches!(kind, VertexKind::Escape | VertexKind::DistantLight)
}
