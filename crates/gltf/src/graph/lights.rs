//! `KHR_lights_punctual`: candela and lux become W/sr and W/m² with a factor of one.

use crate::document::json::JsonNode;
use crate::graph::nodes::Placed;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DVec3, Rgb};
use bilux_scene::Spec;

/// A light at its node, with a radius if that is above 0.
///
/// `None`, with a warning, if the node's transform leaves it no direction.
pub(crate) fn light<'d>(
    root: JsonNode<'d>,
    user: JsonNode<'d>,
    placed: &Placed<'d>,
    radius: f32,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Spec>, FormatError> {
    let index = user.need("light")?;
    let list = root.extension("KHR_lights_punctual");
    let Some(light) = list.and_then(|list| list.item("lights", index.as_count().ok()?)) else {
        return Err(index.error("the document's KHR_lights_punctual has no such light"));
    };
    let (position, kind) = (placed.world.w_axis.truncate(), light.need("type")?);
    let Some(forward) = placed.world.transform_vector3(DVec3::NEG_Z).try_normalize() else {
        diagnostics.note("a light's node has a scale of zero: left out", || placed.node.at());
        return Ok(None);
    };
    let colour = light.numbers::<3>("color")?.unwrap_or([1.0; 3]).map(|c| c.max(0.0) as f32);
    let intensity = light.number("intensity")?.unwrap_or(1.0).max(0.0) as f32;
    let power = Rgb::from_array(colour) * intensity;
    let name = if placed.node.name().is_empty() { light.name() } else { placed.node.name() };
    let spec = match kind.as_text()? {
        "directional" => {
            Spec::new(name, "directional").with("direction", forward.as_vec3()).with("irradiance", power)
        }
        "point" if radius > 0.0 && power != Rgb::BLACK => Spec::new(name, "sphere")
            .with("position", position.as_vec3())
            .with("radius", radius)
            .with("intensity", power),
        "point" => Spec::new(name, "point").with("position", position.as_vec3()).with("intensity", power),
        "spot" => {
            let cone = light.need("spot")?;
            let angle = |key, default: f64| Ok::<_, FormatError>(cone.number(key)?.unwrap_or(default));
            let inner = angle("innerConeAngle", 0.0)?.clamp(0.0, 3.1).to_degrees() as f32;
            let outer = angle("outerConeAngle", std::f64::consts::FRAC_PI_4)?.clamp(0.0, 3.1).to_degrees();
            Spec::new(name, "spot")
                .with("position", position.as_vec3())
                .with("look_at", (position + forward * (1.0 + 1e-4 * position.abs().max_element())).as_vec3())
                .with("intensity", power)
                .with("angle", outer as f32)
                .with("inner_angle", inner)
        }
        other => {
            return Err(
                kind.error(format!("'{other}' is not a type of light: use directional, point or spot"))
            );
        }
    };
    if radius > 0.0 && spec.kind != "sphere" {
        diagnostics.note("only point lights get a radius", || light.at());
    }
    if light.get("range").is_some() {
        diagnostics
            .note("a light's range is ignored: light falls off with the square of the distance", || {
                light.at()
            });
    }
    Ok(Some(Spec { span: light.at(), ..spec }))
}
