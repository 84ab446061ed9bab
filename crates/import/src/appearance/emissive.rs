//! Shapes that emit light.

use bilux_math::{DMat4, Vec3};
use bilux_scene::Mesh;
use std::sync::Arc;

/// The scale of a matrix, if it is uniform.
pub fn uniform_scale(matrix: &DMat4) -> Option<f64> {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate());
    let scale = x.length();
    let off = [
        x.dot(y),
        y.dot(z),
        z.dot(x),
        x.length_squared() - y.length_squared(),
        x.length_squared() - z.length_squared(),
    ];
    (scale > 0.0 && off.iter().all(|o| o.abs() < 1e-5 * scale * scale)).then_some(scale)
}

/// A copy of a mesh whose triangles are counter-clockwise as seen from the side of their normals, from which it
/// emits.
pub fn fronted(mesh: &Arc<Mesh>) -> Arc<Mesh> {
    if mesh.normals.is_empty() {
        return mesh.clone();
    }
    let turned = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let normal: Vec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
        (b - a).cross(c - a).dot(normal) < 0.0
    };
    if !mesh.triangles.iter().any(turned) {
        return mesh.clone();
    }
    let mut front = (**mesh).clone();
    for t in &mut front.triangles {
        if turned(t) {
            t.swap(1, 2);
        }
    }
    Arc::new(front)
}
