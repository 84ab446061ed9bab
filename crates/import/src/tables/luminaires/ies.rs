//! IES LM-63, in the editions of 1986, 1991, 1995, 2002 and 2019. [IES LM-63]

use super::symmetry::{Planes, both_sides};
use super::words::{Words, text_of};
use super::{LuminaireFormatEntry, Measured};
use crate::FormatError;
use crate::input::reading::Source;
use bilux_scene::{Goniometer, IntensityDistribution, MAX_ANGLES};

pub(super) const FORMAT: LuminaireFormatEntry = LuminaireFormatEntry { sniff, read };

/// The line that ends the labels; it is in every edition.
const TILT: &[u8] = b"TILT";

fn sniff(bytes: &[u8]) -> bool {
    let begins = bytes.trim_ascii_start();
    begins.starts_with(b"IES")
        || bytes.split(|byte| matches!(byte, b'\n' | b'\r')).any(|line| tilt(line).is_some())
}

/// Value that follows `TILT=`.
fn tilt(line: &[u8]) -> Option<&[u8]> {
    let (word, rest) = line.trim_ascii().split_at_checked(TILT.len())?;
    let value = rest.trim_ascii_start().strip_prefix(b"=")?;
    word.eq_ignore_ascii_case(TILT).then(|| value.trim_ascii())
}

fn read(source: &Source) -> Result<Measured, FormatError> {
    let mut words = Words::new(source);
    let Labels { name, is_of_2019, tilt } = labels(&mut words)?;
    let mut warnings = Vec::new();
    match &*tilt.to_ascii_uppercase() {
        b"NONE" => {}
        b"INCLUDE" => {
            if skip_tilt(&mut words)? {
                let message = "its factors for a lamp that is tilted are left out";
                warnings.push(message.to_owned());
            }
        }
        _ => {
            return Err(words.wrong(format!(
                "the factors for a tilted lamp are in the file '{}', which is not read: write TILT=NONE to use the lamp as it \
                 was measured",
                text_of(&tilt)
            )));
        }
    }
    let name = if name.is_empty() { source.stem() } else { name };
    let (distribution, stated) = numbers(&mut words, &name, is_of_2019)?;
    warnings.extend(disagreement(stated, distribution.lumens()));
    Ok(Measured { distribution, warnings })
}

/// Labels that come before the numbers.
struct Labels {
    name: String,
    is_of_2019: bool,
    tilt: Vec<u8>,
}

fn labels(words: &mut Words) -> Result<Labels, FormatError> {
    let (mut name, mut is_of_2019, mut is_first) = (String::new(), false, true);
    while let Some(line) = words.line() {
        if let Some(tilt) = tilt(line) {
            return Ok(Labels { name, is_of_2019, tilt: tilt.to_vec() });
        }
        if is_first {
            is_of_2019 = line.starts_with(b"IES:LM-63-2019");
        }
        is_first = false;
        for label in [&b"[LUMINAIRE]"[..], b"[LUMCAT]"] {
            if name.is_empty() && line.len() > label.len() && line[..label.len()].eq_ignore_ascii_case(label)
            {
                name = text_of(&line[label.len()..]);
            }
        }
    }
    Err(words.wrong("there is no line TILT=NONE or TILT=INCLUDE, after which the numbers begin"))
}

/// Skips the factors of `TILT=INCLUDE`; true if any of them is not 1.
fn skip_tilt(words: &mut Words) -> Result<bool, FormatError> {
    words.number("the lamp's orientation in the luminaire")?;
    let count = words.count("the number of tilt angles", [1, MAX_ANGLES])?;
    words.numbers(count, "tilt angles")?;
    Ok(words.numbers(count, "tilt factors")?.iter().any(|factor| *factor != 1.0))
}

/// Least and greatest fraction of the light of its lamps that a luminaire lets out: most of it, and no more than there is, but for
/// rounding.
const LET_OUT: [f64; 2] = [0.55, 1.05];

/// Message where the light of the lamps, in lumens, cannot be that of the intensities; nothing where it is not stated.
fn disagreement(stated: f64, found: f64) -> Option<String> {
    let [least, most] = LET_OUT;
    let share = found / stated;
    (stated > 0.0 && !(least..=most).contains(&share)).then(|| {
        format!(
            "it states lamps of {stated:.0} lm, but its intensities add up to {found:.0} lm ({:.0}%), which is what the lamp gives: \
             scale it if the lumens are right",
            share * 100.0
        )
    })
}

/// The distribution, and the light of the lamps in lumens with all factors; not positive if the file does not state it.
fn numbers(
    words: &mut Words,
    name: &str,
    is_of_2019: bool,
) -> Result<(IntensityDistribution, f64), FormatError> {
    let lamps = words.number("the number of lamps")?;
    let lumens = words.number("the lumens of each lamp")?;
    let mut factor = not_negative(words, "the multiplier of the intensities")?;
    let rows = words.count("the number of vertical angles", [1, MAX_ANGLES])?;
    let planes = words.count("the number of horizontal angles", [1, MAX_ANGLES])?;
    let goniometer = match words.count("the photometric type", [1, 3])? {
        1 => Goniometer::C,
        2 => Goniometer::B,
        _ => Goniometer::A,
    };
    for what in ["the unit of lengths", "the width", "the length", "the height"] {
        words.number(what)?;
    }
    let ballast = not_negative(words, "the ballast factor")?;
    factor *= ballast;
    // The edition of 2019 has the kind of the file here.
    let last = not_negative(words, "the ballast-lamp photometric factor")?;
    factor *= if is_of_2019 { 1.0 } else { last };
    let stated =
        if lumens > 0.0 { lamps * lumens * ballast * if is_of_2019 { 1.0 } else { last } } else { 0.0 };
    words.number("the watts")?;
    let vertical = angles(words, rows, "vertical angles")?;
    let horizontal = angles(words, planes, "horizontal angles")?;
    let candela = words.numbers(rows * planes, "intensities")?;
    if let Some(wrong) = candela.iter().find(|value| **value < 0.0) {
        return Err(words.wrong_file(format!("an intensity is {wrong} cd: it must not be negative")));
    }
    let candela: Vec<f32> = candela.iter().map(|value| (value * factor) as f32).collect();
    let (planes, polar) = match goniometer {
        Goniometer::C => (around(Planes::new(&horizontal, &candela), words)?, vertical),
        Goniometer::A => {
            let planes = Planes::new(&horizontal, &candela);
            let planes = if horizontal[0] == 0.0 { planes.mirrored(0.0) } else { planes };
            (planes, from_the_pole(&vertical))
        }
        Goniometer::B => {
            // Its planes turn by the vertical angle.
            let candela: Vec<f32> = transposed(&candela, rows);
            let planes = Planes::new(&vertical, &candela);
            let (planes, horizontal) = if horizontal[0] == 0.0 {
                (planes.with_both_sides(), both_sides(&horizontal, |angle| -angle))
            } else {
                (planes, horizontal)
            };
            (planes, from_the_pole(&horizontal))
        }
    };
    Ok((planes.distribution(name, goniometer, polar, words)?, stated))
}

/// Polar angles from angles above an equator.
fn from_the_pole(angles: &[f64]) -> Vec<f64> {
    angles.iter().map(|angle| angle + 90.0).collect()
}

/// The numbers of a table with this many in each row, column by column.
fn transposed(table: &[f32], columns: usize) -> Vec<f32> {
    (0..columns).flat_map(|column| table[column..].iter().step_by(columns).copied()).collect()
}

fn not_negative(words: &mut Words, what: &str) -> Result<f64, FormatError> {
    let number = words.number(what)?;
    if number >= 0.0 {
        Ok(number)
    } else {
        Err(words.wrong(format!("{what} is {number}: it must not be negative")))
    }
}

/// Angles that ascend.
fn angles(words: &mut Words, count: usize, what: &str) -> Result<Vec<f64>, FormatError> {
    let mut angles = words.numbers(count, what)?;
    // Some files have the last plane of a full turn as 0.
    if let [.., before, last] = angles[..]
        && last == 0.0
        && before > 180.0
    {
        angles[count - 1] = 360.0;
    }
    match angles.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => {
            let message = format!("the {what} do not ascend: {} is followed by {}", pair[0], pair[1]);
            Err(words.wrong(message))
        }
        None => Ok(angles),
    }
}

/// All planes of type C, from those that the lamp's symmetry leaves.
fn around(planes: Planes, words: &Words) -> Result<Planes, FormatError> {
    let azimuths: Vec<f64> = planes.0.iter().map(|(azimuth, _)| *azimuth).collect();
    let (first, last) = (azimuths[0], azimuths[azimuths.len() - 1]);
    let widest = azimuths.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    let is = |a: f64, b: f64| first == a && last == b;
    Ok(match azimuths.len() {
        1 => planes,
        _ if is(0.0, 90.0) => planes.mirrored(90.0).mirrored(180.0),
        _ if is(0.0, 180.0) => planes.mirrored(180.0),
        _ if is(90.0, 270.0) => planes.mirrored(270.0),
        _ if last - first == 360.0 => planes,
        // The turn is nearly complete: the plane that closes it is not repeated.
        _ if last - first < 360.0 && first + 360.0 - last <= 1.5 * widest => planes.closed(),
        _ => {
            return Err(words.wrong_file(format!(
                "the horizontal angles go from {first} to {last} degrees: they are 0 alone, or go from 0 to 90, 180 or 360, or from \
                 90 to 270"
            )));
        }
    })
}

/// A distribution as a file of the edition of 2002.
pub(super) fn write(distribution: &IntensityDistribution) -> Vec<u8> {
    let (mut azimuths, polar) = (distribution.azimuths().to_vec(), distribution.polar_angles().to_vec());
    let mut candela = distribution.candela().to_vec();
    let same = candela.chunks_exact(polar.len()).all(|plane| *plane == candela[..polar.len()]);
    let is_round = same && azimuths[azimuths.len() - 1] - azimuths[0] == 360.0;
    if is_round {
        candela.truncate(polar.len());
        azimuths = vec![0.0];
    }
    let from_equator = || polar.iter().map(|angle| angle - 90.0).collect::<Vec<_>>();
    let (kind, vertical, horizontal) = match distribution.goniometer() {
        Goniometer::C => (1, polar, azimuths),
        Goniometer::A => (3, from_equator(), azimuths),
        Goniometer::B => {
            let rows = polar.len();
            candela = transposed(&candela, rows);
            (2, azimuths, from_equator())
        }
    };
    let list =
        |numbers: Vec<String>| numbers.chunks(10).map(|line| line.join(" ")).collect::<Vec<_>>().join("\r\n");
    let text = |numbers: &[f64]| list(numbers.iter().map(f64::to_string).collect());
    let lines = [
        "IESNA:LM-63-2002".to_owned(),
        format!("[LUMINAIRE] {}", distribution.name()),
        "TILT=NONE".to_owned(),
        format!("1 -1 1 {} {} {kind} 2 0 0 0", vertical.len(), horizontal.len()),
        "1 1 0".to_owned(),
        text(&vertical),
        text(&horizontal),
        list(candela.iter().map(f32::to_string).collect()),
    ];
    (lines.join("\r\n") + "\r\n").into_bytes()
}
