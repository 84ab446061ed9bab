//! EULUMDAT (.ldt): a line for each value. [Stockmar 1990]

use super::symmetry::Planes;
use super::words::{Words, text_of};
use super::{LuminaireFormatEntry, Measured};
use crate::FormatError;
use crate::input::reading::Source;
use bilux_scene::{Goniometer, MAX_ANGLES};

pub(super) const FORMAT: LuminaireFormatEntry = LuminaireFormatEntry { sniff, read };

/// The format has no signature: the second and the third of its lines are numbers.
fn sniff(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|byte| *byte == b'\n').skip(1);
    let mut is_digit = |most: u8| {
        let word = lines.next().unwrap_or_default().trim_ascii();
        matches!(word, [digit] if (b'0'..=most).contains(digit))
    };
    is_digit(b'9') && is_digit(b'4')
}

/// The ratios of installed flux that rooms of ten shapes receive.
const DIRECT_RATIOS: usize = 10;
/// The sets of lamps that a file can list.
const MAX_SETS: usize = 20;

fn read(source: &Source) -> Result<Measured, FormatError> {
    let mut words = Words::new(source);
    skip(&mut words, 1, "the company")?;
    skip(&mut words, 1, "the kind of luminaire")?;
    let symmetry = words.count_of_line("the symmetry (Isym)", [0, 4])?;
    let planes = words.count_of_line("the number of C planes (Mc)", [1, MAX_ANGLES])?;
    words.number_of_line("the distance of C planes (Dc)")?;
    let rows = words.count_of_line("the number of γ angles (Ng)", [2, MAX_ANGLES])?;
    words.number_of_line("the distance of γ angles (Dg)")?;
    skip(&mut words, 1, "the number of the report")?;
    let name = words.line().map(text_of).unwrap_or_default();
    // Its number, file and date; its size and that of what shines; ratios of flux.
    skip(&mut words, 3 + 9 + 1, "the efficiency")?;
    words.number_of_line("the efficiency")?;
    let factor = not_negative(&mut words, "the factor of the intensities")?;
    words.number_of_line("the tilt of the luminaire")?;
    let (lumens, warnings) = lamps(&mut words)?;
    skip(&mut words, DIRECT_RATIOS, "the direct ratios")?;
    let azimuths = lines(&mut words, planes, "C angles")?;
    let polar = lines(&mut words, rows, "γ angles")?;
    let listed = listed(symmetry, planes, &words)?;
    let per_thousand = words_left(&mut words, listed.len() * rows)?;
    if let Some(wrong) = per_thousand.iter().find(|value| **value < 0.0) {
        return Err(words.wrong_file(format!("an intensity is {wrong} cd/klm: it must not be negative")));
    }
    let candela: Vec<f32> =
        per_thousand.iter().map(|value| (value * factor * lumens / 1000.0) as f32).collect();
    let azimuth = |plane: usize| azimuths[plane % planes] + 360.0 * (plane / planes) as f64;
    let of_listed: Vec<f64> = listed.map(azimuth).collect();
    let name = if name.is_empty() { source.stem() } else { name };
    let all = all_planes(symmetry, Planes::new(&of_listed, &candela));
    let distribution = all.distribution(&name, Goniometer::C, polar, &words)?;
    Ok(Measured { distribution, warnings })
}

/// Lines that say nothing of the light.
fn skip(words: &mut Words, count: usize, what: &str) -> Result<(), FormatError> {
    for _ in 0..count {
        words.line().ok_or_else(|| words.wrong(format!("the file ends before {what}: it is cut off")))?;
    }
    Ok(())
}

fn not_negative(words: &mut Words, what: &str) -> Result<f64, FormatError> {
    let number = words.number_of_line(what)?;
    if number >= 0.0 {
        Ok(number)
    } else {
        Err(words.wrong(format!("{what} is {number}: it must not be negative")))
    }
}

/// The lumens of the lamps to which the intensities refer: those of the first set, of which others are alternatives.
fn lamps(words: &mut Words) -> Result<(f64, Vec<String>), FormatError> {
    let sets = words.count_of_line("the number of sets of lamps", [1, MAX_SETS])?;
    let mut all = Vec::new();
    for _ in 0..sets {
        // A negative number of lamps says that the intensities are those of the luminaire itself.
        words.number_of_line("the number of lamps")?;
        skip(words, 1, "the type of lamp")?;
        all.push(not_negative(words, "the luminous flux of the lamps")?);
        skip(words, 3, "the lamps' colour, colour rendering and watts")?;
    }
    let first = all[0];
    let others = all.iter().any(|lumens| *lumens != first);
    let message = || format!("of its {sets} sets of lamps the first is used, with {first} lm");
    Ok((first, others.then(message).into_iter().collect()))
}

fn lines(words: &mut Words, count: usize, what: &str) -> Result<Vec<f64>, FormatError> {
    if count > words.left().div_ceil(2) {
        return Err(words.wrong(format!("the file ends before its {count} {what}: it is cut off")));
    }
    let one = format!("one of the {count} {what}");
    let mut angles: Vec<f64> = Vec::new();
    for _ in 0..count {
        let angle = words.number_of_line(&one)?;
        if let Some(last) = angles.last().filter(|last| **last >= angle) {
            return Err(words.wrong(format!("the {what} do not ascend: {last} is followed by {angle}")));
        }
        angles.push(angle);
    }
    Ok(angles)
}

/// The intensities, a line for each.
fn words_left(words: &mut Words, count: usize) -> Result<Vec<f64>, FormatError> {
    if count > words.left().div_ceil(2) {
        return Err(words.wrong(format!("the file ends before its {count} intensities: it is cut off")));
    }
    let what = format!("one of the {count} intensities");
    (0..count).map(|_| words.number_of_line(&what)).collect()
}

/// The planes whose intensities a file of this symmetry lists; numbers from `planes` on are those of the next turn.
fn listed(symmetry: usize, planes: usize, words: &Words) -> Result<std::ops::Range<usize>, FormatError> {
    let parts = [1, 1, 2, 4, 4][symmetry];
    if !planes.is_multiple_of(parts) {
        let message =
            format!("{planes} C planes (Mc) are no multiple of {parts}, as the symmetry {symmetry} needs");
        return Err(words.wrong_file(message));
    }
    Ok(match symmetry {
        0 => 0..planes,
        1 => 0..1,
        2 => 0..planes / 2 + 1,
        3 => planes / 4 * 3..planes / 4 * 5 + 1,
        _ => 0..planes / 4 + 1,
    })
}

/// All planes around the lamp.
fn all_planes(symmetry: usize, listed: Planes) -> Planes {
    match symmetry {
        0 if listed.0.len() > 1 => listed.closed(),
        2 => listed.mirrored(180.0),
        3 => listed.mirrored(450.0),
        4 => listed.mirrored(90.0).mirrored(180.0),
        _ => listed,
    }
}
