//! A tree that Embree builds over a mesh.

use super::layouts::Pointer;
use super::library::Embree;
use crate::rays::files::indexed;
use bilux::Error;
use bilux::accel::TriangleMesh;
use std::rc::Rc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Constants for `rtcSetSharedGeometryBuffer`.
const BUFFER_INDEX: u32 = 0;
const BUFFER_VERTEX: u32 = 1;
const FORMAT_UINT3: u32 = 0x5003;
const FORMAT_FLOAT3: u32 = 0x9003;
const GEOMETRY_TRIANGLE: u32 = 0;
const FLAG_ROBUST: u32 = 1 << 2;

/// Build configuration of a tree.
#[derive(Clone, Copy)]
pub(in crate::rays) struct Kind {
    pub(in crate::rays) name: &'static str,
    quality: u32,
    robust: bool,
}

/// Every build configuration in the comparison.
pub(in crate::rays) const KINDS: [Kind; 4] = [
    Kind { name: "embree", quality: 1, robust: false },
    Kind { name: "embree-high", quality: 2, robust: false },
    Kind { name: "embree-robust", quality: 1, robust: true },
    Kind { name: "embree-high-robust", quality: 2, robust: true },
];

/// A tree over a mesh.
pub(in crate::rays) struct Tree {
    pub(super) embree: Rc<Embree>,
    pub(super) scene: Pointer,
    pub(in crate::rays) build_seconds: f64,
    pub(in crate::rays) bytes: usize,
    // The memory that the geometry's buffers point to.
    _positions: Vec<[f32; 3]>,
    _indices: Vec<[u32; 3]>,
}

impl Tree {
    /// Builds a tree. Bitwise identical vertices are merged, since meshes usually come indexed; that is not timed.
    pub(in crate::rays) fn build(
        embree: &Rc<Embree>,
        kind: Kind,
        mesh: &TriangleMesh,
    ) -> Result<Tree, Error> {
        let (mut positions, indices) = indexed(mesh);
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
