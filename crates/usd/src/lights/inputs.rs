//! Attributes of lights.

use crate::stage::Stage;
use crate::stage::context::Context;
use bilux_import::FormatError;
use bilux_math::Rgb;

/// A number of a light, by its name now or by that in older files.
pub(super) fn number(
    stage: &Stage,
    prim: u32,
    name: &str,
    unstated: f64,
    context: &mut Context,
) -> Result<f64, FormatError> {
    let budget = &mut context.reading.budget;
    let found = match stage.number(prim, &format!("inputs:{name}"), budget)? {
        Some(found) => Some(found),
        None => stage.number(prim, name, budget)?,
    };
    Ok(found.unwrap_or(unstated))
}

pub(super) fn colour(stage: &Stage, prim: u32, context: &mut Context) -> Result<Rgb, FormatError> {
    let budget = &mut context.reading.budget;
    let found = match stage.value(prim, "inputs:color", budget)? {
        Some(found) => Some(found),
        None => stage.value(prim, "color", budget)?,
    };
    let rgb = found.and_then(|value| value.tuple::<3>()).unwrap_or([1.0; 3]);
    Ok(Rgb::from_array(rgb.map(|c| if c.is_finite() { c.max(0.0) as f32 } else { 0.0 })))
}
