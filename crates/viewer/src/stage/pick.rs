//! Surface at a pixel, and how light gets there.

use super::json::value_json;
use super::paths;
use bilux::math::Vec2;
use bilux::scene::{CameraSample, SceneBuilder, Surface, Tracer};
use bilux::{Error, Session};
use serde_json::{Value, json};

/// The number of samples whose mean and 95% interval are shown.
const SAMPLES: u32 = 256;

/// Surface at a place of the picture, as fractions of its width and height, and this many paths of light that reach it.
///
/// # Errors
/// If the integrator fails there.
pub(super) fn answer(session: &Session, at: [f32; 2], count: u32) -> Result<Value, Error> {
    let (job, scene) = (session.job(), session.job().completed_scene());
    let settings = job.settings();
    let [x, y] = [at[0] * settings.width as f32, at[1] * settings.height as f32].map(|side| side as u32);
    let sample = CameraSample { film: Vec2::from(at), lens: Vec2::ZERO, time: settings.time };
    let ray = job.scene().from_camera(job.camera().ray(&sample));
    let surface = Tracer::new(job.scene(), false).closest(&ray);
    let light = session.outcome().map(|outcome| outcome.rendered.film.pixel(x, y).to_array());
    let estimates = job.estimate([x, y], SAMPLES)?;
    let estimates = estimates.map(|all| all.map(|one| json!({ "mean": one.mean, "half": one.half_width })));
    let paths = (0..count).map(|index| paths::path(job, [x, y], index)).collect::<Result<Vec<_>, _>>()?;
    Ok(json!({
        "say": "picked",
        "at": at,
        "pixel": [x, y],
        "surface": surface.as_ref().map(|surface| surface_json(scene, surface)),
        "light": light,
        "samples": session.samples(),
        "interval": estimates.as_ref().map(|all| all.to_vec()),
        "interval_samples": SAMPLES,
        "paths": paths,
    }))
}

/// A surface, with the names of its object and its material.
fn surface_json(scene: &SceneBuilder, surface: &Surface) -> Value {
    let object = scene.objects.get(surface.object as usize);
    let name = |object: &bilux::scene::Object| match object.name.as_str() {
        "" => object.mesh.name.clone(),
        name => name.to_owned(),
    };
    let material = object.and_then(|object| Some((object.material, scene.materials.get(object.material)?)));
    let parameters = |spec: &bilux::scene::Spec| {
        let all = spec.parameters.0.iter().map(|(key, value, _)| json!([key, value_json(value)]));
        all.collect::<Vec<_>>()
    };
    json!({
        // What lights are made of has no object in the scene.
        "object": object.map(name),
        "number": object.map(|_| surface.object),
        "material": material.map(|(number, spec)| json!({
            "number": number, "name": spec.name, "kind": spec.kind, "parameters": parameters(spec),
        })),
        "position": surface.p.to_array(),
        "normal": surface.n_shade.to_array(),
        "distance": surface.t,
        "uv": surface.uv.to_array(),
    })
}
