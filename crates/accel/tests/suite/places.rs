//! Queries on a tree other than ray queries, and trees as files.

use crate::support::{Numbers, bits, closed, meshes, rays};
use bilux_accel::bvh8::{NearestPoint, StorageError};
use bilux_accel::{Accelerator, BuildOptions, Bvh8, Query, TriangleMesh};
use bilux_math::glam::DVec3;
use std::fs;

fn tree(mesh: &TriangleMesh) -> Bvh8 {
    Bvh8::new(mesh, &BuildOptions::default()).expect("a small mesh")
}

fn of(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// Walks downhill over a triangle in many small steps of its weights: slow, and independent of the library's method.
fn distance_by_search(at: DVec3, triangle: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = triangle.map(of);
    let distance = |u: f64, v: f64| at.distance(a + (b - a) * u + (c - a) * v);
    let (mut u, mut v, mut step) = (1.0 / 3.0, 1.0 / 3.0, 0.25);
    while step > 1e-9 {
        let around = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step), (step, -step), (-step, step)];
        let better = around
            .iter()
            .map(|(du, dv)| (u + du, v + dv))
            .filter(|(u, v)| *u >= 0.0 && *v >= 0.0 && u + v <= 1.0)
            .min_by(|p, q| distance(p.0, p.1).total_cmp(&distance(q.0, q.1)))
            .filter(|p| distance(p.0, p.1) < distance(u, v));
        match better {
            Some(p) => (u, v) = p,
            None => step *= 0.5,
        }
    }
    distance(u, v)
}

#[test]
fn the_nearest_point_is_the_nearest_of_all_triangles() {
    let mut numbers = Numbers::new(7);
    let triangles: Vec<[[f32; 3]; 3]> = (0..150)
        .map(|_| {
            let at = numbers.vector();
            std::array::from_fn(|_| {
                let step = numbers.vector();
                std::array::from_fn(|k| at[k] + 0.2 * step[k])
            })
        })
        .collect();
    let mesh = TriangleMesh::from_corners(triangles.clone()).expect("few");
    let tree = tree(&mesh);
    for _ in 0..60 {
        let point = numbers.vector().map(|x| 1.5 * x);
        let NearestPoint { distance, point: found, u, v, primitive } =
            tree.nearest_point(point, f32::INFINITY).expect("there are triangles");
        let searched =
            triangles.iter().map(|t| distance_by_search(of(point), t)).fold(f64::INFINITY, f64::min);
        assert!((f64::from(distance) - searched).abs() < 1e-5, "{distance} {searched}");
        assert!((of(found).distance(of(point)) - f64::from(distance)).abs() < 1e-5);
        let [a, b, c] = triangles[primitive as usize].map(of);
        assert!((a + (b - a) * f64::from(u) + (c - a) * f64::from(v)).distance(of(found)) < 1e-5);
        assert_eq!(tree.nearest_point(point, distance * 0.999), None);
        assert_eq!(tree.clearance(point, f32::INFINITY), distance);
        assert_eq!(tree.clearance(point, distance * 0.999), distance * 0.999);
        assert!(tree.nearest_point(point, distance * 1.001).is_some());
    }
    assert_eq!(tree.nearest_point([f32::NAN; 3], f32::INFINITY), None);
    assert_eq!(tree.clearance([f32::NAN; 3], 2.0), 2.0);
    assert_eq!(tree.nearest_point([0.0; 3], f32::NAN), None);
}

#[test]
fn a_point_of_a_triangle_is_its_own_nearest_point_on_every_nasty_mesh() {
    for (name, mesh) in meshes::all() {
        let tree = tree(&mesh);
        for triangle in
            mesh.triangles().iter().filter(|t| t.iter().flatten().all(|x| x.is_finite())).take(200)
        {
            let nearest = tree.nearest_point(triangle[1], f32::INFINITY).expect("there are triangles");
            assert_eq!(nearest.distance, 0.0, "{name}: {triangle:?}");
        }
    }
}

#[test]
fn overlapping_finds_the_triangles_inside_and_across_a_box() {
    for (name, mesh) in meshes::all() {
        let tree = tree(&mesh);
        let mut numbers = Numbers::new(3);
        for _ in 0..40 {
            let Some(some) = mesh.triangles().get(numbers.below(mesh.len())) else { continue };
            if some.iter().flatten().any(|x| !x.is_finite()) {
                continue;
            }
            let size = numbers.unit() * some[0].iter().fold(1e-3f32, |size, x| size.max(x.abs()));
            let (low, high) = (some[0].map(|x| x - size), some[1].map(|x| x + size));
            let found = tree.overlapping(low, high);
            let is_sorted = found.windows(2).all(|pair| pair[0] < pair[1]);
            assert!(is_sorted, "{name}");
            for (index, triangle) in mesh.triangles().iter().enumerate() {
                let inside = |p: &[f32; 3]| (0..3).all(|k| p[k] >= low[k] && p[k] <= high[k]);
                let beside = (0..3).any(|k| {
                    triangle.iter().all(|p| p[k] > high[k]) || triangle.iter().all(|p| p[k] < low[k])
                });
                let named = found.binary_search(&(index as u32)).is_ok();
                let finite = triangle.iter().flatten().all(|x| x.is_finite());
                assert!(named || !finite || !triangle.iter().any(inside), "{name} leaves out {index}");
                assert!(!named || !beside, "{name} names {index}");
            }
        }
        assert!(tree.overlapping([1.0; 3], [-1.0; 3]).is_empty(), "{name}: a box inside out holds nothing");
    }
    // Passes a corner of the box without touching it.
    let slanted = vec![[[2.2, 0.0, 0.0], [0.0, 2.2, 0.0], [0.0, 2.2, 5.0]]];
    let tree = tree(&TriangleMesh::from_corners(slanted).expect("one"));
    assert!(tree.overlapping([-1.0; 3], [1.0; 3]).is_empty());
    assert_eq!(tree.overlapping([-1.0; 3], [1.2; 3]), [0]);
}

#[test]
fn a_tree_that_was_saved_gives_the_same_hits_loaded_and_mapped() {
    let folder = tempfile::tempdir().expect("a folder");
    for (seed, (name, mesh)) in meshes::all().into_iter().enumerate() {
        let tree = tree(&mesh);
        let path = folder.path().join(format!("{seed}.bvh8"));
        tree.save(fs::File::create(&path).expect("a file")).expect("saved");
        let loaded = Bvh8::load(fs::File::open(&path).expect("a file")).expect("loaded");
        let mapped = map(&path).expect("mapped");
        for ray in rays::nasty(&mesh, 100, seed as u64) {
            let truth = bits(tree.closest_hit(&ray, &Query::default()));
            for other in [&loaded, &mapped] {
                assert_eq!(bits(other.closest_hit(&ray, &Query::default())), truth, "{name}");
            }
        }
        assert_eq!(loaded.memory_bytes(), tree.memory_bytes());
    }
}

#[allow(unsafe_code, reason = "the test is alone with its file")]
fn map(path: &std::path::Path) -> Result<Bvh8, StorageError> {
    // SAFETY: no other process knows the file.
    unsafe { Bvh8::map(path) }
}

#[test]
fn damaged_trees_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = closed::all()[0].mesh();
    let mut bytes = Vec::new();
    tree(&mesh).save(&mut bytes).expect("saved");
    let refuses = |bytes: &[u8]| {
        let path = folder.path().join("tree.bvh8");
        fs::write(&path, bytes).expect("written");
        let (loaded, mapped) = (Bvh8::load(bytes), map(&path));
        assert!(loaded.is_err() && mapped.is_err());
        loaded.err().map(|e| e.to_string()).unwrap_or_default()
    };
    for len in (0..bytes.len()).step_by(97) {
        refuses(&bytes[..len]);
    }
    for at in (0..bytes.len()).step_by(61) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 16;
        refuses(&damaged);
    }
    let expected = bytes.len();
    assert!(
        refuses(&bytes[..expected - 5])
            .contains(&format!("has {} bytes, but its header says {expected}", expected - 5))
    );
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(refuses(&longer).contains("bytes"));
    assert!(
        refuses(b"ply and so on, which is longer than a header of sixty-four bytes....").contains("BILUXBV8")
    );
    let mut promising = bytes.clone();
    promising[16..24].copy_from_slice(&u64::MAX.to_le_bytes());
    refuses(&promising);
}
