//! Every setting of a render, whether from a scene file's `[render]`, a preset or the command line: all of them use the
//! same keys of one table.

mod accel;
mod background;
mod depth;
mod idle;
mod memory;
mod names;
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
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice, integer};
use bilux_scene::{AccelChoice, Parameters, Reader, SceneBuilder, SceneError, Span, Spec, Value};
use bilux_transport::integrators::{INTEGRATORS, IntegratorEntry};
use bilux_transport::{MAX_DEPTH, Stop};
use names::{find_integrator, tone_curve};
pub(crate) use shutter::shutter_of;
use size::calibrated_size;
pub use size::{parse_size, size_error};
use std::time::Duration;
pub use studio::parse_orbit;
use studio::{as_list_text, studio};
use view::OF_CAMERA;
pub use view::View;

/// The values of the setting `denoise`.
pub const DENOISE: &[&str] = &["display", "auto", "oidn", "builtin", "off"];

/// The settings that `[render]` and `--set` accept, besides the integrator's parameters.
pub const RENDER: Entry = Entry {
    name: "render",
    summary: "how the picture is made",
    source: "",
    parameters: &[
        text("integrator", "the light-transport algorithm", "auto"),
        text("accel", "the acceleration structure for ray queries", "auto"),
        text("size", "width and height of the picture, as WxH", "512x512"),
        integer("spp", "samples per pixel; 0 for the integrator's own choice", 0, 1 << 31, "0"),
        number(
            "noise",
            "stop when the noise is, on average, at most this fraction of the light; 0 for no limit",
            "",
            0.0,
            10.0,
            "0",
        ),
        number(
            "time_limit",
            "finish within this time, including reading and denoising; 0 for no limit",
            "s",
            0.0,
            1e9,
            "0",
        ),
        integer(
            "seed",
            "the seed of the random numbers; a different seed gives different noise",
            0,
            i64::MAX,
            "0",
        ),
        integer(
            "max_depth",
            "maximum number of scattering events after the camera; those inside skin and milk do not count; 0 is emission only; 100 with `fog`, if nothing is said",
            0,
            MAX_DEPTH as i64,
            "16",
        ),
        integer("threads", "number of threads; 0 uses all cores", 0, 4096, "0"),
        text("camera", "name or number of the camera", "0"),
        text(
            "eye",
            "move the camera to this point, as X,Y,Z in metres; camera leaves it where it is",
            OF_CAMERA,
        ),
        text(
            "look_at",
            "turn the camera to this point, as X,Y,Z in metres; camera leaves it as it is",
            OF_CAMERA,
        ),
        number("zoom", "magnify the picture by this factor", "", 1e-3, 1e3, "1"),
        choice("ground", "what a model without a camera and lights stands on", GROUNDS, "auto"),
        number("fog", "fog around everything, and how far one sees in it; 0 is none", "m", 0.0, 1e6, "0"),
        text(
            "orbit",
            "the position of the studio's camera: degrees to the right of the model's front and degrees above it, as \
             AZ,EL",
            "26.5,17.8",
        ),
        choice("up", "the model's up axis; auto infers it from the format and the shape", AXES, "auto"),
        choice("front", "the model's front axis; auto infers it from the format and the shape", AXES, "auto"),
        number(
            "focal",
            "focal length of the studio's camera, for a picture 24 mm high",
            "mm",
            1.0,
            10_000.0,
            "45",
        ),
        number("time", "the time that the picture shows", "s", -1e9, 1e9, "0"),
        number("shutter", "how long the shutter is open", "s", 0.0, 1e9, "0"),
        number(
            "readout",
            "how much later a rolling shutter exposes the last row than the first",
            "s",
            0.0,
            1e9,
            "0",
        ),
        number("fps", "frames per second, for --frames", "1/s", 1e-6, 1e6, "24"),
        text("filter", "the pixel reconstruction filter", "box"),
        choice(
            "texture_filter",
            "how image textures are filtered: over a footprint of half a pixel, for less noise, or not at all",
            &["footprint", "none"],
            "footprint",
        ),
        choice("pixel_anchor", "where pixel (0, 0) is sampled", &["centre", "corner"], "centre"),
        number(
            "exposure",
            "brightens display formats by this many stops (powers of two); if it is not given, a picture by the light of a \
             glTF or OBJ file, where that is too bright or too dim for a display, is exposed to show it",
            "EV",
            -64.0,
            64.0,
            "0",
        ),
        Parameter {
            name: "auto_exposure",
            summary: "also expose display formats automatically, to the brightness of a photograph",
            unit: "",
            kind: ParameterKind::Bool,
            default: "false",
        },
        text(
            "background",
            "the background: surroundings, transparent, or a colour (white, #rrggbb or R,G,B)",
            "surroundings",
        ),
        text(
            "tonemap",
            "the tone-mapping curve for display formats; auto is neutral if the studio lights the model, unless \
             all of it is unlit, else none",
            "auto",
        ),
        choice(
            "denoise",
            "the denoiser; display uses the best one for display formats when noise or time ends the render",
            DENOISE,
            "display",
        ),
        choice("transfer", "the transfer function from linear light to bytes", &["srgb", "linear"], "srgb"),
        choice("culling", "which faces of closed, opaque meshes to cull", &["none", "back"], "none"),
        choice(
            "build",
            "how much time building the tree may take; auto is best for bvh8 from 64 samples per triangle on, else \
             balanced",
            &["auto", "fast", "balanced", "best"],
            "auto",
        ),
        choice(
            "cpu",
            "the instruction set that kernels may use",
            &["auto", "baseline", "sse4.2", "avx2", "avx512"],
            "auto",
        ),
        choice("bsp_split", "how bsp chooses its planes", &["mean", "fuchs"], "mean"),
        choice(
            "bsp_group",
            "whether bsp groups polygons or whole objects",
            &["polygons", "objects"],
            "polygons",
        ),
        switch("early_out", "end a traversal at the first hit that no closer hit can replace"),
        switch("cull_by_partition", "reject back faces by the side of their partition plane"),
    ],
};

const fn text(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Text, default }
}

const fn switch(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Bool, default: "true" }
}

const fn number(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    min: f64,
    max: f64,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Number { min, max }, default }
}

const AXES: &[&str] = &["auto", "x", "y", "z", "-x", "-y", "-z"];

const GROUNDS: &[&str] = &["auto", "shadow", "mirror", "none"];

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
