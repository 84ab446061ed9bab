//! Reads binary STL: 80 arbitrary bytes, a count, and 50 bytes per triangle.

use super::facet_colours::FacetColours;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_math::{DVec3, Rgb, Vec3};
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
    let mut scene = SceneBuilder::default();
    let mut diagnostics = Diagnostics::default();
    for (header, triangles) in solids(source, &mut diagnostics)? {
        if !triangles.is_empty() {
            add_solid(reading, source, (header, triangles), &mut scene, &mut diagnostics)?;
        }
    }
    diagnostics.into_warnings(&mut scene);
    Ok(scene)
}

/// A header and the bytes of its triangles.
type Solid<'a> = (&'a [u8], &'a [u8]);

/// The solids of a file: usually one, but some programs write several files into one.
fn solids<'a>(source: &Source<'a>, diagnostics: &mut Diagnostics) -> Result<Vec<Solid<'a>>, FormatError> {
    let mut rest = source.bytes;
    let mut solids = Vec::new();
    while let Some(count) = claimed(rest) {
        let end = HEADER as u64 + u64::from(count) * TRIANGLE as u64;
        let Some(end) = usize::try_from(end).ok().filter(|&end| end <= rest.len()) else { break };
        solids.push((&rest[..HEADER], &rest[HEADER..end]));
        rest = &rest[end..];
        // Empty ones would be padding of zeros.
        if count == 0 {
            break;
        }
    }
    if rest.is_empty() { Ok(solids) } else { only_solid(source, diagnostics).map(|solid| vec![solid]) }
}

/// The solid of a file whose size is not what its header says.
fn only_solid<'a>(source: &Source<'a>, diagnostics: &mut Diagnostics) -> Result<Solid<'a>, FormatError> {
    let whole = || whole_file(source.name);
    let Some(stated) = claimed(source.bytes) else {
        let message = format!(
            "a binary STL file has {HEADER} bytes before its first triangle, but this file has only {}, and it does \
             not begin with 'solid' as a text STL does",
            source.bytes.len()
        );
        return Err(FormatError::malformed(message, whole()));
    };
    let (header, body) = source.bytes.split_at(HEADER);
    let room = (body.len() / TRIANGLE) as u64;
    let is_whole = body.len().is_multiple_of(TRIANGLE);
    let count = match u64::from(stated) {
        0 => room,
        _ if is_whole => room,
        stated if stated <= room => {
            diagnostics.note("there are bytes after the last triangle; they are ignored", whole);
            stated
        }
        _ => {
            let message = format!(
                "the header says {stated} triangles, but there are bytes for only {room}: the file was cut off, or is \
                 not an STL file"
            );
            return Err(FormatError::malformed(message, whole()));
        }
    };
    if count != u64::from(stated) {
        let what = format!(
            "the header says {stated} triangles, but the file has {count}: the header is wrong, and all are read"
        );
        diagnostics.note(&what, whole);
    }
    Ok((header, &body[..count as usize * TRIANGLE]))
}

fn add_solid(
    reading: &mut Reading,
    source: &Source,
    (header, bytes): Solid,
    scene: &mut SceneBuilder,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    let whole = || whole_file(source.name);
    let triangles = || bytes.chunks_exact(TRIANGLE);
    let count = triangles().len();
    let colours = FacetColours::of(header, triangles().map(attribute));
    colours.report(diagnostics, whole);
    let colour_size = if colours.are_there() { size_of::<[Rgb; 3]>() } else { 0 };
    let size = size_of::<([Vec3; 3], [u32; 3])>() + colour_size;
    reading.budget.take_bytes((count * size) as u64, source.name)?;
    reading.budget.take::<(Object, Mesh)>(1, source.name)?;
    if 3 * count as u64 >= u64::from(u32::MAX) {
        let message = "there are more than 4 billion corners: split the file";
        return Err(FormatError::malformed(message, whole()));
    }
    let mut mesh = Mesh { name: source.stem(), ..Mesh::default() };
    mesh.positions.reserve_exact(3 * count);
    mesh.triangles.reserve_exact(count);
    let origin = reading.origin;
    for triangle in triangles() {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(triangle[12..48].chunks_exact(12).map(point).map(|p| relative(p, origin)));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    if colours.are_there() {
        mesh.vertex_kd.reserve_exact(3 * count);
        mesh.vertex_kd.extend(triangles().flat_map(|triangle| [colours.at(attribute(triangle)); 3]));
    }
    if mesh.positions.iter().any(|p| !p.is_finite()) {
        diagnostics
            .note("some triangles have numbers that are infinite or not numbers (NaN); they are kept", whole);
    }
    let name = mesh.name.clone();
    scene.objects.push(Object::new(&name, Arc::new(mesh), 0));
    Ok(())
}

/// The two bytes after a triangle.
fn attribute(triangle: &[u8]) -> u16 {
    u16::from_le_bytes([triangle[TRIANGLE - 2], triangle[TRIANGLE - 1]])
}

fn point(bytes: &[u8]) -> Vec3 {
    let number = |i: usize| f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]);
    Vec3::new(number(0), number(4), number(8))
}

#[inline]
fn relative(p: Vec3, origin: DVec3) -> Vec3 {
    if origin == DVec3::ZERO { p } else { (p.as_dvec3() - origin).as_vec3() }
}
