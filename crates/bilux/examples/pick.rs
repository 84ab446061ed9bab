//! Prints what is visible at a pixel: the object's name, its distance, and the normal there.
//!
//! ```text
//! cargo run -p bilux --example pick
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux::prelude::*;
use bilux::scene::{CameraSample, Tracer};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = bilux::generate(&Spec::new("", "cornell"))?;
    let job = Job::new(&scene, JobRequest::new())?;
    let (_, camera) = job.scene().cameras().first().ok_or("the scene has a camera")?;
    let mut tracer = Tracer::new(job.scene(), false);
    let mut names = Vec::new();
    for (x, y) in [(0.5, 0.5), (0.02, 0.5), (0.98, 0.5)] {
        let ray = camera.ray(&CameraSample { film: Vec2::new(x, y), lens: Vec2::ZERO, time: 0.0 });
        match tracer.closest(&ray) {
            Some(surface) => {
                let name =
                    scene.objects.get(surface.object as usize).map_or("a light", |object| &object.name);
                println!("({x}, {y}): {name}, {:.2} away, facing {}", surface.t, surface.n_geom);
                names.push(name.to_owned());
            }
            None => println!("({x}, {y}): nothing"),
        }
    }
    assert_eq!(names.len(), 3, "the box fills the picture");
    Ok(())
}
