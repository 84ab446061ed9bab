//! The examples run, and their assertions hold.

#[path = "../../examples/ambient_occlusion.rs"]
mod ambient_occlusion;
#[path = "../../examples/moving.rs"]
mod moving;
#[path = "../../examples/pick.rs"]
mod pick;

#[test]
fn every_example_runs() {
    pick::main().unwrap();
    ambient_occlusion::main().unwrap();
    moving::main().unwrap();
}

#[test]
fn a_hit_knows_its_point_and_its_normal_and_has_no_negative_zero() {
    use bilux_accel::{ACCELERATORS, BuildOptions, Query, Ray, TriangleMesh, build};
    use std::sync::Arc;
    let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
    let mesh = Arc::new(TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap());
    for row in ACCELERATORS {
        let tree = build(row.entry.name, mesh.clone(), &BuildOptions::default()).unwrap();
        // On the edges and at the corners, from both sides.
        for (x, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (2.0, 0.0), (0.0, 2.0), (0.5, 0.5)] {
            for y in [4.0f32, -4.0] {
                let ray = Ray::new([x, y, z], [0.0, -y.signum(), 0.0]);
                let hit = tree.closest_hit(&ray, &Query::default()).unwrap();
                assert_eq!((hit.point(&ray), hit.normal(&mesh)), ([x, 0.0, z], [0.0, -1.0, 0.0]));
                let mut batch = [None];
                tree.closest_hits(&[ray], &Query::default(), &mut batch);
                for hit in [hit, batch[0].unwrap(), tree.all_hits(&ray, &Query::default())[0]] {
                    let signs = [hit.t, hit.u, hit.v].map(f32::is_sign_negative);
                    assert_eq!(signs, [false; 3], "{}: {hit:?}", row.entry.name);
                }
            }
        }
    }
}
