//! The film of a camera whose lens was measured in pixels: the matrix that OpenCV calls K.

use super::perspective::{MIRRORED, vector};
use crate::parameters::Reader;
use bilux_math::DVec2;
use bilux_math::glam::DMat3;
use bilux_math::registry::{Parameter, ParameterKind, integer};
use std::f64::consts::PI;

/// The parameters that all cameras of OpenCV have; pixels have their centres at whole numbers, as in OpenCV.
pub(super) const PARAMETERS: [Parameter; 11] = [
    vector("position", "position of the eye", "0 0 5"),
    vector("look_at", "a point on the axis", "0 0 0"),
    vector("up", "the up direction in the picture", "0 1 0"),
    integer("width", "width of the pictures that it was calibrated with, in pixels", 1, 1 << 20, "640"),
    integer("height", "height of the pictures that it was calibrated with, in pixels", 1, 1 << 20, "480"),
    pixels("fx", "focal length in widths of a pixel", 1e-3, "525"),
    pixels("fy", "focal length in heights of a pixel", 1e-3, "525"),
    pixels("cx", "where the axis meets the picture, from the centre of the leftmost pixels", -1e9, "319.5"),
    pixels("cy", "where the axis meets the picture, from the centre of the uppermost pixels", -1e9, "239.5"),
    pixels("skew", "by how much the picture leans to the right downwards: K[0][1]", -1e9, "0"),
    MIRRORED,
];

/// The names of the parameters that are K.
const fn pixels(name: &'static str, summary: &'static str, min: f64, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "pixels", kind: ParameterKind::Number { min, max: 1e9 }, default }
}

/// A coefficient of a lens.
pub(super) const fn coefficient(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Number { min: -1e9, max: 1e9 }, default: "0" }
}

/// A film by its focal lengths. Its lengths are in pixels, or in any unit that they all have.
#[derive(Clone, Copy)]
pub(super) struct Pixels {
    /// The corner of the picture, from the upper left corner of the calibrated ones.
    first: DVec2,
    size: DVec2,
    pub(super) focal: DVec2,
    /// The principal point, from the upper left corner of the calibrated pictures.
    centre: DVec2,
    skew: f64,
    /// The calibrated size, if the picture has another shape.
    other: Option<DVec2>,
}

impl Pixels {
    /// Film of a table's parameters in a picture of this width over height. A picture of the shape that was calibrated is all
    /// of that, at any size; others have its height, and less or more at the sides.
    pub(super) fn read(reader: &Reader, aspect: f64) -> Pixels {
        let of = |x: &str, y: &str| DVec2::new(reader.number_f64(x), reader.number_f64(y));
        let calibrated = of("width", "height");
        // Sizes are whole numbers: half of 641 x 481 has not quite its shape.
        let is_alike = (aspect * calibrated.y - calibrated.x).abs() < 1.0 + 0.002 * calibrated.x;
        let width = if is_alike { calibrated.x } else { aspect * calibrated.y };
        Pixels {
            first: DVec2::new(0.5 * (calibrated.x - width), 0.0),
            size: DVec2::new(width, calibrated.y),
            focal: of("fx", "fy"),
            centre: of("cx", "cy") + 0.5,
            skew: reader.number_f64("skew"),
            other: (!is_alike).then_some(calibrated),
        }
    }

    /// A film of this size whose axis meets its middle.
    pub(super) fn centred(size: DVec2, focal: DVec2) -> Pixels {
        Pixels { first: DVec2::ZERO, size, focal, centre: size * 0.5, skew: 0.0, other: None }
    }

    /// The point of the plane at distance 1 by that of the film.
    pub(super) fn to_plane(self, film: DVec2) -> DVec2 {
        let at = self.first + film * self.size - self.centre;
        let y = at.y / self.focal.y;
        DVec2::new((at.x - self.skew * y) / self.focal.x, y)
    }

    /// The point of the film by that of the plane at distance 1.
    pub(super) fn to_film(self, plane: DVec2) -> DVec2 {
        let at = plane * self.focal + DVec2::new(self.skew * plane.y, 0.0);
        (at + self.centre - self.first) / self.size
    }

    /// The film's area per area of the plane at distance 1.
    pub(super) fn density(&self) -> f64 {
        self.focal.x * self.focal.y / (self.size.x * self.size.y)
    }

    /// The height of the film on the plane at distance 1.
    pub(super) fn height(&self) -> f64 {
        self.size.y / self.focal.y
    }

    /// Distance of the farthest corner of the picture from the axis, on the plane at distance 1.
    pub(super) fn reach(&self) -> f64 {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        corners.map(|corner| self.to_plane(corner).length()).into_iter().fold(0.0, f64::max)
    }

    /// [`Pixels::to_film`] as a matrix.
    pub(super) fn matrix(&self) -> DMat3 {
        let [fx, skew] = [self.focal.x, self.skew].map(|x| x / self.size.x);
        let middle = (self.centre - self.first) / self.size;
        DMat3::from_cols_array(&[
            fx,
            0.0,
            0.0,
            skew,
            self.focal.y / self.size.y,
            0.0,
            middle.x,
            middle.y,
            1.0,
        ])
    }

    /// Warnings for users: that the picture has another shape than those that were calibrated, and which part of it is
    /// black since it `is_blind` there.
    pub(super) fn warnings(&self, angle: f64, is_blind: impl Fn(DVec2) -> bool) -> Vec<String> {
        const GRID: usize = 100;
        let mut warnings = Vec::new();
        if let Some(DVec2 { x, y }) = self.other {
            warnings.push(format!(
                "the camera was calibrated with pictures of {x}x{y}, and this one has another shape: it shows more or less at \
                 the sides; render {x}x{y} or a part of it"
            ));
        }
        let centre = |i: usize| DVec2::new((i % GRID) as f64 + 0.5, (i / GRID) as f64 + 0.5) / GRID as f64;
        let blind = (0..GRID * GRID).filter(|i| is_blind(centre(*i))).count();
        if blind > 0 {
            let percent = (blind as f64 * 100.0 / (GRID * GRID) as f64).max(0.01);
            let why = match angle < PI {
                true => "its distortion folds over",
                false => "it has seen everything",
            };
            warnings.push(format!(
                "the camera's lens model ends {:.1} degrees from its axis, where {why}: {percent:.3}% of the picture is beyond \
                 that and stays black",
                angle.to_degrees()
            ));
        }
        warnings
    }
}
