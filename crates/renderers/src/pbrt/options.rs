//! The directives before `WorldBegin`: film, filter, sampler and integrator, as settings that a render may follow.

use super::entity::Entity;
use super::state::Matrices;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::names::unknown;
use bilux_scene::{Parameters, Span, Value};

/// All options, the last of each kind.
pub(super) struct Options {
    pub(super) camera: Option<(Entity, Matrices)>,
    film: Option<Entity>,
    filter: Option<Entity>,
    sampler: Option<Entity>,
    integrator: Option<Entity>,
    /// The times of the two matrices, in seconds.
    pub(super) times: [f64; 2],
}

/// Settings of the picture, as the options state them.
pub(super) struct Settings {
    pub(super) parameters: Parameters,
    /// The times at which the shutter opens and closes, in seconds.
    pub(super) shutter: [f32; 2],
    /// The factor by which the film scales light.
    pub(super) gain: f32,
    /// The width and height of the film in pixels.
    pub(super) size: [i32; 2],
}

impl Default for Options {
    fn default() -> Options {
        Options { camera: None, film: None, filter: None, sampler: None, integrator: None, times: [0.0, 1.0] }
    }
}

impl Options {
    /// The film's diagonal in millimetres.
    pub(super) fn diagonal(&self) -> f64 {
        let given = self.film.as_ref().and_then(|film| film.parameters.finite("diagonal", 35.0).ok());
        f64::from(given.unwrap_or(35.0)).max(1e-3)
    }

    /// Records an option; accelerators are ignored, since they do not change the image.
    pub(super) fn record(&mut self, what: &str, entity: Entity, matrices: Matrices) {
        match what {
            "camera" => self.camera = Some((entity, matrices)),
            "film" => self.film = Some(entity),
            "pixelfilter" => self.filter = Some(entity),
            "sampler" => self.sampler = Some(entity),
            "integrator" | "surfaceintegrator" => self.integrator = Some(entity),
            _ => {}
        }
    }

    /// The settings that all options except the camera make.
    pub(super) fn settings(&self, diagnostics: &mut Diagnostics) -> Result<Settings, FormatError> {
        let parameters = Parameters::default();
        let mut settings = Settings { parameters, shutter: [0.0, 1.0], gain: 1.0, size: [1280, 720] };
        if let Some((camera, _)) = &self.camera {
            let list = &camera.parameters;
            settings.shutter = [list.finite("shutteropen", 0.0)?, list.finite("shutterclose", 1.0)?];
        }
        if let Some(film) = &self.film {
            read_film(film, &mut settings, diagnostics)?;
        }
        let [width, height] = settings.size;
        let at = settings.parameters.find("size").map(|(_, at)| at.clone()).unwrap_or_default();
        settings.set("size", Value::Text(format!("{width}x{height}")), &at);
        read_filter(self.filter.as_ref(), &mut settings, diagnostics)?;
        if let Some(sampler) = &self.sampler {
            read_sampler(sampler, &mut settings)?;
        }
        let (depth, at) = match &self.integrator {
            Some(integrator) => depth(integrator, diagnostics)?,
            None => (5, Span::default()),
        };
        settings.set("max_depth", Value::Integer(i64::from(depth.clamp(0, 10_000))), &at);
        Ok(settings)
    }
}

impl Settings {
    fn set(&mut self, key: &str, value: Value, at: &Span) {
        self.parameters.set_at(key, value, at.clone());
    }
}

/// Reads the size of the film, and how much it scales light.
fn read_film(
    film: &Entity,
    settings: &mut Settings,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    let list = &film.parameters;
    let known = ["rgb", "gbuffer", "spectral", "image"];
    if !known.contains(&film.kind.as_str()) {
        return Err(unknown("film", &film.kind, known, &film.at));
    }
    let side = |name, default| list.integer(name).map(|side| side.unwrap_or(default));
    settings.size = [side("xresolution", 1280)?, side("yresolution", 720)?];
    let at = list.place("xresolution");
    settings.set("size", Value::Text(String::new()), &at);
    if film.kind == "image" {
        // A film of version 3, which has no sensors.
        settings.gain = list.finite("scale", 1.0)?.max(0.0);
    } else {
        let speed = list.finite("iso", 100.0)?;
        let exposure = settings.shutter[1] - settings.shutter[0];
        let gain = exposure * speed / 100.0;
        if gain > 0.0 {
            settings.gain = gain;
        } else {
            let what = "an exposure of zero would make the picture black: an exposure of one second is used";
            diagnostics.note(what, || film.at.clone());
        }
    }
    if film.kind == "spectral" {
        diagnostics.note("spectral films are not supported: pictures are RGB", || film.at.clone());
    }
    let sensor = list.text("sensor")?.unwrap_or("cie1931");
    if sensor != "cie1931" || list.finite("whitebalance", 0.0)? != 0.0 {
        list.has("whitebalance");
        let what = "sensors and white balance are not supported: colours are those of the standard observer";
        diagnostics.note(what, || list.place("sensor"));
    }
    for name in ["cropwindow", "pixelbounds"] {
        if list.has(name) {
            let what = "the whole film is rendered, not only a part of it; use --crop";
            diagnostics.note(what, || list.place(name));
        }
    }
    for name in ["maxcomponentvalue", "maxsampleluminance"] {
        if list.has(name) {
            diagnostics.note("bright samples are not clamped", || list.place(name));
        }
    }
    for name in ["filename", "diagonal", "savefp16", "coordinatesystem", "nbuckets", "lambdamin", "lambdamax"]
    {
        list.has(name);
    }
    list.report_unused(diagnostics);
    Ok(())
}

/// Reads the pixel filter, or sets pbrt's default.
fn read_filter(
    filter: Option<&Entity>,
    settings: &mut Settings,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    let Some(filter) = filter else {
        settings.set("filter", "gaussian".into(), &Span::default());
        return Ok(());
    };
    let list = &filter.parameters;
    // pbrt's name, the name in Bilux, pbrt's default radius, and the radius in Bilux.
    let filters = [
        ("box", "box", 0.5, 0.5),
        ("gaussian", "gaussian", 1.5, 1.5),
        ("triangle", "tent", 2.0, 1.0),
        ("mitchell", "gaussian", 2.0, 1.5),
        ("sinc", "blackman-harris", 4.0, 1.5),
    ];
    let Some((name, ours, default, radius)) = filters.iter().find(|row| row.0 == filter.kind) else {
        let names = filters.iter().map(|row| row.0);
        return Err(unknown("pixel filter", &filter.kind, names, &filter.at));
    };
    let mut is_same = !["mitchell", "sinc"].contains(name);
    for (new, old) in [("xradius", "xwidth"), ("yradius", "ywidth")] {
        let given = if list.has(old) { list.finite(old, *default)? } else { list.finite(new, *default)? };
        is_same &= given == *radius;
    }
    if *name == "gaussian" {
        // In version 3, alpha expresses the same width.
        is_same &= list.finite("sigma", 0.5)? == 0.5 && list.finite("alpha", 2.0)? == 2.0;
    }
    for name in ["B", "C", "tau"] {
        list.has(name);
    }
    if !is_same {
        let what = format!("the pixel filter is '{ours}' with radius {radius} instead of this one");
        diagnostics.note(&what, || filter.at.clone());
    }
    list.report_unused(diagnostics);
    settings.set("filter", (*ours).into(), &filter.at);
    Ok(())
}

/// Reads the number of samples. Their distribution affects only the noise of the image.
fn read_sampler(sampler: &Entity, settings: &mut Settings) -> Result<(), FormatError> {
    let list = &sampler.parameters;
    let side = |name| list.integer(name).map(|n| n.map(i64::from));
    let samples = match side("pixelsamples")? {
        Some(samples) => Some(samples),
        None if sampler.kind == "stratified" => {
            Some(side("xsamples")?.unwrap_or(4) * side("ysamples")?.unwrap_or(4))
        }
        None => None,
    };
    // Exporters write 1 if the user has chosen nothing: no image is meant to be that noisy.
    if let Some(samples) = samples.filter(|samples| *samples > 1) {
        settings.set("spp", Value::Integer(samples.clamp(1, 1 << 31)), &list.at);
    }
    if let Some(seed) = side("seed")? {
        settings.set("seed", Value::Integer(seed.max(0)), &list.at);
    }
    Ok(())
}

/// The maximum path depth and its location. The choice of the integrator is left to the renderer.
fn depth(integrator: &Entity, diagnostics: &mut Diagnostics) -> Result<(i32, Span), FormatError> {
    let list = &integrator.parameters;
    if ["ao", "ambientocclusion", "function"].contains(&integrator.kind.as_str()) {
        let what =
            format!("the integrator '{}' is not supported: the default integrator is used", integrator.kind);
        diagnostics.note(&what, || integrator.at.clone());
    }
    if list.flag("regularize", false)? {
        diagnostics.note("regularisation is not supported", || list.place("regularize"));
    }
    Ok((list.integer("maxdepth")?.unwrap_or(5), list.place("maxdepth")))
}
