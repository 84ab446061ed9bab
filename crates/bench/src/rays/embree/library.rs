//! The library and its functions, found by name.

use super::layouts::{Arguments, Pointer, RayHit1, RayHits, Valid};
use bilux::Error;
use libloading::Library;
use std::ffi::{c_char, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicIsize, Ordering};

/// Called when Embree allocates or frees memory.
///
/// # Safety
/// Embree passes back the pointer that it was given for this callback.
type Monitor = unsafe extern "C" fn(Pointer, isize, bool) -> bool;

/// Declares the functions that are used, and looks them up by name.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// # Safety
        /// Each must be called as Embree's documentation says.
        #[allow(non_snake_case, reason = "as the library calls them")]
        pub(super) struct Functions { $(pub(super) $name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)* }

        impl Functions {
            fn find(library: &Library) -> Result<Functions, libloading::Error> {
                // SAFETY: each symbol has the type that Embree 4's documentation gives it.
                unsafe { Ok(Functions { $($name: *library.get(concat!(stringify!($name), "\0").as_bytes())?,)* }) }
            }
        }
    };
}

functions! {
    rtcNewDevice: fn(*const c_char) -> Pointer;
    rtcReleaseDevice: fn(Pointer);
    rtcGetDeviceError: fn(Pointer) -> u32;
    rtcGetDeviceProperty: fn(Pointer, u32) -> isize;
    rtcSetDeviceMemoryMonitorFunction: fn(Pointer, Monitor, Pointer);
    rtcNewScene: fn(Pointer) -> Pointer;
    rtcReleaseScene: fn(Pointer);
    rtcSetSceneBuildQuality: fn(Pointer, u32);
    rtcSetSceneFlags: fn(Pointer, u32);
    rtcCommitScene: fn(Pointer);
    rtcNewGeometry: fn(Pointer, u32) -> Pointer;
    rtcReleaseGeometry: fn(Pointer);
    rtcSetSharedGeometryBuffer: fn(Pointer, u32, u32, u32, *const c_void, usize, usize, usize);
    rtcSetGeometryBuildQuality: fn(Pointer, u32);
    rtcCommitGeometry: fn(Pointer);
    rtcAttachGeometry: fn(Pointer, Pointer) -> u32;
    rtcIntersect1: fn(Pointer, *mut RayHit1, *const Arguments);
    rtcOccluded1: fn(Pointer, *mut RayHit1, *const Arguments);
    rtcIntersect4: fn(*const Valid, Pointer, *mut RayHits<4>, *const Arguments);
    rtcOccluded4: fn(*const Valid, Pointer, *mut RayHits<4>, *const Arguments);
    rtcIntersect8: fn(*const Valid, Pointer, *mut RayHits<8>, *const Arguments);
    rtcOccluded8: fn(*const Valid, Pointer, *mut RayHits<8>, *const Arguments);
    rtcIntersect16: fn(*const Valid, Pointer, *mut RayHits<16>, *const Arguments);
    rtcOccluded16: fn(*const Valid, Pointer, *mut RayHits<16>, *const Arguments);
}

const PROPERTY_VERSION_MAJOR: u32 = 1;

/// The library and its device, on one thread.
pub(in crate::rays) struct Embree {
    pub(super) functions: Functions,
    pub(super) device: Pointer,
    /// The number of bytes that Embree holds.
    pub(super) held: Box<AtomicIsize>,
    /// Never unloaded: its threads outlive the device.
    _library: ManuallyDrop<Library>,
}

/// # Safety
/// See [`Monitor`]; the pointer is that of [`Embree::held`].
unsafe extern "C" fn count(held: Pointer, bytes: isize, _post: bool) -> bool {
    // SAFETY: the pointer is that of `Embree::held`, which lives as long as the device.
    unsafe { &*held.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::Relaxed);
    true
}

impl Embree {
    /// Loads the library.
    pub(in crate::rays) fn load(path: &Path) -> Result<Rc<Embree>, Error> {
        let failed = |why: String| {
            Error::Settings(format!(
                "'{}' is not Embree 4: {why}; name the library itself, such as libembree4.so.4",
                path.display()
            ))
        };
        // SAFETY: the user asked for this library's code to be run.
        let library = unsafe { Library::new(path) }.map_err(|e| failed(e.to_string()))?;
        let functions = Functions::find(&library).map_err(|e| failed(e.to_string()))?;
        // SAFETY: the configuration ends in a zero.
        let device = unsafe { (functions.rtcNewDevice)(c"threads=1".as_ptr()) };
        // SAFETY: the device was just made; the property is one that every version has.
        if device.is_null()
            || unsafe { (functions.rtcGetDeviceProperty)(device, PROPERTY_VERSION_MAJOR) } != 4
        {
            return Err(failed("it does not create a device of version 4".to_owned()));
        }
        let held = Box::new(AtomicIsize::new(0));
        let counter: Pointer = std::ptr::from_ref(&*held).cast_mut().cast();
        // SAFETY: `held` outlives the device; `count` has the required type.
        unsafe { (functions.rtcSetDeviceMemoryMonitorFunction)(device, count, counter) };
        Ok(Rc::new(Embree { functions, device, held, _library: ManuallyDrop::new(library) }))
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: scenes hold an `Rc` of this, so none is left.
        unsafe { (self.functions.rtcReleaseDevice)(self.device) }
    }
}
