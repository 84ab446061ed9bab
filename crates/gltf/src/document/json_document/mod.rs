//! The whole document: its JSON and the bytes of its buffers.

use crate::document::container::Container;
use crate::document::json::JsonNode;
use crate::document::meshopt;
use crate::document::uri;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// The JSON and the buffers.
pub(crate) struct Document<'a> {
    pub(crate) root: JsonNode<'a>,
    source: Source<'a>,
    buffers: Vec<Cow<'a, [u8]>>,
    /// The bytes of compressed views after decompression, by index.
    unpacked: HashMap<usize, Vec<u8>>,
    /// The data of accessors whose primitives are compressed as a whole (Draco), by index.
    drawn: HashMap<usize, DecodedAccessor>,
    /// The size in bytes of all buffers and of the file itself.
    size: usize,
    /// True if the file contains a buffer of its own.
    has_binary: bool,
}

/// The data of an accessor that lies in no buffer, as consecutive elements.
pub(crate) struct DecodedAccessor {
    pub(crate) bytes: Vec<u8>,
    /// The number of elements.
    pub(crate) count: usize,
}

/// A slice of a buffer.
#[derive(Clone, Copy)]
pub(crate) struct BufferView<'d> {
    pub(crate) bytes: &'d [u8],
    /// Bytes from one element to the next, if the view states it.
    pub(crate) stride: Option<usize>,
}

impl<'a> Document<'a> {
    /// Loads every buffer, and decompresses those views that are compressed.
    pub(crate) fn load(
        root: JsonNode<'a>,
        container: &Container<'a>,
        reading: &mut Reading,
        source: &Source<'a>,
        diagnostics: &mut Diagnostics,
    ) -> Result<Document<'a>, FormatError> {
        let mut buffers = Vec::new();
        for (i, node) in root.list("buffers")?.into_iter().enumerate() {
            let wanted = node.need("byteLength")?.as_count()?;
            if node.get("uri").is_some_and(|uri| uri.as_text().is_ok_and(uri::is_odd)) {
                diagnostics
                    .note("the part of a data URI before its comma is malformed and is ignored", || {
                        node.at()
                    });
            }
            let bytes: Cow<[u8]> = match (node.get("uri"), container.binary) {
                (Some(uri), _) => Cow::Owned(uri::load(reading, source, uri)?),
                (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
                // Only a decoder fills this buffer; reading from it is an error.
                (None, _) => Cow::Borrowed(&[]),
            };
            if bytes.len() < wanted && !bytes.is_empty() {
                diagnostics.note("a buffer is shorter than its byteLength says", || node.at());
            }
            buffers.push(bytes);
        }
        if container.binary.is_some_and(|b| !b.is_empty()) && buffers.is_empty() {
            diagnostics.note("no buffer refers to the binary chunk, so it is not used", || root.at());
        }
        let size = buffers.iter().map(|b| b.len()).sum::<usize>() + source.bytes.len();
        let mut document = Document {
            root,
            source: *source,
            buffers,
            unpacked: HashMap::new(),
            drawn: HashMap::new(),
            size,
            has_binary: container.binary.is_some(),
        };
        document.unpacked = document.unpack(reading)?;
        Ok(document)
    }

    /// This document with data for accessors that lie in no buffer.
    #[cfg(feature = "draco")]
    pub(crate) fn with_drawn(self, drawn: HashMap<usize, DecodedAccessor>) -> Document<'a> {
        Document { drawn, ..self }
    }

    /// The name of the file.
    pub(crate) fn file(&self) -> &'a str {
        self.source.name
    }

    /// The folder that relative names refer to.
    pub(crate) fn folder(&self) -> Option<&'a Path> {
        self.source.folder
    }

    fn unpack(&self, reading: &mut Reading) -> Result<HashMap<usize, Vec<u8>>, FormatError> {
        let mut unpacked = HashMap::new();
        for (i, view) in self.root.list("bufferViews")?.into_iter().enumerate() {
            let Some(extension) = view.extension(meshopt::NAME) else { continue };
            let bytes = self.buffer(extension.need("buffer")?)?;
            unpacked.insert(i, meshopt::unpacked(extension, bytes, &mut reading.budget)?);
        }
        Ok(unpacked)
    }

    /// The data of an accessor that was compressed with its whole primitive.
    pub(crate) fn drawn(&self, accessor: usize) -> Option<&DecodedAccessor> {
        self.drawn.get(&accessor)
    }

    /// The size in bytes of all that was read: a bound on what an honest file can describe without data.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// True if the file contains a buffer of its own, as GLB may.
    pub(crate) fn has_binary(&self) -> bool {
        self.has_binary
    }

    /// The length of a buffer in bytes.
    pub(crate) fn buffer_length(&self, index: usize) -> usize {
        self.buffers.get(index).map_or(0, |bytes| bytes.len())
    }

    /// A warning about a buffer view that can still be read.
    ///
    /// # Errors
    /// If the view cannot be read.
    pub(crate) fn check_view(&self, view: JsonNode<'a>) -> Result<Option<&'static str>, FormatError> {
        if view.extension(meshopt::NAME).is_some() {
            return Ok(None);
        }
        let found = self.part(view, self.buffer(view.need("buffer")?)?)?;
        Ok(match found.stride {
            Some(stride) if stride % 4 != 0 => Some("byteStride must be a multiple of 4"),
            Some(stride) if stride > found.bytes.len() => Some("byteStride is more than the view has bytes"),
            _ if found.bytes.is_empty() => {
                Some("a buffer view must have at least 1 byte, but this one has none")
            }
            _ => None,
        })
    }

    /// The item that `index` refers to in a list of the document.
    pub(crate) fn named(&self, list: &'a str, index: JsonNode<'a>) -> Result<JsonNode<'a>, FormatError> {
        let number = index.as_count()?;
        self.root.item(list, number).ok_or_else(|| {
            let count = self.root.list(list).map_or(0, |items| items.len());
            index.error(format!(
                "this refers to number {number} of '{list}', but the file has only {count}, counted from 0"
            ))
        })
    }

    fn buffer(&self, index: JsonNode<'a>) -> Result<&[u8], FormatError> {
        self.named("buffers", index)?;
        Ok(&self.buffers[index.as_count()?])
    }

    /// The bytes of the buffer view that `index` refers to.
    pub(crate) fn view(&self, index: JsonNode<'a>) -> Result<BufferView<'_>, FormatError> {
        let node = self.named("bufferViews", index)?;
        let buffer = self.buffer(node.need("buffer")?)?;
        match self.unpacked.get(&index.as_count()?) {
            Some(bytes) => Ok(BufferView { bytes, stride: node.count("byteStride")? }),
            None => self.part(node, buffer),
        }
    }

    /// The slice of a buffer that a view describes.
    fn part<'s>(&'s self, node: JsonNode<'a>, buffer: &'s [u8]) -> Result<BufferView<'s>, FormatError> {
        let offset = node.count("byteOffset")?.unwrap_or(0);
        let length = node.need("byteLength")?.as_count()?;
        let end = offset.checked_add(length);
        let bytes = end.and_then(|end| buffer.get(offset..end)).ok_or_else(|| {
            let have = buffer.len();
            let message =
                format!("{length} bytes from byte {offset} extend beyond the buffer, which has {have}");
            node.error(message)
        })?;
        let stride = node.count("byteStride")?;
        if let Some(stride) = stride.filter(|stride| !(4..=252).contains(stride)) {
            return Err(node.error(format!("byteStride is {stride}, but must be from 4 to 252")));
        }
        Ok(BufferView { bytes, stride })
    }
}
