//! Reads a file in the encoding that it has.

use super::node::Tree;
use super::records::{Builder, Encoding};
use super::{binary, text};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::text::Places;
use bilux_import::input::reading::Source;

impl<'a> Tree<'a> {
    /// The nodes of a file.
    pub(in crate::fbx) fn read(source: &Source<'a>, budget: &mut Budget) -> Result<Tree<'a>, FormatError> {
        let places = Places::new(source.name, source.bytes);
        let mut builder = Builder { records: Vec::new(), budget, file: source.name };
        let root = builder.push(b"", b"", 0)?;
        let (version, encoding) = if source.bytes.starts_with(binary::MAGIC) {
            let header = binary::Header::read(source.bytes, &places)?;
            binary::parse(source.bytes, &header, &places, &mut builder)?;
            (header.version, Encoding::Binary { is_big_endian: header.is_big_endian })
        } else if !text::is_text(source.bytes) {
            let message = "this is neither a binary FBX file nor one in text";
            return Err(FormatError::malformed(message, places.whole()));
        } else {
            text::parse(source.bytes, &places, &mut builder)?;
            (0, Encoding::Text)
        };
        builder.close(root);
        let mut tree = Tree { version, encoding, records: builder.records, places, file: source.name };
        if tree.encoding == Encoding::Text {
            tree.version = text::version(&tree)?;
        }
        Ok(tree)
    }
}
