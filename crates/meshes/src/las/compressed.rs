//! LAZ: points that are compressed in chunks. COPC is LAZ too, with an index that reading all of it does not need.

use super::header::{Header, read_header, u16_at, u32_at};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::reading::{Reading, Source};
use bilux_pictures::guarded_decoding;
use laz::{DecompressionSelection, LasZipDecompressor, LazItemType, LazVlr};
use std::borrow::Cow;
use std::io::Cursor;

/// The header of a variable length record, and where in it are the name of its program, its number and its length.
const RECORD_HEADER: usize = 54;
const PROGRAM: &[u8] = b"laszip encoded";
const NUMBER: u16 = 22204;

/// The compressor of the first versions: points in one stream, without chunks.
const ONE_STREAM: u16 = 1;

/// Bytes of the record with the number of points in a chunk.
const CHUNK_SIZE: std::ops::Range<usize> = 12..16;

/// Place of the colour in a kept point, after three coordinates, the intensity, and two bytes of returns, flags and classes.
const COLOUR: usize = 16;

/// The points of a file as records of their own, with the header that describes these.
pub(super) fn unpacked(
    reading: &mut Reading,
    source: &Source,
    header: Header,
) -> Result<(Vec<u8>, Header), FormatError> {
    let fail = |why: &str| {
        FormatError::malformed(
            format!("the compressed points cannot be read: {why}"),
            whole_file(source.name),
        )
    };
    let damaged = || fail("they are damaged, or the file was cut off");
    let record = description(source.bytes)
        .ok_or_else(|| fail("the record that says how they are compressed is missing"))?;
    let record = &*in_chunks(record);
    let vlr = guarded_decoding(|| LazVlr::from_buffer(record).ok()).flatten().ok_or_else(damaged)?;
    // The decompressor's own sum may overflow.
    let size: u64 = vlr.items().iter().map(|item| u64::from(item.size())).sum();
    if size != header.record as u64 {
        return Err(fail("the header and the record of the compression disagree about the size of a point"));
    }
    let held = check_sizes(source.bytes, &header, record, &vlr).ok_or_else(damaged)?;
    reading.budget.take_bytes(held, source.name)?;
    let width = COLOUR + if header.colour.is_some() { 6 } else { 0 };
    let total = header.count.saturating_mul(width as u64);
    reading.budget.take_bytes(total, source.name)?;
    let unpacked = guarded_decoding(|| -> Option<Vec<u8>> {
        let mut from = Cursor::new(source.bytes);
        from.set_position(header.points as u64);
        let wanted = DecompressionSelection::base()
            .decompress_z()
            .decompress_intensity()
            .decompress_flags()
            .decompress_classification()
            .decompress_rgb();
        let mut decompressor = LasZipDecompressor::selective(from, vlr, wanted).ok()?;
        let (mut point, mut all) = (vec![0; header.record], Vec::new());
        for _ in 0..header.count {
            decompressor.decompress_one(&mut point).ok()?;
            all.extend_from_slice(point.get(..COLOUR)?);
            if let Some(at) = header.colour {
                all.extend_from_slice(point.get(at..at + 6)?);
            }
        }
        Some(all)
    });
    let all = unpacked.flatten().ok_or_else(damaged)?;
    let colour = header.colour.map(|_| COLOUR);
    Ok((all, Header { points: 0, record: width, colour, ..header }))
}

/// The content of the record that says how points are compressed.
fn description(bytes: &[u8]) -> Option<&[u8]> {
    let mut at = usize::from(u16_at(bytes, 94));
    for _ in 0..u32_at(bytes, 100) {
        let head = bytes.get(at..at + RECORD_HEADER)?;
        let length = usize::from(u16_at(head, 20));
        let content = bytes.get(at + RECORD_HEADER..at + RECORD_HEADER + length)?;
        if head[2..].starts_with(PROGRAM) && u16_at(head, 18) == NUMBER {
            return Some(content);
        }
        at += RECORD_HEADER + length;
    }
    None
}

/// The record with a size of chunks. The first versions (LASzip 1.2) have no chunks and no size, for which the decompressor
/// would look for a table of chunks of different sizes.
fn in_chunks(record: &[u8]) -> Cow<'_, [u8]> {
    if record.len() < CHUNK_SIZE.end || u16_at(record, 0) != ONE_STREAM {
        return record.into();
    }
    let mut record = record.to_vec();
    record[CHUNK_SIZE].copy_from_slice(&1u32.to_le_bytes());
    record.into()
}

/// Checks the sizes that the decompressor takes from the file: the number of chunks, and the sizes of their layers.
/// Returns how much memory it will take, in bytes.
fn check_sizes(bytes: &[u8], header: &Header, record: &[u8], vlr: &LazVlr) -> Option<u64> {
    if u16_at(record, 0) == ONE_STREAM {
        return Some(0);
    }
    let at = |place: usize| Some(i64::from_le_bytes(*bytes.get(place..)?.first_chunk()?));
    let mut table = at(header.points)?;
    if table <= header.points as i64 {
        // A writer that cannot go back writes the place at the end.
        table = at(bytes.len().checked_sub(8)?)?;
    }
    let table = usize::try_from(table).ok()?;
    let chunks = u32_at(bytes.get(table..)?, 4) as usize;
    if chunks > bytes.len() {
        return None;
    }
    let layers = |item: &laz::LazItem| match item.item_type() {
        LazItemType::Point14 => 9,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(count) => usize::from(count),
        LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
        _ => 0,
    };
    let layers: usize = vlr.items().iter().map(layers).sum();
    if layers == 0 {
        return Some(16 * chunks as u64);
    }
    let mut from = Cursor::new(bytes);
    from.set_position(header.points as u64);
    let table = guarded_decoding(|| laz::laszip::ChunkTable::read_from(&mut from, vlr).ok()).flatten()?;
    let mut counts = (&table).into_iter().map(|chunk| chunk.point_count);
    // The decompressor goes from chunk to chunk by the sizes of the layers, whatever sizes the table states.
    let (mut largest, mut start, mut left) = (0u64, header.points + 8, header.count);
    while left > 0 {
        let counted = start.checked_add(header.record)?;
        let sizes = bytes.get(counted + 4..)?.get(..4 * layers)?;
        let total: u64 = (0..layers).map(|layer| u64::from(u32_at(sizes, 4 * layer))).sum();
        start = usize::try_from(total).ok()?.checked_add(counted + 4 + 4 * layers)?;
        if start > bytes.len() {
            return None;
        }
        largest = largest.max(total);
        let held = if vlr.uses_variable_size_chunks() {
            // It may go by either of the two counts.
            u64::from(u32_at(bytes, counted)).min(counts.next()?)
        } else {
            u64::from(vlr.chunk_size())
        };
        left = left.saturating_sub(held.max(1));
    }
    Some(16 * chunks as u64 + 2 * largest)
}

/// The header of a file, and its points: those of the file, or what is unpacked of them.
pub(super) fn points<'s>(
    reading: &mut Reading,
    source: &'s Source,
) -> Result<(Cow<'s, [u8]>, Header), FormatError> {
    let header = read_header(source)?;
    if header.is_compressed {
        let (bytes, header) = unpacked(reading, source, header)?;
        return Ok((bytes.into(), header));
    }
    Ok((source.bytes.into(), header))
}
