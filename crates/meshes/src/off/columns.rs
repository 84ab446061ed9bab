//! Parts of OFF that the reader and the writer share.

/// The comment that keeps faces without normals flat when Bilux reads its own files.
pub(super) const FLAT_COMMENT: &[u8] = b"shading flat";

/// The columns after the position on the line of a vertex, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Columns {
    pub(super) normals: bool,
    pub(super) colours: bool,
    pub(super) uvs: bool,
}

impl Columns {
    /// The columns that the first word `[ST][C][N]OFF` states, and its length; counts may follow without a space.
    pub(super) fn of_word(word: &[u8]) -> Option<(Columns, usize)> {
        let mut rest = word;
        let mut takes = |prefix: &[u8]| {
            let found = rest.strip_prefix(prefix);
            rest = found.unwrap_or(rest);
            found.is_some()
        };
        let columns = Columns { uvs: takes(b"ST"), colours: takes(b"C"), normals: takes(b"N") };
        let is_off = takes(b"OFF") && rest.iter().all(u8::is_ascii_digit);
        is_off.then_some((columns, word.len() - rest.len()))
    }

    /// The count of numbers of a vertex, without the optional opacity of its colour.
    pub(super) fn width(self) -> usize {
        3 + 3 * usize::from(self.normals) + 3 * usize::from(self.colours) + 2 * usize::from(self.uvs)
    }
}
