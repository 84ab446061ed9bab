//! Options of `bench render`.

use bilux::formats::ReadOptions;
use std::path::PathBuf;

/// The benchmark's options.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names from [`SCENES`](super::SCENES); all of them if there are neither names nor files.
    pub scenes: Vec<String>,
    /// The user's own scene files. Their references are rendered first.
    pub files: Vec<PathBuf>,
    /// Options for reading files.
    pub read: ReadOptions,
    /// The CPU seconds that each of the two integrators spends on the reference of a file.
    pub reference_seconds: f64,
    /// Names of integrators, `auto:TECHNIQUES` for one set of techniques of `auto`; if empty, the default ones.
    pub integrators: Vec<String>,
    /// CPU seconds per picture, summed over all threads.
    pub seconds: Vec<f64>,
    /// The number of pictures per scene, integrator and budget, at least 1.
    pub seeds: u32,
    /// The number of threads; 0 for all cores.
    pub threads: u32,
    /// The folder for a page with pictures and curves.
    pub report: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            scenes: Vec::new(),
            files: Vec::new(),
            read: ReadOptions::default(),
            reference_seconds: 60.0,
            integrators: Vec::new(),
            seconds: vec![1.0, 4.0],
            seeds: 5,
            threads: 0,
            report: None,
        }
    }
}

impl Options {
    /// The CPU seconds of an integrator on a scene.
    pub(super) fn work(&self) -> f64 {
        self.seconds.iter().sum::<f64>() * f64::from(self.seeds.max(1))
    }
}
