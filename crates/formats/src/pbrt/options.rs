//! The directives before `WorldBegin`: film, filter, sampler and integrator, as settings that a render may follow.

use super::reader::{Entity, Pbrt};
use super::state::Matrices;
use super::unknown;
use crate::FormatError;
use bilux_scene::{Span, Value};

/// All options, the last of each kind.
pub(super) struct Options {
    pub(super) camera: Option<(Entity, Matrices)>,
    film: Option<Entity>,
    filter: Option<Entity>,
    sampler: Option<Entity>,
    integrator: Option<Entity>,
    /// The times of the two matrices, in seconds.
    pub(super) times: [f64; 2],
    /// The times at which the shutter opens and closes, in seconds.
    pub(super) shutter: [f32; 2],
    /// The factor by which the film scales light.
    pub(super) gain: f32,
    /// The width and height of the film in pixels.
    pub(super) size: [i32; 2],
}

impl Default for Options {
    fn default() -> Options {
        Options {
            camera: None,
            film: None,
            filter: None,
            sampler: None,
            integrator: None,
            times: [0.0, 1.0],
            shutter: [0.0, 1.0],
            gain: 1.0,
            size: [1280, 720],
        }
    }
}

impl Pbrt<'_, '_> {
    /// Records an option; accelerators are ignored, since they do not change the image.
    pub(super) fn option(&mut self, what: &str, entity: Entity) {
        match what {
            "camera" => {
                let matrices = self.state.matrices;
                if !self.state.media[1].is_empty() {
                    self.oddities
                        .note("a medium around the camera counts only inside shapes that bound it", || {
                            entity.at.clone()
                        });
                }
                self.systems.insert("camera".to_owned(), matrices.map(|m| m.inverse()));
                self.options.camera = Some((entity, matrices));
            }
            "film" => self.options.film = Some(entity),
            "pixelfilter" => self.options.filter = Some(entity),
            "sampler" => self.options.sampler = Some(entity),
            "integrator" | "surfaceintegrator" => self.options.integrator = Some(entity),
            "volumeintegrator" | "renderer" => {
                let message = format!("'{what}' of pbrt-v2 is not used");
                self.oddities.note(&message, || entity.at.clone());
            }
            _ => {}
        }
    }

    fn set_option(&mut self, key: &str, value: Value, at: &Span) {
        self.scene.settings.set_at(key, value, at.clone());
    }

    /// Adds the settings from all options except the camera.
    pub(super) fn settings(&mut self) -> Result<(), FormatError> {
        if let Some((camera, _)) = &self.options.camera {
            let list = &camera.parameters;
            self.options.shutter = [list.finite("shutteropen", 0.0)?, list.finite("shutterclose", 1.0)?];
        }
        let shutter = self.options.shutter;
        if let Some(film) = self.options.film.take() {
            self.film(&film, shutter[1] - shutter[0])?;
        }
        let [width, height] = self.options.size;
        let at = self.scene.settings.find("size").map(|(_, at)| at.clone()).unwrap_or_default();
        self.set_option("size", Value::Text(format!("{width}x{height}")), &at);
        let filter = self.options.filter.take();
        self.filter(filter.as_ref())?;
        if let Some(sampler) = self.options.sampler.take() {
            self.sampler(&sampler)?;
        }
        let depth = match self.options.integrator.take() {
            Some(integrator) => self.integrator(&integrator)?,
            None => (5, Span::default()),
        };
        self.set_option("max_depth", Value::Integer(i64::from(depth.0.clamp(0, 10_000))), &depth.1);
        Ok(())
    }

    fn film(&mut self, film: &Entity, exposure: f32) -> Result<(), FormatError> {
        let list = &film.parameters;
        let known = ["rgb", "gbuffer", "spectral", "image"];
        if !known.contains(&film.kind.as_str()) {
            return Err(unknown("film", &film.kind, known, &film.at));
        }
        let side = |name, default| list.integer(name).map(|side| side.unwrap_or(default));
        self.options.size = [side("xresolution", 1280)?, side("yresolution", 720)?];
        let at = list.place("xresolution");
        self.set_option("size", Value::Text(String::new()), &at);
        if film.kind == "image" {
            // A film of version 3, which has no sensors.
            self.options.gain = list.finite("scale", 1.0)?.max(0.0);
        } else {
            let speed = list.finite("iso", 100.0)?;
            let gain = exposure * speed / 100.0;
            if gain > 0.0 {
                self.options.gain = gain;
            } else {
                let what =
                    "an exposure of zero would make the picture black: an exposure of one second is used";
                self.oddities.note(what, || film.at.clone());
            }
        }
        if film.kind == "spectral" {
            self.oddities.note("spectral films are not supported: pictures are RGB", || film.at.clone());
        }
        let sensor = list.text("sensor")?.unwrap_or("cie1931");
        if sensor != "cie1931" || list.finite("whitebalance", 0.0)? != 0.0 {
            list.has("whitebalance");
            let what =
                "sensors and white balance are not supported: colours are those of the standard observer";
            self.oddities.note(what, || list.place("sensor"));
        }
        for name in ["cropwindow", "pixelbounds"] {
            if list.has(name) {
                let what = "the whole film is rendered, not only a part of it; use --crop";
                self.oddities.note(what, || list.place(name));
            }
        }
        for name in ["maxcomponentvalue", "maxsampleluminance"] {
            if list.has(name) {
                self.oddities.note("bright samples are not clamped", || list.place(name));
            }
        }
        for name in
            ["filename", "diagonal", "savefp16", "coordinatesystem", "nbuckets", "lambdamin", "lambdamax"]
        {
            list.has(name);
        }
        list.report_unused(&mut self.oddities);
        Ok(())
    }

    fn filter(&mut self, filter: Option<&Entity>) -> Result<(), FormatError> {
        let Some(filter) = filter else {
            self.set_option("filter", "gaussian".into(), &Span::default());
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
            self.oddities.note(&what, || filter.at.clone());
        }
        list.report_unused(&mut self.oddities);
        self.set_option("filter", (*ours).into(), &filter.at);
        Ok(())
    }

    /// Reads the number of samples. Their distribution affects only the noise of the image.
    fn sampler(&mut self, sampler: &Entity) -> Result<(), FormatError> {
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
            self.set_option("spp", Value::Integer(samples.clamp(1, 1 << 31)), &list.at);
        }
        if let Some(seed) = side("seed")? {
            self.set_option("seed", Value::Integer(seed.max(0)), &list.at);
        }
        Ok(())
    }

    /// The maximum path depth and its location. The choice of the integrator is left to the renderer.
    fn integrator(&mut self, integrator: &Entity) -> Result<(i32, Span), FormatError> {
        let list = &integrator.parameters;
        if ["ao", "ambientocclusion", "function"].contains(&integrator.kind.as_str()) {
            let what = format!(
                "the integrator '{}' is not supported: the default integrator is used",
                integrator.kind
            );
            self.oddities.note(&what, || integrator.at.clone());
        }
        if list.flag("regularize", false)? {
            self.oddities.note("regularisation is not supported", || list.place("regularize"));
        }
        Ok((list.integer("maxdepth")?.unwrap_or(5), list.place("maxdepth")))
    }
}
