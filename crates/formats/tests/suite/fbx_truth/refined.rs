//! Subdivision surfaces: an OBJ file has some level of them.

use bilux_formats::{ReadOptions, Scheme, read};
use bilux_math::{DMat4, DVec3};
use bilux_scene::SceneBuilder;
use std::collections::HashMap;
use std::path::Path;

/// For each read: refined further, surfaces take minutes to compare.
pub(super) const MEMORY: u64 = 200 << 20;

/// The places of corners, each once.
pub(super) fn places(corners: impl Iterator<Item = DVec3>, size: f64) -> HashMap<[i64; 3], Vec<DVec3>> {
    let mut places: HashMap<[i64; 3], Vec<DVec3>> = HashMap::new();
    for p in corners {
        let cell = places.entry(p.to_array().map(|x| (x / size).floor() as i64)).or_default();
        if !cell.contains(&p) {
            cell.push(p);
        }
    }
    places
}

/// Of a refined surface and of what an OBJ file of a coarser level becomes in the end: the share of the places of the coarser one
/// that the finer one has too, which is 1 if both are the same surface.
pub(super) fn share_on(ours: &SceneBuilder, to_file: &DMat4, path: &Path, tolerance: f64) -> f64 {
    let mut best = 0.0f64;
    for subdivide in [None, Some(Scheme::CatmullClark)] {
        let Ok(limit) = read(path, &ReadOptions { subdivide, max_memory: MEMORY, ..ReadOptions::default() })
        else {
            return 0.0;
        };
        let all = |scene: &SceneBuilder, to: &DMat4| {
            let points = scene.objects.iter().flat_map(|object| {
                let matrix =
                    *to * DMat4::from_translation(scene.origin) * object.motion.at(0.0).matrix().as_dmat4();
                object.mesh.positions.iter().map(move |p| matrix.transform_point3(p.as_dvec3()))
            });
            places(points, tolerance * 2.0)
        };
        let (mut few, mut many) = (all(ours, to_file), all(&limit, &DMat4::IDENTITY));
        if few.len() > many.len() {
            std::mem::swap(&mut few, &mut many);
        }
        let near = |p: &DVec3| {
            let [x, y, z] = p.to_array().map(|x| (x / (tolerance * 2.0)).floor() as i64);
            (0..27).any(|i| {
                let cell = [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1];
                many.get(&cell).is_some_and(|all| all.iter().any(|q| q.distance(*p) <= tolerance))
            })
        };
        let total: usize = few.values().map(Vec::len).sum();
        let found = few.values().flatten().filter(|p| near(p)).count();
        best = best.max(found as f64 / total.max(1) as f64);
    }
    best
}
