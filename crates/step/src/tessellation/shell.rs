//! The faces of a shape, and their triangles.

use super::boundary::{Bounds, EdgePoints};
use super::edges::Edge;
use super::face::{Patch, Trimmed};
use crate::curves::Accuracy;
use crate::part21::Table;
use crate::structure::axes::Axes;
use crate::structure::styles::{Style, Styles};
use crate::surfaces::{Scale, Surface, plane, surface};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_math::DVec3;
use bilux_math::parallel::map;
use std::collections::{HashMap, HashSet};

/// A face of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) id: u64,
    /// True if the shape turns its side.
    pub(crate) is_turned: bool,
    /// Style of the face, as it, its shell or its shape states.
    pub(crate) style: Option<Style>,
}

/// Shapes of shapes end here.
const MAX_DEPTH: usize = 8;

/// The faces of a shape.
pub(crate) fn faces(
    reading: &mut Reading,
    table: &Table,
    styles: &Styles,
    shape: u64,
) -> Result<Vec<Face>, FormatError> {
    let mut found = Vec::new();
    let mut known = HashSet::new();
    let mut rest = vec![(Face { id: shape, is_turned: false, style: None }, 0)];
    while let Some((face, depth)) = rest.pop() {
        if !known.insert((face.id, face.is_turned)) {
            continue;
        }
        reading.budget.take::<(Face, usize)>(1, &table.file())?;
        let kind = table.kind(face.id);
        let style = styles.of(face.id).or(face.style);
        if styles.hides(face.id) {
            continue;
        }
        if matches!(kind, b"ADVANCED_FACE" | b"FACE_SURFACE" | b"FACE") {
            found.push(Face { style, ..face });
            continue;
        }
        let is_face = table.is(face.id, "FACE_SURFACE") || table.is(face.id, "ADVANCED_FACE");
        if is_face || depth > MAX_DEPTH || !is_part(kind, table, face.id) {
            continue;
        }
        // What is oriented says so last.
        let turns = kind.starts_with(b"ORIENTED")
            && table.simple(face.id).and_then(|values| values.flag(values.len().checked_sub(1)?))
                == Some(false);
        let inner = Face { is_turned: face.is_turned != turns, style, ..face };
        let mut below: Vec<u64> = Vec::new();
        for (_, values) in table.parts(face.id) {
            below.extend(values.references());
            (0..values.len()).for_each(|index| below.extend(values.references_at(index)));
        }
        // The last one is taken first.
        rest.extend(below.into_iter().rev().map(|id| (Face { id, ..inner }, depth + 1)));
    }
    Ok(found)
}

/// True for what has faces.
fn is_part(kind: &[u8], table: &Table, id: u64) -> bool {
    let has = |word: &[u8]| kind.windows(word.len()).any(|window| window == word);
    has(b"SHELL")
        || has(b"BREP")
        || has(b"FACE_SET")
        || has(b"SURFACE_MODEL")
        || has(b"ORIENTED_FACE")
        || table.is(id, "MANIFOLD_SOLID_BREP")
}

/// State that the faces of a shape have in common.
pub(crate) struct Shape<'t, 'b> {
    table: &'t Table<'b>,
    accuracy: Accuracy,
    scale: Scale,
    edges: EdgePoints,
}

/// The chord error, as a part of the size of a shape.
const CHORD: f64 = 1.0 / 2000.0;

/// The angle that a chord spans, in radians: 32 pieces for a whole turn.
const ANGLE: f64 = 0.2;

/// Edges that are read, and faces that are tessellated, before their memory is counted.
const AT_ONCE: usize = 128;

impl<'t, 'b> Shape<'t, 'b> {
    /// Samples the edges of faces. `unit` is that of angles, in radians.
    pub(crate) fn new(
        reading: &mut Reading,
        table: &'t Table<'b>,
        faces: &[Face],
        unit: f64,
    ) -> Result<Shape<'t, 'b>, FormatError> {
        let mut ids: Vec<u64> = faces
            .iter()
            .filter_map(|face| Bounds::read(table, face.id))
            .flat_map(|b| b.edges().collect::<Vec<_>>())
            .collect();
        ids.sort_unstable();
        ids.dedup();
        let mut edges: HashMap<u64, Edge> = HashMap::new();
        for some in ids.chunks(AT_ONCE) {
            let read = map(some, |&id| Some((id, Edge::read(table, id, unit)?)));
            let read: Vec<(u64, Edge)> = read.into_iter().flatten().collect();
            let bytes: usize = read.iter().map(|(_, edge)| edge.size()).sum();
            reading.budget.take_bytes(bytes as u64, &table.file())?;
            edges.extend(read);
        }
        let mut points: Vec<DVec3> = edges.values().flat_map(Edge::some_points).collect();
        for face in faces {
            points.extend(round_extent(table, face.id, unit));
        }
        points.retain(|p| p.is_finite());
        let first = points.first().copied().unwrap_or_default();
        let (low, high) = points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
        let size = (high - low).length().max(f64::MIN_POSITIVE);
        let far = low.abs().max(high.abs()).max_element();
        let accuracy = Accuracy { distance: CHORD * size, angle: ANGLE };
        let mut sampled = map(&edges, |(&id, edge)| (id, edge.points(accuracy)));
        sampled.retain(|(_, points)| points.len() > 1);
        let count: usize = sampled.iter().map(|(_, points)| points.len()).sum();
        reading.budget.take::<DVec3>(count + ids.len(), &table.file())?;
        let scale = Scale { angle: unit, size: 4.0 * (size + far) };
        Ok(Shape { table, accuracy, scale, edges: sampled.into_iter().collect() })
    }

    /// The triangles of faces, in their order; `None` for those that cannot be trimmed.
    pub(crate) fn patches(
        &self,
        reading: &mut Reading,
        faces: &[Face],
    ) -> Result<Vec<Option<Patch>>, FormatError> {
        let mut patches = Vec::with_capacity(faces.len());
        for some in faces.chunks(AT_ONCE) {
            let made = map(some, |face| self.patch(face));
            for patch in made.iter().flatten() {
                let bytes = 48 * patch.positions.len() + 12 * patch.triangles.len() + patch.surface_bytes;
                reading.budget.take_bytes(bytes as u64, &self.table.file())?;
            }
            patches.extend(made);
        }
        Ok(patches)
    }

    fn patch(&self, face: &Face) -> Option<Patch> {
        let bounds = Bounds::read(self.table, face.id).filter(|bounds| !bounds.is_broken)?;
        let lines = bounds.lines(&self.edges)?;
        let values = self.table.simple(face.id)?;
        let is_same = values.flag(3).unwrap_or(true);
        let surface: Box<dyn Surface> = match values.reference(2) {
            Some(id) => surface(self.table, id, self.scale)?,
            // A face without a surface is flat.
            None => plane(flat(lines.first()?)?),
        };
        let size = self.scale.size * 0.25;
        let trimmed = Trimmed { surface: &*surface, lines, is_same, size };
        let mut patch = trimmed.patch(self.accuracy)?;
        patch.surface_bytes = surface.size();
        if face.is_turned {
            patch.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
            patch.normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        Some(patch)
    }
}

/// Points around a face that has no edges: a whole sphere, or a whole torus.
fn round_extent(table: &Table, face: u64, unit: f64) -> Vec<DVec3> {
    let is_bare = Bounds::read(table, face).is_some_and(|bounds| bounds.edges().next().is_none());
    let id = table.simple(face).and_then(|values| values.reference(2));
    let Some(id) = id.filter(|_| is_bare) else { return Vec::new() };
    let Some(found) = surface(table, id, Scale { angle: unit, size: 1.0 }) else { return Vec::new() };
    let [u, v] = found.domain();
    let share = |[from, to]: [f64; 2], i: usize| from + (to - from) * i as f64 / 4.0;
    let at = |i: usize| bilux_math::DVec2::new(share(u, i % 5), share(v, i / 5));
    (0..25).map(|i| found.point(at(i))).collect()
}

/// The plane of a polygon. [Newell 1972]
fn flat(line: &[DVec3]) -> Option<Axes> {
    let first = *line.first()?;
    let normal: DVec3 = line.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    normal.try_normalize().map(|normal| Axes::new(first, Some(normal), None))
}
