//! TIFF: a directory of tags. [TIFF 6.0, section 2]

use super::u32_at;
use crate::PictureError;
use std::io::ErrorKind;
use tiff::tags::Tag;
use tiff::{ColorType, TiffError, TiffFormatError, TiffUnsupportedError};

const FORMAT: &str = "TIFF";

/// Why the decoder rejects these bytes.
pub(in super::super) fn explain(error: TiffError, bytes: &[u8]) -> PictureError {
    let invalid = |what: String| PictureError::invalid(FORMAT, what);
    match error {
        TiffError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            PictureError::truncated(FORMAT, "the pixels or what comes before them")
        }
        TiffError::IoError(_) => invalid(super::CONTRADICTION.to_owned()),
        TiffError::UnsupportedError(error) => unsupported(in_words(&error)),
        TiffError::LimitsExceeded => PictureError::Unsupported {
            format: FORMAT,
            what: "a part that needs more memory than the limit".to_owned(),
            advice: "raise the memory limit if you trust the file",
        },
        TiffError::FormatError(error) => invalid(format_fault(&error, &directory(bytes))),
        TiffError::IntSizeError => invalid(format!("a number{} is larger than any file", directory(bytes))),
        TiffError::UsageError(_) => invalid(super::CONTRADICTION.to_owned()),
    }
}

/// Rejects a valid feature that this program does not read.
pub(in super::super) fn unsupported(what: String) -> PictureError {
    let advice = "save it as grey or RGB, with Deflate compression or none";
    PictureError::Unsupported { format: FORMAT, what, advice }
}

/// A kind of colour, in words.
pub(in super::super) fn colours(kind: ColorType) -> &'static str {
    match kind {
        ColorType::Gray(_) | ColorType::GrayA(_) => "grey",
        ColorType::RGB(_) | ColorType::RGBA(_) => "RGB",
        ColorType::Palette(_) => "a palette",
        ColorType::CMYK(_) | ColorType::CMYKA(_) => "CMYK colour",
        ColorType::YCbCr(_) => "YCbCr colour",
        ColorType::Lab(_) => "Lab colour",
        _ => "its colour type",
    }
}

/// ` in the directory at byte 8`, if the file says where that is.
fn directory(bytes: &[u8]) -> String {
    let is_big_endian = bytes.starts_with(b"MM");
    // Files larger than 4 GiB store their numbers elsewhere.
    let is_small = bytes.starts_with(b"II*\0") || bytes.starts_with(b"MM\0*");
    let at = u32_at(bytes, 4, is_big_endian).filter(|at| is_small && (*at as usize) < bytes.len());
    at.map_or_else(String::new, |at| format!(" in the directory at byte {at}"))
}

/// The name of a tag from the specification; other tags have numbers.
fn tag(tag: Tag) -> String {
    match tag {
        Tag::Unknown(number) => format!("tag {number}"),
        known => format!("the tag {known:?}"),
    }
}

fn format_fault(error: &TiffFormatError, place: &str) -> String {
    use TiffFormatError as E;
    match error {
        E::TiffSignatureNotFound | E::TiffSignatureInvalid => "it does not begin as a TIFF does".to_owned(),
        E::ImageFileDirectoryNotFound => "it has no directory of tags".to_owned(),
        E::InconsistentSizesEncountered => "its parts have sizes that contradict each other".to_owned(),
        E::InvalidDimensions(width, height) => format!("it says that it has {width} x {height} pixels"),
        E::InvalidTag | E::InvalidTypeForTag => format!("a tag{place} has an invalid value"),
        E::InvalidTagValueType(of) => format!("{}{place} has a value of the wrong type", tag(*of)),
        E::RequiredTagNotFound(of) => format!("{}, which every picture needs, is missing{place}", tag(*of)),
        E::InvalidCountForTag(of, count) => {
            format!("{}{place} has {count} values, which is the wrong number", tag(*of))
        }
        E::UnknownPredictor(number) => {
            format!("the tag Predictor{place} is {number}, which is not a predictor")
        }
        E::UnknownPlanarConfiguration(number) => {
            format!("the tag PlanarConfiguration{place} is {number}, which is not a configuration")
        }
        E::StripTileTagConflict => "it has both or neither of the tags for strips and for tiles".to_owned(),
        E::CycleInOffsets => "its directories form a loop".to_owned(),
        E::SamplesPerPixelIsZero => format!("the tag SamplesPerPixel{place} is 0"),
        E::CompressedDataCorrupt(_) => "its compressed pixels cannot be decompressed".to_owned(),
        _ => super::CONTRADICTION.to_owned(),
    }
}

fn in_words(error: &TiffUnsupportedError) -> String {
    use TiffUnsupportedError as E;
    match error {
        E::FloatingPointPredictor(_) | E::HorizontalPredictor(_) => "its predictor".to_owned(),
        E::InconsistentBitsPerSample(_) => {
            "a picture whose channels have different numbers of bits".to_owned()
        }
        E::InterpretationWithBits(..) | E::UnsupportedBitsPerChannel(_) => {
            "the bit depth of its samples".to_owned()
        }
        E::UnknownInterpretation | E::UnsupportedInterpretation(_) => "its colour type".to_owned(),
        E::UnsupportedColorType(kind) => colours(*kind).to_owned(),
        E::UnknownCompressionMethod | E::UnsupportedCompressionMethod(_) => {
            "the compression of its pixels".to_owned()
        }
        E::UnsupportedSampleDepth(count) => format!("a picture with {count} samples per pixel"),
        E::UnsupportedSampleFormat(_) => "the number type of its samples".to_owned(),
        E::UnsupportedPlanarConfig(_) => "the order of its channels".to_owned(),
        E::ChromaSubsampling => "subsampled colour".to_owned(),
        _ => "a part of it".to_owned(),
    }
}
