//! Mixtures of two materials.

use crate::radiance::world::World;
use bilux_import::FormatError;
use bilux_scene::{Span, Spec, Value};

/// Two materials in one, with this share of the second.
pub(super) fn mix(world: &mut World, a: Spec, b: Spec, amount: f64, at: &Span) -> Result<Spec, FormatError> {
    if amount <= 0.0 {
        return Ok(a);
    }
    if amount >= 1.0 {
        return Ok(b);
    }
    let (a, b) = (world.material(a, at)?, world.material(b, at)?);
    let mix = Spec::new("", "mix").with("a", Value::Material(a)).with("b", Value::Material(b));
    Ok(mix.with("amount", amount as f32))
}
