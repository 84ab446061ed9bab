//! PC2, the caches of 3ds Max and Blender: a header of 32 bytes, and the positions of all points for one frame after the
//! other, in numbers that begin with the low byte.

use super::around::Around;
use super::file::CacheFile;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_math::Vec3;

pub(super) const SIGNATURE: &[u8; 12] = b"POINTCACHE2\0";

/// The positions at a frame, from a file behind its signature.
pub(super) fn read(
    mut file: CacheFile,
    frame: f64,
    points: usize,
    reading: &mut Reading,
) -> Result<Vec<Vec3>, FormatError> {
    let mut header = [0; 20];
    file.fill(&mut header)?;
    let field = |i: usize| -> [u8; 4] { std::array::from_fn(|byte| header[4 * i + byte]) };
    let [version, count, samples] = [0, 1, 4].map(|i| i32::from_le_bytes(field(i)));
    let [start, step] = [2, 3].map(|i| f64::from(f32::from_le_bytes(field(i))));
    if version != 1 {
        return Err(
            file.error(&format!("is of version {version}, of which nothing is known: save it as version 1"))
        );
    }
    if usize::try_from(count) != Ok(points) {
        return Err(file.error(&format!("is of {count} points, and the mesh has {points}: save it again")));
    }
    if samples < 1 || !start.is_finite() || !(step.is_finite() && step > 0.0) {
        return Err(file.error("states no times that could be: save it again"));
    }
    let place = ((frame - start) / step).clamp(0.0, f64::from(samples - 1));
    let mut around = Around::new(place);
    let first = place.floor();
    file.skip(first as u64 * 12 * points as u64)?;
    for sample in [first, first + 1.0].into_iter().filter(|&sample| sample < place + 1.0) {
        let vectors = file.vectors(points, |bytes: &[u8; 12]| little(bytes), reading)?;
        around.add(sample, vectors);
    }
    Ok(around.vectors())
}

fn little(bytes: &[u8; 12]) -> Vec3 {
    let number = |i: usize| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * i + byte]));
    Vec3::new(number(0), number(1), number(2))
}
