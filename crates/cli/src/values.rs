//! Values as they are written on the command line.

use std::path::PathBuf;
use std::time::Duration;

pub fn parse_rival(text: &str) -> Result<(String, PathBuf), String> {
    let (name, path) = text.split_once('=').ok_or("is written as embree=/path/of/libembree4.so.4")?;
    Ok((name.to_owned(), PathBuf::from(path)))
}

pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor = match text[digits.len()..].to_ascii_uppercase().as_str() {
        "" | "B" => 1,
        "K" | "KB" | "KIB" => 1 << 10,
        "M" | "MB" | "MIB" => 1 << 20,
        "G" | "GB" | "GIB" => 1u64 << 30,
        "T" | "TB" | "TIB" => 1 << 40,
        other => return Err(format!("'{other}' is no unit of memory: write 512M or 8G")),
    };
    let number: f64 = digits.parse().map_err(|_| format!("'{text}' is no size: write 512M or 8G"))?;
    if number > 0.0 { Ok((number * factor as f64) as u64) } else { Err("has to be more than 0".to_owned()) }
}

pub fn parse_frames(text: &str) -> Result<(u32, u32), String> {
    let (a, b) = text.split_once('-').unwrap_or((text, text));
    match (a.trim().parse(), b.trim().parse()) {
        (Ok(a), Ok(b)) if a <= b => Ok((a, b)),
        _ => Err("frames are written as 0-47, the first before the last".to_owned()),
    }
}

pub fn parse_samples(text: &str) -> Result<(u32, u32), String> {
    match text.split_once("..").map(|(a, b)| (a.trim().parse(), b.trim().parse())) {
        Some((Ok(a), Ok(b))) if a < b => Ok((a, b)),
        _ => Err("samples are written as 0..64, the end not included".to_owned()),
    }
}

fn numbers<T: std::str::FromStr, const N: usize>(text: &str, example: &str) -> Result<[T; N], String> {
    let parsed: Option<Vec<T>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    parsed.and_then(|n| n.try_into().ok()).ok_or_else(|| format!("is written as {example}"))
}

pub fn parse_crop(text: &str) -> Result<[u32; 4], String> {
    numbers(text, "X,Y,WIDTH,HEIGHT")
}

pub fn parse_replay(text: &str) -> Result<[u32; 3], String> {
    numbers(text, "X,Y,SAMPLE")
}

pub fn parse_vector(text: &str) -> Result<[f32; 3], String> {
    numbers(text, "X,Y,Z")
}

/// A time above 0.
pub fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|&s: &f64| s > 0.0);
    let time = seconds.and_then(|s| Duration::try_from_secs_f64(s).ok());
    time.ok_or_else(|| "a number of seconds above 0 is wanted, as in 10 or 0.5".to_owned())
}

/// A length, 0 or more.
pub fn parse_radius(text: &str) -> Result<f32, String> {
    let radius = text.parse().ok().filter(|r: &f32| r.is_finite() && *r >= 0.0);
    radius.ok_or_else(|| "a length in metres is wanted, as in 0.05".to_owned())
}

/// By how much a picture is brightened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// As much as it takes.
    Auto,
    /// Powers of two.
    Stops(f32),
}

/// `auto`, or powers of two.
pub fn parse_exposure(text: &str) -> Result<Exposure, String> {
    match (text, text.parse::<f32>()) {
        ("auto", _) => Ok(Exposure::Auto),
        (_, Ok(stops)) if stops.is_finite() => Ok(Exposure::Stops(stops)),
        _ => Err("it is a number of powers of two, such as -1 or 0.5, or auto".to_owned()),
    }
}
