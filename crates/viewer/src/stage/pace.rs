//! Sizes of the pictures that are shown while the camera moves, so small that each picture is there soon.

use crate::settings::divided;
use std::time::Duration;

/// Maximum time for one of these pictures.
const SOON: Duration = Duration::from_millis(40);

/// Maximum time for the first samples of a clean picture, and their minimum number.
const CLEAN: Duration = Duration::from_millis(450);
const CLEAN_SAMPLES: f64 = 4.0;

/// Maximum time until a clean picture is replaced by the one in full size, if there can be a larger one between them.
const PATIENCE: Duration = Duration::from_secs(2);

/// The maximum divisor of width and height.
const SMALLEST: u32 = 16;

/// Times that pictures have taken so far.
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

    /// The divisor of the picture after a clean one: 1 if the samples of the full size that it takes are there soon enough, and
    /// else half of the divisor. So nothing stays on the screen for longer than a few times what it took to get there, however
    /// slow the scene is.
    pub(super) fn after_clean(&self, size: [u32; 2], divisor: u32, samples: u32) -> u32 {
        let [w, h] = size.map(f64::from);
        let is_soon = w * h * self.each * f64::from(samples) <= PATIENCE.as_secs_f64();
        if is_soon || divisor <= 2 { 1 } else { divisor.div_ceil(2) }
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

    /// From the smallest clean picture to the full size, each picture takes at most some four times as long as the one before, or
    /// no longer than one waits for.
    #[test]
    fn nothing_stays_much_longer_than_what_was_before_it() {
        let size = [1280, 720];
        let time = |pace: &Pace, divisor: u32, samples: u32| {
            let [w, h] = divided(size, divisor).map(f64::from);
            w * h * pace.each * f64::from(samples)
        };
        for seconds in [0.01, 0.3, 4.0, 60.0, 2000.0] {
            let mut pace = Pace::new();
            pace.learn(size, Duration::ZERO, Duration::from_secs_f64(seconds));
            let (mut divisor, mut steps, samples) = (pace.clean_divisor(size), 0, 3);
            while divisor > 1 {
                let next = pace.after_clean(size, divisor, samples);
                let (before, after) = (time(&pace, divisor, samples), time(&pace, next, samples));
                assert!(
                    next < divisor && (after <= PATIENCE.as_secs_f64() || after <= 4.6 * before),
                    "{seconds}: {next}"
                );
                (divisor, steps) = (next, steps + 1);
            }
            assert!(steps <= 4 && (seconds > 0.5 || steps == 1), "{seconds}: {steps} steps");
        }
    }

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
