//! Packed trees match the originals: boxes contain the original boxes, and triangles are the same to the bit.

use super::{Bvh8, CompactBvh8};
use crate::bvh8::compact_layout::{self as layout, BLOCK_UNITS, NODE_UNITS};
use crate::bvh8::layout::{self as wide, LANES, NO_TRIANGLE, Planes, Ref, Unit};
use crate::{Accelerator, BuildOptions, TriangleMesh};
use bilux_math::hash::{hash_words, unit_f32};

/// Small triangles at random positions in a cube of this size.
fn scattered(count: u64, size: f32, at: f32) -> TriangleMesh {
    let number = |words: [u64; 4]| unit_f32(hash_words(words) as u32);
    let triangle = |i: u64| {
        std::array::from_fn(|corner| {
            let near = |axis: u64| number([i, axis, 0, 1]) + 0.05 * number([i, axis, corner as u64, 2]);
            std::array::from_fn(|axis| near(axis as u64) * size + at)
        })
    };
    TriangleMesh::from_corners((0..count).map(triangle).collect()).expect("few triangles")
}

/// A grid over a square, in which six triangles share each corner.
fn net(side: usize) -> TriangleMesh {
    let at = |i: usize, j: usize| [i as f32, (i * j % 7) as f32 * 0.2, j as f32];
    let cell = |cell: usize| {
        let (i, j) = (cell / side, cell % side);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    TriangleMesh::from_corners((0..side * side).flat_map(cell).collect()).expect("few triangles")
}

fn both(mesh: &TriangleMesh) -> (Bvh8, CompactBvh8) {
    let tree = Bvh8::new(mesh, &BuildOptions::default()).expect("few triangles");
    let compact = CompactBvh8::pack(&tree).expect("few triangles");
    (tree, compact)
}

fn holds(outer: &Planes, inner: &Planes) -> bool {
    (0..3).all(|k| outer[0][k] <= inner[0][k] && outer[1][k] >= inner[1][k])
}

/// Walks through both trees in parallel and returns the maximum growth of a box, relative to the common extent of its
/// node's children.
fn compare(tree: &Bvh8, compact: &CompactBvh8) -> f32 {
    let mut stack = vec![(tree.outline.root, compact.outline.root)];
    let mut worst = 0f32;
    while let Some((a, b)) = stack.pop() {
        assert_eq!((a.is_node(), a.blocks()), (b.is_node(), b.blocks()));
        if !a.is_node() {
            let blocks = tree.units[a.leaf_units()].chunks_exact(wide::BLOCK_UNITS);
            for (k, block) in blocks.enumerate() {
                let at = b.unit() + k * BLOCK_UNITS;
                let there = (0..LANES).map(|lane| layout::triangle(&compact.units, at, lane));
                let there: Vec<_> = there.filter(|(_, primitive)| *primitive != NO_TRIANGLE).collect();
                let bits = |(corners, primitive): &([[f32; 3]; 3], u32)| {
                    (corners.map(|p| p.map(f32::to_bits)), *primitive)
                };
                assert!(wide::triangles(block).map(|t| bits(&t)).eq(there.iter().map(bits)));
            }
            continue;
        }
        let wide: Vec<_> = wide::children(&tree.units[a.unit()..]).collect();
        let packed: Vec<_> = layout::children(&compact.units[b.unit()..]).collect();
        assert_eq!(wide.len(), packed.len());
        let whole = wide.iter().fold(wide::EMPTY, |all, (planes, _)| crate::bvh::tree::union(&all, planes));
        for ((inner, _), (outer, _)) in wide.iter().zip(&packed) {
            assert!(holds(outer, inner), "{outer:?} does not hold {inner:?}");
            for k in 0..3 {
                let more = (inner[0][k] - outer[0][k]).max(outer[1][k] - inner[1][k]);
                let extent = whole[1][k] - whole[0][k];
                worst = if extent > 0.0 { worst.max(more / extent) } else { worst };
            }
        }
        stack.extend(wide.iter().zip(&packed).map(|((_, a), (_, b))| (*a, *b)));
    }
    worst
}

#[test]
fn compact_boxes_contain_the_originals_and_triangles_are_the_same() {
    for (size, at) in [(1.0, 0.0), (1e30, 0.0), (1e-30, 0.0), (1.0, -3e4), (1e-3, 1e3)] {
        let (tree, compact) = both(&scattered(3000, size, at));
        // A step, which is a power of two, is less than two 255ths; far from the origin, floats are coarser.
        let more = compare(&tree, &compact);
        assert!(more < if at == 0.0 { 0.0085 } else { 0.2 }, "{size} {at}: {more}");
    }
    let (tree, compact) = both(&net(60));
    compare(&tree, &compact);
}

#[test]
fn compact_boxes_contain_the_originals_near_the_float_limits() {
    for (size, at) in
        [(3e38, 0.0), (f32::MAX, -f32::MAX), (1e-43, 0.0), (2e-38, -1e-38), (0.0, 7.0), (0.0, -0.0)]
    {
        let (tree, compact) = both(&scattered(500, size, at));
        compare(&tree, &compact);
    }
}

#[test]
fn absent_children_are_none() {
    let node = |count: usize| {
        let mut units = [Unit::default(); NODE_UNITS];
        let child = |k: usize| ([[k as f32; 3], [k as f32 + 0.5; 3]], Ref::node(k));
        layout::write_node(&mut units, &(0..count).map(child).collect::<Vec<_>>());
        units
    };
    for count in 1..=8 {
        let units = node(count);
        let children: Vec<_> = layout::children(&units).collect();
        assert_eq!(children.len(), count);
        assert_eq!(units[0].0[3] >> 24, (1 << count) - 1);
        assert!(children.iter().enumerate().all(|(k, (planes, _))| planes[0][0] <= k as f32));
    }
}

#[test]
fn shared_corners_take_less_than_half_the_memory() {
    let mesh = net(100);
    let (tree, compact) = both(&mesh);
    let bytes = |tree: &dyn Accelerator| tree.memory_bytes() as f64 / mesh.len() as f64;
    assert!(bytes(&compact) < 0.45 * bytes(&tree), "{} {}", bytes(&compact), bytes(&tree));
    // Triangles that share nothing take the same space as before, and no more.
    let mesh = scattered(20_000, 1.0, 0.0);
    let (tree, compact) = both(&mesh);
    assert!(compact.memory_bytes() < tree.memory_bytes());
    let empty = both(&TriangleMesh::default()).1;
    assert_eq!((empty.memory_bytes(), empty.shape().nodes), (0, 0));
}

#[test]
fn pools_are_full_and_shapes_the_same() {
    let (tree, compact) = both(&net(100));
    assert_eq!(tree.shape(), compact.shape());
    assert_eq!(tree.bounds(), compact.bounds());
}
