//! Mitsuba's `.vol`: a number for each voxel of a box. [Jakob 2022]

use super::numbers::{self, Decode};
use super::{Bytes, Catalogue, GridFormatEntry, Listed, Volume, dense};
use crate::FormatError;
use crate::budget::Budget;
use crate::reading::Source;
use bilux_math::{Aabb, Vec3};

/// The first bytes, of which the last is the version.
pub(crate) const SIGNATURE: &[u8] = b"VOL\x03";

/// The number types of values, from 1: their bytes, and how they are read.
const TYPES: [(usize, Decode); 3] = [(4, numbers::floats), (2, numbers::halves), (1, numbers::bytes_of_one)];

pub(super) const FORMAT: GridFormatEntry =
    GridFormatEntry { sniff: |bytes| bytes.starts_with(SIGNATURE), list, read };

fn list(source: &Source) -> Result<Catalogue, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    bytes.take(SIGNATURE.len() + 16)?;
    let channels = bytes.i32()?;
    let refused = (channels != 1)
        .then(|| format!("has {channels} channels, but a density is one number for each voxel"));
    Ok(Catalogue { grids: vec![Listed { name: String::new(), index: 0, refused }], up: None })
}

fn read(source: &Source, _: &Listed, budget: &mut Budget) -> Result<Volume, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    bytes.take(SIGNATURE.len())?;
    let kind = bytes.i32()?;
    let size = bytes.i32s()?.map(|side| usize::try_from(side).unwrap_or(0));
    bytes.take(4)?;
    let mut corners = [0.0; 6];
    for number in &mut corners {
        *number = bytes.f32()?;
    }
    let known = usize::try_from(kind).ok().and_then(|kind| TYPES.get(kind.checked_sub(1)?));
    let Some(&(width, decode)) = known else {
        return Err(bytes.fail(format!("its numbers have the type {kind}, but only 1 to 3 are known")));
    };
    let wanted = size.iter().fold(width, |count: usize, side| count.saturating_mul(*side));
    let values = bytes.take(wanted)?;
    let [a, b] = [0, 3].map(|i| Vec3::from_slice(&corners[i..]));
    // A file without a box fills the unit cube, as in Mitsuba.
    let bounds = if a.is_finite() && b.is_finite() && (b - a).min_element() > 0.0 {
        Aabb { min: a, max: b }
    } else {
        Aabb { min: Vec3::ZERO, max: Vec3::ONE }
    };
    dense(source, size, &bounds, budget, |y, z, row| {
        decode(&values[(z * size[1] + y) * size[0] * width..], row);
    })
}
