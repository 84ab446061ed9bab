//! Files compressed by gzip, which are read as what they hold: `.stl.gz`, or any other name.

use flate2::read::MultiGzDecoder;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};

/// The first bytes of such a file.
pub const SIGNATURE: [u8; 2] = [0x1f, 0x8b];

/// A stream as it is, or as what it decompresses to.
///
/// # Errors
/// If its first bytes cannot be read.
pub fn plain<'s>(mut stream: Box<dyn Read + Send + 's>) -> io::Result<Box<dyn Read + Send + 's>> {
    let mut head = Vec::new();
    stream.by_ref().take(SIGNATURE.len() as u64).read_to_end(&mut head)?;
    let is_compressed = head == SIGNATURE;
    let whole = Cursor::new(head).chain(stream);
    Ok(if is_compressed { Box::new(Unpacked(MultiGzDecoder::new(whole))) } else { Box::new(whole) })
}

/// The name of a file without a last `.gz`, which says how it is packed and not what it is.
pub fn plain_name(path: &Path) -> PathBuf {
    let is_packed = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_packed { path.with_extension("") } else { path.to_owned() }
}

/// A decompressed stream whose errors say what to do.
struct Unpacked<R>(MultiGzDecoder<R>);

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.0.read(into).map_err(|error| match error.kind() {
            io::ErrorKind::Interrupted => error,
            kind => io::Error::new(kind, format!("it cannot be decompressed: {error}; compress it again")),
        })
    }
}
