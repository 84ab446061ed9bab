//! Reads binary STL: 80 arbitrary bytes, a count, and 50 bytes per triangle.

use crate::FormatError;
use crate::reading::{Oddities, Reading, Source};
use crate::text::whole_file;
use bilux_math::Vec3;
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::sync::Arc;

/// Bytes before the first triangle.
pub(super) const HEADER: usize = 84;
/// Bytes of a triangle: the normal, three corners, and two bytes that each program uses as it likes.
pub(super) const TRIANGLE: usize = 50;

/// The number of triangles that the header states.
fn claimed(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(80..HEADER)?.first_chunk()?))
}

/// True if the size is that of a binary file with the stated number of triangles.
pub(super) fn fits(bytes: &[u8]) -> bool {
    claimed(bytes)
        .is_some_and(|count| bytes.len() as u64 == HEADER as u64 + u64::from(count) * TRIANGLE as u64)
}

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let whole = || whole_file(source.name);
    let Some(count) = claimed(source.bytes) else {
        let message = format!(
            "a binary STL file has {HEADER} bytes before its first triangle, but this file has only {}, and it does \
             not begin with 'solid' as a text STL does",
            source.bytes.len()
        );
        return Err(FormatError::malformed(message, whole()));
    };
    let body = &source.bytes[HEADER..];
    let room = body.len() / TRIANGLE;
    if (room as u64) < u64::from(count) {
        let message = format!(
            "the header says {count} triangles, but there are bytes for only {room}: the file was cut off, or is not \
             an STL file"
        );
        return Err(FormatError::malformed(message, whole()));
    }
    let mut scene = SceneBuilder::default();
    let mut oddities = Oddities::default();
    if body.len() as u64 != u64::from(count) * TRIANGLE as u64 {
        oddities.note("there are bytes after the last triangle; they are ignored", whole);
    }
    reading.budget.take_bytes(u64::from(count) * size_of::<([Vec3; 3], [u32; 3])>() as u64, source.name)?;
    let mut mesh = Mesh { name: source.stem(), ..Mesh::default() };
    mesh.positions.reserve_exact(3 * count as usize);
    mesh.triangles.reserve_exact(count as usize);
    for triangle in body.chunks_exact(TRIANGLE).take(count as usize) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(triangle[12..48].chunks_exact(12).map(point));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    if mesh.positions.iter().any(|p| !p.is_finite()) {
        oddities
            .note("some triangles have numbers that are infinite or not numbers (NaN); they are kept", whole);
    }
    if count > 0 {
        let name = mesh.name.clone();
        scene.objects.push(Object::new(&name, Arc::new(mesh), 0));
    }
    oddities.into_warnings(&mut scene);
    Ok(scene)
}

fn point(bytes: &[u8]) -> Vec3 {
    let number = |i: usize| f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]);
    Vec3::new(number(0), number(4), number(8))
}
