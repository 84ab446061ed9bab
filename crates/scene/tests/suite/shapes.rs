//! Elementary shapes are closed, face outwards, and have the volume that they should.

use bilux_math::{Aabb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_testing::solids;

#[test]
fn shapes_are_closed_and_face_outwards() {
    let centre = Vec3::new(0.3, -1.0, 2.0);
    let box_bounds = Aabb { min: centre - Vec3::ONE, max: centre + Vec3::new(1.0, 2.0, 3.0) };
    let sphere = 4.0 / 3.0 * std::f64::consts::PI;
    let ring = 2.0 * std::f64::consts::PI * std::f64::consts::PI * 2.0 * 0.25;
    let lumpy = |d: Vec3| 1.0 + 0.3 * (d.x * d.y - d.z * d.z);
    for (mesh, wanted, tolerance) in [
        (shapes::cuboid(box_bounds), 24.0, 1e-6),
        (shapes::icosphere(centre, 1.0, 4), sphere, 0.01),
        (shapes::uv_sphere(centre, 1.0, 48, 24), sphere, 0.02),
        (shapes::torus(centre, 2.0, 0.5, 64, 32), ring, 0.02),
        (shapes::blob(centre, 4, lumpy), sphere * 0.75, 0.3),
    ] {
        assert_eq!(solids::open_edges(&mesh.positions, &mesh.triangles), 0, "{}", mesh.name);
        let found = solids::volume(&mesh.positions, &mesh.triangles);
        assert!((found / wanted - 1.0).abs() < tolerance, "{}: {found} for {wanted}", mesh.name);
        if !mesh.normals.is_empty() {
            let agreement = solids::least_agreement(&mesh.positions, &mesh.normals, &mesh.triangles);
            assert!(agreement > 0.8, "{}", mesh.name);
        }
    }
    assert_eq!(shapes::icosphere(centre, 1.0, 3).triangles.len(), 20 * 64);
    let boards = shapes::chessboard(Vec3::ZERO, 8.0, 8);
    assert!(boards.iter().all(|b| b.triangles.len() == 64));
    assert_eq!(boards[0].bounds().extent(), Vec3::new(8.0, 0.0, 8.0));
}
