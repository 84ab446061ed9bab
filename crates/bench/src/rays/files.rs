//! Files of meshes, rays and hits, for engines that are measured separately. Little-endian throughout.
//!
//! A mesh is `MSH1`, the numbers of vertices and of triangles (u32), three f32 per vertex, three u32 per triangle. Rays
//! are `RAY1`, a u32 (0 closest, 1 any), their number (u32), and eight f32 each: origin, minimum t, direction, maximum
//! t. Hits are t, u, v (f32) and the primitive (u32, all ones for a miss) per ray, or one byte per ray for any-hit
//! queries.

use super::batch::{Answers, Batch};
use bilux::Error;
use bilux::accel::{Ray, TriangleMesh};
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::Path;

/// The vertices, each once, and triples of indices into them.
pub(super) fn indexed(mesh: &TriangleMesh) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut known) = (Vec::new(), HashMap::with_capacity(mesh.len()));
    let mut index = |corner: &[f32; 3]| {
        *known.entry(corner.map(f32::to_bits)).or_insert_with(|| {
            positions.push(*corner);
            positions.len() as u32 - 1
        })
    };
    let indices = mesh.triangles().iter().map(|[a, b, c]| [a, b, c].map(&mut index)).collect();
    (positions, indices)
}

/// Writes `NAME.msh` and `NAME-CLASS.ray` to a folder, which is created if it does not exist.
pub(super) fn dump(folder: &Path, name: &str, mesh: &TriangleMesh, batches: &[Batch]) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|e| file_error("make the folder", folder, e))?;
    write_mesh(&folder.join(format!("{name}.msh")), mesh)?;
    batches
        .iter()
        .try_for_each(|batch| write_rays(&folder.join(format!("{name}-{}.ray", batch.class)), batch))
}

/// Writes a mesh.
///
/// # Errors
/// If the file cannot be written.
pub fn write_mesh(path: &Path, mesh: &TriangleMesh) -> Result<(), Error> {
    let (positions, indices) = indexed(mesh);
    write(path, |file| {
        file.write_all(b"MSH1")?;
        file.write_all(&(positions.len() as u32).to_le_bytes())?;
        file.write_all(&(indices.len() as u32).to_le_bytes())?;
        positions.iter().flatten().try_for_each(|c| file.write_all(&c.to_le_bytes()))?;
        indices.iter().flatten().try_for_each(|i| file.write_all(&i.to_le_bytes()))
    })
}

/// Writes rays.
///
/// # Errors
/// If the file cannot be written.
pub fn write_rays(path: &Path, batch: &Batch) -> Result<(), Error> {
    write(path, |file| {
        file.write_all(b"RAY1")?;
        file.write_all(&u32::from(batch.any).to_le_bytes())?;
        file.write_all(&(batch.rays.len() as u32).to_le_bytes())?;
        for ray in &batch.rays {
            let ([a, b, c], [x, y, z]) = (ray.origin, ray.direction);
            [a, b, c, ray.t_min, x, y, z, ray.t_max]
                .iter()
                .try_for_each(|f| file.write_all(&f.to_le_bytes()))?;
        }
        Ok(())
    })
}

/// Writes hits.
pub(super) fn write_hits(path: &Path, answers: &Answers) -> Result<(), Error> {
    write(path, |file| {
        answers.any.iter().try_for_each(|&hit| file.write_all(&[u8::from(hit)]))?;
        for hit in &answers.closest {
            let [t, u, v] = hit.map_or([0.0; 3], |hit| [hit.t, hit.u, hit.v]);
            [t, u, v].iter().try_for_each(|f| file.write_all(&f.to_le_bytes()))?;
            file.write_all(&hit.map_or(u32::MAX, |hit| hit.primitive).to_le_bytes())?;
        }
        Ok(())
    })
}

fn write(path: &Path, work: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> Result<(), Error> {
    let written = File::create(path).and_then(|file| {
        let mut file = BufWriter::new(file);
        work(&mut file)?;
        file.flush()
    });
    written.map_err(|e| file_error("write", path, e))
}

/// Reads a mesh.
///
/// # Errors
/// If the file cannot be read, its length does not match its counts, or an index is out of range.
pub fn read_mesh(path: &Path) -> Result<TriangleMesh, Error> {
    let (mut file, [vertices, triangles]) = open(path, b"MSH1", |[v, t]| 12 * (u64::from(v) + u64::from(t)))?;
    let mut words = || -> Result<[[u8; 4]; 3], Error> {
        let mut bytes = [0; 12];
        file.read_exact(&mut bytes).map_err(|e| file_error("read", path, e))?;
        Ok(std::array::from_fn(|k| [bytes[4 * k], bytes[4 * k + 1], bytes[4 * k + 2], bytes[4 * k + 3]]))
    };
    let positions =
        (0..vertices).map(|_| Ok(words()?.map(f32::from_le_bytes))).collect::<Result<_, Error>>()?;
    let indices =
        (0..triangles).map(|_| Ok(words()?.map(u32::from_le_bytes))).collect::<Result<_, Error>>()?;
    TriangleMesh::new(positions, indices).map_err(|e| file_error("read", path, e))
}

/// Reads rays; their class is the file's name.
///
/// # Errors
/// If the file cannot be read, or its length does not match its count.
pub fn read_rays(path: &Path) -> Result<Batch, Error> {
    let (mut file, [kind, count]) = open(path, b"RAY1", |[_, count]| 32 * u64::from(count))?;
    if kind > 1 {
        return Err(file_error("read", path, format!("rays are of kind 0 (closest) or 1 (any), not {kind}")));
    }
    let mut ray = || -> Result<Ray, Error> {
        let mut bytes = [0; 32];
        file.read_exact(&mut bytes).map_err(|e| file_error("read", path, e))?;
        let f = |k: usize| {
            f32::from_le_bytes([bytes[4 * k], bytes[4 * k + 1], bytes[4 * k + 2], bytes[4 * k + 3]])
        };
        let ray = Ray::new([f(0), f(1), f(2)], [f(4), f(5), f(6)]);
        Ok(Ray { t_min: f(3), t_max: f(7), ..ray })
    };
    let rays = (0..count).map(|_| ray()).collect::<Result<_, Error>>()?;
    let class = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    Ok(Batch { class, any: kind == 1, rays })
}

/// Opens a file, checks its first four bytes, and checks that its length matches its two counts.
fn open(
    path: &Path,
    magic: &[u8; 4],
    length: impl Fn([u32; 2]) -> u64,
) -> Result<(BufReader<File>, [u32; 2]), Error> {
    let fail = |why: String| Err(file_error("read", path, why));
    let file = File::open(path).map_err(|e| file_error("read", path, e))?;
    let there = file.metadata().map_err(|e| file_error("read", path, e))?.len();
    let (mut file, mut head) = (BufReader::new(file), [0; 12]);
    if there < 12 || file.read_exact(&mut head).is_err() || head[..4] != magic[..] {
        return fail(format!("it does not begin with {}", String::from_utf8_lossy(magic)));
    }
    let number = |k: usize| u32::from_le_bytes([head[k], head[k + 1], head[k + 2], head[k + 3]]);
    let numbers = [number(4), number(8)];
    let wanted = 12 + length(numbers);
    if there != wanted {
        return fail(format!("its numbers {numbers:?} ask for {wanted} bytes, but it has {there}"));
    }
    Ok((file, numbers))
}

/// An error about a setting that names a faulty file.
fn file_error(what: &str, path: &Path, why: impl std::fmt::Display) -> Error {
    Error::Settings(format!("cannot {what} '{}': {why}", path.display()))
}
