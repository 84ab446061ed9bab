//! Books on shelves, by colour.

use super::furniture::{BOARDS, SHELF};
use crate::modelling::parts::{between, chance, joined, placed, rounded, sharp};
use bilux_math::Vec3;
use bilux_scene::Mesh;

/// The number of colours; the pages come after them.
pub(super) const COLOURS: usize = 6;

/// All books of the shelf with this `number`: a mesh for every colour, then one of all pages.
pub(super) fn books(number: u32, n: u32) -> Vec<Mesh> {
    let mut parts: Vec<Vec<Mesh>> = vec![Vec::new(); COLOURS + 1];
    for (row, &board) in BOARDS[..5].iter().enumerate() {
        let (mut x, end) = (0.02 - 0.5 * SHELF[0], 0.5 * SHELF[0] - 0.02);
        let mut k = (number * 5 + row as u32) * 1000;
        // Each row ends at a random point.
        let end = end - 0.5 * chance(90, k) * chance(91, k);
        loop {
            k += 1;
            let thick = 0.014 + 0.038 * chance(92, k) * chance(93, k);
            let lean = if chance(94, k) > 0.93 { 8.0 } else { 0.0 };
            let high = (0.19 + 0.11 * chance(95, k)).min(BOARDS[row + 1] - board - 0.045);
            let deep = 0.13 + 0.06 * chance(96, k);
            let room = thick + if lean > 0.0 { high * 0.15 } else { 0.0 };
            if x + room > end {
                break;
            }
            let inset = 0.275 - 0.05 * chance(97, k);
            let [cover, pages] = book([thick, high, deep], n);
            let turn = (Vec3::Z, lean);
            // A book that leans to the left stands on its lower left edge, so move it to the right.
            let at = [x + if lean > 0.0 { high * 0.142 } else { 0.0 }, board + 0.0005, inset];
            parts[(chance(98, k) * COLOURS as f32) as usize].push(placed(&cover, turn, at));
            parts[COLOURS].push(placed(&pages, turn, at));
            x += room + 0.0012;
        }
    }
    parts.into_iter().map(joined).collect()
}

/// Cover and pages; the origin is the lower left edge of the spine, and the front is +z.
fn book([thick, high, deep]: [f32; 3], n: u32) -> [Mesh; 2] {
    const BOARD: f32 = 0.002;
    let side = |x: f32| sharp(between([x, 0.0, -deep], [x + BOARD, high, -0.001]));
    let spine = rounded(between([0.0, 0.0, -0.006], [thick, high, 0.004]), 0.0045, n);
    let pages = between([BOARD, 0.004, 0.005 - deep], [thick - BOARD, high - 0.004, -0.005]);
    [joined([side(0.0), side(thick - BOARD), spine]), sharp(pages)]
}
