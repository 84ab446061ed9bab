//! Tar files, plain or compressed by gzip.

use super::data::{Data, Part};
use super::member::{Member, Packing};
use flate2::read::MultiGzDecoder;
use std::io::{self, Read};
use std::sync::Arc;
use tar::Archive;

/// The first bytes of a gzip file.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Bytes in the first block of every tar file, and their place there.
const MAGIC: (&[u8], usize) = (b"ustar", 257);

/// True if the bytes begin as tar files do, after decompression.
pub(super) fn is_tar(bytes: &[u8]) -> bool {
    let has_magic = |head: &[u8]| head.get(MAGIC.1..).is_some_and(|rest| rest.starts_with(MAGIC.0));
    if !bytes.starts_with(&GZIP) {
        return has_magic(bytes);
    }
    let mut head = Vec::new();
    let mut stream = MultiGzDecoder::new(bytes).take((MAGIC.1 + MAGIC.0.len()) as u64);
    // A stream that is cut off gives what it has.
    _ = stream.read_to_end(&mut head);
    has_magic(&head)
}

/// The files of the archive. One that is compressed by gzip is unpacked into memory, if it takes no more than `limit`
/// bytes: a stream of gzip has no places to start from.
pub(super) fn unpacked(data: Data, limit: u64) -> io::Result<(Data, Vec<Member>)> {
    let mut head = Vec::new();
    Part::whole(data.clone()).take(2).read_to_end(&mut head)?;
    let data = if head == GZIP {
        let mut bytes = Vec::new();
        let stream = MultiGzDecoder::new(Part::whole(data));
        let unpacked = stream.take(limit.saturating_add(1)).read_to_end(&mut bytes);
        unpacked.map_err(|_| io::Error::other("its compressed stream is damaged, or was cut off"))?;
        if bytes.len() as u64 > limit {
            let message = format!(
                "it unpacks to more than the {limit} bytes that are allowed; raise the memory limit if you trust it"
            );
            return Err(io::Error::other(message));
        }
        Data::Memory(Arc::from(bytes))
    } else {
        data
    };
    let damaged = |_| io::Error::other("a header in it is damaged, or it was cut off");
    let mut members = Vec::new();
    for entry in Archive::new(Part::whole(data.clone())).entries_with_seek().map_err(damaged)? {
        let entry = entry.map_err(damaged)?;
        if !entry.header().entry_type().is_file() {
            continue;
        }
        members.push(Member {
            name: String::from_utf8_lossy(&entry.path_bytes()).into_owned(),
            size: entry.size(),
            packing: Packing::Stored,
            start: entry.raw_file_position(),
            stored: entry.size(),
            checksum: None,
        });
    }
    Ok((data, members))
}
