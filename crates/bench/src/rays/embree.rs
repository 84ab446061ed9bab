//! Embree 4, loaded at run time from a shared library that the user names. Its C interface is declared here following
//! its public documentation; nothing of it is linked.
#![allow(unsafe_code, reason = "a C library is loaded and called")]

mod packets;

pub(super) use packets::{EmbreeEngine, Packets};

use bilux::Error;
use bilux::accel::TriangleMesh;
use libloading::Library;
use packets::{Arguments, RayHit1, RayHits, Valid};
use std::ffi::{c_char, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::time::Instant;

type Pointer = *mut c_void;
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
        struct Functions { $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)* }

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

/// Constants for `rtcSetSharedGeometryBuffer`.
const BUFFER_INDEX: u32 = 0;
const BUFFER_VERTEX: u32 = 1;
const FORMAT_UINT3: u32 = 0x5003;
const FORMAT_FLOAT3: u32 = 0x9003;
const GEOMETRY_TRIANGLE: u32 = 0;
const FLAG_ROBUST: u32 = 1 << 2;
const PROPERTY_VERSION_MAJOR: u32 = 1;
/// Packets of four, eight and sixteen rays are native.
const PROPERTIES_NATIVE: [(usize, u32); 3] = [(4, 32), (8, 33), (16, 34)];

/// The library and its device, on one thread.
pub(super) struct Embree {
    functions: Functions,
    device: Pointer,
    /// The number of bytes that Embree holds.
    held: Box<AtomicIsize>,
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
    pub(super) fn load(path: &Path) -> Result<Rc<Embree>, Error> {
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

    /// How rays can be passed to it on this machine: one by one, in packets of each width that it traces as such (it
    /// takes others apart), and in the widest of them as coherent rays.
    pub(super) fn ways(&self) -> Vec<Packets> {
        // SAFETY: the device lives as long as `self`; version 4 has these properties.
        let is_native =
            |property| unsafe { (self.functions.rtcGetDeviceProperty)(self.device, property) } != 0;
        let native = PROPERTIES_NATIVE.iter().filter(|(_, property)| is_native(*property));
        let widths: Vec<usize> = native.map(|&(width, _)| width).collect();
        let of_width = widths.iter().map(|&width| Packets { width, coherent: false });
        let coherent = widths.last().map(|&width| Packets { width, coherent: true });
        [Packets::ONE].into_iter().chain(of_width).chain(coherent).collect()
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: scenes hold an `Rc` of this, so none is left.
        unsafe { (self.functions.rtcReleaseDevice)(self.device) }
    }
}

/// How a tree is built.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    quality: u32,
    robust: bool,
}

/// Every build configuration in the comparison.
pub(super) const KINDS: [Kind; 4] = [
    Kind { name: "embree", quality: 1, robust: false },
    Kind { name: "embree-high", quality: 2, robust: false },
    Kind { name: "embree-robust", quality: 1, robust: true },
    Kind { name: "embree-high-robust", quality: 2, robust: true },
];

/// A tree over a mesh.
pub(super) struct Tree {
    embree: Rc<Embree>,
    scene: Pointer,
    pub(super) build_seconds: f64,
    pub(super) bytes: usize,
    // The memory that the geometry's buffers point to.
    _positions: Vec<[f32; 3]>,
    _indices: Vec<[u32; 3]>,
}

impl Tree {
    /// Builds a tree. Bitwise identical vertices are merged, since meshes usually come indexed; that is not timed.
    pub(super) fn build(embree: &Rc<Embree>, kind: Kind, mesh: &TriangleMesh) -> Result<Tree, Error> {
        let (mut positions, indices) = super::files::indexed(mesh);
        let (vertices, f) = (positions.len(), &embree.functions);
        // Embree reads sixteen bytes for the last vertex.
        positions.push([0.0; 3]);
        let before = embree.held.load(Ordering::Relaxed);
        let begun = Instant::now();
        // SAFETY: handles are used as documented; both buffers live as long as the tree, with the required padding
        // after the last vertex, and every index is less than `vertices`.
        let (scene, error) = unsafe {
            let scene = (f.rtcNewScene)(embree.device);
            (f.rtcSetSceneBuildQuality)(scene, kind.quality);
            (f.rtcSetSceneFlags)(scene, if kind.robust { FLAG_ROBUST } else { 0 });
            let geometry = (f.rtcNewGeometry)(embree.device, GEOMETRY_TRIANGLE);
            (f.rtcSetGeometryBuildQuality)(geometry, kind.quality);
            let set = f.rtcSetSharedGeometryBuffer;
            set(geometry, BUFFER_VERTEX, 0, FORMAT_FLOAT3, positions.as_ptr().cast(), 0, 12, vertices);
            set(geometry, BUFFER_INDEX, 0, FORMAT_UINT3, indices.as_ptr().cast(), 0, 12, indices.len());
            (f.rtcCommitGeometry)(geometry);
            (f.rtcAttachGeometry)(scene, geometry);
            (f.rtcReleaseGeometry)(geometry);
            (f.rtcCommitScene)(scene);
            (scene, (f.rtcGetDeviceError)(embree.device))
        };
        let build_seconds = begun.elapsed().as_secs_f64();
        let bytes = (embree.held.load(Ordering::Relaxed) - before).max(0) as usize;
        let (embree, _positions, _indices) = (embree.clone(), positions, indices);
        let tree = Tree { embree, scene, build_seconds, bytes, _positions, _indices };
        if error == 0 {
            Ok(tree)
        } else {
            Err(Error::Settings(format!("Embree fails with its error {error}")))
        }
    }
}

impl Drop for Tree {
    fn drop(&mut self) {
        // SAFETY: the scene is this tree's own, and released once.
        unsafe { (self.embree.functions.rtcReleaseScene)(self.scene) }
    }
}
