//! Writing OpenEXR: one part, rows from the top, 32-bit floats and integers, ZIP. [OpenEXR]
//!
//! The header and tables are written here and not by the library, which keeps texts in a hash map: their order would
//! change from run to run, and the same picture must always give the same bytes.

use super::Source;
use super::WriteOptions;
use super::primaries::REC709;
use crate::limits::MAX_SIDE;
use crate::{Alpha, ColourSpace, Crop, Picture, PictureError};
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType, Text};
use ::exr::meta::header::{Header, standard_names};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

pub(super) const FORMAT: &str = "EXR";

/// A plane of any type.
struct Plane<'a> {
    name: &'a str,
    samples: Samples<'a>,
}

#[derive(Clone, Copy)]
enum Samples<'a> {
    Floats(&'a [f32]),
    Integers(&'a [u32]),
}

/// Contents of a file before its samples.
struct Layout<'a> {
    size: [usize; 2],
    crop: Option<Crop>,
    metadata: &'a BTreeMap<String, String>,
    /// The name of each plane, in the order of the file, and whether it has integers.
    planes: Vec<(&'a str, bool)>,
}

impl<'a> Layout<'a> {
    /// Of a picture with these planes, and so many rows.
    fn of(picture: &'a Picture, rows: usize, planes: &[Plane<'a>]) -> Layout<'a> {
        let kind = |plane: &Plane<'a>| (plane.name, matches!(plane.samples, Samples::Integers(_)));
        Layout {
            size: [picture.width(), rows],
            crop: picture.crop,
            metadata: &picture.metadata,
            planes: planes.iter().map(kind).collect(),
        }
    }
}

/// Rows that are compressed together.
const BLOCK_ROWS: usize = 16;

/// The library's text attributes, which may hold arbitrary text.
const STANDARD_TEXTS: [&str; 7] =
    ["owner", "comments", "capDate", "software", "view", "renderingTransform", "lookModTransform"];

/// Attributes that are matrices, and in our metadata their sixteen numbers.
pub(super) const MATRICES: [&str; 2] = ["worldToCamera", "worldToNDC"];

/// The attribute that says how wide a pixel is over its height, and its key in our metadata unless that is 1.
pub(super) const PIXEL_ASPECT: &str = "pixelAspectRatio";

pub(super) fn write(picture: Source, _: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    match picture {
        Source::Planes(picture) => {
            let is_linear =
                picture.colour_space == ColourSpace::LinearRec709 && picture.alpha == Alpha::Premultiplied;
            let picture =
                if is_linear { Cow::Borrowed(picture) } else { Cow::Owned(picture.clone().into_linear()) };
            let planes = sorted_planes(&picture)?;
            let width = picture.width();
            let layout = Layout::of(&picture, picture.height(), &planes);
            file_of(&layout, |rows| Ok(block_bytes(&planes, width, rows)))
        }
        Source::Bytes(bytes) => {
            // The numbers of a few rows at a time: those of all of them would take four times as much as the bytes.
            let numbers = |rows: Range<usize>| Ok(bytes.rows(FORMAT, rows)?.into_linear());
            let mut first = numbers(0..1)?;
            first.metadata.clone_from(&bytes.metadata);
            let layout = Layout::of(&first, bytes.height, &sorted_planes(&first)?);
            file_of(&layout, |rows| {
                let (part, count) = (numbers(rows.clone())?, rows.len());
                Ok(block_bytes(&sorted_planes(&part)?, bytes.width, 0..count))
            })
        }
    }
}

/// The bytes of a file, from those of some of its rows.
fn file_of(
    layout: &Layout,
    rows_of: impl Fn(Range<usize>) -> Result<Vec<u8>, PictureError>,
) -> Result<Vec<u8>, PictureError> {
    let [width, height] = layout.size;
    let [_, top] = corner(layout)?;
    let mut bytes = header_bytes(layout)?;
    let header = library_header(layout);
    let blocks = height.div_ceil(BLOCK_ROWS);
    let table = bytes.len();
    bytes.resize(table + 8 * blocks, 0);
    for block in 0..blocks {
        let offset = (bytes.len() as u64).to_le_bytes();
        bytes[table + 8 * block..][..8].copy_from_slice(&offset);
        let first = block * BLOCK_ROWS;
        let rows = first..(first + BLOCK_ROWS).min(height);
        let section = IntegerBounds::new((0, first as i32), (width, rows.len()));
        let packed = Compression::ZIP16
            .compress_image_section_to_le(&header, rows_of(rows)?, section)
            .map_err(|error| unwritable(error.to_string()))?;
        bytes.extend_from_slice(&(top + first as i32).to_le_bytes());
        bytes.extend_from_slice(&(packed.len() as i32).to_le_bytes());
        bytes.extend_from_slice(&packed);
    }
    Ok(bytes)
}

/// The left and upper corner of the picture in the larger one that it is a part of.
fn corner(layout: &Layout) -> Result<[i32; 2], PictureError> {
    let Some(Crop { x, y, whole }) = layout.crop else { return Ok([0; 2]) };
    let fits = |at: usize, side: usize, whole: usize| {
        whole as u64 <= MAX_SIDE && at.checked_add(side).is_some_and(|end| end <= whole)
    };
    let [columns, rows] = layout.size;
    if !fits(x, columns, whole[0]) || !fits(y, rows, whole[1]) {
        let [width, height] = whole;
        return Err(unwritable(format!(
            "its place at {x},{y} is not within a picture of {width} x {height}"
        )));
    }
    Ok([x as i32, y as i32])
}

/// All planes in the order of their names, as the format requires.
fn sorted_planes(picture: &Picture) -> Result<Vec<Plane<'_>>, PictureError> {
    let floats =
        picture.channels().iter().map(|c| Plane { name: &c.name, samples: Samples::Floats(&c.samples) });
    let integers = picture
        .integer_planes()
        .iter()
        .map(|plane| Plane { name: &plane.name, samples: Samples::Integers(&plane.samples) });
    let mut planes: Vec<Plane> = floats.chain(integers).collect();
    planes.sort_by_key(|plane| plane.name.as_bytes());
    match planes.iter().find(|plane| plane.name.len() > 255) {
        Some(plane) => {
            Err(unwritable(format!("the channel name '{}' has more than 255 bytes; shorten it", plane.name)))
        }
        None if planes.is_empty() => Err(unwritable("it has no channels".to_owned())),
        None => Ok(planes),
    }
}

/// The header that the library's compressor needs.
fn library_header(layout: &Layout) -> Header {
    let channels = layout
        .planes
        .iter()
        .map(|&(name, is_integer)| ChannelDescription {
            name: Text::from_slice_unchecked(name.as_bytes()),
            sample_type: if is_integer { SampleType::U32 } else { SampleType::F32 },
            quantize_linearly: false,
            sampling: Vec2(1, 1),
        })
        .collect();
    let [width, height] = layout.size;
    Header::new(Text::from_slice_unchecked(b""), (width, height), channels).with_encoding(
        Compression::ZIP16,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    )
}

/// Everything before the offset table.
fn header_bytes(layout: &Layout) -> Result<Vec<u8>, PictureError> {
    let corner @ [left, top] = corner(layout)?;
    let size = layout.size;
    let window = |corners: [[i32; 2]; 2]| -> Vec<u8> {
        corners.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect()
    };
    let data_window = window([corner, [left + size[0] as i32 - 1, top + size[1] as i32 - 1]]);
    let whole = layout.crop.map_or(size, |crop| crop.whole);
    let display_window = window([[0; 2], whole.map(|side| side as i32 - 1)]);
    let long = layout.planes.iter().map(|(name, _)| *name).chain(layout.metadata.keys().map(|key| &key[..]));
    let long_names = if long.into_iter().any(|name| name.len() > 31) { 0x400 } else { 0 };
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01];
    bytes.extend_from_slice(&(2u32 | long_names).to_le_bytes());
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend_from_slice(&[name.as_bytes(), b"\0", kind.as_bytes(), b"\0"].concat());
        bytes.extend_from_slice(&(value.len() as i32).to_le_bytes());
        bytes.extend_from_slice(value);
    };
    attribute("channels", "chlist", &channel_list(&layout.planes));
    attribute(
        "chromaticities",
        "chromaticities",
        &floats(&REC709.as_flattened().iter().map(|c| *c as f32).collect::<Vec<_>>()),
    );
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", &data_window);
    attribute("displayWindow", "box2i", &display_window);
    attribute("lineOrder", "lineOrder", &[0]);
    let shape = layout.metadata.get(PIXEL_ASPECT).and_then(|text| text.parse().ok());
    let shape: f32 = shape.filter(|shape: &f32| shape.is_normal() && *shape > 0.0).unwrap_or(1.0);
    attribute(PIXEL_ASPECT, "float", &shape.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    for (key, value) in layout.metadata.iter().filter(|(key, _)| *key != PIXEL_ASPECT) {
        if let Some(matrix) = MATRICES.contains(&&key[..]).then(|| matrix(value)).flatten() {
            attribute(key, "m44f", &floats(&matrix));
            continue;
        }
        let key = if key == "Software" { "software" } else { key };
        check_text(key, value)?;
        attribute(key, "string", value.as_bytes());
    }
    bytes.push(0);
    Ok(bytes)
}

/// Sixteen numbers of a text, if that is what it has.
fn matrix(text: &str) -> Option<Vec<f32>> {
    let numbers: Option<Vec<f32>> = text.split(' ').map(|number| number.parse().ok()).collect();
    numbers.filter(|numbers| numbers.len() == 16)
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn channel_list(planes: &[(&str, bool)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for &(name, is_integer) in planes {
        let kind = if is_integer { 0 } else { 2 };
        bytes.extend_from_slice(name.as_bytes());
        bytes.push(0);
        // Type; whether perceptually linear, and three unused bytes; no subsampling in x and y.
        [kind, 0, 1, 1].iter().for_each(|field: &i32| bytes.extend_from_slice(&field.to_le_bytes()));
    }
    bytes.push(0);
    bytes
}

fn check_text(key: &str, value: &str) -> Result<(), PictureError> {
    let reserved = standard_names::ALL.contains(&key.as_bytes()) && !STANDARD_TEXTS.contains(&key);
    let what = if key.is_empty() || key.len() > 255 || key.contains('\0') {
        format!("the metadata key '{key}' must have 1 to 255 bytes, none of them zero; rename it")
    } else if reserved {
        format!("'{key}' is an attribute of the format itself; rename this metadata key")
    } else if value.len() > i32::MAX as usize {
        format!("the metadata '{key}' is longer than 2 GiB; shorten it")
    } else {
        return Ok(());
    };
    Err(unwritable(what))
}

/// Rows of native-endian samples; in each row all samples of the first plane, then of the second.
fn block_bytes(planes: &[Plane], width: usize, rows: std::ops::Range<usize>) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(4 * planes.len() * width * rows.len());
    for y in rows {
        let row = y * width..(y + 1) * width;
        for plane in planes {
            match plane.samples {
                Samples::Floats(samples) => {
                    samples[row.clone()].iter().for_each(|s| bytes.extend_from_slice(&s.to_ne_bytes()))
                }
                Samples::Integers(samples) => {
                    samples[row.clone()].iter().for_each(|s| bytes.extend_from_slice(&s.to_ne_bytes()))
                }
            }
        }
    }
    bytes
}

fn unwritable(what: String) -> PictureError {
    PictureError::Unwritable { format: FORMAT, what }
}
