//! `rect`: a flat, visible panel that emits light and casts soft shadows.

use super::{BuiltLight, CLASSIC, GROUP, LightEntry, Sides, colour, given_classic, vector};
use crate::mesh::Mesh;
use crate::messages::error::SceneError;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec2};
use std::f32::consts::PI;
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "rect",
        summary: "rectangular area light, visible to the camera",
        source: "",
        parameters: &[
            vector("position", "centre", "0 5 0"),
            vector("edge_u", "edge from one side to the other", "1 0 0"),
            vector("edge_v", "edge from one end to the other", "0 0 1"),
            colour("radiance", "emitted radiance; or give 'intensity'", "W/(m² sr)", "0"),
            colour(
                "intensity",
                "radiance times area, which stays the same when the panel shrinks",
                "W/sr",
                "0",
            ),
            Parameter {
                name: "sides",
                summary: "which sides emit light: both, or the front, to which edge_u × edge_v points",
                unit: "",
                kind: ParameterKind::Choice(Sides::NAMES),
                default: "both",
            },
            CLASSIC,
            GROUP,
        ],
    },
    surrounds: false,
    // Each side sends π times its intensity.
    flux_per_intensity: |reader| if reader.text("sides") == "front" { PI } else { 2.0 * PI },
    build: |reader, _| {
        let (p, u, v) = (reader.vector("position"), reader.vector("edge_u"), reader.vector("edge_v"));
        let area = u.cross(v).length();
        if !(area > 0.0 && area.is_finite()) {
            let message = "edge_u and edge_v of a rect light must span an area";
            return Err(SceneError::invalid(message, reader.span("edge_u")));
        }
        let emission = if reader.is_given("radiance") {
            reader.colour("radiance")
        } else {
            reader.colour("intensity") / area
        };
        if emission == Rgb::BLACK {
            let message = "a rect light needs 'radiance' or 'intensity'";
            return Err(SceneError::invalid(message, reader.span("radiance")));
        }
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let mesh = Mesh {
            name: "rect light".to_owned(),
            positions: corners.map(|(a, b)| p + u * a + v * b).to_vec(),
            uvs: corners.map(|(a, b)| Vec2::new(a + 0.5, b + 0.5)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let sides = Sides::from_name(&reader.text("sides"));
        Ok(BuiltLight::Surface { mesh: Arc::new(mesh), emission, sides, classic: given_classic(reader) })
    },
};
