//! Writes sensors with film and sampler, and the integrator.

use super::document::{Document, numbers};
use bilux_import::output::values::{number, vector};
use bilux_import::output::writing::Writing;
use bilux_import::world::camera_loss::{field_of_view_in, not_perspective};
use bilux_math::Vec3;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Spec, Value};

/// Settings that need no warning.
const QUIET: [&str; 6] = ["size", "max_depth", "filter", "camera", "spp", "seed"];

impl Document<'_> {
    /// Writes the integrator; Mitsuba counts edges of a path, and Bilux where it scatters.
    pub(super) fn settings(&mut self, writing: &mut Writing) {
        let depth = self.whole("max_depth").unwrap_or(16).clamp(0, 1000);
        // Paths through media may pass many of their boundaries.
        let has_media = self.scene.materials.iter().any(|spec| {
            ["absorption", "scattering", "transmission_depth"]
                .iter()
                .any(|key| spec.parameters.find(key).is_some())
        });
        self.open(&format!("integrator type=\"{}\"", if has_media { "volpath" } else { "path" }));
        self.integer("max_depth", depth + 1);
        self.close("integrator");
        for (key, ..) in &self.scene.settings.0 {
            if !QUIET.contains(&key.as_str()) {
                writing.warn(format!("Mitsuba files cannot store the setting '{key}': left out"));
            }
        }
    }

    fn whole(&self, key: &str) -> Option<i64> {
        match self.scene.settings.find(key) {
            Some((Value::Integer(i), _)) => Some(*i),
            _ => None,
        }
    }

    fn setting(&self, key: &str) -> Option<String> {
        match self.scene.settings.find(key) {
            Some((Value::Text(text), _)) => Some(text.clone()),
            _ => None,
        }
    }

    fn size(&self) -> [u32; 2] {
        let size = self.setting("size").and_then(|size| {
            let (width, height) = size.split_once('x')?;
            Some([width.parse::<u32>().ok()?, height.parse::<u32>().ok()?])
        });
        size.filter(|size| size.iter().all(|side| *side > 0)).unwrap_or([512, 512])
    }

    pub(super) fn sensor(&mut self, camera: &CameraSpec, writing: &mut Writing) {
        let spec = &camera.spec;
        if !camera.keyframes.is_empty() {
            writing.warn("cameras are written as they are at 0 seconds");
        }
        let [width, height] = self.size();
        let point = |key, default: Vec3| vector(spec, key).unwrap_or(default);
        let (position, ahead) = (point("position", Vec3::new(0.0, 0.0, 5.0)), point("look_at", Vec3::ZERO));
        let aperture = number(spec, "aperture").filter(|radius| *radius > 0.0);
        let kind = match (spec.kind == "orthographic", aperture) {
            (true, _) => "orthographic",
            (false, Some(_)) => "thinlens",
            (false, None) => "perspective",
        };
        let id = self.id(&spec.name, "camera");
        self.open(&format!("sensor type=\"{kind}\" id=\"{id}\""));
        if kind != "orthographic" {
            let mut others = spec.clone();
            others.parameters.0.retain(|(key, ..)| !key.starts_with("principal"));
            not_perspective(&others, "Mitsuba", writing);
            self.text("fov_axis", "y");
            self.number("fov", field_of_view_in(spec, width as f32 / height as f32));
            for (key, theirs) in
                [("principal_x", "principal_point_offset_x"), ("principal_y", "principal_point_offset_y")]
            {
                let offset = 0.5 - number(spec, key).unwrap_or(0.5);
                if offset != 0.0 && spec.kind == "perspective" {
                    self.number(theirs, offset);
                }
            }
            if let Some(radius) = aperture {
                let focus = number(spec, "focus").filter(|focus| *focus > 0.0);
                self.number("aperture_radius", radius);
                self.number("focus_distance", focus.unwrap_or((ahead - position).length()));
            }
        }
        // Its own clipping planes are a hundredth and ten thousand units away.
        let bounds = self.scene.bounds(0.0);
        let far = if bounds.is_empty() {
            1e4
        } else {
            bounds.extent().length() + bounds.centre().distance(position)
        };
        self.number("near_clip", far * 1e-5);
        self.number("far_clip", far * 1e3);
        self.view(spec, [position, ahead, point("up", Vec3::Y)], width as f32 / height as f32);
        self.film([width, height], writing);
        self.close("sensor");
    }

    /// The place of a sensor; the film of an orthographic one is two units wide before it.
    fn view(&mut self, spec: &Spec, [position, ahead, up]: [Vec3; 3], aspect: f32) {
        self.open("transform name=\"to_world\"");
        if matches!(spec.parameters.find("mirrored"), Some((Value::Bool(true), _))) {
            self.line("<scale x=\"-1\" y=\"1\" z=\"1\"/>");
        }
        if spec.kind == "orthographic" {
            let half = 0.5 * number(spec, "height").unwrap_or(2.0) * aspect;
            self.line(&format!("<scale x=\"{half}\" y=\"{half}\" z=\"1\"/>"));
        }
        let [position, ahead, up] = [position, ahead, up].map(|v| numbers(&v.to_array()).replace(' ', ", "));
        self.line(&format!("<lookat origin=\"{position}\" target=\"{ahead}\" up=\"{up}\"/>"));
        self.close("transform");
    }

    fn film(&mut self, [width, height]: [u32; 2], writing: &mut Writing) {
        self.open("film type=\"hdrfilm\"");
        self.integer("width", width.into());
        self.integer("height", height.into());
        self.text("pixel_format", "rgb");
        let filter = match self.setting("filter").as_deref() {
            None | Some("box") => "box",
            Some("tent") => "tent",
            Some("gaussian") => "gaussian",
            Some(other) => {
                writing.warn(format!(
                    "Mitsuba files cannot store the filter '{other}': gaussian is written instead"
                ));
                "gaussian"
            }
        };
        self.line(&format!("<rfilter type=\"{filter}\"/>"));
        self.close("film");
        self.open("sampler type=\"independent\"");
        self.integer("sample_count", self.whole("spp").filter(|count| *count > 0).unwrap_or(64));
        if let Some(seed) = self.whole("seed").filter(|seed| *seed > 0) {
            self.integer("seed", seed);
        }
        self.close("sampler");
    }
}
