//! A file of a cache.

use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_math::Vec3;
use bilux_scene::Span;
use std::io::Read;
use std::path::Path;

const CUT_OFF: &str = "ends too early: it is not a whole cache of points";

/// The numbers of control points and of corners of a mesh.
#[derive(Clone, Copy)]
pub(super) struct Counts {
    pub(super) points: usize,
    pub(super) corners: usize,
}

/// A file of a cache that is being read from its beginning to its end.
pub(super) struct CacheFile {
    pub(super) stream: Box<dyn Read>,
    name: String,
    at: Span,
}

impl CacheFile {
    pub(super) fn open(path: &Path, at: Span, reading: &mut Reading) -> Result<CacheFile, FormatError> {
        let (stream, length) = reading.open_file(path)?;
        // What is packed may be endless.
        let stream = std::io::BufReader::new(stream.take(length.max(reading.budget.left())));
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(CacheFile { stream: Box::new(stream), name, at })
    }

    pub(super) fn error(&self, what: &str) -> FormatError {
        FormatError::malformed(format!("'{}' {what}", self.name), self.at.clone())
    }

    pub(super) fn fill(&mut self, bytes: &mut [u8]) -> Result<(), FormatError> {
        self.stream.read_exact(bytes).map_err(|_| self.error(CUT_OFF))
    }

    pub(super) fn skip(&mut self, count: u64) -> Result<(), FormatError> {
        let skipped = std::io::copy(&mut self.stream.by_ref().take(count), &mut std::io::sink());
        match skipped {
            Ok(skipped) if skipped == count => Ok(()),
            _ => Err(self.error(CUT_OFF)),
        }
    }

    /// Vectors of as many bytes each, which `decode` understands.
    pub(super) fn vectors<const BYTES: usize>(
        &mut self,
        count: usize,
        decode: impl Fn(&[u8; BYTES]) -> Vec3,
        reading: &mut Reading,
    ) -> Result<Vec<Vec3>, FormatError> {
        reading.budget.take::<Vec3>(count, &self.name)?;
        let mut vectors = Vec::with_capacity(count);
        let mut one = [0; BYTES];
        for _ in 0..count {
            self.fill(&mut one)?;
            vectors.push(decode(&one));
        }
        Ok(vectors)
    }
}
