//! Parsers for the values on the command line.

use bilux::formats::Scheme;
use bilux::transport::LengthBins;
use std::path::PathBuf;
use std::time::Duration;

pub fn parse_engine(text: &str) -> Result<(String, PathBuf), String> {
    let (name, path) =
        text.split_once('=').ok_or("write a name and a path, such as embree=/usr/lib/libembree4.so.4")?;
    Ok((name.to_owned(), PathBuf::from(path)))
}

pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = &text[digits.len()..];
    let factor = match unit.to_ascii_uppercase().as_str() {
        "" | "B" => 1,
        "K" | "KB" | "KIB" => 1 << 10,
        "M" | "MB" | "MIB" => 1 << 20,
        "G" | "GB" | "GIB" => 1u64 << 30,
        "T" | "TB" | "TIB" => 1 << 40,
        _ if digits.is_empty() => 1,
        _ => return Err(format!("'{unit}' is not a unit of memory: write 512M or 8G")),
    };
    let number: f64 =
        digits.parse().map_err(|_| format!("'{text}' is not an amount of memory: write 512M or 8G"))?;
    if number > 0.0 {
        Ok((number * factor as f64) as u64)
    } else {
        Err("write more than 0, such as 512M or 8G".to_owned())
    }
}

/// Parses a number of samples, which cannot be 0.
pub fn parse_spp(text: &str) -> Result<u32, String> {
    if text.parse::<u128>().is_ok_and(|samples| samples > 1 << 31) {
        return Err(format!("this is too many: write at most {}, such as 64", 1u32 << 31));
    }
    at_least_one(text, "write a whole number of at least 1, such as 64")
}

/// Parses a number of pictures around a model.
pub fn parse_turntable(text: &str) -> Result<u32, String> {
    at_least_one(text, "write a whole number of at least 1, such as 36")
}

/// Parses a number of tasks. OpenJD allows a parameter to have no more values.
pub fn parse_chunks(text: &str) -> Result<u32, String> {
    let chunks = text.parse().ok().filter(|chunks| (1..=1024).contains(chunks));
    chunks.ok_or_else(|| "write a whole number from 1 to 1024, such as 8".to_owned())
}

fn at_least_one(text: &str, advice: &str) -> Result<u32, String> {
    text.parse().ok().filter(|&n| n >= 1).ok_or_else(|| advice.to_owned())
}

/// Parses a whole number from 0.
pub fn parse_count(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| "write a whole number, 0 or more".to_owned())
}

/// Parses the number of pictures that a median is taken of.
pub fn parse_seeds(text: &str) -> Result<u32, String> {
    let seeds = text.parse().ok().filter(|seeds| (1..=1000).contains(seeds));
    seeds.ok_or_else(|| "write a whole number from 1 to 1000, such as 5".to_owned())
}

/// Parses a bound on a metric.
pub fn parse_bound(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "write a number, such as 0.02".to_owned())
}

/// Parses the upper end of a scale.
pub fn parse_positive(text: &str) -> Result<f32, String> {
    let most = text.parse().ok().filter(|&most: &f32| most > 0.0 && most.is_finite());
    most.ok_or_else(|| "write a number larger than 0, such as 100".to_owned())
}

/// Parses a maintenance factor.
pub fn parse_maintenance(text: &str) -> Result<f32, String> {
    let factor = text.parse().ok().filter(|&factor: &f32| factor > 0.0 && factor <= 1.0);
    factor.ok_or_else(|| "write a number above 0 and at most 1, such as 0.8".to_owned())
}

/// Parses a point in time in seconds, which may be negative.
pub fn parse_time(text: &str) -> Result<f32, String> {
    text.parse().map_err(|_| "write a time in seconds, such as 0.5".to_owned())
}

/// Parses the quality of a JPEG.
pub fn parse_quality(text: &str) -> Result<u8, String> {
    let quality = text.parse().ok().filter(|quality| (1..=100).contains(quality));
    quality.ok_or_else(|| "write a whole number from 1 to 100, such as 92".to_owned())
}

/// Parses a fraction of the light: `0.02` or `2%`.
pub fn parse_noise(text: &str) -> Result<f32, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number.trim_end(), 100.0),
        None => (text, 1.0),
    };
    let advice = || "write how much noise may be left, such as 2% or 0.02".to_owned();
    let noise = number.parse::<f32>().map_err(|_| advice())?;
    match noise / unit {
        part if part > 0.0 && part <= 1.0 => Ok(part),
        part if part > 1.0 && unit == 1.0 && part <= 100.0 => {
            Err(format!("this is {}% of the light: write {text}% or {}", part * 100.0, part / 100.0))
        }
        part if part > 1.0 => Err("this is more noise than light: write a smaller value, such as 2% or \
                                   0.02"
            .to_owned()),
        0.0 => Err("noise of 0 cannot be reached: write a value above 0, such as 1% or 0.01".to_owned()),
        _ => Err(advice()),
    }
}

/// Parses a time in seconds, above 0.
pub fn parse_seconds(text: &str) -> Result<f32, String> {
    seconds_of(text)
        .map(|seconds| seconds as f32)
        .filter(|seconds| *seconds > 0.0)
        .ok_or_else(advice_on_seconds)
}

/// Parses a time in seconds, above 0, in double precision.
pub fn parse_cpu_seconds(text: &str) -> Result<f64, String> {
    seconds_of(text).ok_or_else(advice_on_seconds)
}

fn seconds_of(text: &str) -> Option<f64> {
    let seconds = text.strip_suffix('s').unwrap_or(text).trim_end().parse::<f64>().ok();
    seconds.filter(|&seconds| seconds > 0.0 && (seconds as f32).is_finite())
}

fn advice_on_seconds() -> String {
    "write a number of seconds above 0, such as 5 or 0.5".to_owned()
}

pub fn parse_frames(text: &str) -> Result<(u32, u32), String> {
    let (a, b) = text.split_once('-').unwrap_or((text, text));
    match (a.trim().parse(), b.trim().parse()) {
        (Ok(a), Ok(b)) if a <= b => Ok((a, b)),
        _ => Err("write the first and the last frame, such as 0-47".to_owned()),
    }
}

pub fn parse_samples(text: &str) -> Result<(u32, u32), String> {
    match text.split_once("..").map(|(a, b)| (a.trim().parse(), b.trim().parse())) {
        Some((Ok(a), Ok(b))) if a < b => Ok((a, b)),
        _ => Err("write the first sample and the one after the last, such as 0..64".to_owned()),
    }
}

fn numbers<T: std::str::FromStr, const N: usize>(text: &str, example: &str) -> Result<[T; N], String> {
    let parsed: Option<Vec<T>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    parsed.and_then(|n| n.try_into().ok()).ok_or_else(|| format!("write {example}"))
}

pub fn parse_crop(text: &str) -> Result<[u32; 4], String> {
    numbers(text, "the left and upper edge, the width and the height in pixels, such as 0,0,64,64")
}

/// Parses intervals of the length of paths, in metres.
pub fn parse_lengths(text: &str) -> Result<LengthBins, String> {
    let advice = "the beginning, the width and the number of the intervals, such as 1,0.05,40";
    let [begin, width, count]: [f64; 3] = numbers(text, advice)?;
    let is_whole = count.fract() == 0.0 && (1.0..=65_536.0).contains(&count);
    if width > 0.0 && width.is_finite() && begin.is_finite() && is_whole {
        return Ok(LengthBins { begin, width, count: count as u32 });
    }
    Err(format!("write {advice}: the width is above 0, and the number from 1 to 65536"))
}

pub fn parse_replay(text: &str) -> Result<[u32; 3], String> {
    numbers(text, "the column, the row and the sample, such as 10,20,0")
}

pub fn parse_vector(text: &str) -> Result<[f32; 3], String> {
    numbers(text, "three numbers, such as 4,0,0")
}

/// Parses a time in seconds as a duration.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    let seconds = seconds_of(text).ok_or_else(advice_on_seconds)?;
    Duration::try_from_secs_f64(seconds)
        .map_err(|_| "this time is too long: write a smaller number of seconds".to_owned())
}

/// Parses the value of a variable.
pub fn parse_definition(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').filter(|(name, _)| !name.is_empty());
    let parts = parts.map(|(name, value)| (name.to_owned(), value.to_owned()));
    parts.ok_or_else(|| "write a name and a value, such as spp=64".to_owned())
}

/// Parses a length, 0 or more.
pub fn parse_radius(text: &str) -> Result<f32, String> {
    let radius = text.parse().ok().filter(|r: &f32| r.is_finite() && *r >= 0.0);
    radius.ok_or_else(|| "write a length in metres, such as 0.05".to_owned())
}

/// Parses the name of a scheme of subdivision.
pub fn parse_scheme(text: &str) -> Result<Scheme, String> {
    let names = Scheme::ALL.map(|(name, _)| name);
    Scheme::named(text).ok_or_else(|| format!("write one of {}", names.join(", ")))
}

/// By how much a picture is brightened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// As much as automatic exposure decides.
    Auto,
    /// By this many powers of two.
    Stops(f32),
}

/// Parses `auto`, or a number of stops (powers of two).
pub fn parse_exposure(text: &str) -> Result<Exposure, String> {
    match (text, text.parse::<f32>()) {
        ("auto", _) => Ok(Exposure::Auto),
        (_, Ok(stops)) if stops.is_finite() => Ok(Exposure::Stops(stops)),
        _ => Err("write a number of powers of two, such as -1 or 0.5, or auto".to_owned()),
    }
}
