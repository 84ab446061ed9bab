//! The library and its device are loaded once per process, on first request, and then shared.

use super::library::Device;
use super::places::{self, FILE};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A device for each requested number of threads.
static DEVICES: Mutex<Vec<(usize, Arc<Device>)>> = Mutex::new(Vec::new());

/// Advice for users who do not have the library.
const ADVICE: &str =
    "Open Image Denoise gives cleaner pictures: pip install pyoidn, or set OIDN_LIB to its library";

/// The device for a number of threads, 0 for one per core. While another thread loads the library, this waits for it.
/// If `may_load` is false, the device is available only if it was loaded before.
///
/// # Errors
/// Says what is missing and how to get it, or why what was found cannot be used.
pub(super) fn device(threads: usize, may_load: bool) -> Result<Arc<Device>, String> {
    let mut devices = DEVICES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, device)) = devices.iter().find(|(of, _)| *of == threads) {
        return Ok(device.clone());
    }
    if !may_load {
        return Err("a sandbox loads no library once it has opened a file".to_owned());
    }
    let device = Arc::new(open(threads)?);
    devices.push((threads, device.clone()));
    Ok(device)
}

fn open(threads: usize) -> Result<Device, String> {
    if let Some(named) = places::named() {
        let failed = |why| format!("OIDN_LIB names a library that cannot be used: {why}");
        return Device::open(&named, threads).map_err(failed);
    }
    let mut refused = None;
    for file in places::files() {
        match Device::open(&file, threads) {
            Ok(device) => return Ok(device),
            Err(why) => refused = refused.or(Some(why)),
        }
    }
    // The system's own library comes last; if it is missing, that needs no explanation.
    Device::open(Path::new(FILE), threads).map_err(|_| match refused {
        Some(why) => format!("Open Image Denoise is installed, but cannot be used: {why}"),
        None => ADVICE.to_owned(),
    })
}
