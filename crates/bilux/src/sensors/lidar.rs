//! Laser scans of scenes, with the parameters of the row [`LIDAR`].

use crate::{Built, Error};
use bilux_scene::{AccelChoice, Parameters, Reader, SceneBuilder, Spec};
use bilux_transport::lidar::{Keep, LIDAR, Pulse, Return, Scanner, scan};

/// A scanner with these parameters; all others have their defaults.
///
/// # Errors
/// If a parameter has a wrong name or a value out of range, or no distance is measured.
pub fn scanner(parameters: &Parameters) -> Result<Scanner, Error> {
    let mut spec = Spec::new("", LIDAR.name);
    spec.parameters = parameters.clone();
    let reader = Reader::new(&spec, &LIDAR)?;
    let number = |key: &str| reader.number_f64(key);
    let range = [number("min_range"), number("max_range")];
    if range[0] >= range[1] {
        return Err(Error::Settings(format!(
            "min_range: {} is not below max_range, {}: no distance is measured",
            range[0], range[1]
        )));
    }
    let channel = ["red", "green", "blue"].iter().position(|name| *name == reader.text("channel"));
    Ok(Scanner {
        channel: channel.unwrap_or_default(),
        divergence: number("divergence") * 1e-3,
        rays: reader.integer("rays") as u32,
        range,
        separation: number("separation"),
        threshold: number("threshold"),
        range_noise: number("range_noise"),
        intensity_noise: number("intensity_noise"),
        max_events: reader.integer("max_events") as u32,
        keep: Keep::named(&reader.text("returns")),
        seed: reader.integer("seed") as u64,
    })
}

/// Returns of the pulses of a scanner in a scene as it is: nothing is added to it. Each pulse meets moving objects where they are
/// at its time. What is built is kept for later scans and renders.
///
/// # Errors
/// If anything in the scene is wrong.
pub fn scanned(
    scene: &SceneBuilder,
    pulses: &[Pulse],
    scanner: &Scanner,
    built: &mut Built,
) -> Result<Vec<Return>, Error> {
    let times = pulses.iter().map(|pulse| pulse.time);
    let begin = times.clone().fold(f32::INFINITY, f32::min);
    let end = times.fold(f32::NEG_INFINITY, f32::max);
    if pulses.is_empty() {
        return Ok(Vec::new());
    }
    let scene = scene.build_with(&mut built.completed, &AccelChoice::default(), [begin, end], 1.0)?;
    Ok(scan(&scene, pulses, scanner))
}
