//! Fraction of the sky that each point sees: one ray per pixel from the eye, then short rays in all directions, in
//! batches.
//!
//! ```text
//! cargo run --release -p bilux-accel --example ambient_occlusion
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_accel::{Accelerator, BuildOptions, Query, Ray, TriangleMesh, build};
use std::error::Error;

const SIZE: usize = 32;
const DIRECTIONS: usize = 64;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let tree = build("auto", corner()?.into(), &BuildOptions::default())?;
    let picture = picture(&*tree);
    for row in picture.chunks(SIZE) {
        let shade = |seen: &f32| char::from(b" .:-=+*#%@"[(seen * 9.0) as usize]);
        println!("{}", row.iter().map(shade).collect::<String>());
    }
    // Near the wall half of the sky is occluded; far from it, almost nothing.
    let [near, far] = [&picture[..SIZE], &picture[SIZE * (SIZE - 1)..]].map(|row| row.iter().sum::<f32>());
    assert!(near < 0.75 * far, "{near} {far}");
    Ok(())
}

/// A floor and a wall.
fn corner() -> Result<TriangleMesh, bilux_accel::MeshError> {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [4.0, 0.0, 4.0],
        [0.0, 0.0, 4.0],
        [0.0, 4.0, 0.0],
        [4.0, 4.0, 0.0],
    ];
    TriangleMesh::new(positions, vec![[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4]])
}

/// The fraction of the sky that each point of the floor sees, viewed from above.
fn picture(tree: &dyn Accelerator) -> Vec<f32> {
    let query = Query::default();
    let pixel = |i: usize| {
        let [x, z] = [i % SIZE, i / SIZE].map(|k| 4.0 * (k as f32 + 0.5) / SIZE as f32);
        let down = Ray::new([x, 3.0, z], [0.0, -1.0, 0.0]);
        let Some(hit) = tree.closest_hit(&down, &query) else { return 1.0 };
        let from = hit.point(&down);
        // A ray cannot hit the triangle that it leaves, so no offset is needed.
        let rays: Vec<Ray> =
            (0..DIRECTIONS).map(|k| Ray { exclude: hit.primitive(), ..Ray::new(from, around(k)) }).collect();
        let mut hidden = vec![false; rays.len()];
        tree.any_hits(&rays, &query, &mut hidden);
        hidden.iter().filter(|hidden| !**hidden).count() as f32 / DIRECTIONS as f32
    };
    (0..SIZE * SIZE).map(pixel).collect()
}

/// Directions spread uniformly over the hemisphere above: a spiral of equal areas.
fn around(k: usize) -> [f32; 3] {
    let y = (k as f32 + 0.5) / DIRECTIONS as f32;
    let (sin, cos) = bilux_math::transcendental::sin_cos(2.399_963 * k as f32);
    let r = (1.0 - y * y).sqrt();
    [r * cos, y, r * sin]
}
