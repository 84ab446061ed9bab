//! The name and the times of an animation.

/// An animation before its curves are read.
pub(super) struct Clip {
    pub(super) name: String,
    /// When it begins and ends, in units of time of the file.
    pub(super) begin: i64,
    pub(super) end: i64,
}
