//! Faces as the cage of a subdivision surface.

use super::{IndexedFaces, Run};
use crate::FormatError;
use crate::geometry::subdivision::{Cage, PendingCage, Scheme};
use crate::input::reading::{Reading, Source};
use crate::input::sink::Sink;
use bilux_math::Vec2;
use bilux_scene::{Object, Span};

/// Makes an object of every run, whose mesh is refined when the whole scene is known. `material` gives the index of a
/// run's material.
pub(super) fn as_cage(
    scheme: Scheme,
    reading: &mut Reading,
    source: &Source,
    place: &dyn Fn(u64) -> Span,
    indexed: IndexedFaces,
    sink: &mut Sink,
    mut material: impl FnMut(&Run, &IndexedFaces, &mut Sink) -> usize,
) -> Result<(), FormatError> {
    let bytes = indexed.positions.len() * 48 + indexed.faces.corner_count() * 12 + indexed.faces.len() * 8;
    reading.budget.take_bytes(bytes as u64, source.name)?;
    let mut cage = Cage::new(scheme, &indexed.positions);
    cage.set_colours(&indexed.colours);
    if !indexed.specular.is_empty() || !indexed.face_colours.is_empty() {
        sink.diagnostics.not_shown("colours of faces and specular colours of subdivision surfaces", || {
            place(indexed.places.at(0))
        });
    }
    let (mut points, mut uvs, mut run) = (Vec::new(), Vec::new(), 0);
    for (face, corners) in indexed.faces.iter().enumerate() {
        run += usize::from(indexed.runs.get(run + 1).is_some_and(|next| next.first_face <= face));
        points.clear();
        points.extend(corners.iter().map(|corner| corner[0]));
        uvs.clear();
        if !indexed.uvs.is_empty() {
            let uv = |corner: &[u32; 3]| indexed.uvs.get(corner[1] as usize).copied().unwrap_or(Vec2::ZERO);
            uvs.extend(corners.iter().map(uv));
        }
        cage.add_face(&points, &uvs, run as u32);
    }
    let name = |run: &Run| if run.name.is_empty() { source.stem() } else { run.name.clone() };
    let pending = PendingCage::new(cage, indexed.runs.iter().map(name), place(indexed.places.at(0)));
    for (group, run) in indexed.runs.iter().enumerate() {
        let (mesh, material) = (pending.mesh(group).clone(), material(run, &indexed, sink));
        sink.scene.objects.push(Object::new(&name(run), mesh, material));
    }
    reading.cages.push(pending);
    Ok(())
}
