//! KTX2: the errors of its unpacker. [KTX 2.0]

use crate::PictureError;
use basisu::Error;

const FORMAT: &str = "KTX2";

/// Why the unpacker rejects a file.
pub(in super::super) fn explain(error: Error) -> PictureError {
    let unsupported = |what: &str| PictureError::Unsupported {
        format: FORMAT,
        what: what.to_owned(),
        advice: "save it as one flat picture, with Basis Universal (ETC1S or UASTC)",
    };
    match error {
        Error::Truncated => PictureError::truncated(FORMAT, "the pixels or their tables"),
        Error::VideoRequiresState => unsupported("a video"),
        Error::Unsupported { .. } | Error::UnsupportedFeature(_) | Error::ZstdRequired => {
            unsupported("the compression of its pixels")
        }
        Error::InvalidImageOrLevel => PictureError::invalid(FORMAT, "it has no picture in it"),
        _ => PictureError::invalid(FORMAT, "its compressed pixels cannot be decompressed"),
    }
}
