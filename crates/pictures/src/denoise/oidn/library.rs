//! The library itself. Its C interface is declared here as its public documentation has it.
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

/// Declares the functions that are used, and finds them by name.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// # Safety
        /// Each is to be called as the library's documentation says.
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

/// Processors, not graphics cards, whose pictures differ from one to the next.
const DEVICE_CPU: c_int = 1;
const FORMAT_FLOAT3: c_int = 3;

/// The library with a device on it.
pub(super) struct Device {
    functions: Functions,
    device: Pointer,
    version: [c_int; 3],
    place: PathBuf,
    /// Never closed: its threads outlive the device.
    _library: ManuallyDrop<Library>,
}

impl Device {
    /// Opens the library at a place. Its threads are as many as asked for, 0 for one each core.
    pub(super) fn open(place: &Path, threads: usize) -> Result<Device, String> {
        // SAFETY: the library comes from where the user, or the system, keeps libraries, and is trusted as these are.
        let library = unsafe { Library::new(place) }.map_err(|why| format!("{}: {why}", place.display()))?;
        let library = ManuallyDrop::new(library);
        let functions =
            Functions::find(&library).map_err(|why| format!("{} is no version 2: {why}", place.display()))?;
        // SAFETY: no argument but a number of the documentation.
        let device = unsafe { (functions.oidnNewDevice)(DEVICE_CPU) };
        if device.is_null() {
            return Err(format!("{} gives no device for this processor", place.display()));
        }
        let mut device =
            Device { functions, device, version: [0; 3], place: place.to_owned(), _library: library };
        device.commit(threads).map_err(|why| format!("{}: {why}", place.display()))?;
        Ok(device)
    }

    fn commit(&mut self, threads: usize) -> Result<(), String> {
        let f = &self.functions;
        // SAFETY: the device is one of this library's and not released; texts end with a zero.
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

    /// What has gone wrong since the last time.
    fn check(&self) -> Result<(), String> {
        let mut message = null();
        // SAFETY: the device is one of this library's; the text it gives ends with a zero, and lives until the next error.
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
        // SAFETY: the device is one of this library's, and nobody asks it after this.
        unsafe { (self.functions.oidnReleaseDevice)(self.device) }
    }
}

// SAFETY: the library's documentation allows calls from any thread, also for one device from several at a time.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

/// How much work the network is: the more, the better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quality {
    Fast,
    Balanced,
    High,
}

impl Quality {
    /// As the library numbers them. Versions before 2.3 have no `Fast`.
    fn number(self, version: [c_int; 3]) -> c_int {
        match self {
            Quality::Fast if version >= [2, 3, 0] => 4,
            Quality::Fast | Quality::Balanced => 5,
            Quality::High => 6,
        }
    }
}

/// What a filter is for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Purpose {
    /// The first is filtered; the others, if there are any, help.
    pub(super) inputs: &'static [&'static str],
    /// Light, which has no upper end.
    pub(super) hdr: bool,
    /// What helps has no noise.
    pub(super) clean: bool,
    pub(super) quality: Quality,
}

/// Three floats a pixel, row by row.
type Pixels = Vec<[f32; 3]>;

/// A network made ready for pictures of one size, with room for them.
pub(super) struct Filter {
    device: Arc<Device>,
    filter: Pointer,
    size: (usize, usize),
    inputs: Vec<(&'static str, Pixels)>,
    output: Pixels,
}

// SAFETY: as for the device; the filter is used by whoever owns this alone.
unsafe impl Send for Filter {}

impl Filter {
    /// Makes it ready, which compiles kernels.
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
        // SAFETY: the device is one of this library's and not released; texts end with a zero.
        let filter = unsafe { (device.functions.oidnNewFilter)(device.device, c"RT".as_ptr()) };
        if filter.is_null() {
            return device.check().and(Err("no filter".to_owned()));
        }
        let mut ready = Filter { device: device.clone(), filter, size, inputs, output };
        let f = &device.functions;
        // SAFETY: the filter is one of this library's and not released; texts end with a zero.
        unsafe {
            (f.oidnSetFilterBool)(filter, c"hdr".as_ptr(), purpose.hdr);
            (f.oidnSetFilterBool)(filter, c"cleanAux".as_ptr(), purpose.clean);
            (f.oidnSetFilterInt)(filter, c"quality".as_ptr(), purpose.quality.number(device.version));
        }
        ready.commit();
        device.check()?;
        Ok(ready)
    }

    /// Where an input's pixels go.
    pub(super) fn input(&mut self, name: &str) -> Option<&mut [[f32; 3]]> {
        self.inputs.iter_mut().find(|(of, _)| *of == name).map(|(_, pixels)| pixels.as_mut_slice())
    }

    /// Tells where the pixels are. Where nothing but that has changed, nothing is compiled again.
    fn commit(&mut self) {
        let ((width, height), filter, f) = (self.size, self.filter, &self.device.functions);
        let set = |name: &str, pixels: &mut Pixels| {
            let name = CString::new(name).unwrap_or_default();
            let pixels = pixels.as_mut_ptr().cast();
            // SAFETY: the filter is one of this library's and not released. Images live as long as it, have as many pixels of
            // three floats as is said, and only the output is written.
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
        // SAFETY: the filter is one of this library's and not released.
        unsafe { (f.oidnCommitFilter)(filter) }
    }

    /// The first input, filtered.
    pub(super) fn run(&mut self) -> Result<&[[f32; 3]], String> {
        self.commit();
        // SAFETY: the filter is one of this library's and not released; its images are those of this value, which nobody else uses.
        unsafe { (self.device.functions.oidnExecuteFilter)(self.filter) }
        self.device.check()?;
        Ok(&self.output)
    }
}

impl Drop for Filter {
    fn drop(&mut self) {
        // SAFETY: the filter is one of this library's, and nobody asks it after this.
        unsafe { (self.device.functions.oidnReleaseFilter)(self.filter) }
    }
}
