//! Compressed files, such as the `.gz` files of many scenes.

use crate::FormatError;
use crate::reading::Reading;
use bilux_scene::Span;
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

/// Decompresses bytes if they begin with the gzip header, within the remaining memory.
///
/// The result counts against the budget until [`Reading::release`].
pub(crate) fn plain(
    bytes: Vec<u8>,
    reading: &mut Reading,
    path: &Path,
    at: &Span,
) -> Result<Vec<u8>, FormatError> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let name = path.display().to_string();
    let limit = reading.budget.left();
    let mut unpacked = Vec::new();
    let mut decoder = MultiGzDecoder::new(bytes.as_slice()).take(limit.saturating_add(1));
    decoder.read_to_end(&mut unpacked).map_err(|error| {
        FormatError::malformed(
            format!("'{name}' cannot be decompressed: {error}; compress it again"),
            at.clone(),
        )
    })?;
    reading.budget.take_bytes(unpacked.len() as u64, &name)?;
    reading.release(bytes);
    Ok(unpacked)
}
