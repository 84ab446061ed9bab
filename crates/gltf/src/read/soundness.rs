//! Faults in a file that do not affect the scene or can be worked around. They are reported, since the author may
//! have meant another image.

use crate::document::accessor::Accessor;
use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use crate::document::meshopt;
use crate::materials::pictures::{Pictures, decode, encoded, release};
use crate::validate;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;

/// Reads the images that no material uses, and validates the bytes of all.
pub(crate) fn validate_images(
    document: &Document,
    pictures: &Pictures,
    reading: &mut Reading,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    let root = document.root;
    for (number, image) in root.get("images").into_iter().flat_map(|list| list.children()).enumerate() {
        let is_placed = image.get("uri").is_some() != image.get("bufferView").is_some();
        if !is_placed || !image.is_object() {
            continue;
        }
        match encoded(document, image, reading) {
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => diagnostics.note(&error.without_place(), || image.at()),
            Ok((_, bytes)) => {
                validate::image(image, number, &bytes, root, diagnostics);
                release(bytes, reading);
                if !pictures.contain(number)
                    && let Err(error) = decode(document, image, false, reading)
                {
                    if let FormatError::TooLarge { .. } = error {
                        return Err(error);
                    }
                    diagnostics.note(&error.without_place(), || image.at());
                }
            }
        }
    }
    Ok(())
}

/// Warns about buffers, views and accessors that violate the specification. [glTF 2.0, 3.6]
pub(crate) fn check_data(data: &mut DataReader) -> Result<(), FormatError> {
    let root = data.document.root;
    for buffer in root.list("buffers")? {
        let wanted = buffer.count("byteLength")?;
        let is_stand_in = buffer.extension(meshopt::NAME).is_some();
        if wanted == Some(0) {
            data.note("a buffer must have at least 1 byte, but this one has none", || {
                buffer.at_key("byteLength")
            });
        } else if buffer.get("uri").is_none() && !data.document.has_binary() && !is_stand_in {
            data.note("a buffer has no uri, and there is no binary chunk with its bytes", || buffer.at());
        }
    }
    for view in root.list("bufferViews")? {
        match data.document.check_view(view) {
            Ok(Some(what)) => data.note(what, || view.at()),
            Ok(None) => {}
            Err(error) => data.note(&error.without_place(), || view.at()),
        }
    }
    for (number, accessor) in root.list("accessors")?.into_iter().enumerate() {
        check_accessor(number, accessor, data)?;
    }
    Ok(())
}

fn check_accessor<'d>(
    number: usize,
    node: JsonNode<'d>,
    data: &mut DataReader<'d, '_>,
) -> Result<(), FormatError> {
    if node.get("byteOffset").is_some() && node.get("bufferView").is_none() {
        let what = "a byteOffset has no effect without a bufferView";
        data.note(what, || node.at_key("byteOffset"));
    }
    match Accessor::open(data.document, number, node, data.budget) {
        Err(error @ FormatError::TooLarge { .. }) => return Err(error),
        Err(error) => data.note(&error.without_place(), || node.at()),
        Ok(accessor) if !accessor.is_aligned(data.document)? => {
            let what = "elements are not aligned to multiples of their size; they are read as they are";
            data.note(what, || node.at());
        }
        Ok(_) => {}
    }
    Ok(())
}
