//! Acceleration structures by the names that benchmarks use.

use bilux::Error;
use bilux::accel::registry::Quality;
use bilux::accel::{ACCELERATORS, AcceleratorEntry, BuildOptions, CpuLevel};
use bilux::scene::error::nearest_name;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Finds a structure by its name. A suffix after a hyphen sets how much time its builder may take (`bvh8-best`) or
/// which instructions its kernels may use (`bvh8-sse4.2`); without one, the build is balanced and the CPU level is the
/// highest available.
pub(crate) fn find(name: &str) -> Result<(&'static AcceleratorEntry, BuildOptions), Error> {
    let row = |name: &str| ACCELERATORS.iter().find(|row| row.entry.name == name);
    if let Some(row) = row(name) {
        return Ok((row, BuildOptions::default()));
    }
    let with_option = name.rsplit_once('-').and_then(|(name, option)| {
        let (row, options) = (row(name)?, BuildOptions::default());
        if let Some(quality) = Quality::from_name(option) {
            return Some((row, BuildOptions { quality, ..options }));
        }
        let cpu_level = CpuLevel::ALL.into_iter().find(|level| level.name() == option)?;
        Some((row, BuildOptions { cpu_level, ..options }))
    });
    with_option.ok_or_else(|| {
        let names: Vec<String> = ACCELERATORS.iter().map(|row| row.entry.name.to_owned()).collect();
        let hint = match nearest_name(name, &names) {
            Some(nearest) => format!("did you mean '{nearest}'?"),
            None => format!(
                "known are {}, each also with the suffix -fast, -best or a CPU level",
                names.join(", ")
            ),
        };
        Error::Settings(format!("there is no accelerator '{name}'; {hint}"))
    })
}

/// Makes a pool of `number` threads, or of one per core for 0.
pub(crate) fn threads(number: usize) -> Result<ThreadPool, Error> {
    let pool = ThreadPoolBuilder::new().num_threads(number).build();
    pool.map_err(|e| Error::Settings(format!("cannot start threads: {e}")))
}
