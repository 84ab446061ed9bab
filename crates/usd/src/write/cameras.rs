//! Writes cameras.

use super::document::Document;
use super::placement::placed;
use super::text::{Text, quoted};
use bilux_import::output::values::{number, vector};
use bilux_import::output::writing::Writing;
use bilux_import::world::camera_loss::{field_of_view, not_perspective, picture_aspect_ratio};
use bilux_import::world::frame::metres;
use bilux_import::world::placement::looking;
use bilux_math::Vec3;
use bilux_math::transcendental::tan;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Spec, Value};

/// The height of the film in metres, that of small picture film.
const FILM: f64 = 0.024;

impl Document<'_> {
    pub(super) fn camera(&mut self, camera: &CameraSpec, writing: &mut Writing) {
        let spec = &camera.spec;
        if !camera.keyframes.is_empty() {
            writing.warn("cameras are written as they are at 0 seconds");
        }
        if matches!(spec.parameters.find("mirrored"), Some((Value::Bool(true), _))) {
            writing.warn("USD files cannot store mirrored pictures of cameras: written as not mirrored");
        }
        let name = self.names.unused(&spec.name, "camera");
        let metadata = match name == spec.name || spec.name.is_empty() {
            true => Vec::new(),
            false => vec![format!("displayName = {}", quoted(&spec.name))],
        };
        let mut text = std::mem::replace(&mut self.prims, Text::at_depth(1));
        text.open(&format!("def Camera \"{name}\""), &metadata);
        let point = |key, default: Vec3| vector(spec, key).unwrap_or(default);
        let (position, ahead) = (point("position", Vec3::new(0.0, 0.0, 5.0)), point("look_at", Vec3::ZERO));
        placed(&looking(position, ahead - position, point("up", Vec3::Y)), &mut text);
        let aspect = f64::from(
            number(spec, "frame").filter(|a| *a > 0.0).or(picture_aspect_ratio(self.scene)).unwrap_or(1.0),
        );
        if spec.kind == "orthographic" {
            let height = f64::from(number(spec, "height").unwrap_or(2.0)) * 10.0;
            text.line("token projection = \"orthographic\"");
            text.line(&format!("float horizontalAperture = {}", (height * aspect) as f32));
            text.line(&format!("float verticalAperture = {}", height as f32));
        } else {
            self.lens(spec, aspect, (ahead - position).length(), &mut text, writing);
        }
        text.close();
        self.prims = text;
    }

    /// Film and lens, in tenths of the scene's unit.
    fn lens(&self, spec: &Spec, aspect: f64, ahead: f32, text: &mut Text, writing: &mut Writing) {
        let mut others = spec.clone();
        others.parameters.0.retain(|(key, ..)| !key.starts_with("principal"));
        not_perspective(&others, "USD", writing);
        let height = 10.0 * FILM / metres(self.scene);
        let width = height * aspect;
        let length = 0.5 * height / f64::from(tan(0.5 * field_of_view(spec).to_radians()));
        text.line(&format!("float focalLength = {}", length as f32));
        text.line(&format!("float horizontalAperture = {}", width as f32));
        text.line(&format!("float verticalAperture = {}", height as f32));
        let off = |key| f64::from(number(spec, key).unwrap_or(0.5)) - 0.5;
        if spec.kind == "perspective" && (off("principal_x") != 0.0 || off("principal_y") != 0.0) {
            text.line(&format!("float horizontalApertureOffset = {}", (-off("principal_x") * width) as f32));
            text.line(&format!("float verticalApertureOffset = {}", (off("principal_y") * height) as f32));
        }
        if let Some(radius) = number(spec, "aperture").filter(|radius| *radius > 0.0) {
            let focus = number(spec, "focus").filter(|focus| *focus > 0.0).unwrap_or(ahead);
            text.line(&format!("float fStop = {}", (0.05 * length / f64::from(radius)) as f32));
            text.line(&format!("float focusDistance = {focus}"));
        }
    }
}
