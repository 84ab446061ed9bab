//! A point cloud in the shape of a nautilus.

use std::f64::consts::TAU;
use std::fmt::Write;

/// The number of points.
const POINTS: u32 = 240_000;

/// Growth of the shell's logarithm per radian: three times per turn.
const GROWTH: f64 = 0.175;

/// The number of turns.
const TURNS: f64 = 3.2;

/// A PLY file of coloured points, evenly spread over the shell.
pub(super) fn ply() -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {POINTS}\n");
    for axis in ["x", "y", "z"] {
        text += &format!("property float {axis}\n");
    }
    for channel in ["red", "green", "blue"] {
        text += &format!("property uchar {channel}\n");
    }
    text += "end_header\n";
    for number in 0..POINTS {
        let ([x, y, z], [red, green, blue]) = point(number);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{x:.4} {y:.4} {z:.4} {red} {green} {blue}");
    }
    text
}

/// The position and the colour of a point, by a sequence that leaves no gaps (multiples of the plastic ratio).
#[expect(
    clippy::disallowed_methods,
    reason = "a picture for people, which need not have the same bits everywhere"
)]
fn point(number: u32) -> ([f64; 3], [u8; 3]) {
    let number = f64::from(number) + 0.5;
    let (along, around) =
        ((number * 0.754_877_666_246_693).fract(), (number * 0.569_840_290_998_053).fract());
    // The area of a piece of the shell goes with the square of its radius.
    let last = (GROWTH * TURNS * TAU).exp();
    let radius = (1.0 + along * (last * last - 1.0)).sqrt();
    let angle = radius.ln() / GROWTH;
    let section = around * TAU;
    let ribs = 1.0 + 0.035 * (angle * 14.0).cos();
    let tube = 0.5 * radius * ribs;
    let distance = radius + tube * section.cos();
    let position = [distance * angle.cos(), distance * angle.sin(), 0.9 * tube * section.sin()];
    // Rusty flames on cream, as on a real one: none at the mouth.
    let flame = (angle * 5.0 + 1.5 * section.cos()).sin() > 0.25 && along < 0.72;
    (position, if flame { [158, 74, 38] } else { [236, 220, 190] })
}
