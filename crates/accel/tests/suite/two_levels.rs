//! Instances found by a tree give the same hits as instances tested one by one, bit for bit.

use crate::support::{Numbers, Truth, build_variant, closed, meshes, rays, variants};
use bilux_accel::{
    Accelerator, BuildOptions, Counters, Hit, Instance, Query, Ray, TopLevel, TriangleMesh, TwoLevel,
};
use bilux_math::glam::{DMat4, Quat};
use bilux_math::{Motion, MotionKey, Transform, Vec3};
use bilux_testing::effort;
use rayon::prelude::*;
use std::sync::Arc;

const SHUTTER: [f32; 2] = [0.25, 0.75];

fn still(numbers: &mut Numbers, kind: usize) -> Motion {
    let vector = |numbers: &mut Numbers| numbers.vector().map(f64::from);
    let columns = [vector(numbers), vector(numbers), vector(numbers)];
    let by = vector(numbers).map(|x| x * 3.0);
    let [x, y, z] = match kind {
        // Sheared, often mirrored.
        0 => columns,
        // Mirrored along one axis.
        1 => [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
        // Nearly flat.
        2 => [columns[0], columns[1], columns[2].map(|x| x * 1e-4)],
        // Huge, or tiny.
        3 => columns.map(|c| c.map(|x| x * 1e4)),
        _ => columns.map(|c| c.map(|x| x * 1e-3)),
    };
    let rows = [x, y, z, by].map(|c| [c[0], c[1], c[2], 0.0]);
    let mut matrix = DMat4::from_cols_array_2d(&rows);
    matrix.w_axis.w = 1.0;
    Motion::still(Transform::from_matrix(matrix).unwrap_or_default())
}

fn moving(numbers: &mut Numbers, times: &[f32]) -> Motion {
    let keys = times.iter().map(|&time_seconds| {
        let [x, y, z] = numbers.vector();
        MotionKey {
            time_seconds,
            translation: Vec3::from(numbers.vector()) * 3.0,
            rotation: Quat::from_xyzw(x, y, z, numbers.unit() + 0.01),
            scale: Vec3::from(numbers.vector()).abs() + Vec3::splat(0.1),
        }
    });
    Motion::from_keys(keys.collect()).expect("sound keys")
}

fn motion(numbers: &mut Numbers) -> Motion {
    match numbers.below(9) {
        0 => Motion::still(Transform::IDENTITY),
        // Moves, but not while the shutter is open.
        1 => moving(numbers, &[1.0, 2.0]),
        2 => moving(numbers, &[0.0, 1.0]),
        3 => moving(numbers, &[0.3, 0.4, 0.7]),
        kind => still(numbers, kind - 4),
    }
}

/// Rays at the world's own scale and at that of its contents, at any time.
fn world_rays(around: &TriangleMesh, seed: u64) -> Vec<Ray> {
    let mut numbers = Numbers::new(seed + 500);
    let mut rays = rays::nasty(around, 120, seed);
    for ray in &mut rays {
        ray.time = numbers.unit() * 1.5 - 0.25;
    }
    rays.extend([f32::NAN, f32::NEG_INFINITY, f32::INFINITY].map(|time| Ray { time, ..rays[5] }));
    rays
}

#[test]
fn both_top_levels_give_the_same_hits_over_every_structure() {
    let chosen = ["one", "random", "grid", "not numbers", "empty", "random far away"];
    let shapes: Vec<_> = meshes::all().into_iter().filter(|(name, _)| chosen.contains(name)).collect();
    let shapes: Vec<_> = shapes.into_iter().map(|(_, mesh)| Arc::new(mesh)).collect();
    for seed in 0..effort(2, 4) {
        let mut numbers = Numbers::new(seed);
        let parts: Vec<_> = (0..24).map(|_| (numbers.below(shapes.len()), motion(&mut numbers))).collect();
        let world = |accelerator: &str, options: &BuildOptions, top| {
            let built: Vec<_> = shapes.iter().map(|mesh| build_variant(accelerator, options, mesh)).collect();
            let place = |(shape, motion): &(usize, Motion)| Instance {
                mask: u32::MAX,
                accelerator: Arc::clone(&built[*shape]),
                motion: motion.clone(),
            };
            TwoLevel::new(&parts.iter().map(place).collect::<Vec<_>>(), SHUTTER, top)
        };
        let list = world("brute", &BuildOptions::default(), TopLevel::List);
        let around = &shapes[1 + seed as usize % 2];
        let truth = Truth::new(&list, &world_rays(around, seed));
        assert!(truth.hits() > 100, "only {} hits", truth.hits());
        let tops = [TopLevel::List, TopLevel::Bvh];
        variants().par_iter().enumerate().filter(|(_, (_, name, _))| !name.starts_with("brute")).for_each(
            |(index, (name, accelerator, options))| {
                // In the short form each of the two over half of the structures, and over the other half with the next seed.
                let first = (index + seed as usize) % 2;
                for &top in &tops[effort(first..first + 1, 0..2)] {
                    let found = truth.differences(&world(accelerator, options, top));
                    assert!(
                        found.is_empty(),
                        "{name} {top:?}: {} differ, first {:#?}",
                        found.len(),
                        found[0]
                    );
                }
            },
        );
    }
}

#[test]
fn an_identity_transform_changes_no_bit() {
    let mesh = Arc::new(meshes::all().swap_remove(3).1);
    let brute = build_variant("brute", &BuildOptions::default(), &mesh);
    let truth = Truth::new(brute.as_ref(), &rays::nasty(&mesh, 500, 1));
    for top in [TopLevel::List, TopLevel::Bvh] {
        let motion = Motion::still(Transform::IDENTITY);
        let world = TwoLevel::new(&[Instance::new(brute.clone(), motion)], SHUTTER, top);
        assert!(truth.differences(&world).is_empty());
    }
}

/// Filters are asked about hits of the instance that the ray meets, for every kind of query.
#[test]
fn filters_know_which_instance_is_hit() {
    let mesh = Arc::new(closed::all().iter().find(|c| c.name == "sphere").expect("it is there").mesh());
    let place = |x: f64| {
        Motion::still(Transform::from_matrix(DMat4::from_translation([x, 0.0, 0.0].into())).unwrap())
    };
    for (accelerator, top) in [("bvh8", TopLevel::List), ("bvh8", TopLevel::Bvh), ("bsp", TopLevel::Bvh)] {
        let tree = build_variant(accelerator, &BuildOptions::default(), &mesh);
        let parts: Vec<_> = [0.0, 5.0, 10.0].map(|x| Instance::new(tree.clone(), place(x))).into();
        let world = TwoLevel::new(&parts, SHUTTER, top);
        let above = |x: f32| Ray::new([x + 0.1, 9.0, -0.2], [0.0, -1.0, 0.0]);
        for wanted in 0..3 {
            let only = |hit: &Hit| hit.instance == wanted;
            let query = Query { filter: Some(&only), ..Query::default() };
            for (i, x) in [0.0, 5.0, 10.0].into_iter().enumerate() {
                let is_seen = i as u32 == wanted;
                assert_eq!(
                    world.closest_hit(&above(x), &query).is_some(),
                    is_seen,
                    "{accelerator} {top:?} {i}"
                );
                assert_eq!(world.any_hit(&above(x), &query), is_seen, "{accelerator} {top:?} {i}");
                let mut counters = Counters::default();
                assert_eq!(world.any_hit_counted(&above(x), &query, &mut counters), is_seen);
                assert_eq!(world.all_hits(&above(x), &query).len(), if is_seen { 2 } else { 0 });
            }
        }
    }
}

#[test]
fn a_billion_triangles_take_a_few_hundred_megabytes() {
    const SIDE: usize = 390;
    let mesh = Arc::new(closed::all().iter().find(|c| c.name == "sphere").expect("it is there").mesh());
    let tree = build_variant("bvh8", &BuildOptions::default(), &mesh);
    let place = |i: usize| [(i % SIDE) as f64 * 3.0, 0.0, (i / SIDE) as f64 * 3.0];
    let instance = |i: usize| {
        let matrix = DMat4::from_translation(place(i).into());
        Instance::new(tree.clone(), Motion::still(Transform::from_matrix(matrix).expect("a shift")))
    };
    let world = TwoLevel::new(&(0..SIDE * SIDE).map(instance).collect::<Vec<_>>(), SHUTTER, TopLevel::Bvh);
    let triangles = mesh.len() * world.len();
    assert!(triangles > 1_000_000_000, "{triangles}");
    assert!(world.memory_bytes() < 300_000_000, "{}", world.memory_bytes());
    let mut numbers = Numbers::new(11);
    for _ in 0..2000 {
        let i = numbers.below(world.len());
        let [x, _, z] = place(i).map(|x| x as f32);
        let above = |y: f32| Ray::new([x + 0.1, y, z - 0.2], [0.0, -1.0, 0.0]);
        let hit = world.closest_hit(&above(9.0), &Query::default()).expect("a sphere");
        assert_eq!(hit.instance as usize, i);
        assert!((hit.t - 8.0253).abs() < 0.01, "{hit:?}");
    }
}
