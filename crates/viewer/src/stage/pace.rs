//! How small the pictures are that are shown while the camera moves, so that each of them is there soon.

use crate::settings::divided;
use std::time::Duration;

/// How long one of these pictures may take.
const SOON: Duration = Duration::from_millis(40);

/// How long the first samples of a clean picture may take, and how many they are at least.
const CLEAN: Duration = Duration::from_millis(450);
const CLEAN_SAMPLES: f64 = 4.0;

/// The maximum divisor of width and height.
const SMALLEST: u32 = 16;

/// What pictures have taken so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Seconds for a sample of a pixel.
    each: f64,
    /// Seconds for what does not depend on the size.
    fixed: f64,
}

impl Pace {
    /// Without any experience, two million samples a second.
    pub(super) fn new() -> Pace {
        Pace { each: 5e-7, fixed: 0.005 }
    }

    /// Learns from a sample of all pixels of a picture, and from the time that passed before it.
    pub(super) fn learn(&mut self, size: [u32; 2], before: Duration, sampling: Duration) {
        let pixels = (f64::from(size[0]) * f64::from(size[1])).max(1.0);
        let mixed = |old: f64, new: f64| if new > old { new } else { 0.7 * old + 0.3 * new };
        self.each = mixed(self.each, sampling.as_secs_f64() / pixels);
        self.fixed = mixed(self.fixed, before.as_secs_f64());
    }

    /// The smallest divisor of a size with which a sample of all pixels is there soon.
    pub(super) fn divisor(&self, size: [u32; 2]) -> u32 {
        let time = (SOON.as_secs_f64() - self.fixed).max(0.3 * SOON.as_secs_f64());
        self.fitting(size, 1, time)
    }

    /// The smallest divisor of a size, at least 2, with which a few samples of all pixels are there soon enough for a clean
    /// picture.
    pub(super) fn clean_divisor(&self, size: [u32; 2]) -> u32 {
        self.fitting(size, 2, CLEAN.as_secs_f64() / CLEAN_SAMPLES)
    }

    /// The smallest divisor from `least` with which a sample of all pixels takes no longer than `seconds`.
    fn fitting(&self, size: [u32; 2], least: u32, seconds: f64) -> u32 {
        let fits = |divisor: &u32| {
            let [w, h] = divided(size, *divisor).map(f64::from);
            w * h * self.each <= seconds
        };
        (least..SMALLEST).find(fits).unwrap_or(SMALLEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slower_pictures_are_smaller() {
        let size = [1280, 720];
        let mut pace = Pace::new();
        let at_first = pace.divisor(size);
        pace.learn(size, Duration::from_millis(5), Duration::from_secs(2));
        assert!(pace.divisor(size) > at_first);
        for _ in 0..50 {
            pace.learn(size, Duration::from_millis(1), Duration::from_millis(10));
        }
        assert_eq!((pace.divisor(size), pace.clean_divisor(size)), (1, 2));
        pace.learn(size, Duration::from_secs(9), Duration::from_secs(900));
        assert_eq!(divided(size, pace.divisor(size)), [80, 45]);
    }
}
