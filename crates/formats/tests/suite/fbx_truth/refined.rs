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

/// Of a refined surface and of what an OBJ file of a coarser level becomes in the end, as it is or refined: the share of the places
/// of the coarser one that the finer one has too in one of some units, which is 1 if both are the same surface.
pub(super) fn share_on(ours: &SceneBuilder, units: &[DMat4], path: &Path, tolerance: f64) -> f64 {
    let size = tolerance * 2.0;
    let all = |scene: &SceneBuilder, to: &DMat4| {
        let points = scene.objects.iter().flat_map(|object| {
            let matrix =
                *to * DMat4::from_translation(scene.origin) * object.motion.at(0.0).matrix().as_dmat4();
            object.mesh.positions.iter().map(move |p| matrix.transform_point3(p.as_dvec3()))
        });
        places(points, size)
    };
    let mut best = 0.0f64;
    for subdivide in [None, Some(Scheme::CatmullClark)] {
        let options = ReadOptions { subdivide, max_memory: MEMORY, ..ReadOptions::default() };
        let Ok(limit) = read(path, &options) else { return 0.0 };
        let limit = all(&limit, &DMat4::IDENTITY);
        for unit in units {
            let ours = all(ours, unit);
            best = best.max(match count(&ours) < count(&limit) {
                true => share(&ours, &limit, tolerance),
                false => share(&limit, &ours, tolerance),
            });
            if best == 1.0 {
                return best;
            }
        }
    }
    best
}

fn count(places: &HashMap<[i64; 3], Vec<DVec3>>) -> usize {
    places.values().map(Vec::len).sum()
}

/// The share of some places that are among many.
fn share(few: &HashMap<[i64; 3], Vec<DVec3>>, many: &HashMap<[i64; 3], Vec<DVec3>>, tolerance: f64) -> f64 {
    let near = |p: &DVec3| {
        let [x, y, z] = p.to_array().map(|x| (x / (tolerance * 2.0)).floor() as i64);
        (0..27).any(|i| {
            let cell = [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1];
            many.get(&cell).is_some_and(|all| all.iter().any(|q| q.distance(*p) <= tolerance))
        })
    };
    few.values().flatten().filter(|p| near(p)).count() as f64 / count(few).max(1) as f64
}
