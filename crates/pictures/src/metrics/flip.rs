//! LDR-FLIP: the difference that a viewer sees when flipping between two pictures. [Andersson 2020]
//!
//! The viewing distance is 0.7 m from a display of 3840 pixels over 0.7 m, as in the paper: about 67 pixels per
//! degree.

use super::convolution::{Plane, kernel, normalised};
use super::{MetricEntry, Pair};
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_math::parallel::{fill, join};
use bilux_math::registry::Entry;
use bilux_math::transcendental::{exp_f64, powf_f64};
use std::f64::consts::PI;

/// The row of `flip`.
pub(super) const ENTRY: MetricEntry = MetricEntry {
    entry: Entry {
        name: "flip",
        summary: "mean LDR-FLIP: the difference that viewers see when flipping between the pictures; 0 if equal, at \
                  most 1",
        source: "Andersson 2020",
        parameters: &[],
    },
    higher_is_better: false,
    evaluate: |pair: &Pair| {
        let map = map(pair);
        map.iter().map(|error| f64::from(*error)).sum::<f64>() / map.len() as f64
    },
};

/// Pixels per degree of the visual field.
const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * (PI / 180.0);

/// Sums of Gaussians for the contrast sensitivity to luminance, red-green and blue-yellow: pairs of weight a and
/// width b. [Andersson 2020, table 1]
const SENSITIVITIES: [&[[f64; 2]]; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];
/// The widest of them, which determines the radius of the filters.
const WIDEST: f64 = 0.04;

/// Exponents of the colour and of the feature difference. [Andersson 2020, section 4.3]
const COLOUR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;
/// The fraction of the maximum colour difference that is mapped to the fraction `REACHED` of the error.
const KNEE: f64 = 0.4;
const REACHED: f64 = 0.95;
/// The width of the feature detector, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// The error of every pixel, 0..=1, in rows.
pub(super) fn map(pair: &Pair) -> Vec<f32> {
    let seen = |side: &[Rgb]| {
        let side = opponent(side, pair.width);
        join(|| filtered_lab(&side), || Features::new(&side[0]))
    };
    let [a, b] = &pair.shown;
    let ((lab_a, features_a), (lab_b, features_b)) = join(|| seen(a), || seen(b));
    let (lab, features) = ([lab_a, lab_b], [features_a, features_b]);
    let most = powf_f64(hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])), COLOUR_EXPONENT);
    let error = |i: usize| {
        let colour = redistributed(powf_f64(hyab(lab[0][i], lab[1][i]), COLOUR_EXPONENT), most);
        let feature = features[0].difference(&features[1], i);
        powf_f64(colour, 1.0 - feature) as f32
    };
    let mut errors = vec![0.0; pair.width * pair.height];
    fill(&mut errors, 1 << 10, error);
    errors
}

/// Rec. 709 primaries and D65, (0.31271, 0.32902), as rows for X, Y and Z.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_386_563_253, 0.357_591_490_921, 0.180_450_491_204],
    [0.212_636_821_677, 0.715_182_981_841, 0.072_180_196_481],
    [0.019_330_620_152, 0.119_197_163_640, 0.950_372_587_005],
];

/// The inverse of [`XYZ_FROM_RGB`].
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_232_976, -1.537_398_969_489, -0.498_615_881_996],
    [-0.969_224_252_203, 1.875_929_983_695, 0.041_554_226_340],
    [0.055_639_419_852, -0.204_011_206_124, 1.057_148_977_188],
];

fn transformed(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// XYZ relative to white.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let [xyz, white] = [rgb, [1.0; 3]].map(|c| transformed(&XYZ_FROM_RGB, c));
    [xyz[0] / white[0], xyz[1] / white[1], xyz[2] / white[2]]
}

/// Achromatic, red-green and blue-yellow channels: CIELAB without its cube roots. [Andersson 2020, eq. 1]
fn opponent(side: &[Rgb], width: usize) -> [Plane; 3] {
    let mut planes = [(); 3].map(|()| Plane { width, samples: Vec::with_capacity(side.len()) });
    for colour in side {
        let [x, y, z] = relative_xyz(colour.map(srgb_decode).to_array().map(f64::from));
        let values = [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)];
        planes.iter_mut().zip(values).for_each(|(plane, value)| plane.samples.push(value));
    }
    planes
}

/// The colours as the eye resolves them at that distance, in CIELAB with the Hunt effect.
fn filtered_lab(side: &[Plane; 3]) -> Vec<[f64; 3]> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let planes: Vec<Plane> =
        side.iter().zip(SENSITIVITIES).map(|(plane, gaussians)| blurred(plane, gaussians, radius)).collect();
    let white = transformed(&XYZ_FROM_RGB, [1.0; 3]);
    let lab = |i: usize| {
        let [l, red_green, blue_yellow] = [0, 1, 2].map(|p: usize| planes[p].samples[i]);
        let y = (l + 16.0) / 116.0;
        let (x, z) = (y + red_green / 500.0, y - blue_yellow / 200.0);
        let rgb = transformed(&RGB_FROM_XYZ, [x * white[0], y * white[1], z * white[2]]);
        hunt_lab(rgb.map(|c| c.clamp(0.0, 1.0)))
    };
    (0..side[0].samples.len()).map(lab).collect()
}

/// A weighted sum of Gaussians, whose weights sum to 1. [Andersson 2020, eq. 4]
fn blurred(plane: &Plane, gaussians: &[[f64; 2]], radius: usize) -> Plane {
    let kernels = gaussians.iter().map(|&[a, b]| {
        let degrees = |x: f64| x / PIXELS_PER_DEGREE;
        let gaussian = kernel(radius, |x| exp_f64(-PI * PI * degrees(x) * degrees(x) / b));
        let sum: f64 = gaussian.iter().sum();
        (a * (PI / b).sqrt() * sum * sum, normalised(gaussian))
    });
    let kernels: Vec<(f64, Vec<f64>)> = kernels.collect();
    let total: f64 = kernels.iter().map(|(weight, _)| weight).sum();
    let mut samples = vec![0.0; plane.samples.len()];
    for (weight, gaussian) in kernels {
        let part = plane.convolved(&gaussian, &gaussian).samples;
        samples.iter_mut().zip(part).for_each(|(sum, part)| *sum += weight / total * part);
    }
    Plane { width: plane.width, samples }
}

/// CIELAB of linear Rec. 709, with chroma reduced at low luminance. [Andersson 2020, eq. 5]
fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| {
        if t > DELTA * DELTA * DELTA {
            powf_f64(t, 1.0 / 3.0)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(rgb).map(root);
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// The HyAB distance for large differences: lightness and chroma separately. [Andersson 2020, eq. 6]
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, red_green, blue_yellow] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (red_green * red_green + blue_yellow * blue_yellow).sqrt()
}

/// Maps a colour difference to 0..=1 and compresses the rare large ones. [Andersson 2020, section 4.1.3]
fn redistributed(difference: f64, most: f64) -> f64 {
    let knee = KNEE * most;
    if difference < knee {
        REACHED / knee * difference
    } else {
        (REACHED + (difference - knee) / (most - knee) * (1.0 - REACHED)).min(1.0)
    }
}

/// Likeness of each pixel to an edge, and to a point. [Andersson 2020, section 4.2]
struct Features {
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Features {
    fn new(light: &Plane) -> Features {
        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * deviation).ceil() as usize;
        let variance = deviation * deviation;
        let gaussian = |x: f64| exp_f64(-x * x / (2.0 * variance));
        let smooth = normalised(kernel(radius, gaussian));
        let edge = balanced(kernel(radius, |x| -x * gaussian(x)));
        let point = balanced(kernel(radius, |x| (x * x / variance - 1.0) * gaussian(x)));
        let y = light.samples.iter().map(|light| (light + 16.0) / 116.0).collect();
        let light = Plane { width: light.width, samples: y };
        let strength = |detector: &[f64]| {
            let across = light.convolved(detector, &smooth).samples;
            let down = light.convolved(&smooth, detector).samples;
            across.iter().zip(down).map(|(a, d)| (a * a + d * d).sqrt()).collect()
        };
        Features { edges: strength(&edge), points: strength(&point) }
    }

    fn difference(&self, other: &Features, i: usize) -> f64 {
        let edges = (self.edges[i] - other.edges[i]).abs();
        let points = (self.points[i] - other.points[i]).abs();
        powf_f64(edges.max(points) / std::f64::consts::SQRT_2, FEATURE_EXPONENT)
    }
}

/// Scales positive weights to a sum of 1, and negative ones to −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|w| **w < 0.0).sum::<f64>();
    kernel.into_iter().map(|w| if w > 0.0 { w / positive } else { w / negative }).collect()
}
