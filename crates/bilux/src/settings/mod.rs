//! Every setting of a render, whether from a scene file's `[render]`, a preset or the command line: all of them use the
//! same keys of one table.

mod accel;
mod background;
mod depth;
mod idle;
mod memory;
mod names;
mod rows;
mod same_samples;
mod shutter;
mod size;
mod studio;
mod tree;
mod view;

use crate::Error;
use crate::preparation::judged::Judged;
use crate::preparation::presets::Studio;
use accel::accel_choice;
pub use background::Background;
use background::background;
use bilux_scene::{AccelChoice, Parameters, Reader, SceneBuilder, SceneError, Span, Spec, Value};
use bilux_transport::Stop;
use bilux_transport::integrators::{INTEGRATORS, IntegratorEntry};
use names::{find_integrator, tone_curve};
pub use rows::{DENOISE, Effect, RENDER, ROWS, SettingRow};
pub(crate) use shutter::shutter_of;
use size::calibrated_size;
pub use size::{parse_size, size_error};
use std::time::Duration;
pub use studio::parse_orbit;
use studio::{as_list_text, studio};
pub use view::View;

/// Checked settings.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The integrator's row in the table.
    pub integrator: &'static IntegratorEntry,
    /// The integrator's parameters.
    pub integrator_parameters: Spec,
    /// The acceleration structure.
    pub accel: AccelChoice,
    /// Whether [`Settings::accel_for`] decides how long building may take.
    pub build_by_size: bool,
    /// The width of the picture in pixels.
    pub width: u32,
    /// The height of the picture in pixels.
    pub height: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// The limits that end the picture before all samples are taken.
    pub stop: Stop,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The maximum number of scattering events after the camera; those inside skin and milk do not count.
    pub max_depth: u32,
    /// The number of threads; 0 for all cores.
    pub threads: usize,
    /// The name or number of the camera.
    pub camera: String,
    /// The place where the camera was requested, for messages.
    pub camera_at: Span,
    /// The view to which the camera is moved.
    pub view: View,
    /// The settings of the studio.
    pub studio: Studio,
    /// The time to show, in seconds.
    pub time: f32,
    /// The time for which the shutter is open, in seconds.
    pub shutter: f32,
    /// The time from the exposure of the first row of pixels to that of the last, in seconds.
    pub readout: f32,
    /// Frames per second.
    pub fps: f32,
    /// The name of the pixel reconstruction filter.
    pub filter: String,
    /// Whether image textures are filtered over a footprint of half a pixel.
    pub filters_textures: bool,
    /// Whether pixels are sampled at their corner instead of their centre.
    pub corner_anchor: bool,
    /// The exposure of pictures for a display, in stops.
    pub exposure: f32,
    /// Whether the file or the user states the exposure.
    pub states_exposure: bool,
    /// The judgement of the scene's own light.
    pub(crate) own_light: Option<Judged>,
    /// Whether automatic exposure is added to it.
    pub auto_exposure: bool,
    /// The name of the tone curve.
    pub tonemap: String,
    /// The denoiser.
    pub denoise: String,
    /// The background, visible where the scene has nothing.
    pub background: Background,
    /// Whether bytes are proportional to light.
    pub linear_transfer: bool,
    /// The settings as files and users gave them, from which all of this follows.
    pub given: Parameters,
}

impl Settings {
    /// The samples per pixel of the picture, unless noise or time alone decides their number.
    pub fn asked_spp(&self) -> Option<u32> {
        let is_given = matches!(self.given.find("spp"), Some((Value::Integer(1..), _)));
        (is_given || !self.stop.is_any()).then_some(self.spp)
    }

    /// Combines the settings of the scene with those of the user, which take precedence.
    ///
    /// # Errors
    /// As [`Settings::resolve`].
    pub fn of(scene: &SceneBuilder, user: &Parameters) -> Result<Settings, Error> {
        let mut all = scene.settings.clone();
        // Samples that the user asks for are all taken: limits of the scene would make the picture depend on the machine.
        if user.find("spp").is_some_and(|(value, _)| *value != Value::Integer(0)) {
            all.0.retain(|(key, ..)| !["noise", "time_limit"].contains(&key.as_str()));
        }
        for (key, value, span) in &user.0 {
            all.set_at(key, value.clone(), span.clone());
        }
        if all.find("size").is_none()
            && let Some([width, height]) = calibrated_size(scene, &all)
        {
            all.set("size", format!("{width}x{height}"));
        }
        Settings::resolve(&all)
    }

    /// Checks the combined settings of a file, a preset and the command line.
    ///
    /// # Errors
    /// If a key is unknown (the message names the nearest one), a value is out of range, or an integrator or
    /// accelerator is unknown.
    pub fn resolve(all: &Parameters) -> Result<Settings, Error> {
        let is_render_key = |key: &str| RENDER.parameters.iter().any(|p| p.name == key);
        let (own, rest): (Vec<_>, Vec<_>) = all.0.iter().cloned().partition(|(key, ..)| is_render_key(key));
        let own = own.into_iter().map(|(key, value, at)| match key.as_str() {
            "orbit" | "eye" | "look_at" | "background" => (key, as_list_text(value), at),
            // Users who know `--ground none` write this.
            "denoise" if value == Value::from("none") => (key, Value::from("off"), at),
            _ => (key, value, at),
        });
        let own = own.collect();
        let spec = Spec { parameters: Parameters(own), ..Spec::new("", "render") };
        let reader = Reader::new(&spec, &RENDER)?;
        let integrator = find_integrator(&reader)?;
        let integrator_parameters = integrator_parameters(integrator, rest)?;
        let (width, height) = parse_size(&reader.text("size"))
            .ok_or_else(|| SceneError::invalid(size_error(&reader.text("size")), reader.span("size")))?;
        let (stop, background) = (stop(&reader), background(&reader)?);
        let spp = match reader.integer("spp") {
            0 if stop.is_any() => MAX_SPP,
            0 => integrator.default_spp,
            n => u32::try_from(n).unwrap_or(u32::MAX),
        };
        Ok(Settings {
            integrator,
            integrator_parameters,
            accel: accel_choice(&reader)?,
            build_by_size: reader.text("build") == "auto",
            width,
            height,
            spp,
            stop,
            seed: reader.integer("seed") as u64,
            max_depth: depth::max_depth(all, &reader),
            threads: reader.integer("threads") as usize,
            camera: match reader.text("camera") {
                name if name.is_empty() => "0".to_owned(),
                name => name,
            },
            camera_at: reader.span("camera").clone(),
            background,
            view: View::read(&reader)?,
            studio: Studio { cut_out: background.is_cut_out(), ..studio(&reader)? },
            time: reader.number("time"),
            shutter: reader.number("shutter"),
            readout: reader.number("readout"),
            fps: reader.number("fps"),
            filter: reader.text("filter"),
            filters_textures: reader.text("texture_filter") == "footprint",
            corner_anchor: reader.text("pixel_anchor") == "corner",
            exposure: reader.number("exposure"),
            states_exposure: reader.is_given("exposure"),
            own_light: None,
            auto_exposure: reader.bool("auto_exposure"),
            tonemap: tone_curve(&reader)?,
            denoise: reader.text("denoise"),
            linear_transfer: reader.text("transfer") == "linear",
            given: all.clone(),
        })
    }
}

/// The maximum number of samples per pixel if a noise level or a time limit is given but no number of samples.
const MAX_SPP: u32 = 1 << 16;

fn stop(reader: &Reader) -> Stop {
    let above_zero = |key: &str| Some(reader.number(key)).filter(|&x| x > 0.0);
    Stop { noise: above_zero("noise"), time_limit: above_zero("time_limit").map(Duration::from_secs_f32) }
}

/// The keys that belong to the chosen integrator. Keys of other integrators are dropped, so that one file can serve
/// several.
fn integrator_parameters(
    chosen: &'static IntegratorEntry,
    rest: Vec<(String, Value, Span)>,
) -> Result<Spec, Error> {
    let knows = |row: &IntegratorEntry, key: &str| row.entry.parameters.iter().any(|p| p.name == key);
    let mut spec = Spec::new("", chosen.entry.name);
    for (key, value, span) in rest {
        if knows(chosen, &key) {
            spec.parameters.set_at(&key, value, span);
        } else if !INTEGRATORS.iter().any(|row| knows(row, &key)) {
            let rows = INTEGRATORS.iter().map(|row| &row.entry).chain([&RENDER]);
            let names = rows.flat_map(|entry| entry.parameters.iter().map(|p| p.name));
            return Err(SceneError::unknown("render setting", &key, names, &span).into());
        }
    }
    Ok(spec)
}
