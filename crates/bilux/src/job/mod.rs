//! One render: a scene, a camera, an integrator and settings, combined and checked.

mod ranges;
mod rendering;

use crate::Error;
use crate::built::Built;
use crate::camera_choice::choose_camera;
use crate::fingerprint::fingerprint;
use crate::merging::ASKED;
use crate::outcome::Outcome;
use crate::own_light;
use crate::scene_warnings::{self, oddities};
use crate::series::Series;
use crate::settings::Settings;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use bilux_scene::{AccelChoice, Camera, Orientation, Parameters, Reader, Scene, SceneBuilder, Spec, Warning};
use bilux_transport::integrators::PixelIntegrator;
use bilux_transport::{
    Features, Filter, PixelAnchor, Plan, Progress, RenderError, RenderSettings, Rendered, Replay,
    SamplePlace, ShadowCatcher, Stop, Strategies, Window, coverage, shadow_alpha,
};
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// A picture to be rendered.
pub struct Job {
    pub(crate) scene: Scene,
    accel: AccelChoice,
    pub(crate) camera: Arc<dyn Camera>,
    pub(crate) integrator: Box<dyn PixelIntegrator>,
    /// What the integrator has chosen, if it was asked before rendering ([`Job::plan`]).
    pub(crate) plan: OnceLock<Option<Plan>>,
    pub(crate) settings: Settings,
    pub(crate) render: RenderSettings,
    /// The tone curve that `auto` means here.
    pub(crate) auto_curve: &'static str,
    /// Whether albedo and the like are wanted.
    pub(crate) features: bool,
    /// The time set aside for denoising.
    pub(crate) denoising: Duration,
    /// When its time limit starts; `None` means when rendering starts.
    pub(crate) begun: Option<Instant>,
    /// Whether loading third-party libraries is forbidden.
    pub(crate) sandboxed: bool,
    /// How a model was rotated.
    orientation: Option<Orientation>,
    /// The scene from which the job was built. The fingerprint is computed from it, which takes long if textures are
    /// large.
    pub(crate) source: SceneBuilder,
    fingerprint: OnceLock<String>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) notes: Vec<String>,
    studio_light: Option<String>,
    /// The ground of which only the shadow is in the picture.
    pub(crate) catcher: Option<ShadowCatcher>,
    /// The next frame, if its meshes have another pose.
    pub(crate) next_pose: Option<Box<Job>>,
}

impl Job {
    /// Merges the scene file's settings with the user's, which take precedence, and builds the scene.
    ///
    /// # Errors
    /// If a setting or anything in the scene is wrong.
    pub fn new(scene: &SceneBuilder, user: &Parameters) -> Result<Job, Error> {
        Job::within(scene, user, u64::MAX)
    }

    /// Does the same, but only if `most` bytes of memory are enough.
    ///
    /// # Errors
    /// As for [`Job::new`]; and, before anything is built, if the picture would take more memory.
    pub fn within(scene: &SceneBuilder, user: &Parameters, most: u64) -> Result<Job, Error> {
        Job::in_series(scene, user, most, &Series::default())
    }

    /// Builds the scene for settings that have already been checked.
    ///
    /// # Errors
    /// If anything in the scene is wrong.
    pub fn with_settings(scene: &SceneBuilder, settings: Settings) -> Result<Job, Error> {
        Job::reusing(scene, settings, &mut Built::default())
    }

    /// The same, with what earlier jobs have built.
    pub(crate) fn reusing(
        scene: &SceneBuilder,
        mut settings: Settings,
        known: &mut Built,
    ) -> Result<Job, Error> {
        let aspect = settings.width as f32 / settings.height as f32;
        scene_warnings::check_not_empty(scene)?;
        let mut studio = crate::presets::Studio { aspect: Some(aspect), ..settings.studio };
        let accel_of = |scene: &SceneBuilder| {
            settings.accel_for(scene.objects.iter().map(|object| object.mesh.triangles.len()).sum())
        };
        let mut completed = scene.clone();
        let orientation = crate::presets::set_upright(&mut completed, &studio);
        let own = match settings.own_light {
            None => own_light::measure(&completed, &[studio], &settings, &accel_of(scene), &mut known.alone)?,
            Some(_) => None,
        };
        known.keep_alone(own.is_some());
        let judged = settings.own_light.or(own.as_ref().map(|own| own.judged));
        studio.lit = judged.and_then(|judged| judged.is_enough);
        // The classic shading knows no units: its lights are as bright as ever.
        studio.brightness = judged.filter(|_| !settings.integrator.classic).map(|judged| judged.brightness());
        crate::presets::add_missing(&mut completed, &studio);
        settings.view.place(&mut completed, &settings.camera);
        let objects = completed.objects.len() as u32;
        let has_ground = completed.objects.len() > scene.objects.len();
        let has_backdrop = completed.lights.iter().any(Spec::is_backdrop);
        let of_ground = scene_warnings::of_ground(&studio, has_ground, has_backdrop);
        let catcher = crate::presets::shadow_catcher(&completed, &studio)
            .map(|ground| ShadowCatcher { ground: ground as u32, objects });
        if settings.background.is_cut_out() {
            let nothing = Spec::new("nothing", "environment").with("radiance", Rgb::BLACK);
            crate::presets::replace_backdrop(&mut completed, nothing);
        }
        crate::presets::add_fog(&mut completed, studio.fog);
        let size = [settings.width, settings.height];
        bilux_scene::presets::set_stroke_widths(&mut completed, &settings.camera, size, settings.time);
        let accel = accel_of(&completed);
        settings.own_light = judged;
        let (auto_curve, of_curve) = crate::writing::auto_curve(scene, &completed, &settings);
        let note = own_light::note(&settings, &completed, scene.lights.len());
        let studio_light = own_light::studio_light(&settings, &completed, scene.lights.len());
        let notes = note.into_iter().chain(of_curve).collect();
        let shutter = shutter_at(&settings, settings.time);
        let built = match own.map(|own| own.alone) {
            Some((alone, built)) if own_light::is_as_large(&alone, &completed) => {
                known.completed.clear();
                let mut moved = || completed.build_with(&mut known.alone, &accel, shutter, aspect);
                if settings.view.is_moved() { moved()? } else { built }
            }
            _ => completed.build_with(&mut known.completed, &accel, shutter, aspect)?,
        };
        let reader = Reader::new(&settings.integrator_parameters, &settings.integrator.entry)?;
        let integrator = (settings.integrator.build)(&reader)?;
        let camera = choose_camera(&built, &settings.camera, &settings.camera_at)?;
        let filters = settings.filters_textures;
        let built = if filters { built.filtered(camera.clone(), settings.height) } else { built };
        Ok(Job {
            warnings: oddities(scene, &built, &*camera).into_iter().chain(of_ground).collect(),
            camera,
            render: render_settings(&settings)?,
            auto_curve,
            features: false,
            denoising: Duration::ZERO,
            begun: None,
            sandboxed: false,
            orientation,
            source: completed,
            notes,
            studio_light,
            catcher,
            next_pose: None,
            fingerprint: OnceLock::new(),
            plan: OnceLock::new(),
            accel,
            scene: built,
            integrator,
            settings,
        })
    }

    /// Moves the picture to another time, in seconds. Static objects are not rebuilt.
    pub fn at_time(&mut self, time: f32) {
        self.settings.time = time;
        (self.fingerprint, self.plan) = (OnceLock::new(), OnceLock::new());
        self.scene = self.scene.at(&self.accel, shutter_at(&self.settings, time));
    }

    /// What is odd about the picture, even though it can be rendered.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// What was decided where the scene leaves a choice, such as what lights it.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What the studio lights the scene with, as a list in words, if nothing else is to be told about its light.
    pub fn studio_light(&self) -> Option<&str> {
        self.studio_light.as_deref()
    }

    /// How the model was rotated, if it came without a camera or the user asked for a rotation.
    pub fn orientation(&self) -> Option<Orientation> {
        self.orientation
    }

    /// Starts the clock of the time limit at `begun`, for example when the file was opened, instead of at the first
    /// sample.
    pub fn begun_at(&mut self, begun: Instant) {
        self.begun = Some(begun);
    }

    /// Takes only the samples in `range` of each pixel, for a partial film.
    pub fn samples(&mut self, range: Range<u32>) {
        self.render.samples = range;
    }

    /// The number of samples that each pixel gets, unless noise or time ends the picture.
    pub fn samples_per_pixel(&self) -> u32 {
        self.render.samples.end - self.render.samples.start
    }

    /// The number of samples that each pixel was to get, if noise or time alone does not decide it.
    pub fn asked_samples(&self) -> Option<u32> {
        self.settings.asked_spp().map(|_| self.samples_per_pixel())
    }

    /// Renders only a window of the picture.
    pub fn crop(&mut self, window: Window) {
        self.render.crop = Some(window);
    }

    /// Counts every node visit and triangle test, which is slower.
    pub fn count_work(&mut self) {
        self.render.count_work = true;
    }

    /// Takes samples that also give each pixel's confidence interval ([`Rendered::interval`]). These are different
    /// samples, so parts of such a picture do not merge with parts of an ordinary one.
    ///
    /// # Errors
    /// If the integrator is deterministic.
    pub fn with_interval(&mut self) -> Result<(), Error> {
        if !self.integrator.is_random() {
            return Err(RenderError::IntervalOfPattern.into());
        }
        self.render.interval = true;
        self.fingerprint = OnceLock::new();
        Ok(())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene's description, with what the studio adds, and the camera where the settings have moved it.
    pub fn completed_scene(&self) -> &SceneBuilder {
        &self.source
    }

    /// The camera.
    pub fn camera(&self) -> &dyn Camera {
        &*self.camera
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Adds to what was rendered whatever else the picture needs.
    pub(crate) fn completed(
        &self,
        mut rendered: Rendered,
        features: Option<Features>,
    ) -> Result<Outcome, Error> {
        let render = &self.render;
        let samples = rendered.reached.map_or(render.spp, |reached| reached.spp);
        let [coverage, model_coverage] = self.coverage(render, samples)?;
        if rendered.cancelled {
            rendered.batch_means = None;
        }
        if rendered.cancelled || render.crop.is_some() || render.samples != (0..render.spp) {
            self.fingerprint().clone_into(&mut rendered.film.fingerprint);
        }
        let chosen = || self.chosen().map(|plan| plan.choice.clone());
        rendered.choice = rendered.choice.or_else(chosen);
        let linear_transfer = self.settings.linear_transfer;
        Ok(Outcome { rendered, features, coverage, model_coverage, linear_transfer })
    }

    /// The alpha of each pixel after so many samples; `None` for a picture without an alpha channel. If a shadow is part of it,
    /// also the coverage by the model alone.
    fn coverage(&self, render: &RenderSettings, samples: u32) -> Result<[Option<Vec<f32>>; 2], Error> {
        let (scene, camera, integrator) = (&self.scene, &*self.camera, &*self.integrator);
        Ok(match (self.settings.background.is_cut_out(), self.catcher) {
            (false, _) => [None, None],
            (true, None) => [Some(coverage(scene, camera, integrator, render, samples)?), None],
            (true, Some(catcher)) => {
                let denoiser = self.shadow_denoiser()?;
                let denoiser = denoiser.as_deref();
                shadow_alpha(scene, camera, integrator, render, samples, catcher, denoiser)?.map(Some)
            }
        })
    }

    /// True if its integrator's strategies can be shown separately.
    pub fn has_strategies(&self) -> bool {
        self.integrator.has_strategies()
    }

    /// Renders a picture for each of the integrator's strategies, from the same samples as the main picture. Returns
    /// `None` if it was stopped or there are no strategies.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn strategies(&self, of: &Outcome, progress: &dyn Progress) -> Result<Option<Strategies>, Error> {
        self.strategies_of(of.rendered.reached.map(|reached| reached.spp), progress)
    }

    /// The same for the first samples of each pixel; by default for all.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn strategies_of(
        &self,
        samples: Option<u32>,
        progress: &dyn Progress,
    ) -> Result<Option<Strategies>, Error> {
        let mut settings = RenderSettings { stop: Stop::default(), ..self.render.clone() };
        if let Some(samples) = samples {
            (settings.spp, settings.samples) = (samples, 0..samples);
        }
        let (scene, camera) = (&self.scene, &*self.camera);
        Ok(bilux_transport::strategies(scene, camera, &*self.integrator, &settings, progress)?)
    }

    /// Traces one sample again and records what happens to it.
    ///
    /// # Errors
    /// If the pixel is outside the picture.
    pub fn replay(&self, x: u32, y: u32, sample: u32) -> Result<Replay, Error> {
        let (scene, camera, place) = (&self.scene, &*self.camera, SamplePlace { x, y, sample });
        Ok(bilux_transport::replay(scene, camera, self.renders(), &self.render, place)?)
    }

    /// The fingerprint of this picture: partial films merge only if it agrees.
    pub fn fingerprint(&self) -> &str {
        self.fingerprint.get_or_init(|| {
            let plain = fingerprint(&self.source, &self.settings);
            if self.render.interval { plain + "-replicates" } else { plain }
        })
    }

    /// The film's exact sums, its coverage and its display, as a picture that an `.exr` can hold and `merge` can merge.
    ///
    /// # Errors
    /// If memory is short.
    pub fn partial(&self, outcome: &Outcome) -> Result<Picture, Error> {
        let mut picture = outcome.rendered.film.to_partial()?;
        if let Some(coverage) = &outcome.coverage {
            picture.push_channel("A", coverage.clone())?;
        }
        self.display()?.record(&mut picture);
        if let Some(spp) = self.settings.asked_spp() {
            picture.metadata.insert(ASKED.to_owned(), spp.to_string());
        }
        self.describe(&mut picture, outcome, None);
        Ok(picture)
    }
}

pub(crate) fn shutter_at(settings: &Settings, time: f32) -> [f32; 2] {
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
        filter: Filter::from_name(&settings.filter)?,
        count_work: false,
        stop: settings.stop,
        interval: false,
        batch_means: false,
        ids: false,
    })
}
