//! Pictures with named channels: PNG, EXR, HDR, PFM, PPM, tone mapping and error metrics.
//!
//! ```
//! use bilux_math::Rgb;
//! use bilux_pictures::{Picture, WriteOptions, compare, read, tone_map, write};
//!
//! # fn main() -> Result<(), bilux_pictures::PictureError> {
//! # let folder = tempfile::tempdir().unwrap();
//! # let path = |name: &str| folder.path().join(name);
//! let mut picture = Picture::from_rgb(2, 1, vec![Rgb::new(4.0, 1.0, 0.25), Rgb::grey(0.5)])?;
//! picture.push_channel("depth.Z", vec![3.5, 7.0])?;
//! write(path("light.exr"), &picture, &WriteOptions::default())?;
//! let shown = WriteOptions { exposure: -1.0, tone_map: tone_map("aces")?, ..WriteOptions::default() };
//! write(path("seen.png"), &picture, &shown)?;
//!
//! let again = read(path("light.exr"))?;
//! assert_eq!(again.channel("depth.Z"), Some(&[3.5, 7.0][..]));
//! assert_eq!(compare(&again, &picture)?.value("rmse"), Some(0.0));
//! # Ok(())
//! # }
//! ```
//!
//! Readers keep samples as they are in the file and say what they mean; [`Picture::into_linear`] converts them to
//! light. Files may come from untrusted sources: readers allocate within [`Limits`] and answer any bytes with a
//! picture or an error. The same picture and options always give the same bytes.

mod channel_order;
mod crop;
pub mod cryptomatte;
pub mod denoise;
mod error;
mod font;
pub mod formats;
mod layers;
mod limits;
pub mod metrics;
mod panels;
mod picture;
pub mod sensor;
pub mod tonemap;

pub use channel_order::component_rank;
pub use crop::Crop;
pub use denoise::{DENOISERS, DenoiserEntry};
pub use error::{PictureError, reason};
pub use formats::{
    BitDepth, ForeignFormat, Interleaved, PICTURE_FORMATS, PictureFormatEntry, Rgba8, Source, WriteOptions,
    foreign_format, format_named, format_of_path, guarded_decoding, is_decoding, open_regular, read,
    read_bytes, read_crop, read_crop_bytes, read_interleaved, read_interleaved_bytes, read_rgba8,
    read_stored_bytes, read_with, write, write_atomically, write_bytes, write_source, write_source_bytes,
};
pub use limits::Limits;
pub use metrics::{METRICS, MetricEntry, Report, compare};
pub use panels::{downscaled, label, side_by_side, stacked};
pub use picture::{Alpha, Channel, ColourSpace, IntegerPlane, NonFinite, Picture};
pub use tonemap::{TONEMAPS, ToneMapEntry, auto_exposure, to_display, tone_map};
