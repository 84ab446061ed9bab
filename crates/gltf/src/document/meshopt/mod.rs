//! `EXT_meshopt_compression`: compressed buffer views. The bitstream is that of the extension's appendices.
//! [Kapoulkine 2021]

mod attributes;
mod bytes;
mod filters;
mod indices;

use crate::document::json::JsonNode;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bytes::Broken;
use filters::Filter;

pub(crate) const NAME: &str = "EXT_meshopt_compression";

/// Packing of elements.
#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// Decompresses the elements of a view; `extension` describes where they are in a buffer of these bytes.
pub(crate) fn unpacked(
    extension: JsonNode,
    bytes: &[u8],
    budget: &mut Budget,
) -> Result<Vec<u8>, FormatError> {
    let number = |key: &'static str| extension.need(key)?.as_count();
    let (count, stride) = (number("count")?, number("byteStride")?);
    let mode = match extension.need("mode")?.as_text()? {
        "ATTRIBUTES" => Mode::Attributes,
        "TRIANGLES" => Mode::Triangles,
        "INDICES" => Mode::Indices,
        other => {
            return Err(
                extension.error(format!("'{other}' is not a mode: use ATTRIBUTES, TRIANGLES or INDICES"))
            );
        }
    };
    let filter = Filter::from_name(extension.text("filter")?.unwrap_or("NONE")).ok_or_else(|| {
        extension.error("this is not a filter: use NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL")
    })?;
    let strides_fit = match mode {
        Mode::Attributes => stride % 4 == 0 && (4..=256).contains(&stride) && filter.takes(stride),
        _ => matches!(stride, 2 | 4) && filter == Filter::None,
    };
    if !strides_fit || (mode == Mode::Triangles && count % 3 != 0) {
        let message = format!("{count} elements of {stride} bytes cannot be compressed in this mode");
        return Err(extension.error(message));
    }
    let (offset, length) = (extension.count("byteOffset")?.unwrap_or(0), number("byteLength")?);
    let end = offset.checked_add(length).filter(|&end| end <= bytes.len());
    let Some(bytes) = end.map(|end| &bytes[offset..end]) else {
        let have = bytes.len();
        let message = format!("{length} bytes from byte {offset} extend beyond the buffer, which has {have}");
        return Err(extension.error(message));
    };
    // The best compression ratio is sixteen elements' bytes in two bits, or a triangle in a byte.
    if count > length.saturating_mul(64) {
        return Err(extension.error(format!("{count} elements cannot be in {length} bytes")));
    }
    let size = count.saturating_mul(stride);
    budget.take_bytes(size as u64, &extension.at().file)?;
    let mut elements = vec![0; size];
    let done = match mode {
        Mode::Attributes => attributes::unpack(bytes, stride, &mut elements),
        Mode::Triangles => indices::unpack_triangles(bytes, stride, &mut elements),
        Mode::Indices => indices::unpack_sequence(bytes, stride, &mut elements),
    };
    done.map_err(|Broken| {
        extension
            .error("the compressed data of this buffer view cannot be decompressed: export the file again")
    })?;
    filter.undo(stride, &mut elements);
    Ok(elements)
}
