//! Lights, which shine along the -y axis of their node.
//!
//! The format has no photometric units. An intensity of 100 lights a white surface that faces the lamp to white, in the
//! programs that it comes from: an irradiance of π. Blender writes watts times 100 instead, since 2.80.

use super::attributes::{self, Attribute};
use super::document::{Properties, Settings, display_name};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use bilux_import::input::sink::Sink;
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb};
use bilux_scene::{Span, Spec};
use std::f64::consts::PI;

/// Decay of light with the distance.
const NONE: i64 = 0;
const LINEAR: i64 = 1;
const CUBIC: i64 = 3;

/// A light at its node.
struct Lamp<'p> {
    name: String,
    at: Span,
    position: DVec3,
    forward: DVec3,
    colour: Rgb,
    intensity: f64,
    decay: i64,
    unit: f64,
    /// The distance in metres up to which quadratic decay does not set in.
    reach: f64,
    is_in_watts: bool,
    radius: f32,
    properties: &'p Properties<'p, 'p>,
}

/// Adds the light of a node, if it has one. `middle` is the middle of all meshes.
pub(super) fn place(
    placed: &Placed,
    posed: &Posed,
    graph: &Graph,
    middle: DVec3,
    radius: f32,
    sink: &mut Sink,
) {
    let Some(Attribute { properties, index }) = attributes::of_kind("Light", placed.model, posed) else {
        return;
    };
    let document = posed.document;
    let at = document.object(index).node.at();
    let number = |name: &str, default: f64| properties.number(name).unwrap_or(default);
    let intensity = number("Intensity", 100.0).max(0.0) / 100.0;
    if number("CastLight", 1.0) == 0.0 || intensity == 0.0 {
        sink.diagnostics.remark("a light that is switched off is left out", || at);
        return;
    }
    let Some(forward) = attributes::direction(placed, DVec3::NEG_Y, posed, graph) else {
        sink.diagnostics.note("a light's node has a scale of zero: left out", || at);
        return;
    };
    let Settings { is_of_blender, lamps_have_reach, unit, .. } = document.settings;
    let [r, g, b] = properties.vector("Color").unwrap_or(DVec3::ONE).to_array().map(|c| c.max(0.0) as f32);
    let colour = Rgb::new(r, g, b);
    let lamp = Lamp {
        name: display_name(document.object(placed.model).name),
        at,
        position: placed.world.w_axis.truncate(),
        forward,
        colour: if is_of_blender { colour } else { colour.map(srgb_decode) },
        intensity,
        decay: properties.integer("DecayType").unwrap_or(NONE),
        unit,
        reach: if lamps_have_reach { number("DecayStart", 30.0).max(1e-6) * unit } else { unit },
        is_in_watts: is_of_blender && !lamps_have_reach,
        radius,
        properties: &properties,
    };
    let light = match properties.integer("LightType").unwrap_or(0) {
        0 => lamp.point(middle, sink),
        1 => lamp.directional(),
        2 => lamp.spot(middle, sink),
        3 => lamp.area(placed, middle, sink),
        _ => {
            sink.diagnostics.not_shown("volume lights", || lamp.at.clone());
            return;
        }
    };
    sink.scene.lights.push(Spec { span: lamp.at.clone(), ..light });
}

impl Lamp<'_> {
    fn directional(&self) -> Spec {
        let irradiance = if self.is_in_watts { self.intensity } else { PI * self.intensity };
        Spec::new(&self.name, "directional")
            .with("direction", self.forward.as_vec3())
            .with("irradiance", self.colour * irradiance as f32)
    }

    /// Intensity in W/sr. Light that does not become weaker with the square of the distance is as bright as stated in
    /// the middle of the scene.
    fn power(&self, middle: DVec3, sink: &mut Sink) -> Rgb {
        if self.is_in_watts {
            return self.colour * (self.intensity / (4.0 * PI)) as f32;
        }
        let metres = (middle - self.position).length().max(1e-6);
        let units = metres / self.unit;
        if self.decay == 2 {
            return self.colour * (PI * self.intensity * self.reach * self.reach).min(1e12) as f32;
        }
        let what = "a light without quadratic decay has it here, and is as bright as stated in the middle of the scene";
        sink.diagnostics.note(what, || self.at.clone());
        let weaker = match self.decay {
            LINEAR => units,
            CUBIC => units * units * units,
            _ => 1.0,
        };
        self.colour * (PI * self.intensity / weaker * metres * metres).min(1e12) as f32
    }

    fn point(&self, middle: DVec3, sink: &mut Sink) -> Spec {
        let intensity = self.power(middle, sink);
        let spec = if self.radius > 0.0 && !intensity.is_black() {
            Spec::new(&self.name, "sphere").with("radius", self.radius)
        } else {
            Spec::new(&self.name, "point")
        };
        spec.with("position", self.position.as_vec3()).with("intensity", intensity)
    }

    fn spot(&self, middle: DVec3, sink: &mut Sink) -> Spec {
        let number = |names: [&str; 2], default: f64| {
            names.iter().find_map(|name| self.properties.number(name)).unwrap_or(default)
        };
        // The angles of the file are those of the whole cone.
        let outer = number(["OuterAngle", "Cone angle"], 45.0).clamp(0.0, 360.0) / 2.0;
        let inner = number(["InnerAngle", "HotSpot"], 0.0).clamp(0.0, 2.0 * outer) / 2.0;
        let ahead = self.position + self.forward * (1.0 + 1e-4 * self.position.abs().max_element());
        Spec::new(&self.name, "spot")
            .with("position", self.position.as_vec3())
            .with("look_at", ahead.as_vec3())
            .with("intensity", self.power(middle, sink))
            .with("angle", outer as f32)
            .with("inner_angle", inner as f32)
    }

    /// A square that is two units wide, as its node's scale makes it, with the same light as a point.
    fn area(&self, placed: &Placed, middle: DVec3, sink: &mut Sink) -> Spec {
        if self.properties.integer("AreaLightShape") == Some(1) {
            sink.diagnostics
                .note("an area light in the shape of a sphere is a square here", || self.at.clone());
        }
        let [u, v] = [DVec3::X, DVec3::Z].map(|axis| placed.world.transform_vector3(axis) * 2.0);
        let area = u.cross(v).length();
        if area <= 0.0 || !area.is_finite() {
            return self.point(middle, sink);
        }
        // Its front is where the first edge times the second points.
        let (u, v) = if u.cross(v).dot(self.forward) >= 0.0 { (u, v) } else { (v, u) };
        let radiance = match self.is_in_watts {
            true => self.colour * (self.intensity / (PI * area)) as f32,
            false => self.power(middle, sink) * (1.0 / area) as f32,
        };
        Spec::new(&self.name, "rect")
            .with("position", self.position.as_vec3())
            .with("edge_u", u.as_vec3())
            .with("edge_v", v.as_vec3())
            .with("radiance", radiance.clamp(0.0, 1e12))
            .with("sides", "front")
    }
}
