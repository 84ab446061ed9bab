//! Pictures with named channels: PNG, EXR, HDR, PFM, PPM, tone mapping and error metrics.

mod error;
mod font;
pub mod formats;
mod limits;
pub mod metrics;
mod panels;
mod picture;
pub mod tonemap;

pub use error::PictureError;
pub use formats::{
    BitDepth, PICTURE_FORMATS, PictureFormatEntry, WriteOptions, format_named, format_of_path, is_decoding,
    read, read_bytes, read_with, write, write_atomically, write_bytes,
};
pub use limits::Limits;
pub use metrics::{METRICS, MetricEntry, Report, compare};
pub use panels::{downscaled, label, side_by_side, stacked};
pub use picture::{Alpha, Channel, ColourSpace, IntegerPlane, NonFinite, Picture};
pub use tonemap::{TONEMAPS, ToneMapEntry, to_display, tone_map};
