//! Writes lights; area and sphere lights become black emissive shapes.

use super::document::{Document, float, from_to, numbers, point, rgb};
use bilux_import::FormatError;
use bilux_import::appearance::environment_maps::on_the_sphere;
use bilux_import::output::values::{colour, number, texture, vector};
use bilux_import::output::writing::Writing;
use bilux_math::{Rgb, Vec3};
use bilux_pictures::{Picture, write_bytes};
use bilux_scene::lights::{BuiltLight, build};
use bilux_scene::{Spec, Value};

/// The material of shapes that only emit.
const BLACK: &str = "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]";

impl Document<'_> {
    pub(super) fn light(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(), FormatError> {
        let position = vector(spec, "position").unwrap_or(Vec3::new(0.0, 5.0, 0.0));
        let shine = |key, default: f32| colour(spec, key).unwrap_or(Rgb::grey(default));
        match spec.kind.as_str() {
            "point" => {
                let given = rgb("I", shine("intensity", 100.0)) + &point("from", position);
                self.line(&format!("LightSource \"point\"{given}"));
            }
            "directional" => {
                let direction = vector(spec, "direction").unwrap_or(Vec3::NEG_ONE);
                let given = rgb("L", shine("irradiance", 3.0)) + &from_to(Vec3::ZERO, direction);
                self.line(&format!("LightSource \"distant\"{given}"));
                if number(spec, "diameter").is_some_and(|angle| angle > 0.0) {
                    writing.warn(
                        "pbrt files cannot store 'diameter' of a directional light: its shadows become hard",
                    );
                }
            }
            "spot" => {
                let ahead = vector(spec, "look_at").unwrap_or(Vec3::ZERO);
                let outer = number(spec, "angle").unwrap_or(30.0);
                let inner = number(spec, "inner_angle").unwrap_or(25.0);
                let cone = float("coneangle", outer) + &float("conedeltaangle", (outer - inner).max(0.0));
                let given = rgb("I", shine("intensity", 100.0)) + &from_to(position, ahead) + &cone;
                self.line(&format!("LightSource \"spot\"{given}"));
            }
            "rect" => {
                let edge = |key, default| vector(spec, key).unwrap_or(default);
                let (u, v) = (edge("edge_u", Vec3::X), edge("edge_v", Vec3::Z));
                let radiance = radiance_of(spec, u.cross(v).length());
                let is_in_front =
                    matches!(spec.parameters.find("sides"), Some((Value::Text(t), _)) if t == "front");
                let corners =
                    [-u - v, u - v, u + v, v - u].map(|c| numbers(&(position + c * 0.5).to_array()));
                let shape = format!(
                    "\"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ {} ]",
                    corners.join("  ")
                );
                self.glowing("", &shape, radiance, !is_in_front);
            }
            "sphere" => {
                let radius = number(spec, "radius").unwrap_or(0.5);
                let radiance = radiance_of(spec, std::f32::consts::PI * radius * radius);
                let place = format!("Translate {}\n", numbers(&position.to_array()));
                self.glowing(&place, &format!("\"sphere\"{}", float("radius", radius)), radiance, false);
            }
            "environment" => return self.environment(spec, writing),
            other => writing.warn(format!("pbrt files cannot store lights of kind '{other}': left out")),
        }
        Ok(())
    }

    /// Writes a black shape that emits light.
    fn glowing(&mut self, place: &str, shape: &str, radiance: Rgb, both_sides: bool) {
        let light = area_light(&rgb("L", radiance), both_sides);
        self.line(&format!("AttributeBegin\n{place}{BLACK}\n{light}\nShape {shape}\nAttributeEnd"));
    }

    fn environment(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(), FormatError> {
        let BuiltLight::Light(built) = build(spec, &self.scene.textures)? else { return Ok(()) };
        if built.is_backdrop() {
            writing.warn("pbrt files cannot store backdrops, which light nothing: left out");
            return Ok(());
        }
        let picture = texture(spec, "radiance").and_then(|i| self.scene.textures.get(i));
        let changes = ["zenith", "horizon", "ground"].iter().any(|key| colour(spec, key).is_some());
        if picture.is_none() && !changes {
            self.line(&format!("LightSource \"infinite\"{}", rgb("L", built.le(Vec3::Y))));
            return Ok(());
        }
        // The square has enough texels to keep the resolution of the longitude-latitude map at its equator.
        let side = picture.map_or(256, |picture| (picture.height() * 3 / 2).clamp(64, 2048));
        let place = |k: usize| (k as f64 + 0.5) / side as f64;
        let texels = (0..side * side).map(|i| {
            let direction = on_the_sphere(place(i % side), place(i / side));
            built.le(direction.as_vec3())
        });
        let picture = Picture::from_rgb(side, side, texels.collect())?;
        let bytes = write_bytes("exr", &picture, &bilux_pictures::WriteOptions::default())?;
        let name = writing.add_numbered("sky", writing.count() + 1, "exr", bytes);
        writing.warn("environment maps are resampled to pbrt's square layout");
        self.line(&format!("LightSource \"infinite\" \"string filename\" \"{name}\""));
        Ok(())
    }
}

/// The directive that makes the shapes after it emit.
pub(super) fn area_light(radiance: &str, both_sides: bool) -> String {
    let sides = if both_sides { " \"bool twosided\" true" } else { "" };
    format!("AreaLightSource \"diffuse\"{radiance}{sides}")
}

/// The radiance, given directly or as an intensity over an area.
fn radiance_of(spec: &Spec, area: f32) -> Rgb {
    match colour(spec, "radiance").filter(|radiance| !radiance.is_black()) {
        Some(radiance) => radiance,
        None => colour(spec, "intensity").unwrap_or(Rgb::BLACK) * (1.0 / area.max(f32::MIN_POSITIVE)),
    }
}
