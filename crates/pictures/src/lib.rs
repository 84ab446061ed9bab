//! Pictures with named channels: PNG, EXR, HDR, PFM, PPM, tone mapping and error metrics.

mod error;
pub mod formats;
mod limits;
mod picture;
pub mod tonemap;

pub use error::PictureError;
pub use formats::{
    BitDepth, PICTURE_FORMATS, PictureFormatEntry, WriteOptions, format_named, format_of_path, is_decoding,
    read, read_bytes, read_with, write, write_atomically, write_bytes,
};
pub use limits::Limits;
pub use picture::{Alpha, Channel, ColourSpace, IntegerPlane, NonFinite, Picture};
pub use tonemap::{TONEMAPS, ToneMapEntry, to_display, tone_map};
