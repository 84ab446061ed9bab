//! PNG: reads everything that the format can hold; writes sRGB with 8 or 16 bits. [PNG]

use super::curve::Curve;
use super::faults::png::explain;
use super::guard::guarded;
use super::icc;
use super::meaning::Meaning;
use super::orientation::Orientation;
use super::planes::planes_of;
use super::primaries::{self, Primaries};
use super::rgba8::Interleaved;
use super::{BitDepth, PictureFormatEntry, Source, WriteOptions};
use crate::limits::zeroed;
use crate::{Alpha, ColourSpace, Limits, Picture, PictureError};
use ::png::{ColorType, Compression, Decoder, Encoder, Info, SrgbRenderingIntent, Transformations};
use bilux_math::registry::Entry;
use std::collections::BTreeMap;
use std::io::Cursor;

/// The row of `png`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "png",
        summary: "lossless, 8 or 16 bits, sRGB, with alpha: for the screen and the web",
        source: "PNG",
        parameters: &[],
    },
    extensions: &["png", "apng"],
    for_display: true,
    holds_alpha: true,
    sniff: |bytes| bytes.starts_with(b"\x89PNG"),
    read: |bytes, limits| guarded(FORMAT, || read(bytes, limits)),
    read_stored: Some(|bytes, limits| {
        guarded(FORMAT, || read_stored(bytes, limits).map(|(picture, _)| picture))
    }),
    read_crop: None,
    read_interleaved: Some(|bytes, limits| guarded(FORMAT, || read_interleaved(bytes, limits))),
    write: Some(write),
};

const FORMAT: &str = "PNG";

/// Texts longer than this are dropped: nobody reads a picture for them.
const LONGEST_TEXT: usize = 1 << 20;

/// A decoder that has returned its pixels, and the pixels.
type Decoded<'b> = (::png::Reader<Cursor<&'b [u8]>>, ::png::OutputInfo, Vec<u8>);

/// The samples as they are stored; palettes and samples of less than 8 bits are expanded to bytes. `None` if the picture is not
/// wanted, before its pixels are decoded. `own` is how many bytes per pixel others take besides.
fn decode<'b>(
    bytes: &'b [u8],
    limits: &Limits,
    own: u64,
    is_wanted: impl Fn(&Info) -> bool,
) -> Result<Option<Decoded<'b>>, PictureError> {
    let memory = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), ::png::Limits { bytes: memory });
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(|error| explain(&error, bytes))?;
    let (width, height) = (header.width, header.height);
    if limits.check(FORMAT, width.into(), height.into(), 1 + own).is_err() {
        // How much it is exactly is not known yet; what the message asks for is enough: of a palette or of alpha by one colour, too.
        let bound = 4 * if header.bit_depth == ::png::BitDepth::Sixteen { 2 } else { 1 };
        limits.check(FORMAT, width.into(), height.into(), bound + own.max(bound))?;
    }
    let mut reader = decoder.read_info().map_err(|error| explain(&error, bytes))?;
    // The decoder trusts the length of a palette.
    if reader.info().palette.as_ref().is_some_and(|palette| palette.is_empty() || palette.len() % 3 != 0) {
        return Err(PictureError::invalid(FORMAT, "its palette is not a whole number of colours"));
    }
    if !is_wanted(reader.info()) {
        return Ok(None);
    }
    let size =
        reader.output_buffer_size().ok_or_else(|| PictureError::invalid(FORMAT, "its size overflows"))?;
    let each = (size as u64).div_ceil(u64::from(width) * u64::from(height));
    // The bytes once more while a picture is turned.
    let turned = if orientation(reader.info()).is_upright() { 0 } else { each };
    limits.check(FORMAT, width.into(), height.into(), each + own.max(turned))?;
    let mut samples: Vec<u8> = zeroed(FORMAT, size)?;
    let frame = reader.next_frame(&mut samples).map_err(|error| explain(&error, bytes))?;
    if (frame.width, frame.height) != (width, height) {
        return Err(PictureError::invalid(FORMAT, "its first frame is smaller than the picture"));
    }
    Ok(Some((reader, frame, samples)))
}

/// See [`super::read_interleaved`].
fn read_interleaved(bytes: &[u8], limits: &Limits) -> Result<Option<Interleaved>, PictureError> {
    let is_plain = |info: &Info| {
        info.bit_depth != ::png::BitDepth::Sixteen && meaning(info).is_srgb() && not_heeded(info).is_none()
    };
    let Some((mut reader, frame, samples)) = decode(bytes, limits, 0, is_plain)? else { return Ok(None) };
    let mut whole = Interleaved::new(frame.width as usize, frame.height as usize, samples);
    let orientation = orientation(reader.info());
    // Texts may come after the pixels; damage there does not affect the picture.
    let _ = reader.finish();
    whole.metadata = texts(reader.info());
    Ok(Some(orientation.apply(FORMAT, whole)?))
}

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let (mut picture, meaning) = read_stored(bytes, limits)?;
    meaning.apply(&mut picture);
    Ok(picture)
}

/// Four planes.
const PLANES: u64 = 4 * 4;

/// The samples as they are stored, and what they mean.
fn read_stored(bytes: &[u8], limits: &Limits) -> Result<(Picture, Meaning), PictureError> {
    let Some((mut reader, frame, samples)) = decode(bytes, limits, PLANES, |_| true)? else {
        return Err(PictureError::invalid(FORMAT, "there is no picture in it"));
    };
    let (width, height) = (frame.width, frame.height);
    let pixels = width as usize * height as usize;
    let names: &[&str] = match frame.color_type {
        ColorType::Grayscale => &["Y"],
        ColorType::GrayscaleAlpha => &["Y", "A"],
        ColorType::Rgb => &["R", "G", "B"],
        ColorType::Rgba => &["R", "G", "B", "A"],
        ColorType::Indexed => return Err(PictureError::invalid(FORMAT, "it has indices but no palette")),
    };
    let planes = if frame.bit_depth == ::png::BitDepth::Sixteen {
        let (pairs, _) = samples.as_chunks::<2>();
        let wide = |pair: &[u8; 2]| f32::from(u16::from_be_bytes(*pair)) / 65535.0;
        planes_of(FORMAT, pairs.iter(), names.len(), pixels, wide)?
    } else {
        planes_of(FORMAT, samples.iter(), names.len(), pixels, |byte: &u8| f32::from(*byte) / 255.0)?
    };
    let mut picture = Picture::new(width as usize, height as usize)?;
    picture.alpha = Alpha::Straight;
    picture.colour_space = ColourSpace::Srgb;
    let meaning = meaning(reader.info());
    picture.warnings.extend(not_heeded(reader.info()));
    for (name, plane) in names.iter().zip(planes) {
        picture.push_channel(*name, plane)?;
    }
    // Texts may come after the pixels; damage there does not affect the picture.
    let _ = reader.finish();
    picture.metadata = texts(reader.info());
    Ok((orientation(reader.info()).apply_to_planes(FORMAT, picture)?, meaning))
}

/// Orientation of the picture, by its `eXIf` chunk.
fn orientation(info: &Info) -> Orientation {
    info.exif_metadata.as_ref().map_or(Orientation::of(1), |data| Orientation::of_exif(data))
}

/// Transfer characteristics of `cICP` that a picture can have here. [ITU-T H.273, table 3]
const GAMMA_22: u8 = 4;
const GAMMA_28: u8 = 5;
const LINEAR: u8 = 8;
/// Transfer characteristics that a picture cannot have here.
const PQ: u8 = 16;
const HLG: u8 = 18;
/// Primaries of Rec. 709, and unspecified ones. [ITU-T H.273, table 2]
const REC709_PRIMARIES: [u8; 2] = [1, 2];
/// Others that are converted: those of Rec. 2020, and of P3 with the white of Rec. 709. [ITU-T H.273, table 2]
const OTHER_PRIMARIES: [(u8, Primaries); 2] = [
    (9, [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046], [0.3127, 0.3290]]),
    (12, [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060], [0.3127, 0.3290]]),
];

/// The meaning of the samples: sRGB unless a chunk says otherwise, of which the first in this order counts: `cICP`, `iCCP`, `sRGB`,
/// `gAMA`. 1/2.2 is how files say sRGB without the chunk of that name. [PNG, 4.3 and 13.13]
fn meaning(info: &Info) -> Meaning {
    if let Some(codes) = info.coding_independent_code_points {
        let space = match codes.transfer_function {
            LINEAR => ColourSpace::LinearRec709,
            GAMMA_22 => ColourSpace::Gamma(1.0 / 2.2),
            GAMMA_28 => ColourSpace::Gamma(1.0 / 2.8),
            _ => ColourSpace::Srgb,
        };
        let other = OTHER_PRIMARIES.iter().find(|(code, _)| *code == codes.color_primaries);
        return match other.and_then(|(_, primaries)| primaries::matrix_to_rec709(*primaries)) {
            Some(matrix) => {
                let curves = Box::new([0, 1, 2].map(|_| Curve::Known(space)));
                Meaning::Wide { curves, matrix }
            }
            None => Meaning::Plain(space),
        };
    }
    let of_profile = info.icc_profile.as_deref().and_then(icc::meaning);
    of_profile.unwrap_or_else(|| Meaning::Plain(by_gamma(info)))
}

/// By the chunks that say only the curve.
fn by_gamma(info: &Info) -> ColourSpace {
    let Some(gamma) = info.gama_chunk.filter(|_| info.srgb.is_none()).map(|gamma| gamma.into_value()) else {
        return ColourSpace::Srgb;
    };
    match gamma {
        1.0 => ColourSpace::LinearRec709,
        gamma if (gamma - 1.0 / 2.2).abs() < 0.01 => ColourSpace::Srgb,
        // Such files exist, and their value is meaningless: they are shown as if the chunk were missing.
        gamma if !(0.05..=20.0).contains(&gamma) => ColourSpace::Srgb,
        gamma => ColourSpace::Gamma(gamma),
    }
}

/// Fault of a picture whose colours do not show what its `cICP` chunk says.
fn not_heeded(info: &Info) -> Option<String> {
    let codes = info.coding_independent_code_points?;
    let curve = match codes.transfer_function {
        PQ => Some("PQ"),
        HLG => Some("HLG"),
        _ => None,
    };
    let is_known =
        |code: &u8| REC709_PRIMARIES.contains(code) || OTHER_PRIMARIES.iter().any(|(other, _)| other == code);
    let primaries = Some(codes.color_primaries).filter(|code| !is_known(code));
    match (curve, primaries) {
        (Some(curve), _) => Some(format!("its samples are encoded by {curve} (cICP), and are read as sRGB")),
        (None, Some(code)) => Some(format!(
            "its primaries (cICP, code {code}) are not those of Rec. 709, and its colours are read as if they were"
        )),
        (None, None) => None,
    }
}

fn texts(info: &Info) -> BTreeMap<String, String> {
    let mut texts = BTreeMap::new();
    for text in &info.uncompressed_latin1_text {
        texts.insert(text.keyword.clone(), text.text.clone());
    }
    for text in &info.compressed_latin1_text {
        let mut text = text.clone();
        if let Ok(plain) = text.decompress_text_with_limit(LONGEST_TEXT).and_then(|()| text.get_text()) {
            texts.insert(text.keyword, plain);
        }
    }
    for text in &info.utf8_text {
        let mut text = text.clone();
        if let Ok(plain) = text.decompress_text_with_limit(LONGEST_TEXT).and_then(|()| text.get_text()) {
            texts.insert(text.keyword, plain);
        }
    }
    texts
}

fn write(picture: Source, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let shown = picture.for_display(FORMAT, options)?;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, picture.width() as u32, picture.height() as u32);
    encoder.set_color(match shown.names[..] {
        ["Y"] => ColorType::Grayscale,
        ["Y", "A"] => ColorType::GrayscaleAlpha,
        ["R", "G", "B"] => ColorType::Rgb,
        _ => ColorType::Rgba,
    });
    encoder.set_depth(match options.bit_depth {
        BitDepth::Eight => ::png::BitDepth::Eight,
        BitDepth::Sixteen => ::png::BitDepth::Sixteen,
    });
    // A fifth larger than with the best compression, in a fifth of its time.
    encoder.set_compression(Compression::Fast);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    for (keyword, text) in picture.metadata().iter().filter(|(keyword, _)| !is_of_layers(keyword)) {
        let plain = text.chars().all(|letter| u32::from(letter) < 256);
        // As EXR and as PNG call it.
        let keyword = if keyword == "software" { "Software" } else { keyword };
        let (keyword, text) = (keyword.to_owned(), text.clone());
        let added =
            if plain { encoder.add_text_chunk(keyword, text) } else { encoder.add_itxt_chunk(keyword, text) };
        added.map_err(unwritable)?;
    }
    let mut writer = encoder.write_header().map_err(unwritable)?;
    writer.write_image_data(&shown.samples).map_err(unwritable)?;
    writer.finish().map_err(unwritable)?;
    Ok(bytes)
}

/// True for metadata of layers, which the format does not hold, and of views, which nobody looks for there.
fn is_of_layers(keyword: &str) -> bool {
    keyword.starts_with("cryptomatte/") || keyword.starts_with("worldTo") || keyword == "pixelAspectRatio"
}

fn unwritable(error: ::png::EncodingError) -> PictureError {
    let what = match error {
        ::png::EncodingError::IoError(error) => format!("its bytes cannot be written: {error}"),
        ::png::EncodingError::LimitsExceeded => "it takes more memory than is allowed".to_owned(),
        _ => "PNG does not allow its size, or the key or text of one of its metadata entries".to_owned(),
    };
    PictureError::Unwritable { format: FORMAT, what }
}
