//! One picture to be rendered: a scene, a camera, an integrator and settings, joined and checked.

use crate::Error;
use crate::fingerprint::fingerprint;
use crate::oddities::oddities;
use crate::settings::Settings;
use bilux_pictures::{Picture, WriteOptions};
use bilux_scene::{
    AccelChoice, Camera, Counters, Parameters, Reader, Scene, SceneBuilder, SceneError, Span, Warning,
};
use bilux_transport::integrators::PixelIntegrator;
use bilux_transport::{
    Choice, Film, Filter, Interval, PixelAnchor, Progress, Reached, RenderError, RenderSettings, Replay,
    SamplePlace, Stop, Strategies, Window,
};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A picture to be rendered.
pub struct Job {
    scene: Scene,
    accel: AccelChoice,
    camera: Arc<dyn Camera>,
    integrator: Box<dyn PixelIntegrator>,
    settings: Settings,
    render: RenderSettings,
    fingerprint: String,
    warnings: Vec<Warning>,
}

/// What a render gave.
pub struct Outcome {
    /// The film.
    pub film: Film,
    /// What its rays took.
    pub counters: Counters,
    /// It was stopped before the end; the film holds what there is.
    pub cancelled: bool,
    /// What an integrator that chooses has chosen, and why.
    pub choice: Option<Choice>,
    /// How far it came, where noise or time could end it.
    pub reached: Option<Reached>,
    /// Between which bounds pixels lie, where it was asked for ([`Job::with_interval`]).
    pub interval: Option<Interval>,
    linear_transfer: bool,
}

impl Job {
    /// Joins the scene file's own settings with the user's, which win, and builds the scene.
    ///
    /// # Errors
    /// When a setting or anything in the scene is wrong.
    pub fn new(scene: &SceneBuilder, user: &Parameters) -> Result<Job, Error> {
        let mut all = scene.settings.clone();
        for (key, value, span) in &user.0 {
            all.set_at(key, value.clone(), span.clone());
        }
        let mut job = Job::with_settings(scene, Settings::resolve(&all)?)?;
        job.warnings.extend(job.settings.without_use(user));
        Ok(job)
    }

    /// Builds the scene for settings that are checked already.
    ///
    /// # Errors
    /// When anything in the scene is wrong.
    pub fn with_settings(scene: &SceneBuilder, settings: Settings) -> Result<Job, Error> {
        let completed = crate::presets::completed(scene, &settings.studio);
        let aspect = settings.width as f32 / settings.height as f32;
        let triangles = completed.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        let accel = settings.accel_for(triangles);
        let built = completed.build(&accel, shutter_at(&settings, settings.time), aspect)?;
        let reader = Reader::new(&settings.integrator_parameters, &settings.integrator.entry)?;
        let integrator = (settings.integrator.build)(&reader)?;
        let camera = choose_camera(&built, &settings.camera, &settings.camera_at)?;
        Ok(Job {
            warnings: oddities(scene, &built, &*camera),
            camera,
            render: render_settings(&settings)?,
            fingerprint: fingerprint(&completed, &settings),
            accel,
            scene: built,
            integrator,
            settings,
        })
    }

    /// The same picture at another time, in seconds. What stands still is not built again.
    pub fn at_time(&mut self, time: f32) {
        self.settings.time = time;
        self.scene = self.scene.at(&self.accel, shutter_at(&self.settings, time));
    }

    /// What is odd about the picture, though it can be rendered.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Only samples `range` of each pixel, for a partial film.
    pub fn samples(&mut self, range: Range<u32>) {
        self.render.samples = range;
    }

    /// Only a window of the picture.
    pub fn crop(&mut self, window: Window) {
        self.render.crop = Some(window);
    }

    /// Counts every node and triangle test; slower.
    pub fn count_work(&mut self) {
        self.render.count_work = true;
    }

    /// Takes samples that tell how far a pixel may be off ([`Outcome::interval`]). These are other samples, so that parts of
    /// such a picture do not join with those of a plain one.
    ///
    /// # Errors
    /// When the integrator leaves nothing to chance.
    pub fn with_interval(&mut self) -> Result<(), Error> {
        if !self.integrator.is_random() {
            return Err(RenderError::IntervalOfPattern.into());
        }
        if !std::mem::replace(&mut self.render.interval, true) {
            self.fingerprint += "-replicates";
        }
        Ok(())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Renders.
    ///
    /// # Errors
    /// When the size or the crop makes no sense, or memory is short.
    pub fn render(&self, progress: &dyn Progress) -> Result<Outcome, Error> {
        let rendered =
            bilux_transport::render(&self.scene, &*self.camera, &*self.integrator, &self.render, progress)?;
        let mut film = rendered.film;
        film.fingerprint.clone_from(&self.fingerprint);
        Ok(Outcome {
            film,
            counters: rendered.counters,
            cancelled: rendered.cancelled,
            choice: rendered.choice,
            reached: rendered.reached,
            interval: rendered.interval,
            linear_transfer: self.settings.linear_transfer,
        })
    }

    /// True when the strategies of its integrator can be told apart.
    pub fn has_strategies(&self) -> bool {
        self.integrator.has_strategies()
    }

    /// The pictures of its integrator's strategies, of the samples that the picture is of; `None` when it was stopped, or
    /// there are none.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn strategies(&self, of: &Outcome, progress: &dyn Progress) -> Result<Option<Strategies>, Error> {
        let mut settings = RenderSettings { stop: Stop::default(), ..self.render.clone() };
        if let Some(reached) = of.reached {
            (settings.spp, settings.samples) = (reached.spp, 0..reached.spp);
        }
        let (scene, camera) = (&self.scene, &*self.camera);
        Ok(bilux_transport::strategies(scene, camera, &*self.integrator, &settings, progress)?)
    }

    /// One sample again, with what happened on its way.
    ///
    /// # Errors
    /// When the pixel is outside of the picture.
    pub fn replay(&self, x: u32, y: u32, sample: u32) -> Result<Replay, Error> {
        let (scene, camera) = (&self.scene, &*self.camera);
        Ok(bilux_transport::replay(
            scene,
            camera,
            &*self.integrator,
            &self.render,
            SamplePlace { x, y, sample },
        )?)
    }

    /// What identifies this picture: partial films join only where it agrees.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// How pictures of this job are written.
    ///
    /// # Errors
    /// When no tone curve has the name.
    pub fn write_options(&self) -> Result<WriteOptions, Error> {
        let tone_map = bilux_pictures::tonemap::tone_map(&self.settings.tonemap)?;
        Ok(WriteOptions { exposure: self.settings.exposure, tone_map, ..WriteOptions::default() })
    }

    /// Writes the picture, or for a partial one its film.
    ///
    /// # Errors
    /// When the file cannot be written, or its format cannot hold a partial film.
    pub fn write(&self, outcome: &Outcome, path: &Path) -> Result<(), Error> {
        Ok(bilux_pictures::write(path, &outcome.picture()?, &self.write_options()?)?)
    }

    /// The film with its exact sums, as a picture that `.exr` can hold and `merge` can join.
    ///
    /// # Errors
    /// When memory is short.
    pub fn partial(&self, outcome: &Outcome) -> Result<Picture, Error> {
        Ok(outcome.film.to_partial()?)
    }
}

impl Outcome {
    /// The picture so far; of a crop, the window only.
    ///
    /// # Errors
    /// When memory is short.
    pub fn picture(&self) -> Result<Picture, Error> {
        let mut picture = self.film.window_to_picture()?;
        self.note_how_far(&mut picture);
        if self.linear_transfer {
            // Said to be encoded already, its samples become bytes as they are.
            picture.colour_space = bilux_pictures::ColourSpace::Srgb;
        }
        Ok(picture)
    }

    /// Says in the picture what a rule that ended it has done to it.
    fn note_how_far(&self, picture: &mut Picture) {
        let Some(Reached { spp, noise: Some(noise), bias: Some(bias) }) = self.reached else { return };
        let mut note = |key: &str, value: String| picture.metadata.insert(format!("bilux.noise{key}"), value);
        note("", noise.to_string());
        note(".samples", spp.to_string());
        note(".samples_that_told_it", "in the mean".to_owned());
        note(".bias_at_most", format!("{bias} standard errors of a pixel, root mean square"));
    }
}

fn shutter_at(settings: &Settings, time: f32) -> [f32; 2] {
    [time, time + settings.shutter]
}

fn render_settings(settings: &Settings) -> Result<RenderSettings, Error> {
    Ok(RenderSettings {
        width: settings.width,
        height: settings.height,
        samples: 0..settings.spp,
        spp: settings.spp,
        crop: None,
        seed: settings.seed,
        threads: settings.threads,
        max_depth: settings.max_depth,
        pixel_anchor: if settings.corner_anchor { PixelAnchor::Corner } else { PixelAnchor::Centre },
        filter: Filter::named(&settings.filter)?,
        count_work: false,
        stop: settings.stop,
        interval: false,
    })
}

/// A camera by its name, or by its number from 0.
fn choose_camera(scene: &Scene, wanted: &str, at: &Span) -> Result<Arc<dyn Camera>, Error> {
    let cameras = scene.cameras();
    let by_name = cameras.iter().find(|(name, _)| name == wanted);
    let by_number = wanted.parse().ok().and_then(|i: usize| cameras.get(i));
    if let Some((_, camera)) = by_name.or(by_number) {
        return Ok(camera.clone());
    }
    let names: Vec<&str> = cameras.iter().map(|(name, _)| name.as_str()).filter(|n| !n.is_empty()).collect();
    if names.is_empty() || wanted.parse::<usize>().is_ok() {
        let message = format!(
            "there is no camera '{wanted}': this scene has {}, counted from 0{}",
            cameras.len(),
            if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) }
        );
        return Err(SceneError::invalid(message, at).into());
    }
    Err(SceneError::unknown("camera", wanted, names, at).into())
}
