//! The size of a picture, as users write it: `640x480`.

use bilux_scene::{Parameters, SceneBuilder, Value};
use bilux_transport::film::MAX_SIDE;

/// The size of the pictures that the chosen camera was calibrated with.
pub(super) fn calibrated_size(scene: &SceneBuilder, settings: &Parameters) -> Option<[u32; 2]> {
    let wanted = match settings.find("camera") {
        Some((Value::Text(name), _)) => name.clone(),
        Some((Value::Integer(number), _)) => number.to_string(),
        _ => "0".to_owned(),
    };
    let by_name = scene.cameras.iter().find(|camera| camera.spec.name == wanted);
    by_name.or_else(|| scene.cameras.get(wanted.parse::<usize>().ok()?))?.calibrated_size()
}

/// Explains why [`parse_size`] rejects a text, and what to write instead.
pub fn size_error(text: &str) -> String {
    let sides = text.split(|c: char| !c.is_ascii_digit()).filter(|side| !side.is_empty());
    let sides: Vec<u64> = sides.map(|side| side.parse().unwrap_or(u64::MAX)).collect();
    let fit = sides.iter().all(|side| (1..=u64::from(MAX_SIDE)).contains(side));
    let advice = match sides[..] {
        [_, _] | [_] if !fit => format!("each side has 1 to {MAX_SIDE} pixels"),
        [width, height] => format!("write {width}x{height}"),
        [side] => format!("write {side}x{side} for a square"),
        _ => "write the width and the height in pixels, such as 640x480".to_owned(),
    };
    format!("'{text}' is not a size: {advice}")
}

/// Parses `640x480` as a width and a height that a film can have.
pub fn parse_size(text: &str) -> Option<(u32, u32)> {
    let (w, h) = text.split_once(['x', 'X', '×'])?;
    let side = |s: &str| s.trim().parse::<u32>().ok().filter(|n| (1..=MAX_SIDE).contains(n));
    Some((side(w)?, side(h)?))
}
