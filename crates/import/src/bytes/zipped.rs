//! Writes zip files.

use crate::FormatError;
use crate::bytes::text::whole_file;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Way in which members are stored.
#[derive(Clone, Copy, Debug)]
pub enum Members {
    /// As they are, each at a multiple of 64 bytes, so that programs can map them into memory, as USDZ demands.
    Aligned,
    Deflated,
}

/// A zip file of these members, by name. No member has a date.
///
/// # Errors
/// If it would be larger than four gigabytes.
pub fn zipped(members: &[(String, Vec<u8>)], how: Members) -> Result<Vec<u8>, FormatError> {
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    let options = match how {
        Members::Aligned => options.compression_method(CompressionMethod::Stored).with_alignment(64),
        Members::Deflated => options.compression_method(CompressionMethod::Deflated),
    };
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let mut add = |name: &str, bytes: &[u8]| {
        zip.start_file(name, options)?;
        Ok(zip.write_all(bytes)?)
    };
    for (name, bytes) in members {
        add(name, bytes).map_err(|error| refused(name, &error))?;
    }
    let name = members.first().map_or("", |(name, _)| name);
    Ok(zip.finish().map_err(|error| refused(name, &error))?.into_inner())
}

fn refused(name: &str, error: &zip::result::ZipError) -> FormatError {
    FormatError::malformed(format!("it cannot be stored in a zip file: {error}"), whole_file(&name.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aligned_members_begin_at_multiples_of_64() {
        let members: Vec<(String, Vec<u8>)> =
            (1..5).map(|i| ("n".repeat(i), vec![i as u8 + 200; 17 * i])).collect();
        let bytes = zipped(&members, Members::Aligned).unwrap();
        for (_, data) in members {
            let start = bytes.windows(data.len()).position(|window| window == data).unwrap();
            assert_eq!(start % 64, 0, "{start}");
        }
        assert!(bytes.windows(4).any(|window| window == b"PK\x05\x06"));
    }
}
