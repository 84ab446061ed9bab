//! The library and its device are loaded once a process, whoever asks first, and then shared.

use super::library::Device;
use super::places::{self, FILE};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A device for each number of threads that was asked for.
static DEVICES: Mutex<Vec<(usize, Arc<Device>)>> = Mutex::new(Vec::new());

/// How to get it, for people who do not have it.
const ADVICE: &str = "Open Image Denoise does better: pip install pyoidn, or name its library in OIDN_LIB";

/// The device for so many threads, 0 for one each core. While another thread loads the library, this waits for it. Where `may_load` is
/// false, it is there only if it was loaded before.
///
/// # Errors
/// What is missing and how to get it, or why what was found cannot be used.
pub(super) fn device(threads: usize, may_load: bool) -> Result<Arc<Device>, String> {
    let mut devices = DEVICES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, device)) = devices.iter().find(|(of, _)| *of == threads) {
        return Ok(device.clone());
    }
    if !may_load {
        return Err("no library is loaded after a file of the sandbox was opened".to_owned());
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
    // The system's own comes last; where there is none, that needs no reason.
    Device::open(Path::new(FILE), threads).map_err(|_| match refused {
        Some(why) => format!("Open Image Denoise is installed, but cannot be used: {why}"),
        None => ADVICE.to_owned(),
    })
}
