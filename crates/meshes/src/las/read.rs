//! Reads LAS.

use super::compressed::points;
use super::header::{Header, u16_at, u32_at};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::colours::{Greatest, Stored, decoded};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::meshes::cloud::{Cloud, SAMPLES};
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb};
use bilux_scene::SceneBuilder;

/// The offset of a point's intensity, in all formats.
const INTENSITY: usize = 12;
/// The offset of the byte that says whether a point is withheld, in all formats.
const FLAGS: usize = 15;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let (bytes, header) = points(reading, source)?;
    let all = || bytes[header.points..].chunks_exact(header.record).take(header.count as usize);
    let is_withheld = |record: &&[u8]| record[FLAGS] & header.withheld != 0;
    let withheld = all().filter(is_withheld).count();
    // A file of which nothing would be left is shown whole.
    let is_shown = move |record: &&[u8]| withheld == header.count as usize || !is_withheld(record);
    let records = || all().filter(is_shown);
    let position = |record: &[u8]| {
        let number = |at: usize| f64::from(u32_at(record, at) as i32);
        DVec3::new(number(0), number(4), number(8)) * header.scale + header.offset
    };
    let colour_of = colours(&header, records);
    let first = records().next().map(position).unwrap_or_default();
    let step = (header.count as usize / SAMPLES).max(1);
    let samples: Vec<DVec3> = records().step_by(step).map(position).collect();
    let mut cloud = Cloud::around(first, &samples);
    cloud.reserve(header.count, colour_of.is_some(), &mut reading.budget, source.name)?;
    for record in records() {
        cloud.push(position(record));
        cloud.colours.extend(colour_of.as_ref().map(|of| of(record)));
    }
    let mut scene = cloud.into_scene(source.stem());
    let mut diagnostics = Diagnostics::default();
    if withheld > 0 {
        let left = if withheld == header.count as usize { "all, so they are shown" } else { "left out" };
        diagnostics.remark(&format!("{withheld} points are withheld, which means deleted: {left}"), || {
            whole_file(source.name)
        });
    }
    let unused = "classes, returns, angles and times of points, and intensities beside colours";
    diagnostics.not_used(unused, || whole_file(source.name));
    diagnostics.into_warnings(&mut scene);
    Ok(scene)
}

/// Computes the colour of a record.
type ColourOf = Box<dyn Fn(&[u8]) -> Rgb>;

/// The colours of the records if they have any; otherwise grey levels from their intensities, if these differ.
///
/// Some programs write 8-bit values into the 16-bit fields.
fn colours<'b, I: Iterator<Item = &'b [u8]>>(header: &Header, records: impl Fn() -> I) -> Option<ColourOf> {
    if let Some(at) = header.colour {
        let stored = move |record: &[u8]| {
            Rgb::from_array([0, 2, 4].map(|channel| f32::from(u16_at(record, at + channel))))
        };
        let mut greatest = Greatest::default();
        records().for_each(|record| greatest.see(stored(record)));
        if !greatest.is_zero() {
            let white = greatest.white(Stored::Integers);
            return Some(Box::new(move |record| decoded(stored(record), white)));
        }
    }
    let mut histogram = vec![0u64; 1 << 16];
    records().for_each(|record| histogram[usize::from(u16_at(record, INTENSITY))] += 1);
    let count: u64 = histogram.iter().sum();
    let place = |part: f64| {
        let mut left = (count as f64 * part) as u64;
        let mut reaches = |count: &u64| {
            let is_there = left < *count;
            left = left.saturating_sub(*count);
            is_there
        };
        histogram.iter().position(&mut reaches).unwrap_or(histogram.len() - 1) as f32
    };
    // A few mirror reflections are brighter than everything else.
    let (dark, bright) = (place(0.02), place(0.98));
    (bright > dark).then(|| {
        let grey = move |record: &[u8]| {
            let part = (f32::from(u16_at(record, INTENSITY)) - dark) / (bright - dark);
            Rgb::grey(srgb_decode(0.15 + 0.8 * part.clamp(0.0, 1.0)))
        };
        Box::new(grey) as Box<dyn Fn(&[u8]) -> Rgb>
    })
}
