//! Random numbers that depend on a few words alone, such as a seed and a place, for the noise of measurements.

use crate::hash::{hash_words, mix64};
use crate::transcendental::{cos_f64, exp_f64, ln_f64, ln_gamma_f64};

/// Random numbers that depend on some words alone.
#[derive(Clone, Debug)]
pub struct Stream(u64);

impl Stream {
    /// The numbers of these words.
    pub fn new<const N: usize>(words: [u64; N]) -> Stream {
        Stream(hash_words(words))
    }

    /// A number in (0, 1), never 0 or 1. [Steele 2014]
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        ((mix64(self.0) >> 12) as f64 + 0.5) / (1u64 << 52) as f64
    }

    /// A normal number of mean 0 and variance 1. [Box 1958]
    pub fn normal(&mut self) -> f64 {
        let (radius, turn) = (self.uniform(), self.uniform());
        (-2.0 * ln_f64(radius)).sqrt() * cos_f64(std::f64::consts::TAU * turn)
    }
}

/// Means below this are found by counting, larger ones by rejection, whose hat needs them to be at least 10.
const FEW: f64 = 10.0;

/// A Poisson number of this mean, which is at least 0: exact, and in constant time for large means. [Hörmann 1993, algorithm PTRS]
pub fn poisson(mean: f64, stream: &mut Stream) -> f64 {
    if mean < FEW { counted(mean, stream) } else { rejected(mean, stream) }
}

/// Events of a process until their waiting times exceed the mean. [Devroye 1986, section X.3.3]
fn counted(mean: f64, stream: &mut Stream) -> f64 {
    let none = exp_f64(-mean);
    let (mut events, mut product) = (0.0, stream.uniform());
    while product > none {
        product *= stream.uniform();
        events += 1.0;
    }
    events
}

fn rejected(mean: f64, stream: &mut Stream) -> f64 {
    let (root, log_mean) = (mean.sqrt(), ln_f64(mean));
    let b = 0.931 + 2.53 * root;
    let a = -0.059 + 0.02483 * b;
    let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    let quick = 0.9277 - 3.6224 / (b - 2.0);
    loop {
        let (u, v) = (stream.uniform() - 0.5, stream.uniform());
        let beside = 0.5 - u.abs();
        let events = ((2.0 * a / beside + b) * u + mean + 0.43).floor();
        if beside >= 0.07 && v <= quick {
            return events;
        }
        if events < 0.0 || (beside < 0.013 && v > beside) {
            continue;
        }
        let hat = ln_f64(v) + ln_f64(inverse_alpha) - ln_f64(a / (beside * beside) + b);
        if hat <= events * log_mean - mean - ln_gamma_f64(events + 1.0) {
            return events;
        }
    }
}
