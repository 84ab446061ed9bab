//! Moving objects: one mesh and many instances, each with its own motion; a ray's hit depends on its time.
//!
//! ```text
//! cargo run -p bilux-accel --example moving
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_accel::{Accelerator, BuildOptions, Instance, Query, Ray, TopLevel, TriangleMesh, TwoLevel, build};
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::{Quat, Transform, Vec3};
use std::error::Error;
use std::sync::Arc;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let square = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let mesh = Arc::new(TriangleMesh::new(square, vec![[0, 1, 2], [0, 2, 3]])?);
    let tree: Arc<dyn Accelerator> = build("auto", mesh, &BuildOptions::default())?.into();

    // One stands still at the back, the other passes in front of it within a second.
    let behind = Transform::translate(Vec3::new(0.0, 0.0, -5.0)).ok_or("no such place")?;
    let key = |time_seconds, x| MotionKey {
        time_seconds,
        translation: Vec3::new(x, 0.0, 0.0),
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    let passing = Motion::from_keys(vec![key(0.0, -4.0), key(1.0, 4.0)]).ok_or("no such motion")?;
    let instances = [Instance::new(tree.clone(), Motion::still(behind)), Instance::new(tree, passing)];
    let world = TwoLevel::new(&instances, [0.0, 1.0], TopLevel::default());

    let mut seen = Vec::new();
    for time in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let ray = Ray { time, ..Ray::new([0.1, 0.2, 3.0], [0.0, 0.0, -1.0]) };
        let hit = world.closest_hit(&ray, &Query::default()).ok_or("the one behind is always there")?;
        println!("at {time} s: instance {} at {:?}", hit.instance, hit.point(&ray));
        seen.push(hit.instance);
    }
    assert_eq!(seen, [0, 0, 1, 0, 0]);
    Ok(())
}
