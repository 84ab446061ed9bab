//! Blobs of their bytes.

use super::blob::{BYTES, Blob, FLOATS, GRID, GRIDS, IMAGES, MESH, MESHES};
use super::code::{Coded, Decoder};
use super::error::EncodingError;
use super::hash::ContentHash;
use bilux_math::glam::Vec4;
use bilux_math::{Mat4, Rgb, Transform, Vec2, Vec3};
use bilux_scene::Mesh;
use bilux_scene::media::{Grid, Stored};
use bilux_scene::texture::{Image, Texels};
use std::sync::Arc;

impl Blob {
    /// The blob of these bytes, which must have this hash.
    pub(super) fn read(bytes: &[u8], hash: ContentHash) -> Result<Blob, EncodingError> {
        if ContentHash::of(bytes) != hash {
            return Err(EncodingError::OtherContent(hash));
        }
        let blob = Blob::parse(bytes)?;
        match &blob {
            Blob::Mesh(mesh) => MESHES.of(mesh, || hash),
            Blob::Grid(grid) => GRIDS.of(grid, || hash),
            Blob::Image(image) => IMAGES.of(image, || hash),
        };
        Ok(blob)
    }

    /// The blob of these bytes.
    fn parse(bytes: &[u8]) -> Result<Blob, EncodingError> {
        let mut from = Decoder::new(bytes);
        let blob = match u8::read(&mut from)? {
            MESH => Blob::Mesh(Arc::new(read_mesh(&mut from)?)),
            GRID => Blob::Grid(Arc::new(read_grid(&mut from)?)),
            kind @ (BYTES | FLOATS) => Blob::Image(Arc::new(read_image(&mut from, kind)?)),
            _ => return Err(from.wrong("no mesh, grid or image")),
        };
        if from.left() > 0 {
            return Err(from.wrong(format!("{} bytes too many", from.left())));
        }
        Ok(blob)
    }
}

/// Reads a list of items of N times four bytes.
fn read_list<T, const N: usize>(
    from: &mut Decoder,
    item_of: impl Fn([[u8; 4]; N]) -> T,
) -> Result<Vec<T>, EncodingError> {
    let count = from.count(4 * N)?;
    let (words, _) = from.take(4 * N * count)?.as_chunks::<4>();
    let (items, _) = words.as_chunks::<N>();
    Ok(items.iter().map(|item| item_of(*item)).collect())
}

fn read_mesh(from: &mut Decoder) -> Result<Mesh, EncodingError> {
    let vec3 = |n: [[u8; 4]; 3]| Vec3::from(n.map(f32::from_le_bytes));
    let vec2 = |n: [[u8; 4]; 2]| Vec2::from(n.map(f32::from_le_bytes));
    let rgb = |n: [[u8; 4]; 3]| Rgb::from_array(n.map(f32::from_le_bytes));
    let number = |[n]: [[u8; 4]; 1]| f32::from_le_bytes(n);
    let mesh = Mesh {
        name: String::new(),
        positions: read_list(from, vec3)?,
        normals: read_list(from, vec3)?,
        uvs: read_list(from, vec2)?,
        uvs2: read_list(from, vec2)?,
        tangents: read_list(from, |n: [[u8; 4]; 4]| Vec4::from(n.map(f32::from_le_bytes)))?,
        vertex_kd: read_list(from, rgb)?,
        vertex_ks: read_list(from, rgb)?,
        emission_by_kd: bool::read(from)?,
        vertex_opacity: read_list(from, number)?,
        opacity_threshold: at_most_one(read_list(from, number)?, from)?,
        point_widths: read_list(from, number)?,
        triangles: read_list(from, |n: [[u8; 4]; 3]| n.map(u32::from_le_bytes))?,
        points: read_list(from, |[n]: [[u8; 4]; 1]| u32::from_le_bytes(n))?,
        lines: read_list(from, |n: [[u8; 4]; 2]| n.map(u32::from_le_bytes))?,
    };
    let count = mesh.positions.len();
    let attributes = [mesh.normals.len(), mesh.uvs.len(), mesh.uvs2.len(), mesh.tangents.len()];
    let colours = [mesh.vertex_kd.len(), mesh.vertex_ks.len()];
    let numbers = [mesh.vertex_opacity.len(), mesh.point_widths.len()];
    if attributes.iter().chain(&colours).chain(&numbers).any(|n| *n != 0 && *n != count) {
        return Err(from.wrong("a mesh has attributes for another number of vertices"));
    }
    if let Some(vertex) = mesh.named_vertices().find(|vertex| *vertex as usize >= count) {
        return Err(from.wrong(format!("a mesh has the vertex {vertex}, but only {count} vertices")));
    }
    Ok(mesh)
}

fn at_most_one(list: Vec<f32>, from: &Decoder) -> Result<Option<f32>, EncodingError> {
    if list.len() > 1 { Err(from.wrong("a mesh has several thresholds")) } else { Ok(list.first().copied()) }
}

fn read_grid(from: &mut Decoder) -> Result<Grid, EncodingError> {
    let size = [usize::read(from)?, usize::read(from)?, usize::read(from)?];
    let mut matrix = || {
        let numbers = from.take(64)?.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        Ok::<_, EncodingError>(Mat4::from_cols_slice(&numbers.collect::<Vec<_>>()))
    };
    let to_object = Transform::from_inverses(matrix()?, matrix()?);
    let scale = f32::from_le_bytes(from.take(4)?.as_chunks::<4>().0[0]);
    let places = read_list(from, |[n]: [[u8; 4]; 1]| u32::from_le_bytes(n))?;
    let pairs = read_list(from, |[n]: [[u8; 4]; 1]| u32::from_le_bytes(n))?;
    let voxels: Vec<u16> = pairs.iter().flat_map(|pair| [*pair as u16, (pair >> 16) as u16]).collect();
    let to_object = to_object.ok_or_else(|| from.wrong("a grid has no place"))?;
    let stored = Stored { places: &places, voxels: &voxels, scale };
    Grid::of_stored(size, &to_object, stored).map_err(|why| from.wrong(why.to_string()))
}

fn read_image(from: &mut Decoder, kind: u8) -> Result<Image, EncodingError> {
    let (width, height) = (usize::read(from)?, usize::read(from)?);
    let count = width.checked_mul(height).filter(|count| *count <= from.left());
    let Some(count) = count else {
        return Err(
            from.wrong(format!("an image of {width} x {height} texels has only {} bytes", from.left()))
        );
    };
    let texels = if kind == BYTES {
        let bytes = from.take(count.saturating_mul(4))?;
        Texels::Bytes(bytes.as_chunks::<4>().0.to_vec())
    } else {
        let colours = read_list(from, |n: [[u8; 4]; 3]| Rgb::from_array(n.map(f32::from_le_bytes)))?;
        let alpha = read_list(from, |[n]: [[u8; 4]; 1]| f32::from_le_bytes(n))?;
        if colours.len() != count || !(alpha.is_empty() || alpha.len() == count) {
            return Err(from.wrong(format!("an image of {width} x {height} texels has {}", colours.len())));
        }
        Texels::Floats { colours, alpha }
    };
    Ok(Image { width, height, texels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::hash_words;

    fn blobs() -> Vec<Blob> {
        let mesh = Mesh { lines: vec![[0, 3]], points: vec![1], ..Mesh::quad(Vec3::ZERO, Vec3::X, Vec3::Y) };
        let image = |texels| Blob::Image(Arc::new(Image { width: 2, height: 2, texels }));
        vec![
            Blob::Mesh(Arc::new(mesh)),
            image(Texels::Bytes(vec![[1, 2, 3, 4]; 4])),
            image(Texels::Floats { colours: vec![Rgb::grey(0.25); 4], alpha: vec![0.5; 4] }),
        ]
    }

    #[test]
    fn damaged_blobs_give_errors() {
        for blob in blobs() {
            let bytes = blob.bytes();
            assert_eq!(Blob::parse(&bytes).unwrap().bytes(), bytes);
            assert!((0..bytes.len()).all(|end| Blob::parse(&bytes[..end]).is_err()));
            // With another hash it is refused; without looking at the hash, anything but a panic may happen.
            for round in 0..3000u64 {
                let mut flipped = bytes.clone();
                let random = hash_words([round, 0]) as usize;
                flipped[random % bytes.len()] ^= 1 << (random >> 32 & 7);
                if let Ok(other) = Blob::parse(&flipped) {
                    assert_eq!(other.bytes(), flipped);
                }
                let error = Blob::read(&flipped, blob.hash()).unwrap_err();
                assert_eq!(error, EncodingError::OtherContent(blob.hash()));
            }
        }
    }
}
