//! Options of `bench rays`.

use bilux::formats::ReadOptions;
use std::path::PathBuf;

/// The benchmark's options.
#[derive(Clone, Debug)]
pub struct Options {
    /// Scene files; if empty, our own scenes.
    pub scenes: Vec<PathBuf>,
    /// Options for reading scene files.
    pub read: ReadOptions,
    /// Our structures; if empty, the fastest and `bvh`.
    pub accels: Vec<String>,
    /// Rays per class.
    pub count: usize,
    /// The number of rounds; the median is reported.
    pub rounds: u32,
    /// Competitors in shared libraries: their name (`embree`) and the library.
    pub against: Vec<(String, PathBuf)>,
    /// The folder to which meshes and rays are written.
    pub dump: Option<PathBuf>,
    /// A mesh file, traced by the rays of `rays` instead of scenes.
    pub mesh: Option<PathBuf>,
    /// See `mesh`.
    pub rays: Vec<PathBuf>,
    /// File for the hits of the last file of rays.
    pub hits: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            scenes: Vec::new(),
            read: ReadOptions::default(),
            accels: Vec::new(),
            count: 1 << 20,
            rounds: 5,
            against: Vec::new(),
            dump: None,
            mesh: None,
            rays: Vec::new(),
            hits: None,
        }
    }
}
