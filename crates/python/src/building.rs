//! Jobs, made with what earlier renders of the scene have built.

use crate::memory;
use bilux::scene::{Parameters, SceneBuilder};
use bilux::{Built, Job, JobRequest};
use std::sync::{Mutex, PoisonError};

/// The job, with what earlier renders of the scene have built, and the number of trees that were missing.
pub(crate) fn build(
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    user: &Parameters,
    max_memory: u64,
) -> Result<(Job, u64), bilux::Error> {
    build_of(scene, built, JobRequest::from(user).max_memory(memory::within_limits(max_memory)))
}

/// As [`build`], with more that is asked for.
pub(crate) fn build_of(
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    asked: JobRequest,
) -> Result<(Job, u64), bilux::Error> {
    let mut built = built.lock().unwrap_or_else(PoisonError::into_inner);
    let before = built.tree_work().trees;
    let job = Job::with_built(scene, asked, &mut built)?;
    Ok((job, built.tree_work().trees - before))
}

/// The moment, in seconds, unless a scene whose meshes move by themselves was not read for it.
///
/// # Errors
/// Says what to do.
pub(crate) fn check_moment(scene: &SceneBuilder, time: f32, loaded_at: f32) -> Result<f32, bilux::Error> {
    if !scene.inventory.moves() || time == loaded_at {
        return Ok(time);
    }
    Err(bilux::Error::Settings(format!(
        "time: the meshes of this file move, and it was read for {loaded_at} s: read it again with bilux.load(…, \
         time={time}), or pose it with scene.pose(time={time})"
    )))
}
