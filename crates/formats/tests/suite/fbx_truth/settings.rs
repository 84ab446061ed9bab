//! Settings of FBX files, found in their bytes.

use bilux_math::{DMat4, DVec3};

/// The first number of a property, by its bytes: in text, or in binary.
pub(super) fn property(bytes: &[u8], name: &str) -> Option<f64> {
    let binary = bytes.starts_with(b"Kaydara");
    let quoted = format!("\"{name}\"");
    let needle = if binary { name.as_bytes() } else { quoted.as_bytes() };
    let all =
        bytes.windows(needle.len()).enumerate().filter(|(_, window)| *window == needle).map(|(at, _)| at);
    // In a binary file the length of the name comes before it, which ends in a zero.
    let whole = all.filter(|&at| !binary || bytes[at.saturating_sub(1)] == 0);
    whole
        .filter_map(|at| {
            let rest = &bytes[at + needle.len()..];
            if binary {
                let mut rest = rest;
                while rest.first()? == &b'S' {
                    let length = u32::from_le_bytes(rest.get(1..5)?.try_into().ok()?) as usize;
                    rest = rest.get(5 + length..)?;
                }
                match rest.first()? {
                    b'I' => Some(f64::from(i32::from_le_bytes(rest.get(1..5)?.try_into().ok()?))),
                    b'L' => Some(i64::from_le_bytes(rest.get(1..9)?.try_into().ok()?) as f64),
                    b'D' => Some(f64::from_le_bytes(rest.get(1..9)?.try_into().ok()?)),
                    _ => None,
                }
            } else {
                let line = rest.split(|&byte| byte == b'\n').next()?;
                let line = String::from_utf8_lossy(line);
                line.rsplit(['"', ' ', ',']).map(str::trim).find(|word| !word.is_empty())?.parse().ok()
            }
        })
        .next_back()
}

/// When the file's animation begins, in seconds.
pub(super) fn start(bytes: &[u8]) -> f64 {
    const TICKS: f64 = 46_186_158_000.0;
    let old = || {
        let at = bytes.windows(10).position(|window| window == b"LocalTime:")?;
        let line =
            String::from_utf8_lossy(bytes[at + 10..].split(|&byte| byte == b',').next()?).trim().to_owned();
        line.parse::<f64>().ok()
    };
    let old_binary = || {
        let at = bytes.windows(10).position(|window| window == b"\tLocalTime")?;
        Some(i64::from_le_bytes(bytes.get(at + 11..at + 19)?.try_into().ok()?) as f64)
    };
    property(bytes, "LocalStart").or_else(old).or_else(old_binary).unwrap_or(0.0) / TICKS
}

/// From the world of a scene back to the axes and the unit of its file.
pub(super) fn to_file(bytes: &[u8]) -> DMat4 {
    let number = |name: &str, default: f64| property(bytes, name).unwrap_or(default);
    let axis = |name: &str, default: usize| {
        let index = number(name, default as f64) as usize;
        DVec3::AXES[index.min(2)] * number(&format!("{name}Sign"), 1.0)
    };
    let axes = bilux_math::DMat3::from_cols(axis("CoordAxis", 0), axis("UpAxis", 1), axis("FrontAxis", 2));
    DMat4::from_mat3(axes * (100.0 / number("UnitScaleFactor", 1.0)))
}
