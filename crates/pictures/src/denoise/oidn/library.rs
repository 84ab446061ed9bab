//! The library itself. Its C interface is declared here according to its public documentation.
#![allow(unsafe_code, reason = "a C library is loaded and called")]

use crate::PictureError;
use crate::limits::reserved;
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::ptr::null;
use std::sync::Arc;

type Pointer = *mut c_void;

/// Declares the functions that are used, and looks them up by name.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// # Safety
        /// Each must be called as the library's documentation says.
        #[allow(non_snake_case, reason = "as the library calls them")]
        struct Functions { $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)* }

        impl Functions {
            fn find(library: &Library) -> Result<Functions, libloading::Error> {
                // SAFETY: each symbol has the type that the documentation of version 2 gives it.
                unsafe { Ok(Functions { $($name: *library.get(concat!(stringify!($name), "\0").as_bytes())?,)* }) }
            }
        }
    };
}

functions! {
    oidnNewDevice: fn(c_int) -> Pointer;
    oidnSetDeviceInt: fn(Pointer, *const c_char, c_int);
    oidnSetDeviceBool: fn(Pointer, *const c_char, bool);
    oidnGetDeviceInt: fn(Pointer, *const c_char) -> c_int;
    oidnGetDeviceError: fn(Pointer, *mut *const c_char) -> c_int;
    oidnCommitDevice: fn(Pointer);
    oidnReleaseDevice: fn(Pointer);
    oidnNewFilter: fn(Pointer, *const c_char) -> Pointer;
    oidnSetSharedFilterImage: fn(Pointer, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);
    oidnSetFilterBool: fn(Pointer, *const c_char, bool);
    oidnSetFilterInt: fn(Pointer, *const c_char, c_int);
    oidnCommitFilter: fn(Pointer);
    oidnExecuteFilter: fn(Pointer);
    oidnReleaseFilter: fn(Pointer);
}

/// The CPU device; results on graphics cards differ from one card to the next.
const DEVICE_CPU: c_int = 1;
const FORMAT_FLOAT3: c_int = 3;

/// The library with a device.
pub(super) struct Device {
    functions: Functions,
    device: Pointer,
    version: [c_int; 3],
    place: PathBuf,
    /// Never unloaded: its threads outlive the device.
    _library: ManuallyDrop<Library>,
}

impl Device {
    /// Opens the library at a path. `threads` is the number of its threads, 0 for one per core.
    pub(super) fn open(place: &Path, threads: usize) -> Result<Device, String> {
        // SAFETY: the library comes from where the user, or the system, keeps libraries, and is trusted like those.
        let library = unsafe { Library::new(place) }.map_err(|why| format!("{}: {why}", place.display()))?;
        let library = ManuallyDrop::new(library);
        let functions = Functions::find(&library)
            .map_err(|why| format!("{} is not version 2: {why}", place.display()))?;
        // SAFETY: the only argument is a constant from the documentation.
        let device = unsafe { (functions.oidnNewDevice)(DEVICE_CPU) };
        if device.is_null() {
            return Err(format!("{} does not support this processor", place.display()));
        }
        let mut device =
            Device { functions, device, version: [0; 3], place: place.to_owned(), _library: library };
        device.commit(threads).map_err(|why| format!("{}: {why}", place.display()))?;
        Ok(device)
    }

    fn commit(&mut self, threads: usize) -> Result<(), String> {
        let f = &self.functions;
        // SAFETY: the device belongs to this library and is not released; strings are zero-terminated.
        unsafe {
            if let Some(threads) = c_int::try_from(threads).ok().filter(|&threads| threads > 0) {
                (f.oidnSetDeviceInt)(self.device, c"numThreads".as_ptr(), threads);
            }
            (f.oidnSetDeviceBool)(self.device, c"setAffinity".as_ptr(), false);
            (f.oidnCommitDevice)(self.device);
            let names = [c"versionMajor", c"versionMinor", c"versionPatch"];
            self.version = names.map(|name| (f.oidnGetDeviceInt)(self.device, name.as_ptr()));
        }
        self.check()
    }

    pub(super) fn describe(&self) -> String {
        let [major, minor, patch] = self.version;
        format!("Open Image Denoise {major}.{minor}.{patch} ({})", self.place.display())
    }

    /// Returns the error that has occurred since the last call, if any.
    fn check(&self) -> Result<(), String> {
        let mut message = null();
        // SAFETY: the device belongs to this library; the string that it returns is zero-terminated, and lives until
        // the next error.
        unsafe {
            match (self.functions.oidnGetDeviceError)(self.device, &mut message) {
                0 => Ok(()),
                code if message.is_null() => Err(format!("error {code}")),
                _ => Err(CStr::from_ptr(message).to_string_lossy().into_owned()),
            }
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the device belongs to this library, and is not used after this.
        unsafe { (self.functions.oidnReleaseDevice)(self.device) }
    }
}

// SAFETY: the library's documentation allows calls from any thread, and concurrent calls for one device.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

/// The size of the network: larger is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quality {
    Fast,
    Balanced,
    High,
}

impl Quality {
    /// The library's number for it. Versions before 2.3 have no `Fast`.
    fn number(self, version: [c_int; 3]) -> c_int {
        match self {
            Quality::Fast if version >= [2, 3, 0] => 4,
            Quality::Fast | Quality::Balanced => 5,
            Quality::High => 6,
        }
    }
}

/// The purpose of a filter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Purpose {
    /// The first input is filtered; the others, if any, are auxiliary features.
    pub(super) inputs: &'static [&'static str],
    /// Light, which has no upper bound.
    pub(super) hdr: bool,
    /// The auxiliary features are noise-free.
    pub(super) clean: bool,
    pub(super) quality: Quality,
}

/// Three floats per pixel, row by row.
type Pixels = Vec<[f32; 3]>;

/// A network prepared for pictures of one size, with memory for them.
pub(super) struct Filter {
    device: Arc<Device>,
    filter: Pointer,
    size: (usize, usize),
    inputs: Vec<(&'static str, Pixels)>,
    output: Pixels,
}

// SAFETY: as for the device; the filter is used only by the owner of this value.
unsafe impl Send for Filter {}

impl Filter {
    /// Prepares the filter, which compiles kernels.
    pub(super) fn new(
        device: &Arc<Device>,
        size: (usize, usize),
        purpose: &Purpose,
    ) -> Result<Filter, String> {
        let black = || -> Result<Pixels, PictureError> {
            let mut pixels = reserved("denoising", size.0 * size.1)?;
            pixels.resize(size.0 * size.1, [0.0; 3]);
            Ok(pixels)
        };
        let inputs = purpose.inputs.iter().map(|&name| Ok((name, black()?)));
        let inputs = inputs.collect::<Result<_, PictureError>>().map_err(|why| why.to_string())?;
        let output = black().map_err(|why| why.to_string())?;
        // SAFETY: the device belongs to this library and is not released; strings are zero-terminated.
        let filter = unsafe { (device.functions.oidnNewFilter)(device.device, c"RT".as_ptr()) };
        if filter.is_null() {
            return device.check().and(Err("no filter".to_owned()));
        }
        let mut ready = Filter { device: device.clone(), filter, size, inputs, output };
        let f = &device.functions;
        // SAFETY: the filter belongs to this library and is not released; strings are zero-terminated.
        unsafe {
            (f.oidnSetFilterBool)(filter, c"hdr".as_ptr(), purpose.hdr);
            (f.oidnSetFilterBool)(filter, c"cleanAux".as_ptr(), purpose.clean);
            (f.oidnSetFilterInt)(filter, c"quality".as_ptr(), purpose.quality.number(device.version));
        }
        ready.commit();
        device.check()?;
        Ok(ready)
    }

    /// The buffer for an input's pixels.
    pub(super) fn input(&mut self, name: &str) -> Option<&mut [[f32; 3]]> {
        self.inputs.iter_mut().find(|(of, _)| *of == name).map(|(_, pixels)| pixels.as_mut_slice())
    }

    /// Passes the addresses of the pixels to the library. If nothing else has changed, nothing is recompiled.
    fn commit(&mut self) {
        let ((width, height), filter, f) = (self.size, self.filter, &self.device.functions);
        let set = |name: &str, pixels: &mut Pixels| {
            let name = CString::new(name).unwrap_or_default();
            let pixels = pixels.as_mut_ptr().cast();
            // SAFETY: the filter belongs to this library and is not released. Images live as long as the filter, have
            // the stated number of pixels of three floats, and only the output is written.
            unsafe {
                (f.oidnSetSharedFilterImage)(
                    filter,
                    name.as_ptr(),
                    pixels,
                    FORMAT_FLOAT3,
                    width,
                    height,
                    0,
                    0,
                    0,
                );
            }
        };
        self.inputs.iter_mut().for_each(|(name, pixels)| set(name, pixels));
        set("output", &mut self.output);
        // SAFETY: the filter belongs to this library and is not released.
        unsafe { (f.oidnCommitFilter)(filter) }
    }

    /// Runs the filter on the first input.
    pub(super) fn run(&mut self) -> Result<&[[f32; 3]], String> {
        self.commit();
        // SAFETY: the filter belongs to this library and is not released; its images are those of this value, which
        // nothing else uses.
        unsafe { (self.device.functions.oidnExecuteFilter)(self.filter) }
        self.device.check()?;
        Ok(&self.output)
    }
}

impl Drop for Filter {
    fn drop(&mut self) {
        // SAFETY: the filter belongs to this library, and is not used after this.
        unsafe { (self.device.functions.oidnReleaseFilter)(self.filter) }
    }
}
