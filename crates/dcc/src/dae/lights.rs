//! Lights, which shine along the -z axis of their node.
//!
//! The format has no photometric units. A light of 1 that is not attenuated lights a white surface that faces it to white,
//! in the programs that it comes from: an irradiance of π. Since 2.80 Blender writes watts instead.

use super::element::Element;
use super::graph::Placed;
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::input::sink::Sink;
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb};
use bilux_scene::{Span, Spec};
use std::f64::consts::PI;

/// A light at its node.
struct Lamp<'p, 'd> {
    name: String,
    at: Span,
    element: Element<'d>,
    position: DVec3,
    forward: DVec3,
    colour: Rgb,
    radius: f32,
    posed: &'p Posed<'p, 'd>,
}

/// Adds the lights of a node. `middle` is the middle of all meshes.
pub(super) fn place<'d>(
    placed: &Placed<'d>,
    posed: &Posed<'_, 'd>,
    middle: DVec3,
    radius: f32,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    for instance in placed.node.children_named("instance_light") {
        let found = posed.document.referred(instance, "url", &mut sink.diagnostics);
        let Some(element) = found.and_then(|light| light.path(&["technique_common"])?.children().next())
        else {
            continue;
        };
        let at = element.at();
        let colour = colour(element, posed)?;
        if colour.is_black() {
            sink.diagnostics.remark("a light that is switched off is left out", || at);
            continue;
        }
        let Some(forward) = placed.world.transform_vector3(DVec3::NEG_Z).try_normalize() else {
            sink.diagnostics.note("a light's node has a scale of zero: left out", || at);
            continue;
        };
        let position = placed.world.w_axis.truncate();
        let lamp = Lamp { name: placed.node.label(), at, element, position, forward, colour, radius, posed };
        let light = match element.name() {
            "ambient" => lamp.ambient(),
            "directional" => lamp.directional(),
            "point" => lamp.point(middle, sink),
            "spot" => lamp.spot(middle, sink),
            _ => {
                sink.diagnostics.not_shown("lights of an unknown kind", || lamp.at.clone());
                continue;
            }
        };
        sink.scene.lights.push(Spec { span: lamp.at.clone(), ..light });
        if element.name() == "ambient" && !sink.scene.lights.iter().any(Spec::is_backdrop) {
            // The format has no sky: such a lamp lights what there is, and nothing is seen of it behind that.
            let nothing = Spec::new("behind ambient light", "environment").with("radiance", Rgb::BLACK);
            sink.scene.lights.push(nothing.with("backdrop", true));
        }
    }
    Ok(())
}

/// The colour of a light in linear light, times its intensity.
fn colour(element: Element, posed: &Posed) -> Result<Rgb, FormatError> {
    let stated = element.child("color");
    // A colour of a few numbers needs no budget.
    let numbers = match stated {
        Some(colour) => posed.numbers(colour, &mut bilux_import::bytes::budget::Budget::new(1 << 16))?,
        None => vec![1.0; 3],
    };
    let at = |i: usize| numbers.get(i).copied().filter(|c| *c > 0.0).unwrap_or(0.0).min(1e12) as f32;
    let colour = Rgb::new(at(0), at(1), at(2));
    let most = colour.max_channel().max(1.0);
    Ok(if posed.document.settings.is_of_blender {
        colour
    } else {
        (colour * (1.0 / most)).map(srgb_decode) * most
    })
}

impl Lamp<'_, '_> {
    fn number(&self, name: &str) -> Option<f64> {
        self.posed.number_of(self.element, name)
    }

    fn is_in_watts(&self) -> bool {
        self.posed.document.settings.is_of_new_blender
    }

    /// Light from everywhere, which adds as much to a white surface as its colour.
    fn ambient(&self) -> Spec {
        Spec::new(&self.name, "environment").with("radiance", self.colour)
    }

    fn directional(&self) -> Spec {
        let irradiance = if self.is_in_watts() { 1.0 } else { PI };
        Spec::new(&self.name, "directional")
            .with("direction", self.forward.as_vec3())
            .with("irradiance", self.colour * irradiance as f32)
    }

    /// Intensity in W/sr. Light that does not become weaker with the square of the distance alone is as bright as stated
    /// in the middle of the scene.
    fn power(&self, middle: DVec3, sink: &mut Sink) -> Rgb {
        if self.is_in_watts() {
            return self.colour * (1.0 / (4.0 * PI)) as f32;
        }
        let unit = self.posed.document.settings.unit;
        let metres = (middle - self.position).length().max(1e-6);
        let units = metres / unit;
        let constant = self.number("constant_attenuation");
        let linear = self.number("linear_attenuation").unwrap_or(0.0).max(0.0);
        let quadratic = self.number("quadratic_attenuation").unwrap_or(0.0).max(0.0);
        let constant = constant.unwrap_or(1.0).max(0.0);
        if (constant, linear) == (0.0, 0.0) && quadratic > 0.0 {
            return (self.colour * (PI * unit * unit / quadratic) as f32).clamp(0.0, 1e12);
        }
        let what = "a light without quadratic decay has it here, and is as bright as stated in the middle of the scene";
        sink.diagnostics.note(what, || self.at.clone());
        let weaker = constant + units * (linear + units * quadratic);
        let weaker = if weaker > 0.0 { weaker } else { 1.0 };
        (self.colour * (PI / weaker * metres * metres).min(1e12) as f32).clamp(0.0, 1e12)
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
        // The angle of the file is that of the whole cone.
        let outer = self.number("falloff_angle").unwrap_or(180.0).clamp(0.0, 360.0) / 2.0;
        let soft = self.number("falloff_exponent").unwrap_or(0.0).clamp(0.0, 1.0);
        let ahead = self.position + self.forward * (1.0 + 1e-4 * self.position.abs().max_element());
        Spec::new(&self.name, "spot")
            .with("position", self.position.as_vec3())
            .with("look_at", ahead.as_vec3())
            .with("intensity", self.power(middle, sink))
            .with("angle", outer as f32)
            .with("inner_angle", (outer * (1.0 - soft)) as f32)
    }
}
