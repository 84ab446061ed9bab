//! The library itself. Its C interface is declared here as its public documentation has it.
#![allow(unsafe_code, reason = "a C library is loaded and called")]

use crate::PictureError;
use crate::limits::reserved;
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::ptr::null;

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
    oidnCommitFilter: fn(Pointer);
    oidnExecuteFilter: fn(Pointer);
    oidnReleaseFilter: fn(Pointer);
}

/// Processors, not graphics cards, whose pictures differ from one to the next.
const DEVICE_CPU: c_int = 1;
const FORMAT_FLOAT3: c_int = 3;

/// Three floats a pixel, row by row.
pub(super) struct Image {
    size: (usize, usize),
    samples: Vec<[f32; 3]>,
}

impl Image {
    /// As many pixels as the size has; black where there are fewer.
    pub(super) fn new(
        size: (usize, usize),
        pixels: impl Iterator<Item = [f32; 3]>,
    ) -> Result<Image, PictureError> {
        let mut samples = reserved("denoising", size.0 * size.1)?;
        samples.extend(pixels.take(size.0 * size.1));
        samples.resize(size.0 * size.1, [0.0; 3]);
        Ok(Image { size, samples })
    }

    pub(super) fn pixels(&self) -> impl Iterator<Item = [f32; 3]> {
        self.samples.iter().copied()
    }
}

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
    /// Opens the library at a place; `None` where there is none. Its threads are as many as asked for, 0 for one each core.
    pub(super) fn open(place: &Path, threads: usize) -> Result<Option<Device>, String> {
        // SAFETY: the library comes from where the user, or the system, keeps libraries, and is trusted as these are.
        let Ok(library) = (unsafe { Library::new(place) }) else { return Ok(None) };
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
        Ok(Some(device))
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

    /// The first of the inputs, filtered with the help of the others, which are clean.
    pub(super) fn filter(&self, inputs: &[(&str, &Image)], hdr: bool) -> Result<Image, String> {
        let Some((_, first)) = inputs.first() else { return Err("no input".to_owned()) };
        let size = first.size;
        let mut output = Image::new(size, std::iter::empty()).map_err(|why| why.to_string())?;
        let f = &self.functions;
        // SAFETY: the device is one of this library's. The images live until the filter is released, below, have as many pixels of
        // three floats as is said, and none but the output is written.
        unsafe {
            let filter = (f.oidnNewFilter)(self.device, c"RT".as_ptr());
            if filter.is_null() {
                return self.check().and(Err("no filter".to_owned()));
            }
            let set = |name: &str, pixels: *const [f32; 3]| {
                let name = CString::new(name).unwrap_or_default();
                let (pixels, (width, height)) = (pixels.cast_mut().cast(), size);
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
            };
            inputs.iter().filter(|(_, i)| i.size == size).for_each(|(name, i)| set(name, i.samples.as_ptr()));
            set("output", output.samples.as_mut_ptr());
            if hdr {
                (f.oidnSetFilterBool)(filter, c"hdr".as_ptr(), true);
            }
            if inputs.len() > 1 {
                (f.oidnSetFilterBool)(filter, c"cleanAux".as_ptr(), true);
            }
            (f.oidnCommitFilter)(filter);
            (f.oidnExecuteFilter)(filter);
            (f.oidnReleaseFilter)(filter);
        }
        self.check()?;
        Ok(output)
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
