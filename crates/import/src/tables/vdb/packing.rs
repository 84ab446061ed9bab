//! Compressed runs of bytes: zlib, and the containers of Blosc. [Alted 2010]

use flate2::read::ZlibDecoder;
use std::io::Read;

/// Unpacks a zlib stream of known length.
pub(super) fn unzip(packed: &[u8], out: &mut [u8]) -> Result<(), String> {
    ZlibDecoder::new(packed)
        .read_exact(out)
        .map_err(|error| format!("bytes cannot be decompressed (zlib): {error}"))
}

/// The bytes of a container's header.
const HEADER: usize = 16;
/// Bytes of numbers are sorted by their places in them.
const SHUFFLED: u8 = 1;
/// The bytes are not compressed.
const STORED: u8 = 2;
/// Bits of numbers are sorted by their places.
const BITS_SHUFFLED: u8 = 4;
/// Each block is one stream, and not one for each byte of a number.
const WHOLE: u8 = 16;
/// Numbers of more bytes, and streams of fewer, are not divided.
const MAX_STREAMS: usize = 16;
const MIN_STREAM: usize = 128;

/// The compressors by their numbers.
const COMPRESSORS: [&str; 5] = ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"];

/// Unpacks a container of Blosc 1 of known length.
pub(super) fn unblosc(packed: &[u8], out: &mut [u8]) -> Result<(), String> {
    let header = packed.get(..HEADER).ok_or("a Blosc container is shorter than its header")?;
    let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| header[at + i])) as usize;
    let (flags, width) = (header[2], usize::from(header[3]).max(1));
    let (length, block) = (number(4), number(8));
    if length != out.len() {
        return Err(format!("a Blosc container has {length} bytes instead of {}", out.len()));
    }
    if flags & STORED != 0 {
        out.copy_from_slice(packed[HEADER..].get(..length).ok_or("a Blosc container was cut off")?);
        return Ok(());
    }
    if flags & BITS_SHUFFLED != 0 {
        return Err(
            "a Blosc container with shuffled bits cannot be read: write the file with zip or no compression"
                .into(),
        );
    }
    if block == 0 {
        return Err("a Blosc container has blocks of 0 bytes".into());
    }
    let mut shuffled = vec![0; block.min(length)];
    for (i, part) in out.chunks_mut(block).enumerate() {
        let shuffled = &mut shuffled[..part.len()];
        let begin = word(packed, HEADER + 4 * i)?;
        let divides =
            flags & WHOLE == 0 && width <= MAX_STREAMS && block / width >= MIN_STREAM && part.len() == block;
        let streams = if divides { width } else { 1 };
        unpack_block(packed, begin, shuffled, streams, usize::from(flags >> 5))?;
        if flags & SHUFFLED != 0 && width > 1 {
            unshuffle(shuffled, part, width);
        } else {
            part.copy_from_slice(shuffled);
        }
    }
    Ok(())
}

fn word(packed: &[u8], at: usize) -> Result<usize, String> {
    let bytes = packed.get(at..).and_then(<[u8]>::first_chunk).ok_or("a Blosc container was cut off")?;
    Ok(u32::from_le_bytes(*bytes) as usize)
}

/// Unpacks the streams of a block, which begin at a place.
fn unpack_block(
    packed: &[u8],
    begin: usize,
    out: &mut [u8],
    streams: usize,
    compressor: usize,
) -> Result<(), String> {
    let (mut at, each) = (begin, out.len() / streams);
    for part in out[..each * streams].chunks_mut(each.max(1)) {
        let size = word(packed, at)?;
        at += 4;
        let stream =
            packed.get(at..).and_then(|rest| rest.get(..size)).ok_or("a Blosc container was cut off")?;
        at += size;
        if size == part.len() {
            part.copy_from_slice(stream);
            continue;
        }
        match compressor {
            1 => match lz4_flex::block::decompress_into(stream, part) {
                Ok(count) if count == part.len() => {}
                Ok(count) => return Err(format!("LZ4 gives {count} bytes instead of {}", part.len())),
                Err(error) => return Err(format!("bytes cannot be decompressed (LZ4): {error}")),
            },
            3 => unzip(stream, part)?,
            _ => {
                let name = COMPRESSORS.get(compressor).unwrap_or(&"an unknown compressor");
                return Err(format!(
                    "a Blosc container of {name} cannot be read: write the file with LZ4, zip or no compression"
                ));
            }
        }
    }
    Ok(())
}

/// Puts the bytes of numbers together again; what is left over stays as it is.
fn unshuffle(shuffled: &[u8], out: &mut [u8], width: usize) {
    let count = shuffled.len() / width;
    for (i, number) in out.chunks_exact_mut(width).enumerate() {
        for (j, byte) in number.iter_mut().enumerate() {
            *byte = shuffled[j * count + i];
        }
    }
    out[count * width..].copy_from_slice(&shuffled[count * width..]);
}
