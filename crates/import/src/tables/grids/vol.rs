//! Mitsuba's `.vol`: a number for each voxel of a box. [Jakob 2022]

use super::numbers::{self, Decode};
use super::{Bytes, COLOURS, Catalogue, GridFormatEntry, Listed, Volume, dense};
use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::input::reading::Source;
use bilux_math::{Aabb, Vec3};

/// The first bytes, of which the last is the version.
pub(super) const SIGNATURE: &[u8] = b"VOL\x03";

/// The number types of values, from 1: their bytes, and how they are read.
const TYPES: [(usize, Decode); 3] = [(4, numbers::floats), (2, numbers::halves), (1, numbers::bytes_of_one)];

pub(super) const FORMAT: GridFormatEntry =
    GridFormatEntry { sniff: |bytes| bytes.starts_with(SIGNATURE), list, read, surface: None };

fn list(source: &Source) -> Result<Catalogue, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    bytes.take(SIGNATURE.len() + 16)?;
    let channels = bytes.i32()?;
    let refused = (channels != 1 && channels != 3)
        .then(|| format!("has {channels} channels, but a density is one number for each voxel"));
    let mut grids = vec![Listed { name: String::new(), index: 0, refused, is_level_set: false }];
    if channels == 3 {
        let name = |(index, name): (usize, &&str)| Listed {
            name: (*name).into(),
            index,
            refused: None,
            is_level_set: false,
        };
        grids = ["mean"].iter().chain(&COLOURS).enumerate().map(name).collect();
    }
    Ok(Catalogue { grids, up: None })
}

/// A file of colours has its mean first, and then each of them.
fn read(source: &Source, listed: &Listed, budget: &mut Budget) -> Result<Volume, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    bytes.take(SIGNATURE.len())?;
    let kind = bytes.i32()?;
    let size = bytes.i32s()?.map(|side| usize::try_from(side).unwrap_or(0));
    let channels = if bytes.i32()? == 3 { 3 } else { 1 };
    let mut corners = [0.0; 6];
    for number in &mut corners {
        *number = bytes.f32()?;
    }
    let known = usize::try_from(kind).ok().and_then(|kind| TYPES.get(kind.checked_sub(1)?));
    let Some(&(width, decode)) = known else {
        return Err(bytes.fail(format!("its numbers have the type {kind}, but only 1 to 3 are known")));
    };
    let voxel = width * channels;
    let wanted = size.iter().fold(voxel, |count: usize, side| count.saturating_mul(*side));
    let values = bytes.take(wanted)?;
    let [a, b] = [0, 3].map(|i| Vec3::from_slice(&corners[i..]));
    // A file without a box fills the unit cube, as in Mitsuba.
    let bounds = if a.is_finite() && b.is_finite() && (b - a).min_element() > 0.0 {
        Aabb { min: a, max: b }
    } else {
        Aabb { min: Vec3::ZERO, max: Vec3::ONE }
    };
    let mut volume = dense(source, size, &bounds, budget, |y, z, row| {
        let values = &values[(z * size[1] + y) * size[0] * voxel..];
        if channels == 1 {
            return decode(values, row);
        }
        for (value, bytes) in row.iter_mut().zip(values.chunks_exact(voxel)) {
            let mut colour = [0.0; 3];
            decode(bytes, &mut colour);
            *value = match listed.index.checked_sub(1) {
                Some(channel) => colour[channel],
                None => colour.iter().sum::<f32>() / 3.0,
            };
        }
    })?;
    volume.is_mean = channels == 3 && listed.index == 0;
    Ok(volume)
}
