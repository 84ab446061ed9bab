//! Faults in a file that do not affect the scene or can be worked around. They are reported, since the author may
//! have meant another image.

use super::accessor::Accessor;
use super::json::JsonNode;
use super::reader::Gltf;
use super::{meshopt, validate};
use crate::FormatError;

impl<'d> Gltf<'d, '_, '_> {
    /// Reads the images that no material uses, and validates the bytes of all.
    pub(super) fn validate_images(&mut self) -> Result<(), FormatError> {
        let root = self.document.root;
        let all: Vec<JsonNode<'d>> =
            root.get("images").map(|list| list.children().collect()).unwrap_or_default();
        for (number, image) in all.into_iter().enumerate() {
            let is_placed = image.get("uri").is_some() != image.get("bufferView").is_some();
            if !is_placed || !image.is_object() {
                continue;
            }
            match self.encoded(image) {
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => self.oddities.note(&error.without_place(), || image.at()),
                Ok((_, bytes)) => {
                    validate::image((image, number), &bytes, root, &mut self.oddities);
                    self.release_encoded(bytes);
                    let is_read = [true, false].iter().any(|&is_data| self.has_read(number, is_data));
                    if !is_read && let Err(error) = self.decode(image, false) {
                        if let FormatError::TooLarge { .. } = error {
                            return Err(error);
                        }
                        self.oddities.note(&error.without_place(), || image.at());
                    }
                }
            }
        }
        Ok(())
    }

    /// Warns about buffers, views and accessors that violate the specification. [glTF 2.0, 3.6]
    pub(super) fn check_data(&mut self) -> Result<(), FormatError> {
        let root = self.document.root;
        for buffer in root.list("buffers")? {
            let wanted = buffer.count("byteLength")?;
            let is_stand_in = buffer.extension(meshopt::NAME).is_some();
            if wanted == Some(0) {
                self.oddities.note("a buffer must have at least 1 byte, but this one has none", || {
                    buffer.at_key("byteLength")
                });
            } else if buffer.get("uri").is_none() && !self.document.has_binary() && !is_stand_in {
                self.oddities
                    .note("a buffer has no uri, and there is no binary chunk with its bytes", || buffer.at());
            }
        }
        for view in root.list("bufferViews")? {
            match self.document.check_view(view) {
                Ok(Some(what)) => self.oddities.note(what, || view.at()),
                Ok(None) => {}
                Err(error) => self.oddities.note(&error.without_place(), || view.at()),
            }
        }
        for (number, accessor) in root.list("accessors")?.into_iter().enumerate() {
            self.check_accessor(number, accessor)?;
        }
        Ok(())
    }

    fn check_accessor(&mut self, number: usize, node: JsonNode<'d>) -> Result<(), FormatError> {
        if node.get("byteOffset").is_some() && node.get("bufferView").is_none() {
            let what = "a byteOffset has no effect without a bufferView";
            self.oddities.note(what, || node.at_key("byteOffset"));
        }
        match Accessor::open(self.document, number, node, &mut self.reading.budget) {
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => self.oddities.note(&error.without_place(), || node.at()),
            Ok(accessor) if !accessor.is_aligned(self.document)? => {
                let what = "elements are not aligned to multiples of their size; they are read as they are";
                self.oddities.note(what, || node.at());
            }
            Ok(_) => {}
        }
        Ok(())
    }
}
