//! COLMAP's models, in text or binary: the lenses in `cameras`, and in `images` where each picture was taken.
//!
//! `images.txt` has two lines for each picture: the second one, of points in it, may be empty.

use super::camera::{Lens, Model, Pose};
use super::{CalibratedCameras, CalibrationFormatEntry};
use crate::FormatError;
use crate::bytes::text::{name_of, quoted, whole_file};
use crate::input::reading::{Reading, Source};
use bilux_math::glam::DQuat;
use bilux_math::{DMat3, DVec3};
use bilux_scene::Span;
use std::collections::HashMap;
use std::sync::Arc;

pub(super) const TEXT: CalibrationFormatEntry = CalibrationFormatEntry {
    is_binary: false,
    is_of: |file, _| matches!(file, "cameras.txt" | "images.txt"),
    read: |reading, source| read(reading, source, "txt", [text_cameras, text_images]),
};

pub(super) const BINARY: CalibrationFormatEntry = CalibrationFormatEntry {
    is_binary: true,
    is_of: |file, _| matches!(file, "cameras.bin" | "images.bin"),
    read: |reading, source| read(reading, source, "bin", [binary_cameras, binary_images]),
};

/// Contents of one of the files: lenses by their numbers, or pictures.
#[derive(Default)]
struct Found {
    lenses: HashMap<u32, (Lens, Span)>,
    images: Vec<Image>,
}

struct Image {
    /// Of the rotation from the world to the camera: w, x, y, z.
    turn: [f64; 4],
    shift: [f64; 3],
    lens: u32,
    name: String,
    at: Span,
}

type Reader = fn(&Source) -> Result<Found, FormatError>;

/// Reads a file and the one beside it: pictures need lenses; lenses alone say what they are, but not where.
fn read(
    reading: &mut Reading,
    source: &Source,
    extension: &str,
    [cameras, images]: [Reader; 2],
) -> Result<CalibratedCameras, FormatError> {
    let is_images = source.stem().eq_ignore_ascii_case("images");
    let other = if is_images { "cameras" } else { "images" };
    let at = whole_file(source.name);
    let beside = reading.locator.locate(source.folder, &format!("{other}.{extension}"), &at);
    let beside = match beside {
        Ok(path) => Some((Arc::from(path.display().to_string()), reading.load(&path)?)),
        Err(error) if is_images => return Err(error),
        Err(_) => None,
    };
    let beside = beside.as_ref().map(|(name, bytes)| Source { bytes, name, folder: source.folder });
    let (lenses, pictures) = if is_images {
        (beside.as_ref().map(cameras).transpose()?.unwrap_or_default(), images(source)?)
    } else {
        (cameras(source)?, beside.as_ref().map(images).transpose()?.unwrap_or_default())
    };
    let mut read =
        CalibratedCameras { are_placed: !pictures.images.is_empty(), ..CalibratedCameras::default() };
    for image in &pictures.images {
        let Some((lens, _)) = lenses.lenses.get(&image.lens) else {
            let message = format!(
                "the picture '{}' has the camera {}, which is not in the file",
                image.name, image.lens
            );
            return Err(FormatError::malformed(message, image.at.clone()));
        };
        read.cameras.push(lens.spec(&image.name, Some(&image.pose()?), &image.at)?);
    }
    if !read.are_placed {
        let mut numbers: Vec<_> = lenses.lenses.iter().collect();
        numbers.sort_by_key(|(number, _)| **number);
        for (number, (lens, at)) in numbers {
            read.cameras.push(lens.spec(&number.to_string(), None, at)?);
        }
    }
    Ok(read)
}

impl Image {
    fn pose(&self) -> Result<Pose, FormatError> {
        let [w, x, y, z] = self.turn;
        let turn = DQuat::from_xyzw(x, y, z, w);
        if !(turn.length() > 0.0 && turn.is_finite()) {
            return Err(FormatError::malformed(
                "the quaternion of this picture is no rotation",
                self.at.clone(),
            ));
        }
        Pose::of_world_to_camera(DMat3::from_quat(turn.normalize()), DVec3::from(self.shift), &self.at)
    }
}

/// The models by name, their binary number, and how many focal lengths and coefficients they have, in the order of OpenCV's.
const MODELS: &[(&str, i32, Model, usize, usize)] = &[
    ("SIMPLE_PINHOLE", 0, Model::OpenCv, 1, 0),
    ("PINHOLE", 1, Model::OpenCv, 2, 0),
    ("SIMPLE_RADIAL", 2, Model::OpenCv, 1, 1),
    ("RADIAL", 3, Model::OpenCv, 1, 2),
    ("OPENCV", 4, Model::OpenCv, 2, 4),
    ("OPENCV_FISHEYE", 5, Model::Fisheye, 2, 4),
    ("FULL_OPENCV", 6, Model::OpenCv, 2, 8),
    ("SIMPLE_RADIAL_FISHEYE", 8, Model::Fisheye, 1, 1),
    ("RADIAL_FISHEYE", 9, Model::Fisheye, 1, 2),
];

impl Lens {
    fn of_colmap(
        &(name, _, model, focals, coefficients): &(&str, i32, Model, usize, usize),
        size: [u32; 2],
        numbers: &[f64],
    ) -> Result<Lens, String> {
        let wanted = focals + 2 + coefficients;
        if numbers.len() != wanted {
            return Err(format!("a camera of the model {name} has {wanted} numbers, not {}", numbers.len()));
        }
        let (focal, rest) = numbers.split_at(focals);
        let focal = [focal[0], focal[focals - 1]];
        let (centre, coefficients) = ([rest[0], rest[1]], rest[2..].to_vec());
        Ok(Lens { model, size, focal, centre, skew: 0.0, coefficients }.counted_from_corner())
    }
}

/// The lines that are no comments, with their places.
fn lines<'s>(source: &'s Source) -> impl Iterator<Item = (&'s [u8], Span)> {
    let line = |(i, line): (usize, &'s [u8])| {
        (line.trim_ascii(), Span { line: i as u32 + 1, column: 1, ..whole_file(source.name) })
    };
    source
        .bytes
        .split(|byte| *byte == b'\n')
        .enumerate()
        .map(line)
        .filter(|(line, _)| !line.starts_with(b"#"))
}

/// Reads the words of a line one by one.
struct Words<'a> {
    rest: &'a [u8],
    at: &'a Span,
}

impl<'a> Words<'a> {
    fn word(&mut self) -> &'a [u8] {
        let rest = self.rest.trim_ascii_start();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.rest = &rest[end..];
        &rest[..end]
    }

    fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, FormatError> {
        let word = self.word();
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| {
            let found =
                if word.is_empty() { "the line ends".to_owned() } else { format!("{} stands", quoted(word)) };
            FormatError::malformed(format!("{found} where {what} should be"), self.at.clone())
        })
    }
}

fn text_cameras(source: &Source) -> Result<Found, FormatError> {
    let mut found = Found::default();
    for (line, at) in lines(source).filter(|(line, _)| !line.is_empty()) {
        let mut words = Words { rest: line, at: &at };
        let number = words.number("the number of the camera")?;
        let model = name_of(words.word());
        let row = MODELS.iter().find(|row| row.0 == model).ok_or_else(|| unknown(&model, &at))?;
        let size = [words.number("the width")?, words.number("the height")?];
        let mut numbers = Vec::new();
        while !words.rest.trim_ascii().is_empty() {
            numbers.push(words.number("a number of the lens")?);
        }
        let lens = Lens::of_colmap(row, size, &numbers)
            .map_err(|message| FormatError::malformed(message, at.clone()))?;
        found.lenses.insert(number, (lens, at));
    }
    Ok(found)
}

fn unknown(model: &str, at: &Span) -> FormatError {
    let known: Vec<&str> = MODELS.iter().map(|row| row.0).collect();
    let message = format!("the camera model '{model}' is not supported: known are {}", known.join(", "));
    FormatError::malformed(message, at.clone())
}

fn text_images(source: &Source) -> Result<Found, FormatError> {
    let mut found = Found::default();
    let mut lines = lines(source);
    while let Some((line, at)) = lines.next() {
        if line.is_empty() {
            continue;
        }
        let mut words = Words { rest: line, at: &at };
        words.number::<u32>("the number of the picture")?;
        let mut next = |what| words.number::<f64>(what);
        let turn = [next("QW")?, next("QX")?, next("QY")?, next("QZ")?];
        let shift = [next("TX")?, next("TY")?, next("TZ")?];
        let lens = words.number("the number of the camera")?;
        let name = name_of(words.rest.trim_ascii());
        found.images.push(Image { turn, shift, lens, name, at: at.clone() });
        // Its points.
        lines.next();
    }
    Ok(found)
}

/// Reads numbers of a binary file, little-endian.
struct Bytes<'a> {
    rest: &'a [u8],
    source: &'a Source<'a>,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: u64) -> Result<&'a [u8], FormatError> {
        let split = usize::try_from(count).ok().and_then(|count| self.rest.split_at_checked(count));
        let (taken, rest) = split.ok_or_else(|| {
            let message = format!("the file is cut off: {count} bytes more are wanted at its end");
            FormatError::malformed(message, whole_file(self.source.name))
        })?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        Ok(std::array::from_fn({
            let taken = self.take(N as u64)?;
            |i| taken[i]
        }))
    }

    fn whole(&mut self) -> Result<u64, FormatError> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    fn number(&mut self) -> Result<f64, FormatError> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    fn short(&mut self) -> Result<u32, FormatError> {
        Ok(u32::from_le_bytes(self.array()?))
    }
}

fn binary_cameras(source: &Source) -> Result<Found, FormatError> {
    let (mut bytes, mut found) = (Bytes { rest: source.bytes, source }, Found::default());
    let at = whole_file(source.name);
    for _ in 0..bytes.whole()? {
        let (number, model) = (bytes.short()?, bytes.short()? as i32);
        let row = MODELS.iter().find(|row| row.1 == model);
        let row = row.ok_or_else(|| unknown(&model.to_string(), &at))?;
        let side = |side: u64| u32::try_from(side).unwrap_or(u32::MAX);
        let size = [side(bytes.whole()?), side(bytes.whole()?)];
        let numbers = (0..row.3 + 2 + row.4).map(|_| bytes.number()).collect::<Result<Vec<_>, _>>()?;
        let lens = Lens::of_colmap(row, size, &numbers)
            .map_err(|message| FormatError::malformed(message, at.clone()))?;
        found.lenses.insert(number, (lens, at.clone()));
    }
    Ok(found)
}

fn binary_images(source: &Source) -> Result<Found, FormatError> {
    /// The bytes of a point of a picture: two numbers, and which point of the model it is.
    const POINT: u64 = 24;
    let (mut bytes, mut found) = (Bytes { rest: source.bytes, source }, Found::default());
    for _ in 0..bytes.whole()? {
        bytes.short()?;
        let mut next = || bytes.number();
        let turn = [next()?, next()?, next()?, next()?];
        let shift = [next()?, next()?, next()?];
        let lens = bytes.short()?;
        let length = bytes.rest.iter().position(|byte| *byte == 0).unwrap_or(bytes.rest.len());
        let name = name_of(bytes.take(length as u64)?);
        bytes.take(1)?;
        let points = bytes.whole()?;
        bytes.take(points.saturating_mul(POINT))?;
        found.images.push(Image { turn, shift, lens, name, at: whole_file(source.name) });
    }
    Ok(found)
}
