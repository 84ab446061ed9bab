//! `serialized`: meshes in Mitsuba's own files, which are compressed. [Jakob 2022]

use super::maker::{FileKey, Piece, ShapeMaker};
use super::solids::upwards;
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_math::{DMat4, Vec2, Vec3};
use bilux_scene::{Mesh, Span};
use flate2::read::ZlibDecoder;
use std::io::Read;
use std::rc::Rc;

/// The first two bytes, and the versions that are known.
const SIGNATURE: u16 = 0x041c;
const VERSIONS: std::ops::RangeInclusive<u16> = 3..=4;

/// Flags of a mesh, for what it has.
const NORMALS: u32 = 0x1;
const UVS: u32 = 0x2;
const COLOURS: u32 = 0x8;
const FACE_NORMALS: u32 = 0x10;
const DOUBLES: u32 = 0x2000;

pub(super) fn make(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let (name, at) = plugin.file()?;
    plugin.ignore(&["max_smooth_angle"]);
    let flips = plugin.flag("flip_normals", false)?;
    let is_flat = plugin.flag("face_normals", false)?;
    let v_upwards = plugin.flag("flip_tex_coords", false)?;
    let index = plugin.integer("shape_index")?.unwrap_or(0);
    let index = usize::try_from(index)
        .map_err(|_| FormatError::malformed("'shape_index' counts from 0", plugin.place("shape_index")))?;
    let (path, _) = maker.maker.files().locate(name, &at, maker.maker.reading)?;
    let key: FileKey = (path.clone(), index, [flips, is_flat, v_upwards], None);
    let meshes = match maker.cache.files.get(&key) {
        Some(meshes) => meshes.clone(),
        None => {
            let bytes = maker.maker.reading.load(&path)?;
            let left = maker.maker.reading.budget.left();
            let mut mesh = Packed { bytes: &bytes, name, at: &at }.mesh(index, left)?;
            if is_flat {
                mesh.normals.clear();
            }
            let mesh = if v_upwards { mesh } else { upwards(mesh) };
            maker.maker.reading.release(bytes);
            let meshes = vec![maker.finished(mesh, flips, plugin)?];
            maker.cache.files.insert(key, meshes.clone());
            meshes
        }
    };
    maker.placed(plugin, meshes, &DMat4::IDENTITY)
}

/// With a normal at each vertex, the mean of those around it.
fn smooth(mesh: Mesh) -> Mesh {
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for (i, [p, q, r]) in t.iter().zip([[a, b, c], [b, c, a], [c, a, b]]) {
            let angle = (q - p).normalize_or_zero().dot((r - p).normalize_or_zero());
            sums[*i as usize] += normal * bilux_math::transcendental::acos(angle.clamp(-1.0, 1.0));
        }
    }
    Mesh { normals: sums.into_iter().map(Vec3::normalize_or_zero).collect(), ..mesh }
}

/// A file of meshes.
struct Packed<'b> {
    bytes: &'b [u8],
    name: &'b str,
    at: &'b Span,
}

impl Packed<'_> {
    fn fail(&self, message: &str) -> FormatError {
        FormatError::malformed(format!("'{}' {message}", self.name), self.at.clone())
    }

    fn number(&self, offset: usize, width: usize) -> Option<u64> {
        let bytes = self.bytes.get(offset..offset.checked_add(width)?)?;
        Some(bytes.iter().rev().fold(0, |n, byte| n << 8 | u64::from(*byte)))
    }

    /// One of the meshes, within this many bytes.
    fn mesh(&self, index: usize, left: u64) -> Result<Mesh, FormatError> {
        let wrong = || self.fail("is not a file of meshes as Mitsuba writes them: export it again");
        let (signature, version) = self.number(0, 2).zip(self.number(2, 2)).ok_or_else(wrong)?;
        if signature != u64::from(SIGNATURE) {
            return Err(wrong());
        }
        let version = version as u16;
        if !VERSIONS.contains(&version) {
            return Err(self.fail(&format!("has version {version}, but only 3 and 4 are known")));
        }
        // The end of the file says where each mesh begins.
        let end = self.bytes.len().checked_sub(4).ok_or_else(wrong)?;
        let count = self.number(end, 4).ok_or_else(wrong)? as usize;
        if index >= count {
            return Err(self.fail(&format!("has {count} meshes, so there is no mesh {index}")));
        }
        let width = if version == 4 { 8 } else { 4 };
        let place =
            (count - index).checked_mul(width).and_then(|back| end.checked_sub(back)).ok_or_else(wrong)?;
        let start =
            self.number(place, width).and_then(|start| usize::try_from(start).ok()).ok_or_else(wrong)?;
        let packed = start.checked_add(4).and_then(|start| self.bytes.get(start..end)).ok_or_else(wrong)?;
        let mut bytes = Vec::new();
        // Half of what is left: the mesh is made while its bytes are there.
        let mut decoder = ZlibDecoder::new(packed).take(left / 2);
        decoder
            .read_to_end(&mut bytes)
            .map_err(|error| self.fail(&format!("cannot be decompressed: {error}")))?;
        self.unpacked(&bytes, version)
            .ok_or_else(|| self.fail("ends in the middle of a mesh, or takes too much memory"))?
            .ok_or_else(|| self.fail("refers to vertices that it does not have"))
    }

    /// The mesh of decompressed bytes; nothing if they end too early, or if indices are wrong.
    fn unpacked(&self, bytes: &[u8], version: u16) -> Option<Option<Mesh>> {
        let mut rest = bytes;
        let mut take = |count: usize| {
            let (head, tail) = rest.split_at_checked(count)?;
            rest = tail;
            Some(head)
        };
        let flags = u32::from_le_bytes(take(4)?.try_into().ok()?);
        let mut name = Vec::new();
        let mut letter = if version == 4 { take(1)? } else { &[0] };
        while letter != [0] {
            name.extend_from_slice(letter);
            letter = take(1)?;
        }
        let vertices = usize::try_from(u64::from_le_bytes(take(8)?.try_into().ok()?)).ok()?;
        let triangles = usize::try_from(u64::from_le_bytes(take(8)?.try_into().ok()?)).ok()?;
        let is_double = flags & DOUBLES != 0;
        let width = if is_double { 8 } else { 4 };
        let mut floats = |per_vertex: usize| -> Option<Vec<f32>> {
            let bytes = take(vertices.checked_mul(per_vertex * width)?)?;
            Some(match is_double {
                true => bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b) as f32).collect(),
                false => bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
            })
        };
        let triples = |list: Vec<f32>| list.as_chunks::<3>().0.iter().map(|p| Vec3::from(*p)).collect();
        let positions: Vec<Vec3> = triples(floats(3)?);
        let normals: Vec<Vec3> = if flags & NORMALS != 0 { triples(floats(3)?) } else { Vec::new() };
        let uvs = if flags & UVS != 0 { floats(2)? } else { Vec::new() };
        if flags & COLOURS != 0 {
            floats(3)?;
        }
        if vertices > u32::MAX as usize {
            return None;
        }
        let indices = take(triangles.checked_mul(12)?)?.as_chunks::<4>().0;
        let indices: Vec<u32> = indices.iter().map(|b| u32::from_le_bytes(*b)).collect();
        if indices.iter().any(|i| *i as usize >= vertices) {
            return Some(None);
        }
        let is_flat = flags & FACE_NORMALS != 0;
        let normals = if is_flat { Vec::new() } else { normals };
        let mesh = Mesh {
            name: String::from_utf8_lossy(&name).into_owned(),
            positions,
            normals,
            uvs: uvs.as_chunks::<2>().0.iter().map(|uv| Vec2::from(*uv)).collect(),
            triangles: indices.as_chunks::<3>().0.to_vec(),
            ..Mesh::default()
        };
        Some(Some(if is_flat || !mesh.normals.is_empty() { mesh } else { smooth(mesh) }))
    }
}
