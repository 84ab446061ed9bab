//! `EXT_lights_area`: flat panels and discs that emit from one side, in nits.

use crate::document::json::JsonNode;
use crate::graph::nodes::Placed;
use bilux_import::FormatError;
use bilux_import::input::sink::Sink;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DVec3, Rgb, Vec3};
use bilux_scene::{Mesh, Object, Spec};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Number of vertices around a disc.
const AROUND: u32 = 64;

/// Places a light at its node, shining along the node's -z.
pub(crate) fn place<'d>(
    root: JsonNode<'d>,
    user: JsonNode<'d>,
    placed: &Placed<'d>,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let index = user.need("light")?;
    let list = root.extension("EXT_lights_area");
    let Some(light) = list.and_then(|list| list.item("lights", index.as_count().ok()?)) else {
        return Err(index.error("the document's EXT_lights_area has no such light"));
    };
    let colour = light.numbers::<3>("color")?.unwrap_or([1.0; 3]).map(|c| c.max(0.0) as f32);
    let radiance = Rgb::from_array(colour) * light.number("intensity")?.unwrap_or(1000.0).max(0.0) as f32;
    let axes = [DVec3::X, DVec3::Y, DVec3::NEG_Z].map(|axis| placed.world.transform_vector3(axis));
    let scale = axes.into_iter().map(DVec3::length).fold(0.0, f64::max);
    let size = light.number("size")?.unwrap_or(1.0).max(0.0) * scale;
    let [_, up, forward] = axes.map(DVec3::normalize_or_zero);
    let right = forward.cross(up).normalize_or_zero();
    if radiance.is_black() || !(size > 0.0 && size.is_finite()) || right == DVec3::ZERO {
        sink.diagnostics.note("a light without a size or without intensity is left out", || light.at());
        return Ok(());
    }
    let up = right.cross(forward);
    let name = if placed.node.name().is_empty() { light.name() } else { placed.node.name() };
    let middle = placed.world.w_axis.truncate();
    match light.text("type")?.unwrap_or("rect") {
        "rect" => {
            let aspect = light.get("rect").map_or(Ok(None), |rect| rect.number("aspect"))?.unwrap_or(1.0);
            let spec = Spec::new(name, "rect")
                .with("position", middle.as_vec3())
                .with("edge_u", (right * (size * aspect.abs())).as_vec3())
                .with("edge_v", (up * -size).as_vec3())
                .with("radiance", radiance)
                .with("sides", "front");
            sink.scene.lights.push(Spec { span: light.at(), ..spec });
        }
        "disk" => {
            let black = Spec::new(name, "diffuse").with("reflectance", 0.0f32).with("emission", radiance);
            let material = sink.scene.add_material(black.with("emission_sides", "front"));
            let mesh = disc(middle, right * (size * 0.5), up * (size * 0.5));
            sink.scene.objects.push(Object::new(name, Arc::new(mesh), material));
        }
        other => {
            return Err(light.error(format!("'{other}' is not a type of area light: use rect or disk")));
        }
    }
    Ok(())
}

/// A disc whose vertices run counter-clockwise as seen from the side that `v × u` points to.
fn disc(middle: DVec3, u: DVec3, v: DVec3) -> Mesh {
    let rim = |i: u32| -> Vec3 {
        let (sin, cos) = sin_cos_f64(f64::from(i) / f64::from(AROUND) * TAU);
        (middle + u * cos - v * sin).as_vec3()
    };
    Mesh {
        name: "disk light".to_owned(),
        positions: std::iter::once(middle.as_vec3()).chain((0..AROUND).map(rim)).collect(),
        triangles: (0..AROUND).map(|i| [0, 1 + i, 1 + (i + 1) % AROUND]).collect(),
        ..Mesh::default()
    }
}
