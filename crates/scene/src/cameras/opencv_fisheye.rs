//! `opencv-fisheye`: the camera of OpenCV's `fisheye::calibrate`. [Kannala 2006]

use super::CameraEntry;
use super::central::{self, Projection};
use super::pixels::{self, Pixels, coefficient};
use super::radial::{Lens, Radial, Starts};
use crate::parameters::Reader;
use bilux_math::registry::{Entry, Parameter};
use std::f64::consts::PI;

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "opencv-fisheye",
        summary: "fisheye camera of OpenCV: a camera matrix in pixels, and distances from the axis as a polynomial of angles",
        source: "Kannala 2006",
        parameters: &PARAMETERS,
    },
    build: |keys, aspect| central::build(keys, aspect, 0.0, |reader, aspect| Ok(read(reader, aspect))),
};

const PARAMETERS: [Parameter; 15] = {
    let mut all = [coefficient("k1", "by the 3rd power of the angle from the axis"); 15];
    let mut i = 0;
    while i < pixels::PARAMETERS.len() {
        all[i] = pixels::PARAMETERS[i];
        i += 1;
    }
    all[12] = coefficient("k2", "by its 5th power");
    all[13] = coefficient("k3", "by its 7th power");
    all[14] = coefficient("k4", "by its 9th power");
    all
};

fn read(reader: &Reader, aspect: f64) -> Radial<Polynomial> {
    let pixels = Pixels::read(reader, aspect);
    let lens = Polynomial::new(["k1", "k2", "k3", "k4"].map(|key| reader.number_f64(key)), pixels.reach());
    let widest = lens.widest;
    let mut camera = Radial { lens, pixels, warnings: Vec::new() };
    camera.warnings = pixels.warnings(widest, |film| camera.direction(film).is_none());
    camera
}

struct Polynomial {
    k: [f64; 4],
    widest: f64,
    /// The radius there.
    most: f64,
    starts: Starts,
}

/// θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸), and its slope. [OpenCV]
#[inline]
fn polynomial([k1, k2, k3, k4]: [f64; 4], angle: f64) -> (f64, f64) {
    let z = angle * angle;
    let value = 1.0 + (((k4 * z + k3) * z + k2) * z + k1) * z;
    let slope = 1.0 + (((9.0 * k4 * z + 7.0 * k3) * z + 5.0 * k2) * z + 3.0 * k1) * z;
    (angle * value, slope)
}

impl Polynomial {
    fn new(k: [f64; 4], reach: f64) -> Polynomial {
        const STEPS: u32 = 20_000;
        let angle = |i: u32| PI * f64::from(i) / f64::from(STEPS);
        let grows = |angle: f64| polynomial(k, angle).1 > 0.0;
        let widest = match (1..=STEPS).find(|i| !grows(angle(*i))) {
            None => PI,
            Some(first) => {
                let (mut low, mut high) = (angle(first - 1), angle(first));
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    *(if grows(middle) { &mut low } else { &mut high }) = middle;
                }
                low
            }
        };
        let starts = Starts::new(widest, reach, |angle| polynomial(k, angle).0);
        Polynomial { k, widest, most: polynomial(k, widest).0, starts }
    }
}

impl Lens for Polynomial {
    fn radius(&self, angle: f64) -> (f64, f64) {
        polynomial(self.k, angle)
    }

    fn angle(&self, radius: f64) -> Option<f64> {
        const STEPS: usize = 40;
        const SMALL: f64 = 1e-9;
        if radius > self.most {
            return None;
        }
        // Between these the answer is: Newton's method does not leave them.
        let (mut low, mut high) = (0.0, self.widest);
        let mut angle = (radius * self.starts.factor(radius * radius)).min(self.widest);
        for _ in 0..STEPS {
            let (value, slope) = polynomial(self.k, angle);
            *(if value < radius { &mut low } else { &mut high }) = angle;
            let next = angle + (radius - value) / slope;
            let is_inside = low <= next && next <= high;
            let (before, now) = (angle, if is_inside { next } else { 0.5 * (low + high) });
            angle = now;
            if is_inside && (now - before).abs() < SMALL {
                break;
            }
        }
        Some(angle)
    }

    fn widest(&self) -> f64 {
        self.widest
    }
}
