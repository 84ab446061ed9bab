//! Files of grids: OpenVDB, NanoVDB, `.npy` and `.vol`, byte by byte as their formats say, and broken.

use bilux_formats::{GridOfFile, ReadOptions, read_grid, read_grids};
use bilux_math::{Aabb, DVec3, Vec3};
use bilux_scene::media::Grid;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

fn grids(bytes: &[u8]) -> Vec<GridOfFile> {
    read_grids(bytes, "smoke.vdb", &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn only(bytes: &[u8]) -> (Grid, Aabb, String) {
    let mut all = grids(bytes);
    assert_eq!(all.len(), 1);
    let GridOfFile { grid, bounds, warnings, .. } = all.remove(0);
    (grid.unwrap(), bounds, warnings.join("; "))
}

#[track_caller]
fn refusal(bytes: &[u8]) -> String {
    let options = ReadOptions { max_memory: 64 << 20, ..ReadOptions::default() };
    read_grids(bytes, "smoke.vdb", &options).expect_err("this should be refused").to_string()
}

fn put(out: &mut Vec<u8>, bytes: impl AsRef<[u8]>) {
    out.extend_from_slice(bytes.as_ref());
}

fn put_text(out: &mut Vec<u8>, text: &str) {
    put(out, (text.len() as u32).to_le_bytes());
    put(out, text);
}

/// Packing of the numbers of an OpenVDB file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pack {
    No,
    Zip,
    /// Shuffled, as LZ4 that copies.
    Lz4,
    /// Blosc that copies.
    Stored,
}

/// A leaf: where it begins, which of its 512 voxels are active, and their values, z varying fastest.
#[derive(Clone)]
struct Leaf {
    origin: [i32; 3],
    active: Vec<bool>,
    values: Vec<f32>,
}

/// A grid to write.
#[derive(Clone)]
struct Tree {
    name: String,
    kind: &'static str,
    parent: String,
    class: &'static str,
    map: (&'static str, Vec<f64>),
    background: f32,
    pack: Pack,
    active_only: bool,
    /// The kind of inactive values, and these.
    inactive: (u8, [f32; 2]),
    tiles: Vec<([i32; 3], f32)>,
    leaves: Vec<Leaf>,
}

impl Tree {
    fn of(leaves: Vec<Leaf>) -> Tree {
        Tree {
            name: "density".into(),
            kind: "Tree_float_5_4_3",
            parent: String::new(),
            class: "fog volume",
            map: ("UniformScaleMap", vec![0.5; 15]),
            background: 0.0,
            pack: Pack::No,
            active_only: true,
            inactive: (0, [0.0; 2]),
            tiles: Vec::new(),
            leaves,
        }
    }

    fn number(&self, value: f32, is_single: bool) -> Vec<u8> {
        if self.kind.ends_with("_HalfFloat") && !is_single {
            // Exact for the numbers of these tests: 1 and 2 to the power of whole numbers, and few digits.
            let bits = value.to_bits();
            if value == 0.0 {
                return vec![0, 0];
            }
            let sign = (bits >> 16 & 0x8000) as u16;
            let rest = (bits >> 13 & 0x3_ffff) as u16;
            return (sign | rest.wrapping_sub(112 << 10) & 0x7fff).to_le_bytes().to_vec();
        }
        if self.kind.contains("double") {
            f64::from(value).to_le_bytes().to_vec()
        } else {
            value.to_le_bytes().to_vec()
        }
    }

    fn pack(&self, data: Vec<u8>, out: &mut Vec<u8>) {
        let packed = match self.pack {
            _ if data.is_empty() && self.kind.ends_with("_HalfFloat") => return,
            Pack::No => return put(out, data),
            Pack::Zip => {
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
                encoder.write_all(&data).unwrap();
                encoder.finish().unwrap()
            }
            Pack::Lz4 => blosc(&data, 1 << 5 | 1 | 16, &lz4(&shuffled(&data))),
            Pack::Stored => blosc(&data, 2, &data),
        };
        if packed.len() < data.len() || self.pack != Pack::Zip {
            put(out, (packed.len() as i64).to_le_bytes());
            put(out, packed);
        } else {
            put(out, (-(data.len() as i64)).to_le_bytes());
            put(out, data);
        }
    }

    /// Values of a node with a mask, and what is inactive.
    fn values(&self, values: &[f32], active: &[bool], out: &mut Vec<u8>) {
        let (kind, inactive) = self.inactive;
        put(out, [kind]);
        if matches!(kind, 2 | 4 | 5) {
            put(out, self.number(inactive[0], true));
        }
        if kind == 5 {
            put(out, self.number(inactive[1], true));
        }
        if matches!(kind, 3..=5) {
            // Every other value is the second one.
            put(out, vec![0xaa; values.len() / 8]);
        }
        let all = !self.active_only || kind == 6;
        let stored = values.iter().zip(active).filter(|(_, active)| all || **active);
        self.pack(stored.flat_map(|(value, _)| self.number(*value, false)).collect(), out);
    }

    fn tree(&self, out: &mut Vec<u8>) {
        put(out, 1u32.to_le_bytes());
        put(out, self.number(self.background, true));
        put(out, 0u32.to_le_bytes());
        put(out, 1u32.to_le_bytes());
        // All is in the first node of 4096 voxels a side, and there in the first of 128, but for tiles.
        put(out, [0; 12]);
        let cell = |at: [i32; 3], bits: u32, side: i32| {
            let [x, y, z] = at.map(|x| (x / side) as usize & ((1 << bits) - 1));
            (x << (2 * bits)) | (y << bits) | z
        };
        let small = Tree { inactive: (0, [0.0; 2]), ..self.clone() };
        let node = |bits: u32, children: &[usize], tiles: &[(usize, f32)], out: &mut Vec<u8>| {
            let count = 1 << (3 * bits);
            let (mut active, mut values, mut child) =
                (vec![false; count], vec![0.0; count], vec![false; count]);
            children.iter().for_each(|i| child[*i] = true);
            for (i, value) in tiles {
                (active[*i], values[*i]) = (true, *value);
            }
            put(out, mask(&child));
            put(out, mask(&active));
            small.values(&values, &active, out);
        };
        let tiles: Vec<_> = self.tiles.iter().map(|(at, value)| (cell(*at, 5, 128), *value)).collect();
        node(5, &[0], &tiles, out);
        let mut leaves = self.leaves.clone();
        leaves.sort_by_key(|leaf| cell(leaf.origin, 4, 8));
        let children: Vec<_> = leaves.iter().map(|leaf| cell(leaf.origin, 4, 8)).collect();
        node(4, &children, &[], out);
        leaves.iter().for_each(|leaf| put(out, mask(&leaf.active)));
        for leaf in &leaves {
            put(out, mask(&leaf.active));
            self.values(&leaf.values, &leaf.active, out);
        }
    }
}

fn mask(bits: &[bool]) -> Vec<u8> {
    bits.chunks(8).map(|byte| byte.iter().enumerate().map(|(i, on)| u8::from(*on) << i).sum()).collect()
}

fn shuffled(data: &[u8]) -> Vec<u8> {
    let count = data.len() / 4;
    let sorted = (0..4 * count).map(|i| data[i % count * 4 + i / count]);
    sorted.chain(data[4 * count..].iter().copied()).collect()
}

/// An LZ4 block of literals, the last twelve of which repeat nothing. Before them, a run of the same byte if there is one.
fn lz4(data: &[u8]) -> Vec<u8> {
    let run = data.iter().take_while(|byte| **byte == data[0]).count();
    let mut out = Vec::new();
    let mut rest = data;
    let length = |out: &mut Vec<u8>, mut length: usize| {
        while length >= 255 {
            out.push(255);
            length -= 255;
        }
        out.push(length as u8);
    };
    if run >= 64 && data.len() - run >= 12 {
        // One literal, then a match of what is one byte before.
        put(&mut out, [0x1f, data[0], 1, 0]);
        length(&mut out, run - 1 - 4 - 15);
        rest = &data[run..];
    }
    out.push(if rest.len() >= 15 { 0xf0 } else { (rest.len() as u8) << 4 });
    if rest.len() >= 15 {
        length(&mut out, rest.len() - 15);
    }
    put(&mut out, rest);
    out
}

/// A container of one block.
fn blosc(data: &[u8], flags: u8, packed: &[u8]) -> Vec<u8> {
    let mut out = vec![2, 1, flags, 4];
    let is_stored = flags & 2 != 0;
    let body = if is_stored { 16 } else { 16 + 4 + 4 } + packed.len();
    for number in [data.len(), data.len(), body] {
        put(&mut out, (number as u32).to_le_bytes());
    }
    if !is_stored && !data.is_empty() {
        put(&mut out, 20u32.to_le_bytes());
        put(&mut out, (packed.len() as u32).to_le_bytes());
    }
    put(&mut out, packed);
    out
}

fn file(creator: &str, trees: &[Tree]) -> Vec<u8> {
    let mut out = vec![0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];
    for number in [224u32, 10, 0] {
        put(&mut out, number.to_le_bytes());
    }
    put(&mut out, [1]);
    put(&mut out, [b'0'; 36]);
    put(&mut out, 1u32.to_le_bytes());
    put_text(&mut out, "creator");
    put_text(&mut out, "string");
    put_text(&mut out, creator);
    put(&mut out, (trees.len() as u32).to_le_bytes());
    for tree in trees {
        put_text(&mut out, &tree.name);
        put_text(&mut out, tree.kind);
        put_text(&mut out, &tree.parent);
        let mut own = Vec::new();
        let flags = u32::from(tree.active_only) * 2
            + match tree.pack {
                Pack::No => 0,
                Pack::Zip => 1,
                _ => 4,
            };
        put(&mut own, flags.to_le_bytes());
        put(&mut own, 1u32.to_le_bytes());
        put_text(&mut own, "class");
        put_text(&mut own, "string");
        put_text(&mut own, tree.class);
        put_text(&mut own, tree.map.0);
        tree.map.1.iter().for_each(|number| put(&mut own, number.to_le_bytes()));
        if tree.parent.is_empty() {
            tree.tree(&mut own);
        }
        let begin = out.len() as u64 + 24;
        for place in [begin, begin, begin + own.len() as u64] {
            put(&mut out, place.to_le_bytes());
        }
        put(&mut out, own);
    }
    out
}

/// Two leaves, with values that halves hold, zero in half of their voxels.
fn two_leaves() -> Vec<Leaf> {
    let leaf = |origin: [i32; 3], seed: u64| {
        let word = |i: u64| bilux_math::hash::mix64(seed * 1000 + i);
        let active: Vec<bool> = (0..512).map(|i| word(i) & 1 == 1).collect();
        let value =
            |i: usize| if active[i] { 1.0 + (word(i as u64) >> 32 & 255) as f32 / 256.0 } else { 0.0 };
        Leaf { origin, values: (0..512).map(value).collect(), active }
    };
    vec![leaf([16, 8, 32], 1), leaf([24, 16, 32], 2)]
}

/// The value of leaves at an index.
fn expected(leaves: &[Leaf], [x, y, z]: [i32; 3]) -> f32 {
    let is_there = |leaf: &&Leaf| leaf.origin == [x, y, z].map(|i| i.div_euclid(8) * 8);
    let at = ((x & 7) << 6 | (y & 7) << 3 | z & 7) as usize;
    leaves.iter().find(is_there).map_or(0.0, |leaf| leaf.values[at])
}

/// Every voxel around leaves has its value at its centre.
#[track_caller]
fn assert_same(grid: &Grid, leaves: &[Leaf], place: impl Fn(Vec3) -> Vec3, what: &str) {
    for i in 0..32 * 32 * 32 {
        let index = [10 + i % 32, 2 + i / 32 % 32, 20 + i / 1024];
        let found = grid.value(place(Vec3::from(index.map(|x| x as f32))));
        let wanted = expected(leaves, index);
        assert!((found - wanted).abs() < 1e-3 * wanted.max(1.0), "{what}: {found} for {wanted} at {index:?}");
    }
}

#[test]
fn openvdb_of_every_packing_has_the_same_values() {
    let leaves = two_leaves();
    for pack in [Pack::No, Pack::Zip, Pack::Lz4, Pack::Stored] {
        for active_only in [true, false] {
            let kinds = [
                "Tree_float_5_4_3",
                "Tree_float_5_4_3_HalfFloat",
                "Tree_double_5_4_3",
                "Tree_double_5_4_3_HalfFloat",
            ];
            for kind in kinds {
                let tree = Tree { kind, pack, active_only, ..Tree::of(leaves.clone()) };
                let (grid, bounds, warnings) = only(&file("", &[tree]));
                let what = format!("{kind} {pack:?} {active_only}");
                assert_same(&grid, &leaves, |p| p * 0.5, &what);
                assert_eq!(warnings, "");
                // Blocks begin at multiples of eight; values are from 16 to 31, and half a voxel further on both sides.
                assert_eq!((grid.size(), grid.stored_blocks()), ([25, 25, 17], 2), "{what}");
                assert_eq!(grid.to_object().point(bounds.min), Vec3::new(15., 7., 31.) * 0.5);
                assert_eq!(grid.to_object().point(bounds.max), Vec3::new(32., 24., 40.) * 0.5);
            }
        }
    }
}

#[test]
fn inactive_values_are_what_the_kind_of_the_node_says() {
    // With a background, which is taken as 0 where it is inactive.
    let cases = [
        (0, 0.25, [9.0, 9.0], [0.0, 0.0]),
        (1, 0.25, [9.0, 9.0], [0.0, 0.0]),
        (1, -0.25, [9.0, 9.0], [0.25, 0.25]),
        (2, 0.25, [0.75, 9.0], [0.75, 0.75]),
        (3, -0.25, [9.0, 9.0], [0.25, 0.0]),
        (4, 0.0, [0.75, 9.0], [0.75, 0.0]),
        (5, 0.0, [0.75, 0.5], [0.75, 0.5]),
        (6, 0.0, [9.0, 9.0], [0.0, 0.0]),
    ];
    for (kind, background, inactive, wanted) in cases {
        let mut leaves = two_leaves();
        let tree = Tree { background, inactive: (kind, inactive), ..Tree::of(leaves.clone()) };
        for leaf in &mut leaves {
            for i in (0..512).filter(|i| !leaf.active[*i]) {
                leaf.values[i] = wanted[i % 2];
            }
        }
        let (grid, _, warnings) = only(&file("", &[tree]));
        let what = format!("kind {kind}, background {background}");
        for leaf in &leaves {
            for i in 0..512i32 {
                let index = [0, 1, 2].map(|axis: usize| leaf.origin[axis] + (i >> (6 - 3 * axis) & 7));
                let found = grid.value(Vec3::from(index.map(|x| x as f32)) * 0.5);
                let wanted = expected(&leaves, index);
                // The outermost ones may lie beyond the lattice.
                assert!((found - wanted).abs() < 2e-3, "{what}: {found} for {wanted} at {index:?}");
            }
        }
        assert_eq!(
            warnings.contains("everything outside its voxels is"),
            background != 0.0,
            "{what}: {warnings}"
        );
    }
}

#[test]
fn maps_place_the_voxels() {
    let leaves = two_leaves();
    let affine = vec![0.5, 0.25, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 1.0, 2.0, 3.0, 1.0];
    let with = |first: [f64; 3], then: [f64; 3]| [&first[..], &then[..], &[0.0; 12]].concat();
    type Place = fn(Vec3) -> Vec3;
    let cases: [(&str, Vec<f64>, Place); 5] = [
        ("ScaleMap", with([0.5, 1.0, 2.0], [0.0; 3])[..15].to_vec(), |q| q * Vec3::new(0.5, 1.0, 2.0)),
        ("TranslationMap", vec![1.0, 2.0, 3.0], |q| q + Vec3::new(1.0, 2.0, 3.0)),
        ("UniformScaleTranslateMap", with([1.0, 2.0, 3.0], [0.5; 3]), |q| q * 0.5 + Vec3::new(1.0, 2.0, 3.0)),
        ("ScaleTranslateMap", with([1.0, 2.0, 3.0], [0.5, 1.0, 2.0]), |q| {
            q * Vec3::new(0.5, 1.0, 2.0) + Vec3::new(1.0, 2.0, 3.0)
        }),
        ("AffineMap", affine, |q| Vec3::new(0.5 * q.x + 1.0, 0.25 * q.x + 0.5 * q.y + 2.0, 2.0 * q.z + 3.0)),
    ];
    for (name, numbers, place) in cases {
        let (grid, ..) = only(&file("", &[Tree { map: (name, numbers), ..Tree::of(leaves.clone()) }]));
        assert_same(&grid, &leaves, place, name);
    }
    let message =
        refusal(&file("", &[Tree { map: ("NonlinearFrustumMap", vec![]), ..Tree::of(leaves.clone()) }]));
    assert!(message.contains("spread over the view of a camera"), "{message}");
    let flat = ("ScaleMap", vec![0.0; 15]);
    let message = refusal(&file("", &[Tree { map: flat, ..Tree::of(leaves) }]));
    assert!(message.contains("smoke.vdb") && message.contains("not an invertible map"), "{message}");
}

#[test]
fn tiles_are_filled_and_a_file_has_several_grids() {
    let leaves = two_leaves();
    let tiles = vec![([128, 0, 0], 0.5)];
    let with_tiles = Tree { tiles, name: "fuel\u{1e}1".into(), ..Tree::of(leaves.clone()) };
    let instance = Tree {
        name: "copy".into(),
        parent: "fuel\u{1e}1".into(),
        map: ("TranslationMap", vec![1.0, 0.0, 0.0]),
        ..Tree::of(vec![])
    };
    let velocity = Tree { name: "velocity".into(), kind: "Tree_vec3s_5_4_3", ..Tree::of(leaves.clone()) };
    let surface = Tree { name: "surface".into(), class: "level set", ..Tree::of(leaves) };
    let bytes = file("", &[with_tiles, velocity, instance, surface]);
    let named = |name: &str| read_grid(&bytes, "smoke.vdb", name, &ReadOptions::default());
    assert_eq!(
        (named("").unwrap().name, named("copy").unwrap().name),
        ("fuel".to_owned(), "copy".to_owned())
    );
    let none = named("flame").unwrap_err().to_string();
    assert!(none.contains("smoke.vdb") && none.contains("has no grid 'flame', but fuel, copy"), "{none}");
    let all = grids(&bytes);
    let names: Vec<&str> = all.iter().map(|grid| &*grid.name).collect();
    assert_eq!(names, ["fuel", "velocity", "copy", "surface"]);
    assert!(all[1].grid.as_ref().unwrap_err().contains("has the type 'vec3s'"));
    assert!(all[3].grid.as_ref().unwrap_err().contains("is a level set"));
    for (i, place) in [(0, 0.5f32), (2, 1.0)] {
        let grid = all[i].grid.as_ref().unwrap();
        assert_eq!(grid.stored_blocks(), 2 + 16 * 16 * 16);
        let shift = if i == 2 { Vec3::X } else { Vec3::ZERO };
        let value = |x: f32, y: f32, z: f32| grid.value(Vec3::new(x, y, z) * place + shift);
        assert_eq!([value(128., 0., 0.), value(255., 127., 127.), value(200., 50., 70.)], [0.5; 3]);
        assert_eq!([value(127., 9., 0.), value(256., 9., 9.), value(130., -1., 5.)], [0.0; 3]);
        // Half way to the next voxel, half of the value.
        assert_eq!(value(255.5, 9., 9.), 0.25);
    }
}

#[test]
fn numbers_that_are_no_densities_become_zero_and_are_counted() {
    let mut leaves = two_leaves();
    leaves[0].values[..4].copy_from_slice(&[-1.0, f32::NAN, f32::INFINITY, -2.0]);
    leaves[0].active[..4].fill(true);
    let (grid, _, warnings) = only(&file("", &[Tree::of(leaves)]));
    assert_eq!(grid.value(Vec3::new(16., 8., 32.) * 0.5), 0.0);
    assert!(warnings.contains("2 voxels are negative"), "{warnings}");
    assert!(warnings.contains("2 voxels are not finite"), "{warnings}");
}

#[test]
fn openvdb_files_that_cannot_be_read_are_refused_with_the_place() {
    let good = file("", &[Tree { pack: Pack::Lz4, ..Tree::of(two_leaves()) }]);
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        refusal(&bad)
    };
    for (message, wanted) in [
        (with(8, &[218, 0, 0, 0]), "version 218, but only 222 to 224"),
        (with(20, &[0]), "written as a stream"),
        (refusal(&good[..good.len() - 1]), "it was cut off"),
        (refusal(b"nothing"), "this is no file of grids"),
        (
            refusal(&file("", &[Tree { kind: "Tree_float_5_4_3", ..Tree::of(vec![]) }])),
            "has no voxels with values",
        ),
    ] {
        assert!(message.starts_with("smoke.vdb: ") && message.contains(wanted), "{message}");
    }
    // A grid that says to lie before its own description would be read for ever.
    let place = good.windows(16).position(|at| at == b"Tree_float_5_4_3").unwrap() + 16 + 4;
    assert!(with(place, &[0; 8]).contains("which cannot be"), "{}", with(place, &[0; 8]));
}

#[test]
fn files_of_a_kilobyte_do_not_ask_for_gigabytes() {
    // A tile at the root: 4096³ voxels.
    let mut huge = file("", &[Tree::of(vec![])]);
    let map = huge.windows(15).position(|at| at == b"UniformScaleMap").unwrap();
    // After the map come the number of buffers and the background, and then tiles instead of children.
    huge.truncate(map + 15 + 15 * 8 + 4 + 4);
    put(&mut huge, [1, 0, 0, 0, 0, 0, 0, 0]);
    put(&mut huge, [0; 12]);
    put(&mut huge, 0.5f32.to_le_bytes());
    put(&mut huge, [1]);
    let length = huge.len() as u64;
    let ends = huge.windows(16).position(|at| at == b"Tree_float_5_4_3").unwrap() + 16 + 4 + 16;
    huge[ends..ends + 8].copy_from_slice(&length.to_le_bytes());
    let start = std::time::Instant::now();
    let options = ReadOptions::default();
    let message = read_grids(&huge, "smoke.vdb", &options).unwrap_err().to_string();
    assert!(message.contains("takes more than the 4294967296 bytes"), "{message}");
    // Two voxels at the ends of the world.
    let far = |x: i32| Leaf { origin: [x, 0, 0], ..two_leaves().remove(0) };
    let mut scattered = Tree::of(vec![far(0)]);
    scattered.tiles = vec![([3968, 3968, 3968], 0.5)];
    let message = refusal(&file("", &[scattered]));
    assert!(message.contains("are scattered") || message.contains("takes more than"), "{message}");
    let mut npy = b"\x93NUMPY\x01\x00\x46\x00".to_vec();
    put(&mut npy, format!("{:<70}", "{'descr': '|u1', 'fortran_order': False, 'shape': (9999, 9999, 9999)}"));
    assert!(refusal(&npy).contains("it was cut off"), "{}", refusal(&npy));
    assert!(start.elapsed().as_secs_f32() < 2.0, "{:?}", start.elapsed());
}

/// A NanoVDB grid of leaves in the first node of each level; `bits` is 32 for floats.
fn nano(leaves: &[Leaf], kind: u32, bits: usize, codec: u16) -> Vec<u8> {
    let mut grid = vec![0u8; 672];
    grid[..8].copy_from_slice(b"NanoVDB0");
    grid[16..20].copy_from_slice(&(32u32 << 21 | 4 << 10).to_le_bytes());
    for (i, number) in [0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5].iter().enumerate() {
        grid[384 + 8 * i..392 + 8 * i].copy_from_slice(&f64::to_le_bytes(*number));
    }
    grid[528..536].copy_from_slice(&1.0f64.to_le_bytes());
    grid[632..636].copy_from_slice(&2u32.to_le_bytes());
    grid[636..640].copy_from_slice(&kind.to_le_bytes());
    let mut tree = vec![0u8; 64];
    tree[24..32].copy_from_slice(&64i64.to_le_bytes());
    let mut root = vec![0u8; 64];
    root[24..28].copy_from_slice(&1u32.to_le_bytes());
    // The tile's key and its child, which begins 96 bytes after the root.
    put(&mut root, [0; 8]);
    put(&mut root, 96i64.to_le_bytes());
    put(&mut root, [0; 16]);
    let node = |bits: usize, children: &[(usize, i64)]| {
        let count = 1usize << (3 * bits);
        let mut child = vec![false; count];
        children.iter().for_each(|(i, _)| child[*i] = true);
        let mut out = vec![0u8; 32 + count / 8];
        put(&mut out, mask(&child));
        put(&mut out, [0; 32]);
        let table = out.len();
        out.resize(table + 8 * count, 0);
        for (i, place) in children {
            out[table + 8 * i..table + 8 * i + 8].copy_from_slice(&place.to_le_bytes());
        }
        out
    };
    let upper_bytes = 32 + 2 * 4096 + 32 + 8 * 32768;
    let lower_bytes = 32 + 2 * 512 + 32 + 8 * 4096;
    let own = if bits == 32 { 96 + 2048 } else { 96 + 64 * bits };
    let cell = |at: [i32; 3]| at.iter().fold(0, |sum, x| sum << 4 | (*x / 8) as usize & 15);
    let places =
        leaves.iter().enumerate().map(|(i, leaf)| (cell(leaf.origin), (lower_bytes + i * own) as i64));
    let (upper, lower) = (node(5, &[(0, upper_bytes as i64)]), node(4, &places.collect::<Vec<_>>()));
    assert_eq!((upper.len(), lower.len()), (upper_bytes, lower_bytes));
    let mut all = [grid, tree, root, upper, lower].concat();
    for leaf in leaves {
        leaf.origin.iter().for_each(|x| put(&mut all, x.to_le_bytes()));
        put(&mut all, [7, 7, 7, (bits.trailing_zeros() as u8) << 5]);
        put(&mut all, mask(&leaf.active));
        if bits == 32 {
            put(&mut all, [0; 16]);
            leaf.values.iter().for_each(|value| put(&mut all, value.to_le_bytes()));
            continue;
        }
        let most = ((1u32 << bits) - 1) as f32;
        put(&mut all, 0.0f32.to_le_bytes());
        put(&mut all, (2.0 / most).to_le_bytes());
        put(&mut all, [0; 8]);
        let codes = leaf.values.iter().map(|value| (value / 2.0 * most).round() as u32);
        let mut bytes = vec![0u8; 64 * bits];
        for (i, code) in codes.enumerate() {
            for bit in (0..bits).filter(|bit| code >> bit & 1 != 0) {
                let at = i * bits + bit;
                bytes[at / 8] |= 1 << (at % 8);
            }
        }
        put(&mut all, bytes);
    }
    let size = all.len() as u64;
    all[32..40].copy_from_slice(&size.to_le_bytes());
    let packed = match codec {
        1 => {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(&all).unwrap();
            encoder.finish().unwrap()
        }
        2 => blosc(&all, 1 << 5 | 1 | 16, &lz4(&shuffled(&all))),
        _ => all.clone(),
    };
    let packed =
        if codec == 0 { packed } else { [&(packed.len() as u64).to_le_bytes()[..], &packed].concat() };
    let mut out = b"NanoVDB0".to_vec();
    put(&mut out, (32u32 << 21 | 4 << 10).to_le_bytes());
    put(&mut out, 1u16.to_le_bytes());
    put(&mut out, codec.to_le_bytes());
    let mut about = vec![0u8; 176];
    about[..8].copy_from_slice(&size.to_le_bytes());
    about[8..16].copy_from_slice(&(packed.len() as u64).to_le_bytes());
    about[32..36].copy_from_slice(&kind.to_le_bytes());
    about[36..40].copy_from_slice(&2u32.to_le_bytes());
    about[136..140].copy_from_slice(&8u32.to_le_bytes());
    about[168..170].copy_from_slice(&codec.to_le_bytes());
    put(&mut out, about);
    put(&mut out, b"density\0");
    put(&mut out, packed);
    out
}

#[test]
fn nanovdb_of_every_packing_has_the_same_values() {
    let leaves = two_leaves();
    let place = |p: Vec3| p * 0.5 + Vec3::X;
    for codec in 0..3 {
        let bytes = nano(&leaves, 1, 32, codec);
        let all = grids(&bytes);
        assert_eq!(all[0].name, "density");
        assert_same(all[0].grid.as_ref().unwrap(), &leaves, place, &format!("floats, compression {codec}"));
    }
    // Without a file around it.
    let file = nano(&leaves, 1, 32, 0);
    let mut bare = file[16 + 176 + 8..].to_vec();
    bare[7] = b'1';
    assert_same(&only(&bare).0, &leaves, place, "a bare grid");
    for (kind, bits) in [(13, 4), (14, 8), (15, 16), (16, 1), (16, 2), (16, 4), (16, 8), (16, 16)] {
        let most = ((1u32 << bits) - 1) as f32;
        let rounded = |value: &f32| (value / 2.0 * most).round() * 2.0 / most;
        let wanted: Vec<Leaf> = leaves
            .iter()
            .map(|leaf| Leaf { values: leaf.values.iter().map(rounded).collect(), ..leaf.clone() })
            .collect();
        let (grid, ..) = only(&nano(&leaves, kind, bits, 1));
        assert_same(&grid, &wanted, place, &format!("type {kind}, {bits} bits"));
    }
    let velocity = grids(&nano(&leaves, 6, 32, 1));
    assert!(velocity[0].grid.as_ref().unwrap_err().contains("has values of type 6"));
    let mut old = nano(&leaves, 1, 32, 1);
    old[8..12].copy_from_slice(&(28u32 << 21).to_le_bytes());
    assert!(refusal(&old).contains("version 28, but only 32"), "{}", refusal(&old));
}

#[test]
fn a_nanovdb_tree_that_names_a_leaf_for_ever_is_refused() {
    let mut bytes = nano(&two_leaves(), 1, 32, 0);
    // All children of the upper node are the lower one, and all of that the first leaf.
    let grid = 16 + 176 + 8;
    let upper = grid + 672 + 64 + 96;
    let lower = upper + 32 + 2 * 4096 + 32 + 8 * 32768;
    for (node, count) in [(upper, 32768), (lower, 4096)] {
        let table = node + 32 + count / 4 + 32;
        let children = node + 32 + count / 8;
        bytes[children..children + count / 8].fill(255);
        let child = if node == upper { (lower - upper) as i64 } else { (32 + 1024 + 32 + 8 * 4096) as i64 };
        for i in 0..count {
            bytes[table + 8 * i..table + 8 * i + 8].copy_from_slice(&child.to_le_bytes());
        }
    }
    let start = std::time::Instant::now();
    assert!(refusal(&bytes).contains("more leaves than there are bytes for"), "{}", refusal(&bytes));
    assert!(start.elapsed().as_secs_f32() < 1.0);
}

#[test]
fn arrays_of_numpy_have_the_indices_z_y_x() {
    let header = |kind: &str, order: &str, shape: &str| {
        let text = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}");
        let mut out = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        put(&mut out, format!("{text:<117}\n"));
        out
    };
    // The number at [z][y][x] of (2, 3, 4).
    let number = |x: usize, y: usize, z: usize| (1 + x + 10 * y + 100 * z) as f32;
    let c_order = (0..24).map(|i| number(i % 4, i / 4 % 3, i / 12));
    let fortran = (0..24).map(|i| number(i / 6, i / 2 % 3, i % 2));
    let floats =
        |numbers: &mut dyn Iterator<Item = f32>| numbers.flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let doubles: Vec<u8> = c_order.clone().flat_map(|x| f64::from(x).to_be_bytes()).collect();
    let files = [
        [header("<f4", "False", "(2, 3, 4)"), floats(&mut c_order.clone())].concat(),
        [header("<f4", "True", "(2, 3, 4)"), floats(&mut fortran.clone())].concat(),
        [header(">f8", "False", "(2, 3, 4, 1)"), doubles].concat(),
    ];
    for file in &files {
        let (grid, bounds, warnings) = only(file);
        assert_eq!((grid.size(), warnings.as_str()), ([4, 3, 2], ""));
        for i in 0..24 {
            let at = [i % 4, i / 4 % 3, i / 12];
            assert_eq!(grid.voxel(at), number(at[0], at[1], at[2]), "{at:?}");
        }
        assert_eq!(grid.to_object().point(bounds.max), Vec3::new(1.0, 0.75, 0.5));
    }
    let bytes: Vec<u8> = (0..24u8).map(|i| 10 * i).collect();
    let (grid, ..) = only(&[header("|u1", "False", "(2, 3, 4)"), bytes].concat());
    assert!((grid.voxel([1, 2, 1]) - 210.0 / 255.0).abs() < 1e-3);
    for (file, wanted) in [
        (header("<i8", "False", "(2, 3, 4)"), "type '<i8', but only <f4"),
        (header("<f4", "False", "(2, 3)"), "three indices, [z][y][x]"),
        (header("<f4", "False", "(2, 3, 4)"), "96 bytes are expected here, but only 0 follow"),
        (header("<f4", "False", "(0, 3, 4)"), "each side has 1 to"),
    ] {
        assert!(refusal(&file).contains(wanted), "{}", refusal(&file));
    }
}

#[test]
fn vol_files_of_mitsuba_fill_their_box() {
    let file = |kind: i32, channels: i32, numbers: &[u8]| {
        let mut out = b"VOL\x03".to_vec();
        [kind, 2, 3, 2, channels].iter().for_each(|x| put(&mut out, x.to_le_bytes()));
        [1.0f32, 2.0, 3.0, 3.0, 5.0, 9.0].iter().for_each(|x| put(&mut out, x.to_le_bytes()));
        put(&mut out, numbers);
        out
    };
    let floats: Vec<u8> = (0..12).flat_map(|i| (i as f32).to_le_bytes()).collect();
    let (grid, bounds, _) = only(&file(1, 1, &floats));
    assert_eq!((grid.voxel([1, 2, 0]), grid.voxel([0, 1, 1])), (5.0, 8.0));
    let ends = [bounds.min, bounds.max].map(|p| grid.to_object().point(p));
    assert_eq!(ends, [Vec3::new(1.0, 2.0, 3.0), Vec3::new(3.0, 5.0, 9.0)]);
    let (grid, ..) = only(&file(3, 1, &[0, 51, 102, 153, 204, 255, 0, 0, 0, 0, 0, 0]));
    assert!((grid.voxel([1, 0, 0]) - 0.2).abs() < 1e-3 && grid.voxel([1, 2, 0]) == 1.0);
    assert!(grids(&file(1, 2, &floats))[0].grid.as_ref().unwrap_err().contains("has 2 channels"));
    // Colours: their mean, and each of them.
    let colours: Vec<u8> = (0..36).map(|i| [4, 20, 60][i % 3] + i as u8 / 3).collect();
    let all = grids(&file(3, 3, &colours));
    let names: Vec<&str> = all.iter().map(|grid| &*grid.name).collect();
    assert_eq!(names, ["mean", "red", "green", "blue"]);
    for (grid, wanted) in all.iter().zip([28.0, 4.0, 20.0, 60.0]) {
        let found = grid.grid.as_ref().unwrap().voxel([1, 0, 0]) * 255.0;
        assert!((found - wanted - 1.0).abs() < 0.05, "{}: {found}", grid.name);
    }
    assert_eq!(all[0].warnings, ["it has a colour for each voxel, whose mean is taken"]);
    assert!(all[1].warnings.is_empty());
    assert!(refusal(&file(4, 1, &floats)).contains("type 4"));
    assert!(refusal(&file(1, 1, &floats[1..])).contains("48 bytes are expected here, but only 47 follow"));
}

#[test]
fn broken_files_of_grids_give_an_error_or_a_grid() {
    let leaves = two_leaves();
    let options = ReadOptions { max_memory: 32 << 20, ..ReadOptions::default() };
    let survive = |bytes: &[u8]| drop(read_grids(bytes, "x", &options));
    let files = [
        file("", &[Tree { pack: Pack::Lz4, inactive: (4, [0.5, 0.0]), ..Tree::of(leaves.clone()) }]),
        file(
            "",
            &[Tree { pack: Pack::Zip, kind: "Tree_double_5_4_3_HalfFloat", ..Tree::of(leaves.clone()) }],
        ),
        nano(&leaves, 1, 32, 1),
        nano(&leaves, 16, 4, 2),
        nano(&leaves, 14, 8, 0),
    ];
    for (i, bytes) in files.iter().enumerate() {
        let step = (bytes.len() / 20).max(1);
        (0..bytes.len()).step_by(step).for_each(|length| survive(&bytes[..length]));
        for k in 0..32u64 {
            let word = bilux_math::hash::mix64(k * 31 + i as u64);
            let mut bad = bytes.clone();
            // Half of the damage is in the first kilobyte, where the counts are.
            let reach = if k % 2 == 0 { bad.len().min(1024) } else { bad.len() };
            let at = (word >> 8) as usize % reach;
            bad[at] = match k % 4 {
                0 => 255,
                1 => bad[at] ^ 1 << (word & 7),
                2 => 0,
                _ => word as u8,
            };
            survive(&bad);
        }
    }
}

/// A map that is not symmetric: the rows of what columns of indices are multiplied by, and where the first voxel is.
const SKEWED: [[f64; 3]; 3] = [[0.5, 0.125, 0.0], [0.0, 0.25, 0.0625], [-0.25, 0.0, 0.375]];
const SHIFT: [f64; 3] = [1.0, -2.0, 3.0];

fn skewed(p: DVec3) -> DVec3 {
    DVec3::from(SKEWED.map(|row| DVec3::from(row).dot(p))) + DVec3::from(SHIFT)
}

/// The skewed map in a file of NanoVDB that is not compressed: row after row. [NanoVDB.h, Map]
fn with_skewed_map(mut file: Vec<u8>) -> Vec<u8> {
    let map = 16 + 176 + 8 + 296;
    for (i, number) in SKEWED.as_flattened().iter().enumerate() {
        let at = map + 88 + 8 * i;
        file[at..at + 8].copy_from_slice(&number.to_le_bytes());
    }
    for (i, number) in SHIFT.iter().enumerate() {
        let at = map + 88 + 144 + 8 * i;
        file[at..at + 8].copy_from_slice(&number.to_le_bytes());
    }
    file
}

/// The skewed map in OpenVDB, which multiplies rows of indices.
fn affine() -> (&'static str, Vec<f64>) {
    let [a, b, c] = SKEWED;
    let columns = [0, 1, 2].map(|i| [a[i], b[i], c[i], 0.0]);
    let shift = [SHIFT[0], SHIFT[1], SHIFT[2], 1.0];
    ("AffineMap", [columns.as_flattened(), &shift].concat())
}

#[test]
fn maps_that_are_not_symmetric_place_voxels_in_both_formats() {
    let leaves = two_leaves();
    let wanted = |p: Vec3| skewed(p.as_dvec3()).as_vec3();
    let open = file("", &[Tree { map: affine(), ..Tree::of(leaves.clone()) }]);
    assert_same(&only(&open).0, &leaves, wanted, "OpenVDB");
    assert_same(&only(&with_skewed_map(nano(&leaves, 1, 32, 0))).0, &leaves, wanted, "NanoVDB");
}

/// The distances from a ball, in a band of three voxels to both sides, where the map keeps them as those of the indices.
fn ball(centre: DVec3, radius: f64) -> Vec<Leaf> {
    let corner = |i: i32| [i & 1, i >> 1 & 1, i >> 2].map(|x| 8 * x);
    let leaf = |i: i32| {
        let origin = corner(i);
        let distance = |i: usize| {
            let at = [i / 64, i / 8 % 8, i % 8];
            let p = DVec3::from([0, 1, 2].map(|axis: usize| f64::from(origin[axis]) + at[axis] as f64));
            p.distance(centre) - radius
        };
        let values: Vec<f64> = (0..512).map(distance).collect();
        let active = values.iter().map(|d| d.abs() < 3.0).collect();
        Leaf { origin, active, values: values.iter().map(|d| d.clamp(-3.0, 3.0) as f32).collect() }
    };
    (0..8).map(leaf).collect()
}

/// A level set is drawn where its distances are 0: the ball of the closed form, through a map that is not symmetric.
#[test]
fn level_sets_are_drawn_as_surfaces() {
    let (centre, radius) = (DVec3::new(7.25, 8.5, 7.75), 4.25);
    let leaves = ball(centre, radius);
    let surface = Tree {
        name: "surface".into(),
        class: "level set",
        map: affine(),
        background: 3.0,
        active_only: false,
        ..Tree::of(leaves.clone())
    };
    let mut of_nano = with_skewed_map(nano(&leaves, 1, 32, 0));
    for at in [16 + 36, 16 + 176 + 8 + 632] {
        of_nano[at..at + 4].copy_from_slice(&1u32.to_le_bytes());
    }
    let [x, y, z] = [0, 1, 2].map(|i| DVec3::from(SKEWED.map(|row| row[i])));
    let volume = x.dot(y.cross(z)) * 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
    // The last one is mirrored: its first index runs the other way.
    let (name, mut mirrored) = affine();
    mirrored[..3].iter_mut().for_each(|number| *number = -*number);
    let mirrored = Tree { map: (name, mirrored), ..surface.clone() };
    for (name, bytes, along_x) in [
        ("OpenVDB", file("", std::slice::from_ref(&surface)), 1.0),
        ("NanoVDB", of_nano, 1.0),
        ("mirrored", file("", &[mirrored]), -1.0),
    ] {
        let x = x * along_x;
        let skewed = |p: DVec3| skewed(p * DVec3::new(along_x, 1.0, 1.0));
        let scene = bilux_formats::read_bytes(&bytes, "", None, "ball", &ReadOptions::default()).unwrap();
        let mesh = &scene.objects[0].mesh;
        let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize].as_dvec3());
        let (mut sum, mut middle) = (0.0, DVec3::ZERO);
        for [a, b, c] in mesh.triangles.iter().map(corners) {
            let part = a.dot(b.cross(c)) / 6.0;
            sum += part;
            middle += (a + b + c) * 0.25 * part;
        }
        // Between voxels, distances from a ball are less than those on the line from one to the next.
        assert!((sum / volume - 1.0).abs() < 0.045, "{name}: {sum}, not {volume}");
        assert!((middle / sum).distance(skewed(centre)) < 0.01, "{name}: {}", middle / sum);
        // Every vertex lies on the ball, and its normal leads away from it.
        let back = bilux_math::DMat3::from_cols(x, y, z).inverse();
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            let from = back * (p.as_dvec3() - DVec3::from(SHIFT)) - centre;
            assert!((from.length() - radius).abs() < 0.08, "{name}: {}", from.length());
            let wanted = (back.transpose() * from).normalize();
            assert!(n.as_dvec3().dot(wanted) > 0.93, "{name}: {n}, not {wanted}");
        }
    }
    // As a density it stays refused, and next to one it is named.
    let message = read_grid(&file("", std::slice::from_ref(&surface)), "a.vdb", "", &ReadOptions::default())
        .unwrap_err();
    assert!(message.to_string().contains("is a level set"), "{message}");
    let both = file("", &[surface, Tree::of(two_leaves())]);
    let scene = bilux_formats::read_bytes(&both, "", None, "both", &ReadOptions::default()).unwrap();
    assert!(crate::warnings(&scene).contains("the grid 'surface'"), "{}", crate::warnings(&scene));
}
