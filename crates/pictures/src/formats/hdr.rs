//! Radiance's RGBE pictures: three 8-bit mantissas under one exponent. [Ward 1991]
//!
//! A mantissa m under the exponent byte e means m · 2^(e − 136), as in most programs (Radiance itself adds half a
//! step, since it truncates where we round): so integers up to 255 are preserved exactly.

use super::primaries::{self, Primaries, REC709, are_same, to_rec709};
use super::{PictureFormatEntry, Source, WriteOptions, require_colour};
use crate::limits::{reserved, zeroed};
use crate::picture::clamp_sample;
use crate::{Limits, Picture, PictureError};
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// The row of `hdr`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "hdr",
        summary: "Radiance RGBE: linear light at about 1% precision, small; the usual format of environment maps",
        source: "Ward 1991",
        parameters: &[],
    },
    extensions: &["hdr", "rgbe", "pic", "xyze"],
    for_display: false,
    holds_alpha: false,
    sniff: |bytes| bytes.starts_with(b"#?"),
    read,
    read_stored: None,
    read_crop: None,
    read_interleaved: None,
    write: Some(write),
};

const FORMAT: &str = "HDR";

/// Three planes and the current row.
const BYTES_PER_PIXEL: u64 = 3 * 4;

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let mut source = Unread { bytes, at: 0 };
    let header = Header::read(&mut source)?;
    let [width, height] = header.size();
    let pixels = limits.check(FORMAT, width as u64, height as u64, BYTES_PER_PIXEL)?;
    let [rows, columns] = header.axes.map(|axis| axis.length);
    // The shortest row is one pixel and its repeats, so no memory is taken for rows that are not there.
    let repeats = columns.ilog2() as usize / 8;
    if (source.bytes.len() - source.at) / (4 + 4 * repeats.min(1)) < rows {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let mut planes: [Vec<f32>; 3] =
        [zeroed(FORMAT, pixels)?, zeroed(FORMAT, pixels)?, zeroed(FORMAT, pixels)?];
    let mut row = reserved(FORMAT, columns)?;
    for i in 0..rows {
        source.row(columns, &mut row)?;
        for (j, rgbe) in row.iter().enumerate() {
            let colour = header.colour(*rgbe);
            let at = header.position(i, j, width);
            (0..3).for_each(|channel| planes[channel][at] = colour[channel]);
        }
    }
    let mut picture = Picture::new(width, height)?;
    for (name, plane) in ["R", "G", "B"].into_iter().zip(planes) {
        picture.push_channel(name, plane)?;
    }
    if !header.xyz {
        to_rec709(&mut picture, header.primaries);
    }
    Ok(picture)
}

struct Header {
    /// The divisor of every channel.
    exposure: [f32; 3],
    xyz: bool,
    /// Of colours that are no XYZ.
    primaries: Primaries,
    /// From row to row, then from pixel to pixel.
    axes: [Axis; 2],
}

#[derive(Clone, Copy)]
struct Axis {
    length: usize,
    vertical: bool,
    /// True when the first sample is at the right, or at the bottom.
    reversed: bool,
}

impl Header {
    fn read(source: &mut Unread) -> Result<Header, PictureError> {
        let (mut exposure, mut xyz, mut primaries) = ([1.0f32; 3], false, REC709);
        loop {
            let line = source.line("the header")?;
            if line.trim().is_empty() {
                break;
            }
            // Lines that begin with a blank are of the pictures from which a program made this one. [Ward 1991]
            let Some((key, value)) = line.trim().split_once('=').filter(|_| !line.starts_with(['\t', ' ']))
            else {
                continue;
            };
            match key.trim() {
                "FORMAT" => {
                    xyz = match value.trim() {
                        "32-bit_rle_rgbe" => false,
                        "32-bit_rle_xyze" => true,
                        other => {
                            let what =
                                format!("its FORMAT is '{other}', not 32-bit_rle_rgbe or 32-bit_rle_xyze");
                            return Err(PictureError::invalid(FORMAT, what));
                        }
                    }
                }
                // Both may occur more than once, and multiply. [Ward 1991]
                "EXPOSURE" => exposure = multiply(exposure, [number(key, value)?; 3]),
                "COLORCORR" => {
                    let mut words = value.split_whitespace();
                    let mut next = || number(key, words.next().unwrap_or_default());
                    exposure = multiply(exposure, [next()?, next()?, next()?]);
                }
                "PRIMARIES" => primaries = stated(value)?,
                _ => {}
            }
        }
        let axes = resolution(source.line("the resolution")?)?;
        Ok(Header { exposure, xyz, primaries, axes })
    }

    /// Width and height as shown.
    fn size(&self) -> [usize; 2] {
        let [rows, columns] = self.axes.map(|axis| axis.length);
        if self.axes[0].vertical { [columns, rows] } else { [rows, columns] }
    }

    /// The index in a plane of sample `j` of row `i`.
    fn position(&self, i: usize, j: usize, width: usize) -> usize {
        let mut at = 0;
        for (axis, index) in self.axes.iter().zip([i, j]) {
            let index = if axis.reversed { axis.length - 1 - index } else { index };
            at += if axis.vertical { index * width } else { index };
        }
        at
    }

    fn colour(&self, rgbe: [u8; 4]) -> Rgb {
        let stored = decode(rgbe);
        let linear = if self.xyz { rec709_from_xyz(stored) } else { stored };
        linear / Rgb::from_array(self.exposure)
    }
}

fn multiply(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

fn number(key: &str, value: &str) -> Result<f32, PictureError> {
    match value.trim().parse() {
        Ok(number) if number > 0.0 && f32::is_finite(number) => Ok(number),
        _ => {
            let what = format!("its {} is '{}', but must be a number above zero", key.trim(), value.trim());
            Err(PictureError::invalid(FORMAT, what))
        }
    }
}

/// The primaries of Radiance itself, whose green and white differ a little from those of Rec. 709: pictures that state them are read as
/// those that state nothing. [Ward 1991]
const OF_RADIANCE: Primaries = [[0.64, 0.33], [0.29, 0.60], [0.15, 0.06], [1.0 / 3.0, 1.0 / 3.0]];

/// The chromaticities of red, green, blue and white.
fn stated(value: &str) -> Result<Primaries, PictureError> {
    let what = || format!("its PRIMARIES are '{}', but must be eight numbers", value.trim());
    let stated = primaries::of_text(value).ok_or_else(|| PictureError::invalid(FORMAT, what()))?;
    Ok(if are_same(stated, OF_RADIANCE) { REC709 } else { stated })
}

/// Reads a line such as `-Y 512 +X 768`: rows from the top down, pixels from left to right.
fn resolution(line: &str) -> Result<[Axis; 2], PictureError> {
    let wrong = || {
        PictureError::invalid(
            FORMAT,
            format!("its resolution is '{}', not like '-Y 512 +X 768'", line.trim()),
        )
    };
    let words: Vec<&str> = line.split_whitespace().collect();
    let [first, first_length, second, second_length] = words[..] else { return Err(wrong()) };
    let axis = |name: &str, length: &str| {
        let (vertical, reversed) = match name {
            "-Y" => (true, false),
            "+Y" => (true, true),
            "+X" => (false, false),
            "-X" => (false, true),
            _ => return Err(wrong()),
        };
        let length = length
            .parse()
            .ok()
            .filter(|length| (1..=i32::MAX as usize).contains(length))
            .ok_or_else(wrong)?;
        Ok(Axis { length, vertical, reversed })
    };
    let axes = [axis(first, first_length)?, axis(second, second_length)?];
    if axes[0].vertical == axes[1].vertical { Err(wrong()) } else { Ok(axes) }
}

/// The bytes, and the current position.
struct Unread<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Unread<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], PictureError> {
        let taken = self.at.checked_add(count).and_then(|end| self.bytes.get(self.at..end));
        self.at += count;
        taken.ok_or_else(|| PictureError::truncated(FORMAT, "the pixels"))
    }

    fn pixel(&mut self) -> Result<[u8; 4], PictureError> {
        let taken = self.take(4)?;
        Ok([taken[0], taken[1], taken[2], taken[3]])
    }

    fn line(&mut self, part: &'static str) -> Result<&'a str, PictureError> {
        let rest = &self.bytes[self.at..];
        let window = &rest[..rest.len().min(LONGEST_LINE)];
        let end = window.iter().position(|byte| *byte == b'\n').ok_or_else(|| {
            if rest.len() < LONGEST_LINE {
                PictureError::truncated(FORMAT, part)
            } else {
                PictureError::invalid(FORMAT, format!("a line of {part} at byte {} is too long", self.at))
            }
        })?;
        self.at += end + 1;
        // A line that is not text can only be a comment.
        Ok(std::str::from_utf8(&window[..end]).unwrap_or("?"))
    }

    /// One row in any of the three encodings; each row may have its own.
    fn row(&mut self, columns: usize, row: &mut Vec<[u8; 4]>) -> Result<(), PictureError> {
        row.clear();
        let start = self.at;
        let first = self.pixel()?;
        if !(8..=0x7fff).contains(&columns) || first[0] != 2 || first[1] != 2 || first[2] & 0x80 != 0 {
            return self.old_row(columns, first, row);
        }
        let length = usize::from(first[2]) << 8 | usize::from(first[3]);
        if length != columns {
            let what = format!(
                "the row at byte {start} has {length} pixels, but the picture is {columns} pixels wide"
            );
            return Err(PictureError::invalid(FORMAT, what));
        }
        row.resize(columns, [0; 4]);
        (0..4).try_for_each(|component| self.packed_component(component, row))
    }

    /// Run-length encoded bytes of one component: a count above 128 repeats a byte, otherwise that many bytes follow
    /// as they are.
    fn packed_component(&mut self, component: usize, row: &mut [[u8; 4]]) -> Result<(), PictureError> {
        let mut rest = row.iter_mut();
        while rest.len() > 0 {
            let code = usize::from(self.take(1)?[0]);
            let (count, literal) = if code > 128 { (code - 128, false) } else { (code, true) };
            if count == 0 || count > rest.len() {
                let what = {
                    let (at, left) = (self.at - 1, rest.len());
                    format!("the run at byte {at} has {count} pixels, but only {left} are left in its row")
                };
                return Err(PictureError::invalid(FORMAT, what));
            }
            let values = self.take(if literal { count } else { 1 })?;
            let places = rest.by_ref().take(count);
            places.enumerate().for_each(|(i, pixel)| pixel[component] = values[if literal { i } else { 0 }]);
        }
        Ok(())
    }

    /// Plain pixels, where mantissas of 1, 1, 1 mean that the previous pixel is repeated; consecutive repeats are the
    /// digits of one number, lowest first, to the base of 256.
    fn old_row(
        &mut self,
        columns: usize,
        first: [u8; 4],
        row: &mut Vec<[u8; 4]>,
    ) -> Result<(), PictureError> {
        let (mut pixel, mut shift) = (first, 0);
        loop {
            if pixel[..3] == [1, 1, 1] && !row.is_empty() {
                let count = usize::from(pixel[3]).checked_shl(shift).unwrap_or(usize::MAX);
                if shift > 24 || count > columns - row.len() {
                    return Err(PictureError::invalid(
                        FORMAT,
                        format!("the run at byte {} goes beyond the end of its row", self.at - 4),
                    ));
                }
                row.resize(row.len() + count, row[row.len() - 1]);
                shift += 8;
            } else {
                row.push(pixel);
                shift = 0;
            }
            if row.len() == columns {
                return Ok(());
            }
            pixel = self.pixel()?;
        }
    }
}

/// No header line is longer.
const LONGEST_LINE: usize = 1 << 16;

fn decode([r, g, b, e]: [u8; 4]) -> Rgb {
    if e == 0 {
        return Rgb::BLACK;
    }
    let scale = power_of_two(i32::from(e) - 136);
    Rgb::new((f64::from(r) * scale) as f32, (f64::from(g) * scale) as f32, (f64::from(b) * scale) as f32)
}

/// Rounds to the nearest mantissas. Negative values and NaN become 0; infinity becomes the format's maximum.
fn encode(colour: Rgb) -> [u8; 4] {
    let colour = colour.map(|c| clamp_sample(c, GREATEST));
    let brightest = colour.max_channel();
    if brightest < f32::MIN_POSITIVE {
        return [0; 4];
    }
    let mut exponent = (brightest.to_bits() >> 23) as i32 - 126;
    let step =
        |channel: f32, exponent: i32| (f64::from(channel) * power_of_two(8 - exponent) + 0.5).floor() as u32;
    if step(brightest, exponent) > 255 {
        exponent += 1;
    }
    let [r, g, b] = colour.to_array().map(|c| step(c, exponent) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// 255 · 2^119, the largest number of the format.
const GREATEST: f32 = f32::from_bits(0x7eff_0000);

/// 2 to an integer power from −1022 to 1023, exactly.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// Converts CIE XYZ with white at the equal-energy point, as in Radiance, to linear Rec. 709: the matrix of the Rec.
/// 709 primaries and D65, with each row scaled so that X = Y = Z is white.
fn rec709_from_xyz(xyz: Rgb) -> Rgb {
    let [x, y, z] = xyz.to_array();
    Rgb::new(
        2.690 * x - 1.276 * y - 0.414 * z,
        -1.022 * x + 1.978 * y + 0.044 * z,
        0.061 * x - 0.224 * y + 1.163 * z,
    )
}

fn write(picture: Source, _: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let picture = picture.planes(FORMAT)?;
    require_colour(FORMAT, &picture)?;
    let picture = picture.into_owned().into_linear();
    let (width, height) = (picture.width(), picture.height());
    let [r, g, b] = picture.rgb_planes().unwrap_or_default();
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for y in 0..height {
        let row: Vec<[u8; 4]> =
            (y * width..(y + 1) * width).map(|i| encode(Rgb::new(r[i], g[i], b[i]))).collect();
        if (8..=0x7fff).contains(&width) {
            bytes.extend_from_slice(&[2, 2, (width >> 8) as u8, width as u8]);
            (0..4).for_each(|component| pack_component(&row, component, &mut bytes));
        } else {
            bytes.extend_from_slice(row.as_flattened());
        }
    }
    Ok(bytes)
}

/// Runs of four or more equal bytes are packed; the bytes between them are stored as they are.
fn pack_component(row: &[[u8; 4]], component: usize, bytes: &mut Vec<u8>) {
    let value = |i: usize| row[i][component];
    let run = |start: usize| (start..row.len()).take(127).take_while(|i| value(*i) == value(start)).count();
    let mut start = 0;
    while start < row.len() {
        let equal = run(start);
        if equal >= 4 {
            bytes.extend_from_slice(&[128 + equal as u8, value(start)]);
            start += equal;
            continue;
        }
        let mut end = start + equal;
        while end < row.len() && end - start < 128 && run(end) < 4 {
            end += 1;
        }
        bytes.push((end - start) as u8);
        bytes.extend((start..end).map(value));
        start = end;
    }
}
