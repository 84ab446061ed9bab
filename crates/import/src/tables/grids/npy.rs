//! Arrays of numpy, with the indices [z][y][x]. [Kern 2007]

use super::numbers::{self, Decode};
use super::{Bytes, Catalogue, GridFormatEntry, Listed, Volume, dense};
use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::input::reading::Source;
use bilux_math::{Aabb, Vec3};
use bilux_scene::media::Grid;

/// The first bytes; the version follows.
pub(super) const SIGNATURE: &[u8] = b"\x93NUMPY";

pub(super) const FORMAT: GridFormatEntry =
    GridFormatEntry { sniff: |bytes| bytes.starts_with(SIGNATURE), list, read, surface: None };

/// Number types, their bytes, and how they are read.
const TYPES: &[(&str, usize, Decode)] = &[
    ("<f4", 4, numbers::floats),
    (">f4", 4, numbers::floats_big),
    ("<f8", 8, numbers::doubles),
    (">f8", 8, numbers::doubles_big),
    ("<f2", 2, numbers::halves),
    ("|u1", 1, numbers::bytes_of_one),
];

fn list(_: &Source) -> Result<Catalogue, FormatError> {
    Ok(Catalogue {
        grids: vec![Listed { name: String::new(), index: 0, refused: None, is_level_set: false }],
        up: None,
    })
}

fn read(source: &Source, _: &Listed, budget: &mut Budget) -> Result<Volume, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    bytes.take(SIGNATURE.len())?;
    let version = bytes.u8()?;
    bytes.u8()?;
    let length = if version == 1 { usize::from(bytes.u16()?) } else { bytes.u32()? as usize };
    let header = bytes.take(length)?;
    let header = String::from_utf8_lossy(header);
    let kind = entry(&header, "descr").and_then(|text| text.split(['\'', '"']).nth(1)).unwrap_or_default();
    let Some(&(_, width, decode)) = TYPES.iter().find(|(name, ..)| *name == kind) else {
        let known: Vec<&str> = TYPES.iter().map(|(name, ..)| *name).collect();
        let message =
            format!("its numbers have the type '{kind}', but only {} can be read", known.join(", "));
        return Err(bytes.fail(message));
    };
    let is_fortran = entry(&header, "fortran_order").is_some_and(|text| text.starts_with("True"));
    let Some([nz, ny, nx]) = entry(&header, "shape").and_then(shape) else {
        return Err(bytes.fail("a grid is an array with three indices, [z][y][x]"));
    };
    let count = [nx, ny, nz].iter().fold(width, |count: usize, side| count.saturating_mul(*side));
    let values = bytes.take(count)?;
    let longest = nx.max(ny).max(nz).max(1) as f32;
    let sides = Vec3::from([nx, ny, nz].map(|side| side as f32)) / longest;
    dense(source, [nx, ny, nz], &Aabb { min: Vec3::ZERO, max: sides }, budget, |y, z, row| {
        if !is_fortran {
            return decode(&values[(z * ny + y) * nx * width..], row);
        }
        // In Fortran's order the first index varies fastest.
        for (x, value) in row.chunks_exact_mut(1).enumerate() {
            decode(&values[((x * ny + y) * nz + z) * width..], value);
        }
    })
}

/// The file of a grid: halves where these are its numbers, otherwise floats.
pub(super) fn write(grid: &Grid) -> Vec<u8> {
    let ([nx, ny, nz], are_halves) = (grid.size(), grid.stored().scale == 1.0);
    let kind = if are_halves { "<f2" } else { "<f4" };
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({nz}, {ny}, {nx}), }}");
    // The numbers begin at a multiple of 64 bytes, and a line ends before them.
    let length = (SIGNATURE.len() + 4 + header.len() + 1).next_multiple_of(64) - SIGNATURE.len() - 4;
    let mut bytes = SIGNATURE.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    for z in 0..nz {
        for y in 0..ny {
            for value in (0..nx).map(|x| grid.voxel([x, y, z])) {
                if are_halves {
                    bytes.extend(half::f16::from_f32(value).to_le_bytes());
                } else {
                    bytes.extend(value.to_le_bytes());
                }
            }
        }
    }
    bytes
}

/// Text after a key of the header, which is a dictionary as Python writes it.
fn entry<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// The lengths along three axes, after which there may be one of a single channel.
fn shape(text: &str) -> Option<[usize; 3]> {
    let (inner, _) = text.strip_prefix('(')?.split_once(')')?;
    let sides = inner.split(',').map(str::trim).filter(|side| !side.is_empty());
    let sides: Vec<usize> = sides.map(str::parse).collect::<Result<_, _>>().ok()?;
    match sides[..] {
        [z, y, x] | [z, y, x, 1] => Some([z, y, x]),
        _ => None,
    }
}
