//! Reads E57.

use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::meshes::cloud::Cloud;
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb};
use bilux_pictures::guarded_decoding;
use bilux_scene::SceneBuilder;
use e57::{CartesianCoordinate, E57Reader, Error, Point, PointCloud, Quaternion};
use std::io::Cursor;

/// The first bytes of a file.
pub(super) const SIGNATURE: &[u8] = b"ASTM-E57";
/// The place of the length of the XML in the header.
const XML_LENGTH: usize = 32;
/// The memory that the XML takes, as a multiple of its length.
const XML: u64 = 16;

type Reader<'s> = E57Reader<Cursor<&'s [u8]>>;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let bytes = source.bytes;
    let fail = |why: &str| FormatError::malformed(why, whole_file(source.name));
    if !bytes.starts_with(SIGNATURE) {
        return Err(fail("an E57 file begins with the letters ASTM-E57: is this another format?"));
    }
    let length = bytes.get(XML_LENGTH..).and_then(<[u8]>::first_chunk).map_or(0, |b| u64::from_le_bytes(*b));
    if length > bytes.len() as u64 {
        return Err(fail("the header states more data than there are: the file was cut off"));
    }
    reading.budget.take_bytes(length * XML, source.name)?;
    let panicked = || fail("its parts contradict each other: export it again");
    let opened = guarded_decoding(|| Reader::new(Cursor::new(bytes))).ok_or_else(panicked)?;
    let mut reader = opened.map_err(|error| fail(reason(&error)))?;
    let scans = reader.pointclouds();
    let count = scans.iter().fold(0u64, |sum, scan| sum.saturating_add(scan.records));
    if count == 0 {
        return Err(fail("it contains no points"));
    }
    if count >= u64::from(u32::MAX) {
        return Err(fail("there are more than 4 billion points: split the file"));
    }
    let is_coloured = scans.iter().any(|scan| scan.has_color() || scan.has_intensity());
    let mut scan_points =
        ScanPoints { cloud: Cloud::default(), is_coloured, without_place: 0, mended_rotations: 0 };
    scan_points.cloud.reserve(count, is_coloured, &mut reading.budget, source.name)?;
    let mut parts = Vec::new();
    for (number, scan) in scans.iter().enumerate() {
        let before = scan_points.cloud.positions.len();
        let added = guarded_decoding(|| scan_points.add(&mut reader, scan)).ok_or_else(panicked)?;
        added.map_err(|error| fail(reason(&error)))?;
        let name = scan.name.clone().filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("{} {}", source.stem(), number + 1));
        reading.budget.take_bytes(2 * name.len() as u64, source.name)?;
        parts.push((name, scan_points.cloud.positions.len() - before));
    }
    let ScanPoints { cloud, without_place, mended_rotations, .. } = scan_points;
    if cloud.positions.is_empty() {
        return Err(fail("none of its points has a place"));
    }
    let mut scene = cloud.into_scene_of(parts);
    let mut diagnostics = Diagnostics::default();
    let at = || whole_file(source.name);
    if without_place > 0 {
        diagnostics.remark(
            &format!("{without_place} points have no place, as where a laser met nothing; they are left out"),
            at,
        );
    }
    if mended_rotations > 0 {
        let what =
            "quaternions whose length is not 1 are taken as if it were, and those of length 0 turn nothing";
        diagnostics.note(what, at);
    }
    if !reader.images().is_empty() {
        diagnostics.not_shown("photographs", at);
    }
    diagnostics.not_used("rows, columns, returns and times of points, and intensities beside colours", at);
    diagnostics.into_warnings(&mut scene);
    Ok(scene)
}

/// The points of all scans so far.
struct ScanPoints {
    cloud: Cloud,
    is_coloured: bool,
    without_place: u64,
    /// Scans whose rotation was none.
    mended_rotations: usize,
}

impl ScanPoints {
    /// Adds the points of a scan, in the space of the file.
    fn add(&mut self, reader: &mut Reader, scan: &PointCloud) -> Result<(), Error> {
        let has_colours = scan.has_color();
        let mut scan = scan.clone();
        if let Some(transform) = &mut scan.transform {
            self.mended_rotations += usize::from(make_rotation(&mut transform.rotation));
        }
        let mut points = reader.pointcloud_simple(&scan)?;
        points.apply_pose(true);
        points.spherical_to_cartesian(true);
        points.intensity_to_color(false);
        for point in points {
            let point = point?;
            match point.cartesian {
                CartesianCoordinate::Valid { x, y, z } => {
                    self.cloud.push(DVec3::new(x, y, z));
                    if self.is_coloured {
                        self.cloud.colours.push(colour(&point, has_colours));
                    }
                }
                _ => self.without_place += 1,
            }
        }
        Ok(())
    }
}

/// A larger difference of a quaternion's length from 1 is no rounding.
const ROUNDING: f64 = 1e-4;

/// Gives a quaternion the length of 1, which the decoder relies on; one of length 0 becomes no rotation. True if it was far from it.
fn make_rotation(q: &mut Quaternion) -> bool {
    let length = (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z).sqrt();
    if length.is_normal() {
        *q = Quaternion { w: q.w / length, x: q.x / length, y: q.y / length, z: q.z / length };
    } else {
        *q = Quaternion::default();
    }
    (length - 1.0).abs() > ROUNDING
}

/// The colour of a point; of a scan without colours, a grey level from its intensity.
fn colour(point: &Point, has_colours: bool) -> Rgb {
    match (&point.color, point.intensity) {
        (Some(colour), _) => {
            Rgb::new(colour.red, colour.green, colour.blue).map(|c| srgb_decode(in_range(c, 1.0)))
        }
        (None, Some(part)) if !has_colours => Rgb::grey(srgb_decode(0.15 + 0.8 * in_range(part, 0.5))),
        _ => Rgb::WHITE,
    }
}

/// A number as a part of the range that the file states. An empty range says nothing: then it is the other number.
fn in_range(part: f32, unsaid: f32) -> f32 {
    if part.is_finite() { part.clamp(0.0, 1.0) } else { unsaid }
}

/// Reason of an error, in plain words.
fn reason(error: &Error) -> &'static str {
    match error {
        Error::NotImplemented { .. } => {
            "it has data of a kind that cannot be read yet: export it without extensions"
        }
        Error::Read { .. } => "a page of it is damaged (its checksum is wrong), or the file was cut off",
        _ => "its description of the scans is damaged: export it again",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quaternion_of_any_length_is_a_rotation() {
        let length = |q: &Quaternion| (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z).sqrt();
        for (given, wanted, is_said) in [
            ([2.0, 0.0, 0.0, 2.0], [0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()], true),
            ([0.0; 4], [1.0, 0.0, 0.0, 0.0], true),
            ([f64::NAN, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], false),
            ([0.6, 0.8 + 1e-6, 0.0, 0.0], [0.6, 0.8, 0.0, 0.0], false),
        ] {
            let [w, x, y, z] = given;
            let mut q = Quaternion { w, x, y, z };
            let said = make_rotation(&mut q);
            assert!(said == is_said || w.is_nan(), "{given:?}");
            let near = [q.w, q.x, q.y, q.z].iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near && (length(&q) - 1.0).abs() < 1e-12, "{given:?}: {q:?}");
        }
    }
}
