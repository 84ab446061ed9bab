//! Converts RGB colour spaces to linear Rec. 709.

use bilux_math::Rgb;
use bilux_math::glam::{DMat3, DVec3};

/// The colour space of an RGB value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourSpace {
    /// Rec. 709 primaries, linear.
    #[default]
    Srgb,
    DciP3,
    Rec2020,
    Aces,
}

/// The names of the colour spaces in directives.
pub const SPACES: &[(&str, ColourSpace)] = &[
    ("srgb", ColourSpace::Srgb),
    ("rec709", ColourSpace::Srgb),
    ("dci-p3", ColourSpace::DciP3),
    ("rec2020", ColourSpace::Rec2020),
    ("aces2065-1", ColourSpace::Aces),
];

/// Chromaticities of red, green, blue and white. [ITU BT.2020; SMPTE 2065]
type Primaries = [[f64; 2]; 4];

const D65: [f64; 2] = [0.3127, 0.3290];
const REC709: Primaries = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65];

impl ColourSpace {
    fn primaries(self) -> Primaries {
        match self {
            ColourSpace::Srgb => REC709,
            ColourSpace::DciP3 => [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060], D65],
            ColourSpace::Rec2020 => [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046], D65],
            ColourSpace::Aces => [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.0770], [0.32168, 0.33767]],
        }
    }

    /// The colour of a light in Rec. 709; white becomes the white of the space.
    pub fn light(self, colour: Rgb) -> Rgb {
        if self == ColourSpace::Srgb {
            return colour;
        }
        let c = from_xyz(to_xyz(self.primaries()) * DVec3::from(colour.to_array().map(f64::from)));
        clipped(c)
    }

    /// The colour of a surface in Rec. 709; white stays white.
    pub fn surface(self, colour: Rgb) -> Rgb {
        if self == ColourSpace::Srgb {
            return colour;
        }
        let matrix = to_xyz(self.primaries());
        let white = from_xyz(matrix * DVec3::ONE);
        let c = from_xyz(matrix * DVec3::from(colour.to_array().map(f64::from)));
        clipped(c / white)
    }
}

/// Clips negative components, which are outside the gamut of Rec. 709.
fn clipped(c: DVec3) -> Rgb {
    Rgb::from_array(c.max(DVec3::ZERO).as_vec3().to_array())
}

fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

/// The matrix from a space's RGB to XYZ, where white has Y = 1.
fn to_xyz([r, g, b, white]: Primaries) -> DMat3 {
    let unit = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
    let columns = DMat3::from_cols(unit(r), unit(g), unit(b));
    let scales = columns.inverse() * xyz(white);
    columns * DMat3::from_diagonal(scales)
}

/// Converts XYZ to linear Rec. 709; components may be negative.
pub fn from_xyz(c: DVec3) -> DVec3 {
    to_xyz(REC709).inverse() * c
}

/// The colour with this chromaticity and luminance 1, in Rec. 709.
pub fn of_chromaticity(xy: [f64; 2]) -> Rgb {
    clipped(from_xyz(xyz(xy)))
}

/// An XYZ colour scaled to luminance 1, in Rec. 709; black if it has none.
pub fn of_unit_luminance(c: DVec3) -> Rgb {
    if c.y > 0.0 && c.is_finite() { clipped(from_xyz(c / c.y)) } else { Rgb::BLACK }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_of_every_space_is_white() {
        for (name, space) in SPACES {
            let white = space.surface(Rgb::WHITE);
            assert!((0..3).all(|i| (white[i] - 1.0).abs() < 1e-4), "{name}: {white:?}");
        }
        let white = of_chromaticity(D65);
        assert!((0..3).all(|i| (white[i] - 1.0).abs() < 1e-4), "{white:?}");
    }

    /// Uses the standard's matrix instead of the primaries: X = 1.0985 and Z = 0.3558 of illuminant A. [IEC
    /// 61966-2-1; CIE 15]
    #[test]
    fn the_light_of_a_bulb_has_the_colour_that_the_standard_says() {
        let bulb = of_chromaticity([0.44757, 0.40745]);
        let wanted = [1.845, 0.826, 0.233];
        assert!((0..3).all(|i| (bulb[i] - wanted[i]).abs() < 3e-3), "{bulb:?}");
    }

    #[test]
    fn red_of_a_wider_space_is_clipped() {
        let red = ColourSpace::Rec2020.light(Rgb::new(1.0, 0.0, 0.0));
        assert!(red.r > 1.5 && red.g == 0.0 && red.b == 0.0, "{red:?}");
    }
}
