//! Surfaces that emit light.

use super::look::Lamp;
use super::units::light;
use super::world::{World, turned};
use bilux_import::FormatError;
use bilux_math::DVec3;
use bilux_scene::Spec;

/// The material of a lamp's surfaces, which are black by themselves and emit from their fronts.
pub(super) fn material(world: &mut World, lamp: &Lamp) -> Result<usize, FormatError> {
    if let Some(index) = world.looks.lamps.get(&lamp.index) {
        return Ok(*index);
    }
    let spec = Spec::new(&lamp.name, "diffuse")
        .with("reflectance", 0.0f32)
        .with("emission", light(lamp.colour))
        .with("emission_sides", "front");
    let index = world.material(spec, &lamp.at)?;
    world.looks.lamps.insert(lamp.index, index);
    Ok(index)
}

/// A spotlight's surface, as light from its middle: its place, and its area as seen along the light.
pub(super) fn spot(
    world: &mut World,
    lamp: &Lamp,
    [degrees, area]: [f64; 2],
    aim: DVec3,
    middle: DVec3,
) -> Result<(), FormatError> {
    let what = "a spotlight is a point in the middle of its surface, which is not seen, with a sharp edge to its cone";
    world.diagnostics.remark(what, || lamp.at.clone());
    let Some(aim) = turned(aim).try_normalize() else {
        world.diagnostics.note("a spotlight without a direction is left out", || lamp.at.clone());
        return Ok(());
    };
    let position = world.point(middle);
    // Far from the origin, 32-bit floats may not resolve one metre.
    let ahead = position + aim * (1.0 + 1e-4 * position.abs().max_element());
    let half = (0.5 * degrees).clamp(0.0, 180.0) as f32;
    let spec = Spec::new(&lamp.name, "spot")
        .with("position", position.as_vec3())
        .with("look_at", ahead.as_vec3())
        .with("intensity", light(lamp.colour.map(|c| c * area)))
        .with("angle", half)
        .with("inner_angle", half);
    world.light(spec, &lamp.at)
}
