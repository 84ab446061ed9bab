//! Embree 4, loaded at run time from a shared library that the user names. Its C interface is declared here following
//! its public documentation; nothing of it is linked.
#![allow(unsafe_code, reason = "a C library is loaded and called")]

use super::engines::{Answers, Engine};
use super::{Batch, Mode};
use bilux::Error;
use bilux::accel::{Hit, Ray, TriangleMesh};
use libloading::Library;
use std::ffi::{c_char, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr::{null, null_mut};
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
    rtcIntersect16: fn(*const Valid, Pointer, *mut RayHit16, *const Arguments);
    rtcOccluded16: fn(*const Valid, Pointer, *mut RayHit16, *const Arguments);
}

/// Constants for `rtcSetSharedGeometryBuffer`.
const BUFFER_INDEX: u32 = 0;
const BUFFER_VERTEX: u32 = 1;
const FORMAT_UINT3: u32 = 0x5003;
const FORMAT_FLOAT3: u32 = 0x9003;
const GEOMETRY_TRIANGLE: u32 = 0;
const FLAG_ROBUST: u32 = 1 << 2;
const FLAG_COHERENT: u32 = 1 << 16;
const PROPERTY_VERSION_MAJOR: u32 = 1;
const INVALID: u32 = u32::MAX;

/// `RTCRayHit`: a ray and its hit, with room for what later versions append.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RayHit1 {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instances: [u32; 5],
}

/// `RTCRayHit16`: the same for sixteen rays, field by field.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct RayHit16 {
    origin: [[f32; 16]; 3],
    t_near: [f32; 16],
    direction: [[f32; 16]; 3],
    time: [f32; 16],
    t_far: [f32; 16],
    mask: [u32; 16],
    id: [u32; 16],
    flags: [u32; 16],
    normal: [[f32; 16]; 3],
    u: [f32; 16],
    v: [f32; 16],
    primitive: [u32; 16],
    geometry: [u32; 16],
    instances: [[u32; 16]; 2],
}

#[repr(C, align(64))]
struct Valid([i32; 16]);

/// `RTCIntersectArguments`, which has the same layout as `RTCOccludedArguments` except for the type of its last
/// function.
#[repr(C)]
struct Arguments {
    flags: u32,
    features: u32,
    context: Pointer,
    filter: Pointer,
    query: Pointer,
    reserved: [usize; 2],
}

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
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: scenes hold an `Rc` of this, so none is left.
        unsafe { (self.functions.rtcReleaseDevice)(self.device) }
    }
}

// Embree requires these layouts; otherwise it would read past the end.
const _: () = assert!(size_of::<RayHit1>() == 96 && align_of::<RayHit1>() == 16);
const _: () = assert!(size_of::<RayHit16>() == 21 * 64 && align_of::<RayHit16>() == 64);

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

/// How rays are passed to Embree.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Packets {
    One,
    Sixteen,
    Coherent,
}

/// A tree together with one way of tracing rays through it.
pub(super) struct EmbreeEngine {
    pub(super) tree: Rc<Tree>,
    pub(super) packets: Packets,
}

impl Engine for EmbreeEngine {
    fn mode(&self) -> Mode {
        if self.packets == Packets::One { Mode::Single } else { Mode::Batch }
    }

    fn build_seconds(&self) -> f64 {
        self.tree.build_seconds
    }

    fn bytes(&self) -> usize {
        self.tree.bytes
    }

    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        match self.packets {
            Packets::One => self.singly(batch, answers),
            _ => self.in_packets(batch, answers),
        }
    }
}

impl EmbreeEngine {
    fn arguments(&self) -> Arguments {
        Arguments {
            flags: if self.packets == Packets::Coherent { FLAG_COHERENT } else { 0 },
            features: u32::MAX,
            context: null_mut(),
            filter: null_mut(),
            query: null_mut(),
            reserved: [0; 2],
        }
    }

    fn singly(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        let mut rays: Vec<RayHit1> = batch.rays.iter().map(RayHit1::new).collect();
        let (f, scene) = (&self.tree.embree.functions, self.tree.scene);
        let begun = Instant::now();
        let query = if batch.any { f.rtcOccluded1 } else { f.rtcIntersect1 };
        for ray in &mut rays {
            // SAFETY: the scene is committed, the ray has the required layout and alignment, and null selects default
            // arguments.
            unsafe { query(scene, ray, null()) };
        }
        let seconds = begun.elapsed().as_secs_f64();
        if let Some(answers) = answers {
            answers.fill(batch.any, rays.iter().map(RayHit1::hit));
        }
        seconds
    }

    fn in_packets(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        let mut packets: Vec<RayHit16> = batch.rays.chunks(16).map(RayHit16::new).collect();
        let (f, scene, arguments) = (&self.tree.embree.functions, self.tree.scene, self.arguments());
        let valid = Valid([-1; 16]);
        let begun = Instant::now();
        let query = if batch.any { f.rtcOccluded16 } else { f.rtcIntersect16 };
        for packet in &mut packets {
            // SAFETY: as above; the sixteen flags and the arguments live until the call returns.
            unsafe { query(&valid, scene, packet, &arguments) };
        }
        let seconds = begun.elapsed().as_secs_f64();
        if let Some(answers) = answers {
            let hits = packets.iter().flat_map(|packet| (0..16).map(|lane| packet.hit(lane)));
            answers.fill(batch.any, hits.take(batch.rays.len()));
        }
        seconds
    }
}

impl RayHit1 {
    fn new(ray: &Ray) -> RayHit1 {
        RayHit1 {
            origin: ray.origin,
            t_near: ray.t_min,
            direction: ray.direction,
            time: 0.0,
            t_far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: INVALID,
            geometry: INVALID,
            instances: [INVALID; 5],
        }
    }

    /// For any-hit queries, only whether there is a hit: Embree then sets the ray's end to minus infinity.
    fn hit(&self) -> Option<Hit> {
        let is_hit = self.geometry != INVALID || self.t_far == f32::NEG_INFINITY;
        let (t, u, v, primitive) = (self.t_far, self.u, self.v, self.primitive);
        is_hit.then_some(Hit { t, u, v, primitive, instance: 0 })
    }
}

impl RayHit16 {
    /// A packet of up to sixteen rays; the last one fills the remaining lanes.
    fn new(rays: &[Ray]) -> RayHit16 {
        let ray = |lane: usize| &rays[lane.min(rays.len() - 1)];
        let each = |value: &dyn Fn(&Ray) -> f32| std::array::from_fn(|lane| value(ray(lane)));
        RayHit16 {
            origin: std::array::from_fn(|axis| each(&|ray| ray.origin[axis])),
            t_near: each(&|ray| ray.t_min),
            direction: std::array::from_fn(|axis| each(&|ray| ray.direction[axis])),
            time: [0.0; 16],
            t_far: each(&|ray| ray.t_max),
            mask: [u32::MAX; 16],
            id: [0; 16],
            flags: [0; 16],
            normal: [[0.0; 16]; 3],
            u: [0.0; 16],
            v: [0.0; 16],
            primitive: [INVALID; 16],
            geometry: [INVALID; 16],
            instances: [[INVALID; 16]; 2],
        }
    }

    fn hit(&self, lane: usize) -> Option<Hit> {
        let is_hit = self.geometry[lane] != INVALID || self.t_far[lane] == f32::NEG_INFINITY;
        let (t, u, v, primitive) = (self.t_far[lane], self.u[lane], self.v[lane], self.primitive[lane]);
        is_hit.then_some(Hit { t, u, v, primitive, instance: 0 })
    }
}
