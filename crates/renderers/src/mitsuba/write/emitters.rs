//! Writes lights; area and sphere lights become black shapes that emit.

use super::document::{Document, numbers};
use bilux_import::FormatError;
use bilux_import::output::values::{colour, number, vector};
use bilux_import::output::writing::Writing;
use bilux_import::world::dome::Dome;
use bilux_math::{Mat4, Rgb, Vec3};
use bilux_scene::{Spec, Value};
use std::f32::consts::PI;

/// Distance between front and back of what emits on both sides, over its size: they must not coincide.
pub(super) const APART: f32 = 1e-4;

impl Document<'_> {
    pub(super) fn emitter(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(), FormatError> {
        let position = vector(spec, "position").unwrap_or(Vec3::new(0.0, 5.0, 0.0));
        let shine = |key, default: f32| colour(spec, key).unwrap_or(Rgb::grey(default));
        match spec.kind.as_str() {
            "point" => {
                self.light("point", spec);
                self.point("position", position);
                self.rgb("intensity", shine("intensity", 100.0));
                self.close("emitter");
            }
            "spot" => {
                let ahead = vector(spec, "look_at").unwrap_or(Vec3::ZERO);
                let outer = number(spec, "angle").unwrap_or(30.0);
                let inner = number(spec, "inner_angle").unwrap_or(25.0).min(outer);
                if inner < outer {
                    writing.warn("the edge of a spotlight fades linearly in Mitsuba");
                }
                self.light("spot", spec);
                self.rgb("intensity", shine("intensity", 100.0));
                self.number("cutoff_angle", outer);
                self.number("beam_width", inner);
                let up =
                    if (ahead - position).normalize_or_zero().y.abs() > 0.99 { Vec3::X } else { Vec3::Y };
                let [from, to, up] = [position, ahead, up].map(|v| numbers(&v.to_array()).replace(' ', ", "));
                self.open("transform name=\"to_world\"");
                self.line(&format!("<lookat origin=\"{from}\" target=\"{to}\" up=\"{up}\"/>"));
                self.close("transform");
                self.close("emitter");
            }
            "directional" => {
                let [x, y, z] = vector(spec, "direction").unwrap_or(Vec3::NEG_ONE).to_array();
                if number(spec, "diameter").is_some_and(|angle| angle > 0.0) {
                    writing.warn(
                        "Mitsuba files cannot store 'diameter' of a directional light: its shadows become hard",
                    );
                }
                self.light("directional", spec);
                self.line(&format!("<vector name=\"direction\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
                self.rgb("irradiance", shine("irradiance", 3.0));
                self.close("emitter");
            }
            "rect" => self.rect(spec, position),
            "sphere" => {
                let radius = number(spec, "radius").unwrap_or(0.5);
                let id = self.id(&spec.name, "light");
                self.open(&format!("shape type=\"sphere\" id=\"{id}\""));
                self.point("center", position);
                self.number("radius", radius);
                self.glowing(radiance_of(spec, PI * radius * radius));
                self.close("shape");
            }
            "environment" => self.environment(spec, writing)?,
            other => writing.warn(format!("Mitsuba files cannot store lights of kind '{other}': left out")),
        }
        Ok(())
    }

    fn light(&mut self, kind: &str, spec: &Spec) {
        let id = self.id(&spec.name, "light");
        self.open(&format!("emitter type=\"{kind}\" id=\"{id}\""));
    }

    /// The black surface of a shape that emits.
    fn glowing(&mut self, radiance: Rgb) {
        self.open("bsdf type=\"diffuse\"");
        self.rgb("reflectance", Rgb::BLACK);
        self.close("bsdf");
        self.open("emitter type=\"area\"");
        self.rgb("radiance", radiance);
        self.close("emitter");
    }

    /// A panel. Shapes emit from their fronts: one with two sides is two.
    fn rect(&mut self, spec: &Spec, position: Vec3) {
        let edge = |key, default| vector(spec, key).unwrap_or(default);
        let (u, v) = (edge("edge_u", Vec3::X), edge("edge_v", Vec3::Z));
        let radiance = radiance_of(spec, u.cross(v).length());
        let is_one_sided =
            matches!(spec.parameters.find("sides"), Some((Value::Text(sides), _)) if sides == "front");
        let out = u.cross(v).normalize_or_zero();
        let behind = out * (APART * (u.length() + v.length()));
        let sides = [(u, out, Vec3::ZERO), (-u, -out, behind)];
        for (u, out, back) in sides.into_iter().take(if is_one_sided { 1 } else { 2 }) {
            let id = self.id(&spec.name, "light");
            self.open(&format!("shape type=\"rectangle\" id=\"{id}\""));
            let column = |axis: Vec3| axis.extend(0.0);
            let middle = (position - back).extend(1.0);
            let place = Mat4::from_cols(column(u * 0.5), column(v * 0.5), column(out), middle);
            self.matrix("to_world", place);
            self.glowing(radiance);
            self.close("shape");
        }
    }

    /// The middle of our maps is towards -z, that of Mitsuba's towards +z.
    fn environment(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(), FormatError> {
        match Dome::of(spec, self.scene, "Mitsuba", writing)? {
            None => {}
            Some(Dome::Even(radiance)) => {
                self.light("constant", spec);
                self.rgb("radiance", radiance);
                self.close("emitter");
            }
            Some(Dome::Map { file, degrees }) => {
                self.light("envmap", spec);
                self.text("filename", &file);
                self.open("transform name=\"to_world\"");
                self.line(&format!("<rotate y=\"1\" angle=\"{}\"/>", 180.0 - degrees));
                self.close("transform");
                self.close("emitter");
            }
        }
        Ok(())
    }
}

/// The radiance, given directly or as an intensity over an area.
fn radiance_of(spec: &Spec, area: f32) -> Rgb {
    match colour(spec, "radiance").filter(|radiance| !radiance.is_black()) {
        Some(radiance) => radiance,
        None => colour(spec, "intensity").unwrap_or(Rgb::BLACK) * (1.0 / area.max(f32::MIN_POSITIVE)),
    }
}
