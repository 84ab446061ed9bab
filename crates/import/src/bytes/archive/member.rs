//! A file in an archive.

/// A file in an archive.
#[derive(Clone, Debug)]
pub struct Member {
    /// Its name, from the root of the archive, with `/` between folders.
    pub name: String,
    /// Its size in bytes, as the archive states it.
    pub size: u64,
    pub(super) packing: Packing,
    /// Where its bytes are in the archive.
    pub(super) start: u64,
    /// How many there are.
    pub(super) stored: u64,
    pub(super) checksum: Option<u32>,
}

/// How the bytes of a member are stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Stored,
    Deflated,
    /// In a way that cannot be read, described as what it is.
    Unknown(String),
}
