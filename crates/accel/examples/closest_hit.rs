//! Picking: a ray from the eye through the pixel under the mouse, and its first hit.
//!
//! ```text
//! cargo run -p bilux-accel --example closest_hit
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_accel::{BuildOptions, Query, Ray, TriangleMesh, build};
use std::error::Error;
use std::sync::Arc;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    // A square in the plane z = 0, made of two triangles.
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Arc::new(TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])?);
    let tree = build("auto", mesh.clone(), &BuildOptions::default())?;

    let eye = [0.5, 0.5, 2.0];
    for (x, y) in [(40, 60), (70, 20), (0, 0)] {
        // A window of 100 × 100 pixels that is 1.2 units wide at the distance of the square; y points down.
        let [u, v] = [x, y].map(|pixel| (f32::from(pixel as u8) + 0.5) / 100.0 - 0.5);
        let ray = Ray::new(eye, [1.2 * u, -1.2 * v, -2.0]);
        match tree.closest_hit(&ray, &Query::default()) {
            Some(hit) => {
                let (point, normal) = (hit.point(&ray), hit.normal(&mesh));
                println!("({x}, {y}): triangle {} at {point:?}, facing {normal:?}", hit.primitive);
                assert!(point[2].abs() < 1e-6 && normal == [0.0, 0.0, 1.0]);
            }
            None => println!("({x}, {y}): nothing"),
        }
    }
    Ok(())
}
