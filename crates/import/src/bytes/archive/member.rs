//! A file in an archive.

/// A file in an archive.
#[derive(Clone, Debug)]
pub struct Member {
    /// Name from the root of the archive, with `/` between folders.
    pub name: String,
    /// Size in bytes, as the archive states it.
    pub size: u64,
    pub(super) packing: Packing,
    /// Place of the stored bytes in the archive.
    pub(super) start: u64,
    /// Number of stored bytes.
    pub(super) stored: u64,
    pub(super) checksum: Option<u32>,
}

/// Way in which the bytes of a member are stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Stored,
    Deflated,
    /// In a way that cannot be read, described as what it is.
    Unknown(String),
}
