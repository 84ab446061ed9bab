//! Converts linear colours of other primaries (an EXR's `chromaticities`, `PRIMARIES` of Radiance) to Rec. 709.

use crate::Picture;
use crate::picture::qualified;

/// Chromaticities x, y of red, green, blue and white.
pub(super) type Primaries = [[f64; 2]; 4];

/// Rec. 709 with D65: the default for a file without chromaticities.
pub(super) const REC709: Primaries = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// Smaller differences are roundings of the same primaries.
const SAME: f64 = 1e-3;

pub(super) type Matrix = [[f64; 3]; 3];

/// Converts the colours of the main picture and of all layers. Collinear primaries, which span no gamut, leave the
/// picture as it is.
pub(super) fn to_rec709(picture: &mut Picture, from: Primaries) {
    let Some(matrix) = matrix_to_rec709(from).filter(|_| !are_same(from, REC709)) else { return };
    let layers: Vec<String> =
        picture.layers().into_iter().map(str::to_owned).chain([String::new()]).collect();
    for layer in layers {
        let names = ["R", "G", "B"].map(|component| qualified(&layer, component));
        let Some([r, g, b]) = planes(picture, &names) else { continue };
        for (name, row) in names.iter().zip(matrix) {
            let samples = picture.channel_mut(name).unwrap_or_default();
            for (i, sample) in samples.iter_mut().enumerate() {
                let [r, g, b] = [r[i], g[i], b[i]].map(f64::from);
                *sample = (row[0] * r + row[1] * g + row[2] * b) as f32;
            }
        }
    }
}

/// Reads x and y of red, green, blue and white.
pub(super) fn of_text(text: &str) -> Option<Primaries> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let numbers: [f64; 8] = numbers?.try_into().ok()?;
    Some([0, 2, 4, 6].map(|i| [numbers[i], numbers[i + 1]]))
}

/// True if two sets of primaries are the same but for their rounding.
pub(super) fn are_same(a: Primaries, b: Primaries) -> bool {
    a.as_flattened().iter().zip(b.as_flattened()).all(|(a, b)| (a - b).abs() <= SAME)
}

/// The weights of red, green and blue in the luminance; those of Rec. 709 if the primaries are collinear.
pub(super) fn luminance(primaries: Primaries) -> [f32; 3] {
    let weights = |primaries| xyz_from_rgb(primaries).map(|[_, y, _]| y.map(|weight| weight as f32));
    let are_weights = |weights: &[f32; 3]| weights.iter().all(|weight| weight.is_normal());
    weights(primaries).filter(are_weights).or_else(|| weights(REC709)).unwrap_or([0.0, 1.0, 0.0])
}

fn planes(picture: &Picture, names: &[String; 3]) -> Option<[Vec<f32>; 3]> {
    let [r, g, b] = names.each_ref().map(|name| picture.channel(name).map(<[f32]>::to_vec));
    Some([r?, g?, b?])
}

/// The matrix from linear colours of these primaries to linear Rec. 709, with white mapped to white. [Lindbloom RGB]
pub(super) fn matrix_to_rec709(from: Primaries) -> Option<Matrix> {
    let to_xyz = xyz_from_rgb(from)?;
    let adapted = multiply(&adaptation(xyz(from[3]), xyz(REC709[3]))?, &to_xyz);
    let matrix = multiply(&inverse(&xyz_from_rgb(REC709)?)?, &adapted);
    matrix.as_flattened().iter().all(|m| m.is_finite()).then_some(matrix)
}

fn xyz([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// The columns are the primaries, scaled so that their sum is white.
fn xyz_from_rgb(primaries: Primaries) -> Option<Matrix> {
    let [r, g, b, white] = primaries.map(xyz);
    let columns = [0, 1, 2].map(|row: usize| [r[row], g[row], b[row]]);
    let scales = apply(&inverse(&columns)?, white);
    Some(columns.map(|row| [row[0] * scales[0], row[1] * scales[1], row[2] * scales[2]]))
}

/// Sharpened cone responses: Bradford's matrix. [Lindbloom RGB]
const BRADFORD: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/// True for a unit matrix, to within a number in each entry.
pub(super) fn is_identity(matrix: &Matrix, off: f64) -> bool {
    let one = |row: usize, column: usize| if row == column { 1.0 } else { 0.0 };
    (0..9).all(|i| (matrix[i / 3][i % 3] - one(i / 3, i % 3)).abs() <= off)
}

/// From linear colours of these primaries to XYZ whose white is this one.
pub(super) fn adapted_to(primaries: Primaries, white: [f64; 3]) -> Option<Matrix> {
    Some(multiply(&adaptation(xyz(primaries[3]), white)?, &xyz_from_rgb(primaries)?))
}

/// Chromatic adaptation of XYZ from one white to another.
fn adaptation(from: [f64; 3], to: [f64; 3]) -> Option<Matrix> {
    let [from, to] = [from, to].map(|white| apply(&BRADFORD, white));
    let scaled = [0, 1, 2].map(|row: usize| BRADFORD[row].map(|m| m * to[row] / from[row]));
    Some(multiply(&inverse(&BRADFORD)?, &scaled))
}

fn apply(matrix: &Matrix, v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

pub(super) fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|column: usize| (0..3).map(|k| row[k] * b[k][column]).sum()))
}

/// The inverse by cofactors; `None` if the matrix is singular.
pub(super) fn inverse(m: &Matrix) -> Option<Matrix> {
    let cofactor = |row: usize, column: usize| {
        let at = |i: usize, j: usize| m[(row + i) % 3][(column + j) % 3];
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let determinant: f64 = (0..3).map(|column| m[0][column] * cofactor(0, column)).sum();
    let regular = determinant.is_normal();
    regular.then(|| [0, 1, 2].map(|row| [0, 1, 2].map(|column| cofactor(column, row) / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;

    const ACES_CG: Primaries = [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044], [0.32168, 0.33767]];

    /// The matrix that the ACES documents give for ACEScg to Rec. 709 with Bradford's adaptation.
    #[test]
    fn acescg_has_its_published_matrix() {
        let published =
            [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
        let matrix = matrix_to_rec709(ACES_CG).unwrap();
        for (ours, theirs) in matrix.as_flattened().iter().zip(published.as_flattened()) {
            assert!((ours - theirs).abs() < 2e-5, "{matrix:?}");
        }
    }

    /// Rec. 709's own weights (ITU-R BT.709, 3.2), and the middle row of the ACES documents' matrix for ACEScg.
    #[test]
    fn luminance_has_the_published_weights() {
        for (primaries, published) in [
            (REC709, [0.2126, 0.7152, 0.0722]),
            (ACES_CG, [0.27223, 0.67408, 0.05369]),
            ([[0.0; 2]; 4], [0.2126, 0.7152, 0.0722]),
        ] {
            for (ours, theirs) in luminance(primaries).iter().zip(published) {
                assert!((ours - theirs).abs() < 5e-5, "{:?}", luminance(primaries));
            }
        }
    }

    #[test]
    fn white_stays_white_in_every_layer() {
        let mut picture = Picture::from_rgb(1, 1, vec![Rgb::WHITE]).unwrap();
        picture.push_rgb("albedo", &[Rgb::new(0.5, 0.25, 0.125)]).unwrap();
        to_rec709(&mut picture, ACES_CG);
        assert!((0..3).all(|c| (picture.rgb(0, 0)[c] - 1.0).abs() < 1e-6));
        assert!((picture.channel("albedo.R").unwrap()[0] - 0.68667).abs() < 1e-4);
    }

    #[test]
    fn nonsense_changes_nothing() {
        let picture = Picture::from_rgb(1, 1, vec![Rgb::new(0.1, 0.2, 0.3)]).unwrap();
        for primaries in [[[0.0; 2]; 4], [[0.3, 0.3]; 4], [[f64::NAN; 2]; 4], REC709] {
            let mut changed = picture.clone();
            to_rec709(&mut changed, primaries);
            assert_eq!(changed, picture);
        }
    }
}
