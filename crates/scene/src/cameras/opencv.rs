//! `opencv`: the camera of OpenCV's `calibrateCamera`, with radial, tangential and thin prism distortion.

use super::CameraEntry;
use super::central::{self, Projection};
use super::pixels::{self, Pixels, coefficient};
use super::radial::Starts;
use crate::parameters::Reader;
use bilux_math::glam::{DMat2, DMat3};
use bilux_math::registry::{Entry, Parameter};
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{DVec2, DVec3};
use std::f64::consts::TAU;

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "opencv",
        summary: "camera of OpenCV: a camera matrix in pixels, radial, tangential and thin prism distortion",
        source: "OpenCV",
        parameters: &PARAMETERS,
    },
    build: |keys, aspect| {
        central::build(keys, aspect, 0.0, |reader, aspect| Ok(OpenCv::read(reader, aspect)))
    },
};

const PARAMETERS: [Parameter; 23] = {
    let mut all = [coefficient("k1", "radial distortion, by the square of the distance from the axis"); 23];
    let mut i = 0;
    while i < pixels::PARAMETERS.len() {
        all[i] = pixels::PARAMETERS[i];
        i += 1;
    }
    all[12] = coefficient("k2", "radial distortion, by its 4th power");
    all[13] = coefficient("k3", "radial distortion, by its 6th power");
    all[14] = coefficient(
        "k4",
        "what radial distortion is divided by, by the square of the distance from the axis",
    );
    all[15] = coefficient("k5", "what radial distortion is divided by, by its 4th power");
    all[16] = coefficient("k6", "what radial distortion is divided by, by its 6th power");
    all[17] = coefficient("p1", "tangential distortion, downwards");
    all[18] = coefficient("p2", "tangential distortion, to the right");
    all[19] =
        coefficient("s1", "thin prism distortion to the right, by the square of the distance from the axis");
    all[20] = coefficient("s2", "thin prism distortion to the right, by its 4th power");
    all[21] =
        coefficient("s3", "thin prism distortion downwards, by the square of the distance from the axis");
    all[22] = coefficient("s4", "thin prism distortion downwards, by its 4th power");
    all
};

struct OpenCv {
    pixels: Pixels,
    /// None of a camera without distortion.
    lens: Option<Lens>,
    warnings: Vec<String>,
}

/// Distortion of points of the plane at distance 1. [OpenCV]
struct Distortion {
    /// k1, k2, k3, and what they are divided by.
    radial: [[f64; 3]; 2],
    tangential: DVec2,
    /// By the square of the distance from the axis, and by its 4th power.
    prism: [DVec2; 2],
}

/// Distortion, and where it is one to one.
struct Lens {
    distortion: Distortion,
    /// The square of the distance from the axis below which it is.
    limit: f64,
    /// Starts of the search for the points that radial distortion alone would bring somewhere.
    starts: Starts,
}

impl OpenCv {
    fn read(reader: &Reader, aspect: f64) -> OpenCv {
        let number = |key: &str| reader.number_f64(key);
        let distortion = Distortion {
            radial: [["k1", "k2", "k3"].map(number), ["k4", "k5", "k6"].map(number)],
            tangential: DVec2::new(number("p1"), number("p2")),
            prism: [("s1", "s3"), ("s2", "s4")].map(|(x, y)| DVec2::new(number(x), number(y))),
        };
        let pixels = Pixels::read(reader, aspect);
        let lens = (!distortion.is_none()).then(|| Lens::new(distortion, pixels.reach()));
        let mut camera = OpenCv { pixels, lens, warnings: Vec::new() };
        let angle = camera.lens.as_ref().map_or(0.0, |lens| atan2_f64(lens.limit.sqrt(), 1.0));
        camera.warnings = pixels.warnings(angle, |film| camera.direction(film).is_none());
        camera
    }
}

impl Distortion {
    fn is_none(&self) -> bool {
        self.radial == [[0.0; 3]; 2] && self.tangential == DVec2::ZERO && self.prism == [DVec2::ZERO; 2]
    }

    /// Distorted point, and the derivatives of the distortion.
    #[inline]
    fn at(&self, p: DVec2) -> (DVec2, DMat2) {
        let (x, y, r2) = (p.x, p.y, p.length_squared());
        let (radial, slope) = self.radial(r2);
        let DVec2 { x: p1, y: p2 } = self.tangential;
        let [by_square, by_fourth] = self.prism;
        let tangential = DVec2::new(
            2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let prism = (by_square + by_fourth * r2) * r2;
        // How the prism grows with the square of the distance.
        let grows = by_square + by_fourth * (2.0 * r2);
        let mixed = 2.0 * (x * y * slope + p1 * x + p2 * y);
        let along_x = DVec2::new(radial + 2.0 * (x * x * slope + p1 * y) + 6.0 * p2 * x, mixed);
        let along_y = DVec2::new(mixed, radial + 2.0 * (y * y * slope + p2 * x) + 6.0 * p1 * y);
        let slopes = DMat2::from_cols(along_x + grows * (2.0 * x), along_y + grows * (2.0 * y));
        (p * radial + tangential + prism, slopes)
    }

    /// The factor of radial distortion, and how it grows with the square of the distance.
    #[inline]
    fn radial(&self, r2: f64) -> (f64, f64) {
        let [[a, a_slope], [b, b_slope]] = self.radial.map(|[k1, k2, k3]| {
            [1.0 + ((k3 * r2 + k2) * r2 + k1) * r2, (3.0 * k3 * r2 + 2.0 * k2) * r2 + k1]
        });
        let factor = a / b;
        (factor, (a_slope - factor * b_slope) / b)
    }

    /// Whether the symmetric part of the derivatives is positive definite, and the divisor positive. A map for which that
    /// holds in all of a convex domain is one to one there.
    fn is_regular(&self, p: DVec2) -> bool {
        let [k4, k5, k6] = self.radial[1];
        let r2 = p.length_squared();
        let (_, slopes) = self.at(p);
        let off = 0.5 * (slopes.x_axis.y + slopes.y_axis.x);
        let is_positive = slopes.x_axis.x > 0.0 && slopes.x_axis.x * slopes.y_axis.y - off * off > 0.0;
        1.0 + ((k6 * r2 + k5) * r2 + k4) * r2 > 0.0 && is_positive
    }

    /// The radius of the disc around the axis in which it is regular, at most that of nearly all directions ahead.
    fn limit(&self) -> f64 {
        const WIDEST: f64 = 1e4;
        const STEP: f64 = 2e-3;
        let is_radial = self.tangential == DVec2::ZERO && self.prism == [DVec2::ZERO; 2];
        let rays = if is_radial { 1 } else { 64 };
        let mut limit = WIDEST;
        for ray in 0..rays {
            let (sin, cos) = sin_cos_f64(TAU * f64::from(ray) / f64::from(rays));
            let is_regular = |r: f64| self.is_regular(DVec2::new(cos, sin) * r);
            let (mut inside, mut outside) = (0.0, STEP);
            while outside < limit && is_regular(outside) {
                inside = outside;
                outside += STEP * (1.0 + outside);
            }
            if outside >= limit {
                continue;
            }
            while outside - inside > 1e-9 * outside {
                let middle = 0.5 * (inside + outside);
                *(if is_regular(middle) { &mut inside } else { &mut outside }) = middle;
            }
            limit = inside;
        }
        limit
    }
}

impl Lens {
    fn new(distortion: Distortion, reach: f64) -> Lens {
        let limit = distortion.limit();
        let starts = Starts::new(limit, reach, |r| r * distortion.radial(r * r).0);
        Lens { distortion, limit: limit * limit, starts }
    }

    /// The point of the plane that distortion brings to another: Newton's method. `None` where no point is.
    fn undistorted(&self, to: DVec2) -> Option<DVec2> {
        const STEPS: usize = 40;
        // The square of a step after which the next one is below rounding.
        const SMALL: f64 = 1e-18;
        let mut at = self.within(to * self.starts.factor(to.length_squared()));
        let (value, mut slopes) = self.distortion.at(at);
        let mut miss = to - value;
        for _ in 0..STEPS {
            let step = slopes.inverse() * miss;
            if step.length_squared() <= SMALL * (1.0 + at.length_squared()) {
                return Some(at + step).filter(|at| at.length_squared() < self.limit);
            }
            let mut share = 1.0;
            loop {
                let next = self.within(at + step * share);
                let (value, there) = self.distortion.at(next);
                if (to - value).length_squared() < miss.length_squared() {
                    (at, slopes, miss) = (next, there, to - value);
                    break;
                }
                share *= 0.5;
                if share < 1e-3 {
                    return None;
                }
            }
        }
        None
    }

    /// The point, or the nearest one that is just within the limit.
    #[inline]
    fn within(&self, p: DVec2) -> DVec2 {
        let r2 = p.length_squared();
        if r2 < self.limit { p } else { p * ((1.0 - 1e-9) * (self.limit / r2).sqrt()) }
    }
}

impl Projection for OpenCv {
    fn direction(&self, film: DVec2) -> Option<DVec3> {
        let plane = self.pixels.to_plane(film);
        let p = match &self.lens {
            Some(lens) => lens.undistorted(plane)?,
            None => plane,
        };
        Some(p.extend(1.0).normalize())
    }

    fn seen(&self, towards: DVec3) -> Option<(DVec2, f64)> {
        if towards.z.is_nan() || towards.z <= 0.0 {
            return None;
        }
        let p = towards.truncate() / towards.z;
        let r2 = p.length_squared();
        let (plane, area) = match &self.lens {
            Some(lens) if r2 < lens.limit => {
                let (plane, slopes) = lens.distortion.at(p);
                (plane, slopes.determinant())
            }
            Some(_) => return None,
            None => (p, 1.0),
        };
        // The plane at distance 1 has 1 / cos³ of a solid angle there.
        let per_angle = (1.0 + r2) * (1.0 + r2).sqrt();
        Some((self.pixels.to_film(plane), area * per_angle * self.pixels.density()))
    }

    fn matrix(&self) -> Option<DMat3> {
        self.lens.is_none().then(|| self.pixels.matrix())
    }

    fn height_at(&self, p: DVec3) -> f64 {
        p.z.abs() * self.pixels.height()
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}
