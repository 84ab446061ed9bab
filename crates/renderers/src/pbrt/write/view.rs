//! Writes the directives before `WorldBegin`: film, camera, filter, samples and depth.

use super::document::{Document, float, numbers};
use bilux_import::output::values::{number, vector};
use bilux_import::output::writing::Writing;
use bilux_import::world::camera_loss::{field_of_view_in, not_perspective};
use bilux_math::Vec3;
use bilux_math::transcendental::{atan, tan};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Spec, Value};

/// Settings that need no warning.
const QUIET: [&str; 4] = ["size", "max_depth", "filter", "camera"];

impl Document<'_> {
    /// Writes everything before `WorldBegin`.
    pub(super) fn view(&mut self, writing: &mut Writing) {
        let settings = &self.scene.settings;
        let text = |key: &str| match settings.find(key) {
            Some((Value::Text(text), _)) => Some(text.clone()),
            _ => None,
        };
        let whole = |key: &str| match settings.find(key) {
            Some((Value::Integer(i), _)) => Some(*i),
            _ => None,
        };
        let size = text("size").and_then(|size| {
            let (width, height) = size.split_once('x')?;
            Some([width.parse::<u32>().ok()?, height.parse::<u32>().ok()?])
        });
        let [width, height] = size.filter(|size| size.iter().all(|side| *side > 0)).unwrap_or([512, 512]);
        let file = format!("{}.exr", writing.stem.replace(['"', '\\'], "_"));
        self.line(&format!(
            "Film \"rgb\" \"integer xresolution\" [ {width} ] \"integer yresolution\" [ {height} ] \
             \"string filename\" \"{file}\""
        ));
        let filter = match text("filter").as_deref() {
            None | Some("box") => "PixelFilter \"box\"",
            Some("tent") => "PixelFilter \"triangle\" \"float xradius\" [ 1 ] \"float yradius\" [ 1 ]",
            Some("gaussian") => "PixelFilter \"gaussian\"",
            Some(other) => {
                writing.warn(format!(
                    "pbrt files cannot store the filter '{other}': gaussian is written instead"
                ));
                "PixelFilter \"gaussian\""
            }
        };
        self.line(filter);
        let mut sampler = "Sampler \"zsobol\"".to_owned();
        for (key, theirs) in [("spp", "pixelsamples"), ("seed", "seed")] {
            if let Some(count) = whole(key).filter(|count| *count > 0) {
                sampler += &format!(" \"integer {theirs}\" [ {count} ]");
            }
        }
        if sampler.contains('[') {
            self.line(&sampler);
        }
        let depth = whole("max_depth").unwrap_or(16);
        self.line(&format!("Integrator \"volpath\" \"integer maxdepth\" [ {depth} ]"));
        for (key, ..) in &settings.0 {
            if !QUIET.contains(&key.as_str()) && !["spp", "seed"].contains(&key.as_str()) {
                writing.warn(format!("pbrt files cannot store the setting '{key}': left out"));
            }
        }
        match self.scene.cameras.as_slice() {
            [] => {}
            [first, rest @ ..] => {
                if !rest.is_empty() {
                    writing.warn("pbrt files store one camera: the first is written");
                }
                self.camera(first, width as f32 / height as f32, writing);
            }
        }
    }

    /// A pbrt camera looks along +z with +x to the right.
    fn camera(&mut self, camera: &CameraSpec, aspect: f32, writing: &mut Writing) {
        if !camera.keyframes.is_empty() {
            writing.warn("cameras are written as they are at 0 seconds");
        }
        let spec = &camera.spec;
        let at = |key, default: Vec3| vector(spec, key).unwrap_or(default);
        let position = at("position", Vec3::new(0.0, 0.0, 5.0));
        let ahead = at("look_at", Vec3::ZERO);
        if !is_switched_on(spec, "mirrored") {
            self.line("Scale -1 1 1");
        }
        let all = [position, ahead, at("up", Vec3::Y)].map(|v| numbers(&v.to_array()));
        self.line(&format!("LookAt {}", all.join("  ")));
        if spec.kind == "orthographic" {
            let half = number(spec, "height").unwrap_or(2.0) * 0.5;
            let window = numbers(&[-half * aspect, half * aspect, -half, half]);
            self.line(&format!("Camera \"orthographic\" \"float screenwindow\" [ {window} ]"));
            return;
        }
        not_perspective(spec, "pbrt", writing);
        let vertical = field_of_view_in(spec, aspect);
        // In pbrt, the field of view applies to the shorter side.
        let shorter = match aspect < 1.0 {
            true => 2.0 * atan(tan(0.5 * vertical.to_radians()) * aspect).to_degrees(),
            false => vertical,
        };
        let mut line = format!("Camera \"perspective\"{}", float("fov", shorter));
        if let Some(radius) = number(spec, "aperture").filter(|radius| *radius > 0.0) {
            let focus = number(spec, "focus").filter(|focus| *focus > 0.0);
            line += &float("lensradius", radius);
            line += &float("focaldistance", focus.unwrap_or((ahead - position).length()));
        }
        self.line(&line);
    }
}

fn is_switched_on(spec: &Spec, key: &str) -> bool {
    matches!(spec.parameters.find(key), Some((Value::Bool(true), _)))
}
