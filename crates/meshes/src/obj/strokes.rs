//! Points and lines of an OBJ file.

use super::block::{End, Stroke};
use bilux_import::FormatError;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::meshes::indexed_faces::{IndexedFaces, NONE, Run, material_of};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Mesh, Object, Span};
use std::collections::HashMap;
use std::sync::Arc;

/// All points and lines of a file, grouped by name and material.
#[derive(Default)]
pub(super) struct Strokes {
    groups: Vec<Group>,
}

struct Group {
    run: Run,
    points: Vec<u32>,
    lines: Vec<[u32; 2]>,
    /// The location of the first one.
    place: u64,
}

impl Strokes {
    pub(super) fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Adds a point or line to the group of a run; `None` if it refers to a vertex before the first.
    pub(super) fn add(
        &mut self,
        stroke: &Stroke,
        before: usize,
        run: impl FnOnce() -> Run,
        place: u64,
    ) -> Option<()> {
        let run = run();
        let same =
            |group: &Group| group.run.name == run.name && group.run.material_name() == run.material_name();
        if !self.groups.last().is_some_and(same) {
            self.groups.push(Group { run, points: Vec::new(), lines: Vec::new(), place });
        }
        let vertex = |end: End| match end {
            End::Whole(index) => Some(index),
            End::OfBlock(index) => u32::try_from(before as i64 + index).ok(),
        };
        let [a, b] = stroke.ends.map(vertex);
        let (a, b, group) = (a?, b?, self.groups.last_mut()?);
        match stroke.is_point {
            true => group.points.push(a),
            false => group.lines.push([a, b]),
        }
        Some(())
    }

    /// Makes a point of every vertex.
    pub(super) fn add_all(&mut self, vertices: usize, name: String) {
        let run = Run { first_face: 0, name, material: None };
        let points = (0..vertices as u32).collect();
        self.groups.push(Group { run, points, lines: Vec::new(), place: 0 });
    }

    /// Makes an object of each group, with the vertices that it uses.
    pub(super) fn into_objects(
        self,
        reading: &mut Reading,
        source: &Source,
        place: &dyn Fn(u64) -> Span,
        indexed: &IndexedFaces,
        materials: &mut HashMap<String, usize>,
        sink: &mut Sink,
    ) -> Result<(), FormatError> {
        if self.groups.is_empty() {
            return Ok(());
        }
        reading.budget.take_bytes(indexed.positions.len() as u64 * 4, source.name)?;
        let mut places = vec![NONE; indexed.positions.len()];
        for mut group in self.groups {
            let mut mesh = Mesh::default();
            let mut used = Vec::new();
            let mut failure = None;
            let ends = group.points.iter_mut().chain(group.lines.iter_mut().flatten());
            for vertex in ends {
                let Some(slot) = places.get_mut(*vertex as usize) else {
                    failure = Some(*vertex);
                    break;
                };
                if *slot == NONE {
                    *slot = used.len() as u32;
                    used.push(*vertex);
                }
                *vertex = *slot;
            }
            if let Some(vertex) = failure {
                let (named, count) = (u64::from(vertex) + 1, indexed.positions.len());
                let message =
                    format!("a point or line refers to vertex {named}, but the file has only {count}");
                return Err(FormatError::malformed(message, place(group.place)));
            }
            reading.budget.take::<(Vec3, Rgb)>(used.len(), source.name)?;
            mesh.positions = used.iter().map(|&i| indexed.positions[i as usize]).collect();
            if !indexed.colours.is_empty() {
                mesh.vertex_kd = used.iter().map(|&i| indexed.colours[i as usize]).collect();
            }
            used.iter().for_each(|&i| places[i as usize] = NONE);
            (mesh.points, mesh.lines) = (group.points, group.lines);
            let name = if group.run.name.is_empty() { source.stem() } else { group.run.name.clone() };
            mesh.name.clone_from(&name);
            let material = material_of(&group.run, indexed, materials, place, sink);
            sink.scene.objects.push(Object::new(&name, Arc::new(mesh), material));
        }
        Ok(())
    }
}
