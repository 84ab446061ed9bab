//! Why a scene cannot be encoded or decoded.

use super::hash::ContentHash;

/// Why a scene cannot be encoded or decoded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EncodingError {
    /// The bytes do not begin as an encoded scene does.
    #[error("this is not an encoded scene: encode one with the same version of Bilux")]
    NotAScene,
    /// The scene has another version.
    #[error(
        "this scene was encoded by another version of Bilux (form {found}; this one reads {reads}): use the same version on \
         both sides, or save the scene to a file"
    )]
    OtherVersion {
        /// The version found.
        found: u32,
        /// The version that this program reads.
        reads: u32,
    },
    /// Something in it is impossible.
    #[error("the encoded scene is damaged at byte {at}: {what}; send it again")]
    Damaged {
        /// The fault.
        what: String,
        /// Bytes from its beginning.
        at: usize,
    },
    /// A mesh or an image was not sent with it.
    #[error("the encoded scene refers to the blob {0}, which is missing: send it too")]
    MissingBlob(ContentHash),
    /// A blob is not what its hash says.
    #[error("the blob {0} is damaged: its content has another hash; send it again")]
    OtherContent(ContentHash),
    /// A texture that no file can describe.
    #[error(
        "the texture '{0}' is computed by code of this program, which cannot be sent: make an image of it"
    )]
    ComputedByCode(String),
}
