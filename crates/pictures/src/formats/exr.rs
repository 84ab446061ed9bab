//! OpenEXR: any number of named planes of halves, floats or integers, and text attributes. [OpenEXR]

use super::exr_write::FORMAT;
use super::faults::exr::explain;
use super::guard::guarded;
use super::primaries::{REC709, luminance, to_rec709};
use super::{PictureFormatEntry, exr_write};
use crate::limits::zeroed;
use crate::{Channel, Crop, Limits, Picture, PictureError, component_rank};
use ::exr::block::UncompressedBlock;
use ::exr::block::chunk::CompressedBlock;
use ::exr::math::Vec2;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{AttributeValue, IntegerBounds, SampleType, Text};
use ::exr::meta::header::Header;
use bilux_math::registry::Entry;
use half::f16;
use std::collections::HashSet;
use std::io::Cursor;

/// The row of `exr`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "exr",
        summary: "OpenEXR: linear light, layers, integers and metadata, all exact: for further processing and partial \
                  renders",
        source: "OpenEXR",
        parameters: &[],
    },
    extensions: &["exr"],
    for_display: false,
    holds_alpha: true,
    sniff: |bytes| bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]),
    read: |bytes, limits| guarded(FORMAT, || read(bytes, limits, Wanted::DisplayWindow)),
    read_stored: None,
    read_crop: Some(read_crop),
    read_interleaved: None,
    write: Some(exr_write::write),
};

/// No renderer writes this many, and each of them costs time whatever its size.
const MAX_CHANNELS: usize = 4096;

/// Part of the file that becomes the picture.
#[derive(Clone, Copy, PartialEq)]
enum Wanted {
    /// The display window: outside a part's data window it is zero.
    DisplayWindow,
    /// The visible part of the data window, if the file has a single part.
    DataWindow,
}

/// Reads what is visible of the data window ([`super::read_crop_bytes`]).
pub(super) fn read_crop(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    guarded(FORMAT, || read(bytes, limits, Wanted::DataWindow))
}

/// If there are several
/// parts, their names are prefixed to those of their channels, except for the first part with plain colours. Colours
/// with other primaries are converted to Rec. 709; all other samples stay as they are.
fn read(bytes: &[u8], limits: &Limits, wanted: Wanted) -> Result<Picture, PictureError> {
    let header_fault = |error| explain(error, bytes, None);
    let reader = ::exr::block::read(Cursor::new(bytes), false).map_err(header_fault)?;
    let mut frame = Frame::new(reader.meta_data(), limits, wanted)?;
    let meta = reader.meta_data().clone();
    for chunk in ::exr::block::reader::Reader::all_chunks(reader, false).map_err(header_fault)? {
        let chunk = chunk.map_err(header_fault)?;
        let smaller_copy = match &chunk.compressed_block {
            CompressedBlock::Tile(tile) => !tile.coordinates.is_largest_resolution_level(),
            _ => false,
        };
        if !smaller_copy {
            let place = place_of(&chunk.compressed_block);
            let block = UncompressedBlock::decompress_chunk(chunk, &meta, false);
            frame.insert(&block.map_err(|error| explain(error, bytes, Some(&place)))?)?;
        }
    }
    frame.into_picture(&meta)
}

/// The pixels of a block, in words.
fn place_of(block: &CompressedBlock) -> String {
    match block {
        CompressedBlock::ScanLine(lines) => {
            format!("the block of rows that begins at row {}", lines.y_coordinate)
        }
        CompressedBlock::Tile(tile) => {
            let at = tile.coordinates.tile_index;
            format!("the tile in column {} and row {}", at.x(), at.y())
        }
        _ => "a block of pixels".to_owned(),
    }
}

/// The window that becomes the picture, and the planes that receive the contents of the parts.
struct Frame {
    window: IntegerBounds,
    crop: Option<Crop>,
    parts: Vec<Part>,
}

struct Part {
    /// Top left corner of the data window.
    origin: Vec2<i32>,
    planes: Vec<Plane>,
    bytes_per_pixel: usize,
}

struct Plane {
    name: String,
    samples: Samples,
}

enum Samples {
    Halves(Vec<f32>),
    Floats(Vec<f32>),
    Integers(Vec<u32>),
}

impl Frame {
    /// Allocates all planes, after every size has been checked.
    fn new(meta: &MetaData, limits: &Limits, wanted: Wanted) -> Result<Frame, PictureError> {
        let channels: usize = meta.headers.iter().map(|header| header.channels.list.len()).sum();
        let (window, crop) = window(meta, wanted);
        let (width, height) = (window.size.width() as u64, window.size.height() as u64);
        if channels > MAX_CHANNELS {
            return Err(unsupported(format!("a picture of {channels} channels"), "save fewer of them"));
        }
        let pixels = limits.check(FORMAT, width, height, 4 * channels as u64)?;
        let left = Limits::new(limits.max_bytes - 4 * (pixels * channels) as u64);
        meta.headers.iter().try_for_each(|header| check_header(header, &left))?;
        let main = meta.headers.iter().position(|header| {
            let plain = |name: &str| {
                header.channels.list.iter().any(|channel| channel.name.as_slice() == name.as_bytes())
            };
            plain("Y") || (plain("R") && plain("G") && plain("B"))
        });
        let mut parts = Vec::new();
        for (index, header) in meta.headers.iter().enumerate() {
            let named = meta.headers.len() > 1 && main != Some(index);
            let layer =
                header.own_attributes.layer_name.as_ref().filter(|_| named).map(text).unwrap_or_default();
            let plane = |channel: &::exr::meta::attribute::ChannelDescription| {
                Ok(Plane {
                    name: layered(&layer, text(&channel.name)),
                    samples: match channel.sample_type {
                        SampleType::F16 => Samples::Halves(zeroed(FORMAT, pixels)?),
                        SampleType::F32 => Samples::Floats(zeroed(FORMAT, pixels)?),
                        SampleType::U32 => Samples::Integers(zeroed(FORMAT, pixels)?),
                    },
                })
            };
            parts.push(Part {
                origin: header.own_attributes.layer_position,
                planes: header.channels.list.iter().map(plane).collect::<Result<_, PictureError>>()?,
                bytes_per_pixel: header.channels.bytes_per_pixel,
            });
        }
        Ok(Frame { window, crop, parts })
    }

    /// Copies the visible part of a block into the window. In a block, each row has the samples of the first
    /// channel, then of the second, and so on.
    fn insert(&mut self, block: &UncompressedBlock) -> Result<(), PictureError> {
        let (width, height) = (self.window.size.width() as i64, self.window.size.height() as i64);
        let wrong =
            || PictureError::invalid(FORMAT, "a block of pixels is not at the offset that the header gives");
        let part = self.parts.get_mut(block.index.layer).ok_or_else(wrong)?;
        let (columns, rows) = (block.index.pixel_size.width(), block.index.pixel_size.height());
        if Some(block.data.len())
            != columns.checked_mul(rows).and_then(|n| n.checked_mul(part.bytes_per_pixel))
        {
            return Err(PictureError::invalid(FORMAT, "a block of pixels has the wrong size"));
        }
        let left = block.index.pixel_position.x() as i64 + i64::from(part.origin.x())
            - i64::from(self.window.position.x());
        let top = block.index.pixel_position.y() as i64 + i64::from(part.origin.y())
            - i64::from(self.window.position.y());
        let shown =
            (-left).clamp(0, columns as i64) as usize..(width - left).clamp(0, columns as i64) as usize;
        let mut data = &block.data[..];
        for y in top..top + rows as i64 {
            for plane in &mut part.planes {
                let (line, rest) = data.split_at(columns * plane.samples.bytes());
                data = rest;
                if (0..height).contains(&y) && !shown.is_empty() {
                    let start = (y * width + left + shown.start as i64) as usize;
                    plane.samples.copy(line, shown.clone(), start);
                }
            }
        }
        Ok(())
    }

    fn into_picture(self, meta: &MetaData) -> Result<Picture, PictureError> {
        let mut picture = Picture::new(self.window.size.width(), self.window.size.height())?;
        picture.crop = self.crop;
        let mut planes: Vec<Plane> = self.parts.into_iter().flat_map(|part| part.planes).collect();
        // The file stores them in the order of their names: A, B, G, R.
        planes.sort_by_cached_key(|plane| order(&plane.name));
        let mut taken = HashSet::new();
        for plane in planes {
            if !taken.insert(plane.name.clone()) {
                return Err(PictureError::invalid(FORMAT, format!("it has two channels '{}'", plane.name)));
            }
            match plane.samples {
                Samples::Halves(samples) | Samples::Floats(samples) => {
                    picture.push_channel(plane.name, samples)?
                }
                Samples::Integers(samples) => picture.push_integer_plane(plane.name, samples)?,
            }
        }
        let colours = meta.headers.iter().find_map(|header| header.shared_attributes.chromaticities);
        let primaries = colours
            .map_or(REC709, |c| [c.red, c.green, c.blue, c.white].map(|Vec2(x, y)| [x, y].map(f64::from)));
        from_chroma(&mut picture, luminance(primaries));
        to_rec709(&mut picture, primaries);
        let shape = meta.headers.first().map_or(1.0, |header| header.shared_attributes.pixel_aspect);
        if shape.is_normal() && shape > 0.0 && (shape - 1.0).abs() > 1e-4 {
            picture.metadata.insert(exr_write::PIXEL_ASPECT.to_owned(), shape.to_string());
            let what = format!("its pixels are {shape} times as wide as high, and are taken as squares");
            picture.warnings.push(what);
        }
        for header in &meta.headers {
            for (name, value) in header.all_named_attributes() {
                let value = match value {
                    AttributeValue::Text(value) if name != b"name" => text(&value),
                    AttributeValue::Matrix4x4(numbers) if is_matrix(name) => {
                        numbers.map(|c| c.to_string()).join(" ")
                    }
                    _ => continue,
                };
                let name = String::from_utf8_lossy(name).into_owned();
                picture.metadata.entry(name).or_insert(value);
            }
        }
        Ok(picture)
    }
}

/// Converts luminance and chroma to colours: RY is (R − Y) / Y and BY is (B − Y) / Y, where the luminance weights red, green
/// and blue by these numbers. [OpenEXR, luminance/chroma images]
fn from_chroma(picture: &mut Picture, [red, green, blue]: [f32; 3]) {
    let [Some(y), Some(ry), Some(by)] = ["Y", "RY", "BY"].map(|name| picture.channel(name)) else { return };
    let colour = |i: usize| {
        let (r, b) = ((ry[i] + 1.0) * y[i], (by[i] + 1.0) * y[i]);
        [r, (y[i] - red * r - blue * b) / green, b]
    };
    let colours: Vec<[f32; 3]> = (0..picture.pixel_count()).map(colour).collect();
    picture.channels.retain(|channel| !["Y", "RY", "BY"].contains(&&*channel.name));
    let planes = ["R", "G", "B"].into_iter().enumerate().map(|(k, name)| Channel {
        name: name.to_owned(),
        samples: colours.iter().map(|colour| colour[k]).collect(),
    });
    picture.channels.splice(..0, planes);
}

/// The window that becomes the picture, and its place in the display window if it is smaller than that.
fn window(meta: &MetaData, wanted: Wanted) -> (IntegerBounds, Option<Crop>) {
    let whole = |header: &Header| header.shared_attributes.display_window;
    let display = meta.headers.first().map_or(IntegerBounds::zero(), whole);
    let ([header], Wanted::DataWindow) = (&meta.headers[..], wanted) else { return (display, None) };
    // The part of the data window that is in the display window, along one axis: its begin and its length.
    let along = |[shown, shown_length]: [i64; 2], [data, length]: [i64; 2]| {
        let first = shown.max(data);
        (first, (shown + shown_length).min(data + length) - first)
    };
    let (at, origin) = (display.position, header.own_attributes.layer_position);
    let (size, data) = (display.size, header.layer_size);
    let (x, columns) = along([at.x().into(), size.width() as i64], [origin.x().into(), data.width() as i64]);
    let (y, rows) = along([at.y().into(), size.height() as i64], [origin.y().into(), data.height() as i64]);
    let is_all = columns == size.width() as i64 && rows == size.height() as i64;
    if is_all || columns <= 0 || rows <= 0 {
        return (display, None);
    }
    let crop = Crop {
        x: (x - i64::from(at.x())) as usize,
        y: (y - i64::from(at.y())) as usize,
        whole: [size.width(), size.height()],
    };
    (IntegerBounds::new((x as i32, y as i32), (columns as usize, rows as usize)), Some(crop))
}

impl Samples {
    fn bytes(&self) -> usize {
        if matches!(self, Samples::Halves(_)) { 2 } else { 4 }
    }

    /// Copies the samples in `range` of a line to `start` and onwards.
    fn copy(&mut self, line: &[u8], range: std::ops::Range<usize>, start: usize) {
        let end = start + range.len();
        match self {
            Samples::Halves(samples) => {
                let halves = &line.as_chunks::<2>().0[range];
                samples[start..end]
                    .iter_mut()
                    .zip(halves)
                    .for_each(|(to, from)| *to = f16::from_ne_bytes(*from).to_f32());
            }
            Samples::Floats(samples) => {
                let floats = &line.as_chunks::<4>().0[range];
                samples[start..end]
                    .iter_mut()
                    .zip(floats)
                    .for_each(|(to, from)| *to = f32::from_ne_bytes(*from));
            }
            Samples::Integers(samples) => {
                let integers = &line.as_chunks::<4>().0[range];
                samples[start..end]
                    .iter_mut()
                    .zip(integers)
                    .for_each(|(to, from)| *to = u32::from_ne_bytes(*from));
            }
        }
    }
}

/// Rejects what the decoder cannot handle, and blocks for which there is not enough memory: they are held compressed,
/// uncompressed and in the stages in between, up to five times their size as measured with DWAB.
fn check_header(header: &Header, limits: &Limits) -> Result<(), PictureError> {
    if header.deep {
        return Err(unsupported("deep data".to_owned(), "save a flat picture"));
    }
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(unsupported("subsampled colour".to_owned(), "save RGB without subsampling"));
    }
    let block = match header.blocks {
        ::exr::meta::BlockDescription::Tiles(tiles) => tiles.tile_size,
        ::exr::meta::BlockDescription::ScanLines => Vec2(
            header.layer_size.width(),
            header.compression.scan_lines_per_block().min(header.layer_size.height()),
        ),
    };
    let bytes = 6 * header.channels.bytes_per_pixel as u64;
    limits.check(FORMAT, block.width() as u64, block.height() as u64, bytes).map(|_| ())
}

fn unsupported(what: String, advice: &'static str) -> PictureError {
    PictureError::Unsupported { format: FORMAT, what, advice }
}

fn text(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

/// True for the matrices that metadata keep.
fn is_matrix(name: &[u8]) -> bool {
    exr_write::MATRICES.iter().any(|matrix| matrix.as_bytes() == name)
}

/// A channel's name prefixed with that of its part, unless it already is.
fn layered(layer: &str, name: String) -> String {
    let there = name.strip_prefix(layer).is_some_and(|rest| rest.starts_with('.'));
    if there { name } else { crate::picture::qualified(layer, &name) }
}

/// Layers in the order of their names, the main picture first; in each, the usual order of its components.
fn order(name: &str) -> (String, usize, String) {
    let (layer, component) = name.rsplit_once('.').unwrap_or(("", name));
    (layer.to_owned(), component_rank(component), component.to_owned())
}
