//! The directory of a zip file.

use super::data::{Data, Part};
use super::member::{Member, Packing};
use std::io::{self, Read};
use zip::result::ZipError;
use zip::{CompressionMethod, ZipArchive};

/// The first bytes of a zip file.
pub(super) const SIGNATURE: &[u8] = b"PK\x03\x04";

/// True if the data are a zip file. One without members begins with its directory.
pub(super) fn is_zip(data: &Data) -> io::Result<bool> {
    let mut head = Vec::new();
    Part::whole(data.clone()).take(4).read_to_end(&mut head)?;
    Ok(head.starts_with(&SIGNATURE[..2]))
}

/// The files of the archive, as its directory lists them.
pub(super) fn members(data: &Data) -> io::Result<Vec<Member>> {
    let mut archive = ZipArchive::new(Part::whole(data.clone())).map_err(reason)?;
    let mut members = Vec::new();
    for place in 0..archive.len() {
        let file = archive.by_index_raw(place).map_err(reason)?;
        if file.is_dir() {
            continue;
        }
        let packing = match file.compression() {
            _ if file.encrypted() => Packing::Unknown("encrypted".to_owned()),
            CompressionMethod::Stored => Packing::Stored,
            CompressionMethod::Deflated => Packing::Deflated,
            other => Packing::Unknown(format!("packed by {other}, which is not supported")),
        };
        members.push(Member {
            name: file.name().map_err(reason)?.into_owned(),
            size: file.size(),
            packing,
            start: file.data_start().ok_or_else(|| io::Error::other("a member has no place in it"))?,
            stored: file.compressed_size(),
            checksum: Some(file.crc32()),
        });
    }
    check_apart(&members)?;
    Ok(members)
}

/// Refuses members that share bytes: a few of them could stand for more than any disk holds. [Fifield 2019]
fn check_apart(members: &[Member]) -> io::Result<()> {
    let mut places: Vec<(u64, u64, &str)> =
        members.iter().map(|m| (m.start, m.start.saturating_add(m.stored), &*m.name)).collect();
    places.sort_unstable();
    match places.windows(2).find(|pair| pair[1].0 < pair[0].1 && pair[1].1 > pair[1].0) {
        Some(pair) => {
            Err(io::Error::other(format!("its members '{}' and '{}' overlap", pair[0].2, pair[1].2)))
        }
        None => Ok(()),
    }
}

fn reason(error: ZipError) -> io::Error {
    match error {
        ZipError::Io(error) => error,
        ZipError::UnsupportedArchive(what) => io::Error::other(format!("it is of an unknown kind ({what})")),
        _ => io::Error::other("its directory is missing or damaged, as in a file that was cut off"),
    }
}
