//! Measurements of a laser scanner: the distance and the strength of the echoes of each pulse.
//!
//! A pulse leaves a point in a narrow cone, followed by some rays. Where a ray meets a surface that scatters, the part that goes back
//! along the ray is an echo; of mirrors and smooth glass the ray goes on, split, and what it meets there echoes the same way back. The
//! distance is what the scanner takes it for: the optical length of the way. Light that scatters twice on rough surfaces is left out, and so is
//! what fog scatters back, though it weakens what passes. Everything is at one wavelength, that of a colour channel.

mod echoes;
mod parameters;
mod returns;

use bilux_math::Vec3;
use bilux_math::parallel::map;
use bilux_scene::{Scene, Tracer};
pub use parameters::{Keep, LIDAR};

/// A firing of the laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// Origin of the pulse, in metres.
    pub origin: Vec3,
    /// The axis of its cone, a unit vector.
    pub direction: Vec3,
    /// When, in seconds: within the time that the scene was built for.
    pub time: f32,
}

/// Settings by which echoes are measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Scanner {
    /// The colour channel that stands for the laser's wavelength, 0 to 2.
    pub channel: usize,
    /// The full angle of the cone, in radians, over which a pulse is evenly spread.
    pub divergence: f64,
    /// Rays that follow a pulse, at least 1; the first of one is the axis.
    pub rays: u32,
    /// The least and the greatest distance that is measured, in metres.
    pub range: [f64; 2],
    /// Echoes that are closer than this, in metres, are one return.
    pub separation: f64,
    /// Returns that are weaker than this, in 1/m², are missed.
    pub threshold: f64,
    /// Standard deviation of distances, in metres.
    pub range_noise: f64,
    /// Standard deviation of intensities, as a fraction.
    pub intensity_noise: f64,
    /// Mirrors and smooth glass that a ray is followed through.
    pub max_events: u32,
    /// Which returns of a pulse are kept.
    pub keep: Keep,
    /// Chooses the noise.
    pub seed: u64,
}

/// One return of a pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// The index of the pulse.
    pub pulse: usize,
    /// Number among the returns of the pulse, from 1, by distance.
    pub number: u32,
    /// Number of returns of the pulse, kept or not.
    pub count: u32,
    /// The measured distance in metres: half the optical length of the way there and back, with noise.
    pub range: f64,
    /// The power that arrives on each square metre at the scanner, of a pulse of power 1, in 1/m²: ρ cosθ / (π r²) from a matt plate.
    pub intensity: f64,
    /// The object of the scene that it is most of.
    pub object: u32,
}

/// Pulses that one thread takes at a time.
const BATCH: usize = 256;

/// The returns of pulses, in their order, and of each by distance. They depend on neither threads nor on other pulses.
pub fn scan(scene: &Scene, pulses: &[Pulse], scanner: &Scanner) -> Vec<Return> {
    let batches = map(pulses.chunks(BATCH).enumerate(), |(batch, pulses)| {
        let (mut tracer, mut echoes, mut found) = (Tracer::new(scene, false), Vec::new(), Vec::new());
        for (i, pulse) in pulses.iter().enumerate() {
            echoes.clear();
            scanner.echoes(pulse, &mut tracer, &mut echoes);
            scanner.returns(batch * BATCH + i, &mut echoes, &mut found);
        }
        found
    });
    batches.concat()
}
