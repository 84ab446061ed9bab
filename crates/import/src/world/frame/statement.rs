//! Comments on unit and axis in files that have no words for them, so that they are read as they were written.

use super::metres;
use bilux_scene::{Axis, SceneBuilder, UpHint};

/// Number of bytes at the beginning of a file in which the comment is looked for.
const HEAD: usize = 2048;

const BEFORE: &str = "Bilux: lengths are in units of ";
const BETWEEN: &str = " m, and up is ";

/// The comment for a scene, without the mark that begins comments; `None` where readers take the same unasked.
pub fn statement(scene: &SceneBuilder) -> Option<String> {
    let (UpHint::Is(axis) | UpHint::Usually(axis)) = scene.up;
    let is_usual = axis == Axis::Y && metres(scene) == 1.0;
    (!is_usual).then(|| format!("{BEFORE}{}{BETWEEN}{}", metres(scene), axis.name()))
}

/// The up axis and the metres per unit that a file's beginning states in such a comment.
pub fn stated(bytes: &[u8]) -> Option<(Axis, f64)> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    let (_, said) = head.split_once(BEFORE)?;
    let (unit, said) = said.lines().next()?.split_once(BETWEEN)?;
    let unit: f64 = unit.parse().ok().filter(|unit| *unit > 0.0 && f64::is_finite(*unit))?;
    Some((Axis::from_name(said)?, unit))
}
