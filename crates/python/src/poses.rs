//! A scene in other frames, for layers of motion.

use crate::building::build_of;
use crate::request::Request;
use bilux::scene::{Object, SceneBuilder};
use bilux::transport::aovs::Aov;
use bilux::{Built, Job, JobRequest};
use std::sync::{Arc, Mutex};

/// The arguments that give the scene in other frames.
const NAMES: [&str; 2] = ["next", "previous"];

/// The job with the next and the previous pose of the scene, as far as the wanted layers need them: the scenes that were given,
/// or, of a file whose meshes move by themselves, what it holds for these times.
///
/// # Errors
/// If the other scenes have other objects, or the file cannot be read again.
pub(crate) fn with_other_poses(
    mut job: Job,
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    request: &Request,
) -> Result<Job, bilux::Error> {
    for (i, is_needed) in [Aov::needs_next, Aov::needs_previous].into_iter().enumerate() {
        if !request.aovs.iter().copied().any(is_needed) {
            continue;
        }
        let frame = if i == 0 { 1.0 } else { -1.0 } / job.settings().fps;
        let Some(other) = posed(scene, request, i, job.settings().time + frame)? else { continue };
        let asked = JobRequest::from(&request.user).max_memory(request.max_memory);
        let (other, _) = build_of(&other, built, asked.in_series(request.series.clone()))?;
        job = if i == 0 { job.moving_to(&other) } else { job.moving_from(&other) };
    }
    Ok(job)
}

/// The scene in another frame, if anything but its own motion says what it is there.
fn posed(
    scene: &SceneBuilder,
    request: &Request,
    frame: usize,
    time: f32,
) -> Result<Option<SceneBuilder>, bilux::Error> {
    let same = |(now, then): (&Object, &Object)| {
        Arc::ptr_eq(&now.mesh, &then.mesh) || now.mesh.triangles == then.mesh.triangles
    };
    let fits = |then: &SceneBuilder| {
        then.objects.len() == scene.objects.len() && scene.objects.iter().zip(&then.objects).all(same)
    };
    let mut other = scene.clone();
    if let Some(given) = &request.others[frame] {
        if !fits(given) {
            return Err(bilux::Error::Settings(format!(
                "{}: this scene has other objects: give a copy of the scene whose objects are elsewhere or posed otherwise",
                NAMES[frame]
            )));
        }
        (other.objects, other.cameras) = (given.objects.clone(), given.cameras.clone());
        return Ok(Some(other));
    }
    if !scene.inventory.moves() {
        return Ok(None);
    }
    let read = request.origin.as_ref().map(|origin| origin.read_at(time)).transpose()?;
    let Some(read) = read.filter(fits) else {
        return Err(bilux::Error::Settings(
            "aov: the motion of meshes that move by themselves takes the file again, at another frame: render the scene as \
             bilux.load returned it, without other objects, and not from a pickle; or give next= and previous="
                .to_owned(),
        ));
    };
    for (object, read) in other.objects.iter_mut().zip(read.objects) {
        object.mesh = read.mesh;
    }
    Ok(Some(other))
}
