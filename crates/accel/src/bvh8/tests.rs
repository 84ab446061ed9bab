//! Properties that hold for every tree, whatever it is built over.

use super::build::binary::MAX_DEPTH;
use super::layout::{self, BLOCK_UNITS, Planes, Ref};
use super::*;
use crate::registry::Quality;
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

const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Balanced, Quality::Best];

fn build(triangles: &[Triangle], quality: Quality) -> Bvh8 {
    let mesh = TriangleMesh::from_corners(triangles.to_vec()).expect("few triangles");
    Bvh8::new(&mesh, &BuildOptions { quality, ..BuildOptions::default() }).expect("few nodes")
}

/// Checks that each child lies in its parent's box, and that each triangle is in one leaf or, if it is in several,
/// that no point of it is missing from all of them; returns the depth, and whether any triangle is in several leaves.
fn validate(tree: &Bvh8, triangles: &[Triangle]) -> (usize, bool) {
    let mut seen: Vec<Vec<Planes>> = vec![Vec::new(); triangles.len()];
    let corners = tree.outline.corners.map(|[x, y, z, _]| [x, y, z]);
    let mut deepest = 0;
    let mut stack: Vec<(Planes, Ref, usize)> = vec![(corners, tree.outline.root, 1)];
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
        let mut last = None;
        for block in tree.units[reference.leaf_units()].chunks_exact(BLOCK_UNITS) {
            for (triangle, primitive) in layout::triangles(block) {
                assert_eq!(triangle, triangles[primitive as usize]);
                assert!(last.is_none_or(|last| last < primitive), "primitives of a leaf ascend");
                seen[primitive as usize].push(planes);
                last = Some(primitive);
            }
        }
    }
    for (i, (boxes, triangle)) in seen.iter().zip(triangles).enumerate() {
        let holds = |p: &[f32; 3]| boxes.iter().any(|planes| within(planes, &[*p, *p]));
        assert!(triangle.iter().all(holds), "a corner is lost");
        if boxes.len() == 1 {
            continue;
        }
        for k in 0..16 {
            let (a, b) = (f64::from(number(31, i * 16 + k)), f64::from(number(32, i * 16 + k)));
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            let at = |axis: usize| {
                let [p, q, r] = triangle.map(|corner| f64::from(corner[axis]));
                p + (q - p) * a + (r - p) * b
            };
            let is_in = |planes: &Planes| {
                // A few roundings in f64 may put the point slightly outside the triangle.
                let slack =
                    |axis: usize| 1e-14 * triangle.iter().fold(0.0, |m, p| f64::from(p[axis].abs()).max(m));
                (0..3).all(|axis| {
                    let (low, high) = (f64::from(planes[0][axis]), f64::from(planes[1][axis]));
                    low - slack(axis) <= at(axis) && at(axis) <= high + slack(axis)
                })
            };
            assert!(boxes.iter().any(is_in), "a point of triangle {i} is lost");
        }
    }
    (deepest, seen.iter().any(|boxes| boxes.len() > 1))
}

#[test]
fn trees_are_valid_and_shallow_on_worst_cases_for_builders() {
    const N: usize = 50_000;
    let equal_centres = |i: usize| {
        let r = 1.0 + number(1, i);
        [[-r, -r, -r], [r, -r, r], [0.0, r, 0.0]]
    };
    let huge = [[-1e6, -1e6, 0.5], [1e6, -1e6, 0.5], [0.0, 1e6, 0.5]];
    let far = |i: usize| small(i).map(|p| p.map(|x| x * f32::from_bits((64 + i as u32 % 128) << 23)));
    // As long as the whole, in all directions: the case that cuts are made for.
    let long = |i: usize| -> Triangle {
        let from: [f32; 3] = std::array::from_fn(|k| number(k as u64, i));
        let to = std::array::from_fn(|k| number(k as u64 + 3, i));
        [from, to, from.map(|x| x + 0.01)]
    };
    let on_a_line = |i: usize| small(i).map(|p| [p[0], 0.25, 0.25]);
    let cases: [(&str, Vec<Triangle>); 7] = [
        ("long", (0..N / 10).map(long).collect()),
        ("on a line", (0..N).map(on_a_line).collect()),
        ("small", (0..N).map(small).collect()),
        ("copies", vec![small(7); N]),
        ("equal centres", (0..N).map(equal_centres).collect()),
        ("one huge", (0..N).map(|i| if i == 5 { huge } else { small(i) }).collect()),
        ("all scales", (0..N).map(far).collect()),
    ];
    for (name, triangles) in cases {
        for quality in QUALITIES {
            let tree = build(&triangles, quality);
            let (depth, has_pieces) = validate(&tree, &triangles);
            // The depth that the stack of the kernels has space for, and that bounds the work: every item is
            // processed a fixed number of times on each level.
            assert!(depth <= MAX_DEPTH, "{name} by {quality:?} is {depth} deep");
            let is_cut = quality == Quality::Best && name == "long";
            assert!(!is_cut || has_pieces, "{name}");
            assert!(quality == Quality::Best || !has_pieces, "{name} by {quality:?}");
        }
    }
}

#[test]
fn trees_do_not_depend_on_the_number_of_threads() {
    let triangles: Vec<Triangle> = (0..150_000).map(small).collect();
    for quality in QUALITIES {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| build(&triangles, quality))
        };
        let (one, three) = (with(1), with(3));
        assert!(one.outline.root == three.outline.root && *one.units == *three.units);
    }
}

#[test]
fn all_levels_count_the_same_hits() {
    let tree = build(&(0..2000).map(small).collect::<Vec<_>>(), Quality::Balanced);
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
        // Pads differ slightly between levels, and so may the visited nodes.
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
fn forged_trees_are_rejected_or_harmless() {
    let tree = build(&(0..200).map(small).collect::<Vec<_>>(), Quality::Balanced);
    let bytes = saved(&tree);
    let (mut refused, mut harmless) = (0, 0);
    for i in 0..4000u64 {
        let mut forged = bytes.clone();
        for k in 0..1 + i % 3 {
            let at = 8 + (hash_words([i, k, 0]) % (forged.len() as u64 - 8)) as usize;
            forged[at] = hash_words([i, k, 1]) as u8;
        }
        // As a forger would do it: with the right checksum.
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
