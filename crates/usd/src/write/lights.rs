//! Writes lights: the inverse of [`crate::lights`].

use super::document::{Document, Look};
use super::placement::placed;
use super::text::{Text, asset, quoted, rgb};
use bilux_import::FormatError;
use bilux_import::output::values::{colour, number, vector};
use bilux_import::output::writing::Writing;
use bilux_import::world::dome::Dome;
use bilux_import::world::placement::looking;
use bilux_math::{Mat4, Rgb, Vec3};
use bilux_scene::{Mesh, Spec, Value};

impl Document<'_> {
    pub(super) fn light(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(), FormatError> {
        let position = vector(spec, "position").unwrap_or(Vec3::new(0.0, 5.0, 0.0));
        let shine = |key, default: f32| colour(spec, key).unwrap_or(Rgb::grey(default));
        match spec.kind.as_str() {
            "point" => {
                let mut lines = point(shine("intensity", 100.0));
                lines.push("float inputs:radius = 0.01".to_owned());
                self.prim("SphereLight", spec, &Mat4::from_translation(position), &lines);
            }
            "spot" => {
                let at = vector(spec, "look_at").unwrap_or(Vec3::ZERO);
                let mut lines = point(shine("intensity", 100.0));
                lines.push("float inputs:radius = 0.01".to_owned());
                lines.extend(cone(spec));
                let place = looking(position, at - position, Vec3::Y);
                self.prim("SphereLight", spec, &place, &lines);
            }
            "directional" => {
                let direction = vector(spec, "direction").unwrap_or(Vec3::NEG_ONE);
                let mut lines = emission(shine("irradiance", 3.0));
                lines.push(format!("float inputs:angle = {}", number(spec, "diameter").unwrap_or(0.0)));
                // What is divided by the solid angle is the irradiance.
                lines.push("bool inputs:normalize = 1".to_owned());
                self.prim("DistantLight", spec, &looking(Vec3::ZERO, direction, Vec3::Y), &lines);
            }
            "rect" => self.rect(spec, position),
            "sphere" => {
                let radius = number(spec, "radius").unwrap_or(0.5);
                let mut lines = emission(radiance_of(spec, std::f32::consts::PI * radius * radius));
                lines.push(format!("float inputs:radius = {radius}"));
                self.prim("SphereLight", spec, &Mat4::from_translation(position), &lines);
            }
            "environment" => return self.dome(spec, writing),
            other => writing.warn(format!("USD files cannot store lights of kind '{other}': left out")),
        }
        Ok(())
    }

    fn prim(&mut self, kind: &str, spec: &Spec, place: &Mat4, lines: &[String]) {
        let name = self.names.unused(&spec.name, "light");
        let mut metadata = Vec::new();
        if lines.iter().any(|line| line.contains("shaping:")) {
            metadata.push("prepend apiSchemas = [\"ShapingAPI\"]".to_owned());
        }
        if name != spec.name && !spec.name.is_empty() {
            metadata.push(format!("displayName = {}", quoted(&spec.name)));
        }
        let mut text = std::mem::replace(&mut self.prims, Text::at_depth(1));
        text.open(&format!("def {kind} \"{name}\""), &metadata);
        for line in lines {
            text.line(line);
        }
        placed(place, &mut text);
        text.close();
        self.prims = text;
    }

    /// A panel. Lights of USD emit on one side; a panel that emits on both is a mesh that emits.
    fn rect(&mut self, spec: &Spec, position: Vec3) {
        let edge = |key, default| vector(spec, key).unwrap_or(default);
        let (u, v) = (edge("edge_u", Vec3::X), edge("edge_v", Vec3::Z));
        let radiance = radiance_of(spec, u.cross(v).length());
        let one_sided =
            matches!(spec.parameters.find("sides"), Some((Value::Text(sides), _)) if sides == "front");
        if !one_sided {
            return self.panel(spec, &Mesh::quad(position - (u + v) * 0.5, u, v), radiance);
        }
        // They emit along -z, and our front is where the edges turn to.
        let (x, y) = (u.normalize_or_zero(), -v.normalize_or_zero());
        let axes = [x, y, x.cross(y).normalize_or_zero()].map(|axis| axis.extend(0.0));
        let place = Mat4::from_cols(axes[0], axes[1], axes[2], position.extend(1.0));
        let mut lines = emission(radiance);
        lines.push(format!("float inputs:height = {}", v.length()));
        lines.push(format!("float inputs:width = {}", u.length()));
        self.prim("RectLight", spec, &place, &lines);
    }

    fn panel(&mut self, spec: &Spec, mesh: &Mesh, radiance: Rgb) {
        let name = self.material_names.unused(&spec.name, "light");
        let path = Self::material_path(&name);
        let text = &mut self.materials;
        text.open(&format!("def Material \"{name}\""), &[]);
        text.line(&format!("token outputs:surface.connect = <{path}/Surface.outputs:surface>"));
        text.open("def Shader \"Surface\"", &[]);
        text.line("uniform token info:id = \"UsdPreviewSurface\"");
        text.line("color3f inputs:diffuseColor = (0, 0, 0)");
        text.line(&format!("color3f inputs:emissiveColor = {}", rgb(radiance)));
        // Without a reflection.
        text.line("float inputs:ior = 1");
        text.line("float inputs:roughness = 1");
        text.line("token outputs:surface");
        text.close();
        text.close();
        let look = Look { path, has_two_sides: true, ..Look::default() };
        self.bare(&spec.name, mesh, &look);
    }

    /// The light all around. The middle of our maps is towards -z, that of domes towards +z.
    fn dome(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(), FormatError> {
        match Dome::of(spec, self.scene, "USD", writing)? {
            None => {}
            Some(Dome::Even(radiance)) => {
                self.prim("DomeLight", spec, &Mat4::IDENTITY, &emission(radiance));
            }
            Some(Dome::Map { file, degrees }) => {
                let mut lines = emission(Rgb::WHITE);
                lines.push(format!("asset inputs:texture:file = {}", asset(&file)));
                lines.push("token inputs:texture:format = \"latlong\"".to_owned());
                let place = Mat4::from_rotation_y((180.0 - degrees).to_radians());
                self.prim("DomeLight", spec, &place, &lines);
            }
        }
        Ok(())
    }
}

/// A colour, and how strong it is.
fn emission(light: Rgb) -> Vec<String> {
    let most = light.max_channel();
    let shade = if most > 0.0 { light * (1.0 / most) } else { light };
    vec![format!("color3f inputs:color = {}", rgb(shade)), format!("float inputs:intensity = {most}")]
}

/// A sphere that is no more than a point: of what it sends, a sphere's section shows a quarter of its surface.
fn point(intensity: Rgb) -> Vec<String> {
    let mut lines = emission(intensity * 4.0);
    lines.push("bool inputs:normalize = 1".to_owned());
    lines.push("bool treatAsPoint = 1".to_owned());
    lines
}

/// The cone of a spotlight, whose edge begins at this part of its angle from the edge.
fn cone(spec: &Spec) -> [String; 2] {
    let outer = number(spec, "angle").unwrap_or(30.0);
    let inner = number(spec, "inner_angle").unwrap_or(25.0).min(outer);
    let softness = if outer > 0.0 { 1.0 - inner / outer } else { 0.0 };
    [
        format!("float inputs:shaping:cone:angle = {outer}"),
        format!("float inputs:shaping:cone:softness = {softness}"),
    ]
}

/// The radiance, given directly or as an intensity over an area.
fn radiance_of(spec: &Spec, area: f32) -> Rgb {
    match colour(spec, "radiance").filter(|radiance| !radiance.is_black()) {
        Some(radiance) => radiance,
        None => colour(spec, "intensity").unwrap_or(Rgb::BLACK) * (1.0 / area.max(f32::MIN_POSITIVE)),
    }
}
