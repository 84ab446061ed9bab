//! Meshes on bones that Maya moves by their node once more.

use super::obj::{Corner, Truth};
use bilux_math::glam::DVec4;
use bilux_math::{DMat4, DVec3};
use bilux_scene::{Object, SceneBuilder};

/// True if each mesh is where the truth has it after one affine transform, which is found by the middles of all faces.
pub(super) fn is_moved_again(scene: &SceneBuilder, truth: &Truth) -> bool {
    let (mut face, mut start) = (0, 0);
    scene.objects.iter().all(|object| {
        let (mut ours, mut theirs): (Vec<Vec<DVec3>>, Vec<&[Corner]>) = (Vec::new(), Vec::new());
        let mut triangle = 0;
        while triangle < object.mesh.triangles.len() {
            let Some(&end) = truth.ends.get(face) else { return false };
            let corners = &truth.corners[start..end];
            let after = triangle + corners.len().saturating_sub(2);
            ours.push(points(object, triangle, after));
            theirs.push(corners);
            (triangle, face, start) = (after, face + 1, end);
        }
        let Some(matrix) = fitted(&ours, &theirs) else { return false };
        let is_there = |(points, corners): (&Vec<DVec3>, &&[Corner])| {
            let near = |corner: &Corner| {
                points.iter().any(|p| matrix.transform_point3(*p).distance(corner.p) <= truth.tolerance)
            };
            corners.iter().all(near)
        };
        ours.iter().zip(&theirs).all(is_there)
    }) && face == truth.ends.len()
}

/// The points of some triangles of an object, each once.
fn points(object: &Object, from: usize, to: usize) -> Vec<DVec3> {
    let mut points: Vec<DVec3> = Vec::new();
    for &i in object.mesh.triangles[from..to.min(object.mesh.triangles.len())].iter().flatten() {
        let p = object.motion.at(0.0).point(object.mesh.positions[i as usize]).as_dvec3();
        if !points.contains(&p) {
            points.push(p);
        }
    }
    points
}

/// The affine transform of the least squares from the middles of these faces to those of the others.
fn fitted(ours: &[Vec<DVec3>], theirs: &[&[Corner]]) -> Option<DMat4> {
    let zero = || DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
    let outer = |a: DVec4, b: DVec4| DMat4::from_cols(a * b.x, a * b.y, a * b.z, a * b.w);
    let (mut from, mut to) = (zero(), zero());
    for (points, corners) in ours.iter().zip(theirs) {
        let a = (points.iter().sum::<DVec3>() / points.len() as f64).extend(1.0);
        let b = (corners.iter().map(|corner| corner.p).sum::<DVec3>() / corners.len() as f64).extend(1.0);
        from += outer(a, a);
        to += outer(b, a);
    }
    let matrix = to * from.inverse();
    matrix.is_finite().then_some(matrix)
}
