//! The names of objects.

/// Between a name and its class in binary files.
const SEPARATOR: &[u8] = b"\0\x01";

/// A name without its class: `Model::Cube` in texts, and `Cube\0\x01Model` in binary files.
pub(super) fn without_class(name: &[u8]) -> &[u8] {
    if let Some(end) = name.windows(2).position(|pair| pair == SEPARATOR) {
        return &name[..end];
    }
    match name.windows(2).position(|pair| pair == b"::") {
        Some(class) => &name[class + 2..],
        None => name,
    }
}

/// A name as users see it. Texts spell quotes as in HTML.
pub(in crate::fbx) fn display_name(name: &[u8]) -> String {
    String::from_utf8_lossy(name).replace("&quot;", "\"")
}
