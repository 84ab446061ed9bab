//! Shares acceleration structures between repeated meshes.

use bilux_scene::{Mesh, SceneBuilder};
use std::collections::HashMap;
use std::sync::Arc;

/// Meshes whose copies would total more triangles, points and lines than this share one acceleration structure.
const MAX_COPIED: usize = 1 << 18;

/// Marks frequently repeated meshes to share one acceleration structure.
pub fn share_trees(scene: &mut SceneBuilder) {
    let mut uses: HashMap<*const Mesh, usize> = HashMap::new();
    for object in &scene.objects {
        *uses.entry(Arc::as_ptr(&object.mesh)).or_default() += 1;
    }
    for object in &mut scene.objects {
        let copies = uses[&Arc::as_ptr(&object.mesh)] - 1;
        object.instanced = copies * (object.mesh.triangles.len() + object.mesh.stroke_count()) > MAX_COPIED;
    }
}
