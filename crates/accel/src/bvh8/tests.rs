//! What must hold of every tree, whatever it is built over.

use super::build::binary::MAX_DEPTH;
use super::layout::{self, BLOCK_UNITS, LANES, Planes, Ref};
use super::*;
use bilux_math::hash::{hash_words, unit_f32};

type Triangle = [[f32; 3]; 3];

fn number(seed: u64, i: usize) -> f32 {
    unit_f32(hash_words([seed, i as u64]) as u32)
}

fn small(i: usize) -> Triangle {
    std::array::from_fn(|c| {
        std::array::from_fn(|k| number(k as u64, i) + 0.002 * number(9, i * 9 + c * 3 + k))
    })
}

fn build(triangles: Vec<Triangle>) -> Bvh8 {
    let mesh = TriangleMesh::from_corners(triangles).expect("few triangles");
    Bvh8::new(&mesh, &BuildOptions::default()).expect("few nodes")
}

/// Checks that each child lies in its parent's box and each of `count` triangles in one leaf; returns the depth.
fn validate(tree: &Bvh8, count: usize) -> usize {
    let mut seen = vec![0; count];
    let corners = tree.corners.map(|[x, y, z, _]| [x, y, z]);
    let mut deepest = 0;
    let mut stack: Vec<(Planes, Ref, usize)> = vec![(corners, tree.root, 1)];
    let within = |outer: &Planes, inner: &Planes| {
        (0..3).all(|k| outer[0][k] <= inner[0][k] && inner[1][k] <= outer[1][k])
    };
    while let Some((planes, reference, depth)) = stack.pop() {
        deepest = deepest.max(depth);
        if reference.is_node() {
            for (inner, child) in layout::children(&tree.units[reference.unit()..]) {
                assert!(within(&planes, &inner));
                stack.push((inner, child, depth + 1));
            }
            continue;
        }
        for block in tree.units[reference.leaf_units()].chunks_exact(BLOCK_UNITS) {
            let mut last = None;
            for lane in 0..LANES {
                let (triangle, primitive) = layout::triangle(block, lane);
                assert!(triangle.iter().all(|p| within(&planes, &[*p, *p])));
                if last != Some(primitive) {
                    seen[primitive as usize] += 1;
                }
                last = Some(primitive);
            }
        }
    }
    assert!(seen.iter().all(|&times| times == 1), "a triangle is lost, or there twice");
    deepest
}

#[test]
fn trees_are_sound_and_shallow_over_what_makes_builders_slow() {
    const N: usize = 100_000;
    let equal_centres = |i: usize| {
        let r = 1.0 + number(1, i);
        [[-r, -r, -r], [r, -r, r], [0.0, r, 0.0]]
    };
    let huge = [[-1e6, -1e6, 0.5], [1e6, -1e6, 0.5], [0.0, 1e6, 0.5]];
    let far = |i: usize| small(i).map(|p| p.map(|x| x * f32::from_bits((64 + i as u32 % 128) << 23)));
    let cases: [(&str, Vec<Triangle>); 5] = [
        ("small", (0..N).map(small).collect()),
        ("copies", vec![small(7); N]),
        ("equal centres", (0..N).map(equal_centres).collect()),
        ("one huge", (0..N).map(|i| if i == 5 { huge } else { small(i) }).collect()),
        ("all scales", (0..N).map(far).collect()),
    ];
    for (name, triangles) in cases {
        let depth = validate(&build(triangles), N);
        // What the stack of the kernels has room for.
        assert!(depth <= MAX_DEPTH, "{name} is {depth} deep");
    }
}

#[test]
fn trees_do_not_depend_on_the_number_of_threads() {
    let triangles: Vec<Triangle> = (0..150_000).map(small).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| build(triangles.clone()))
    };
    let (one, three) = (with(1), with(3));
    assert!(one.root == three.root && *one.units == *three.units);
}

#[test]
fn all_levels_count_the_same_hits() {
    let tree = build((0..2000).map(small).collect());
    let mut counts = Vec::new();
    for level in CpuLevel::ALL.into_iter().filter(|&level| level <= CpuLevel::detect()) {
        let tree = Bvh8 { level, ..tree.clone() };
        let mut counters = crate::Counters::default();
        for i in 0..500 {
            let v = |j: usize| std::array::from_fn(|k| number(20 + j as u64, i * 3 + k) * 2.0 - 0.5);
            let ray = Ray::new(v(0), v(1));
            crate::Accelerator::closest_hit_counted(&tree, &ray, &Query::default(), &mut counters);
        }
        counts.push(counters);
    }
    for count in &counts {
        assert_eq!(count.rays, 500);
        // Pads differ a little between levels, and so may what is visited.
        assert!(count.nodes.abs_diff(counts[0].nodes) < counts[0].nodes / 100);
        assert!(count.nodes > 500 && count.triangles > 500);
    }
}

fn saved(tree: &Bvh8) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.save(&mut bytes).expect("memory can be written");
    bytes
}

#[test]
fn forged_trees_are_refused_or_harmless() {
    let tree = build((0..200).map(small).collect());
    let bytes = saved(&tree);
    let (mut refused, mut harmless) = (0, 0);
    for i in 0..4000u64 {
        let mut forged = bytes.clone();
        for k in 0..1 + i % 3 {
            let at = 8 + (hash_words([i, k, 0]) % (forged.len() as u64 - 8)) as usize;
            forged[at] = hash_words([i, k, 1]) as u8;
        }
        // As a forger would: with the right checksum.
        let units: Vec<layout::Unit> = forged[64..]
            .chunks_exact(32)
            .map(|unit| {
                let word = |k: usize| [unit[4 * k], unit[4 * k + 1], unit[4 * k + 2], unit[4 * k + 3]];
                layout::Unit(std::array::from_fn(|k| u32::from_le_bytes(word(k))))
            })
            .collect();
        let sum = storage::checksum(&forged[..56], &units);
        forged[56..64].copy_from_slice(&sum.to_le_bytes());
        let Ok(tree) = Bvh8::load(&*forged) else {
            refused += 1;
            continue;
        };
        harmless += 1;
        for j in 0..20 {
            let v = |n: usize| std::array::from_fn(|k| number(40 + n as u64, j * 3 + k) * 2.0 - 0.5);
            crate::Accelerator::closest_hit(&tree, &Ray::new(v(0), v(1)), &Query::default());
            crate::Accelerator::any_hit(&tree, &Ray::new(v(0), v(1)), &Query::default());
            tree.nearest_point(v(0), f32::INFINITY);
        }
    }
    assert!(refused > 100 && harmless > 100, "{refused} {harmless}");
}
