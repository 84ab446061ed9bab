//! AgX: a curve over the logarithm of light, in a space of less saturated primaries, so that bright colours
//! desaturate as on film and keep their hue.

use super::ToneMapEntry;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_math::transcendental::{log2, powf};

/// The row of `agx`.
pub(super) const ENTRY: ToneMapEntry = ToneMapEntry {
    entry: Entry {
        name: "agx",
        summary: "film-like: 16 stops of light; bright colours desaturate without a change of hue",
        source: "Sobotka 2022",
        parameters: &[],
    },
    map: agx,
};

/// From linear Rec. 709 to the inset primaries, row by row, before rows are normalised to a sum of 1. [Wrensch 2023]
const INSET: [[f64; 3]; 3] = [
    [0.842_479_062_253_094, 0.078_433_599_999_999_2, 0.079_223_745_147_764_3],
    [0.042_328_242_261_012_3, 0.878_468_636_469_772, 0.079_166_127_460_543_4],
    [0.042_375_654_905_705_1, 0.078_433_6, 0.879_142_973_793_104],
];
/// `INSET` with rows that sum to 1, so that grey stays grey.
const TO_INSET: [[f64; 3]; 3] = [even(INSET[0]), even(INSET[1]), even(INSET[2])];
const FROM_INSET: [[f64; 3]; 3] = inverse(TO_INSET);

/// Binary logarithms of the darkest and the brightest distinguishable light: 10 stops below middle grey, 6.5 above.
const DARKEST: f32 = -12.473_93;
const BRIGHTEST: f32 = 4.026_069;

/// The curve from the logarithm, 0..=1, to the displayed value, as a polynomial. [Wrensch 2023]
const CURVE: [f64; 7] = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];

fn agx(colour: Rgb) -> Rgb {
    let light = |c: f64| {
        let log = (log2((c as f32).max(1e-10)).clamp(DARKEST, BRIGHTEST) - DARKEST) / (BRIGHTEST - DARKEST);
        CURVE.iter().rev().fold(0.0, |sum, &k| sum * f64::from(log) + k)
    };
    let colour = colour.to_array().map(f64::from);
    let shown = times(&FROM_INSET, times(&TO_INSET, colour).map(light));
    // The curve's output is for a display of gamma 2.2.
    Rgb::from_array(shown.map(|c| powf((c as f32).clamp(0.0, 1.0), 2.2)))
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|row| matrix[row][0] * v[0] + matrix[row][1] * v[1] + matrix[row][2] * v[2])
}

const fn even(row: [f64; 3]) -> [f64; 3] {
    let sum = row[0] + row[1] + row[2];
    [row[0] / sum, row[1] / sum, row[2] / sum]
}

/// The inverse by cofactors.
const fn inverse(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut adjugate = [[0.0; 3]; 3];
    let mut row = 0;
    while row < 3 {
        let mut column = 0;
        while column < 3 {
            let (a, b) = ((row + 1) % 3, (row + 2) % 3);
            let (c, d) = ((column + 1) % 3, (column + 2) % 3);
            adjugate[column][row] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
            column += 1;
        }
        row += 1;
    }
    let determinant = m[0][0] * adjugate[0][0] + m[0][1] * adjugate[1][0] + m[0][2] * adjugate[2][0];
    let mut row = 0;
    while row < 3 {
        let mut column = 0;
        while column < 3 {
            adjugate[row][column] /= determinant;
            column += 1;
        }
        row += 1;
    }
    adjugate
}
