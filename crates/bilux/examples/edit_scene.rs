//! A scene that is edited while its picture is refined, as in a viewer.
//!
//! ```text
//! cargo run --release -p bilux --example edit_scene
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux::math::Motion;
use bilux::prelude::*;
use bilux::{Budget, Edit, Session};
use std::time::Duration;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = bilux::generate(&Spec::new("", "cornell"))?;
    let mut session = Session::new(scene, JobRequest::new().size(160, 120).spp(64))?;
    for frame in 1..=3 {
        let lifted = Transform::translate(Vec3::Y * 0.05 * frame as f32).ok_or("a finite translation")?;
        session.apply(Edit::Place(0, Motion::still(lifted)))?;
        session.step(Budget::Time(Duration::from_millis(100)), &Quiet)?;
        println!("frame {frame}: {} samples per pixel", session.samples());
    }
    assert_eq!(session.tree_work().trees, 5, "all, all but the object that moves, and that one three times");
    let picture = session.picture()?.ok_or("there is a picture after a step")?;
    println!("{} x {} pixels", picture.width(), picture.height());
    Ok(())
}
