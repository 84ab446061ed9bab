//! Construction of a job: the scene is completed by the studio, then built, then looked at.

use super::subject::Subject;
use super::{Found, Job};
use crate::Error;
use crate::job::own_light::{self, OwnLight};
use crate::preparation::built::Built;
use crate::preparation::camera_choice::choose_camera;
use crate::preparation::presets::{self, Studio};
use crate::preparation::scene_warnings::{self, oddities};
use crate::request::JobRequest;
use crate::settings::{Settings, shutter_of};
use bilux_math::Rgb;
use bilux_scene::{AccelChoice, Orientation, Reader, Scene, SceneBuilder, Spec, Warning};
use bilux_transport::aovs::Aov;
use bilux_transport::{Filter, PixelAnchor, RenderError, RenderSettings, ShadowCatcher};
use std::sync::Arc;

/// The tone curve if the studio lights a model.
const STUDIO_TONEMAP: &str = "neutral";

impl Job {
    /// Merges the scene file's settings with those of the request, which take precedence, and builds the scene.
    ///
    /// # Errors
    /// If a setting or anything in the scene is wrong; before anything is built, if the picture would take more memory than
    /// the request allows; or if the interval of a deterministic integrator is asked for.
    pub fn new(scene: &SceneBuilder, request: impl Into<JobRequest>) -> Result<Job, Error> {
        Job::with_built(scene, request, &mut Built::default())
    }

    /// Makes the same job as [`Job::new`], with parts that earlier jobs have built of this scene or another; new ones join them.
    ///
    /// # Errors
    /// As for [`Job::new`].
    pub fn with_built(
        scene: &SceneBuilder,
        request: impl Into<JobRequest>,
        built: &mut Built,
    ) -> Result<Job, Error> {
        let request = request.into();
        let mut settings = request.settings_for(scene)?;
        scene_warnings::check_not_empty(scene)?;
        let Completed { source, alone, orientation, catcher, of_ground } =
            Completed::of(scene, &mut settings, built)?;
        let (auto_curve, of_curve) = auto_curve(scene, &source, &settings);
        let note = own_light::note(&settings, &source, scene.lights.len());
        let accel = accel_for(&source, &settings);
        let unfiltered = built_scene(&source, alone, &settings, &accel, built)?;
        let reader = Reader::new(&settings.integrator_parameters, &settings.integrator.entry)?;
        let integrator = (settings.integrator.build)(&reader)?.into();
        let camera = choose_camera(&unfiltered, &settings.camera, &settings.camera_at)?;
        let built = match settings.filters_textures {
            true => unfiltered.filtered(camera.clone(), settings.height),
            false => unfiltered,
        };
        let warnings = oddities(scene, &built, &*camera).into_iter().chain(of_ground);
        let found = Found {
            warnings: warnings.chain(settings.unused_settings(&request.settings)).collect(),
            notes: note.into_iter().chain(of_curve).collect(),
            studio_light: own_light::studio_light(&settings, &source, scene.lights.len()),
            orientation,
            auto_curve,
        };
        let (scene, source) = (Arc::new(built), Arc::new(source));
        let subject = Subject {
            scene,
            camera,
            integrator,
            source,
            accel,
            catcher,
            next_pose: None,
            previous_pose: None,
        };
        let render = render_settings(&settings, &request)?;
        if render.interval && !subject.integrator.is_random() {
            return Err(RenderError::IntervalOfPattern.into());
        }
        Ok(Job { subject, settings, render, request, found: Arc::new(found), known: Arc::default() })
    }
}

/// A scene with what the studio adds, and with its camera where the settings have moved it.
struct Completed {
    source: SceneBuilder,
    /// The scene in which its own light was measured, as described and as built.
    alone: Option<(SceneBuilder, Scene)>,
    orientation: Option<Orientation>,
    catcher: Option<ShadowCatcher>,
    of_ground: Option<Warning>,
}

impl Completed {
    /// Completes a scene, and notes in the settings what was found of its own light.
    fn of(scene: &SceneBuilder, settings: &mut Settings, known: &mut Built) -> Result<Completed, Error> {
        let mut studio = Studio { aspect: Some(aspect(settings)), ..settings.studio };
        let mut source = scene.clone();
        let orientation = presets::set_upright(&mut source, &studio);
        let own = match settings.own_light {
            None => {
                let accel = accel_for(scene, settings);
                own_light::measure(&source, &[studio], settings, &accel, &mut known.alone)?
            }
            Some(_) => None,
        };
        known.keep_alone(own.is_some());
        let (judged, alone) = own.map(|OwnLight { judged, alone }| (judged, alone)).unzip();
        settings.own_light = settings.own_light.or(judged);
        studio.lit = settings.own_light.and_then(|judged| judged.is_enough);
        // The classic shading knows no units: its lights are as bright as ever.
        let judged = settings.own_light.filter(|_| !settings.integrator.classic);
        studio.brightness = judged.map(|judged| judged.brightness());
        presets::add_missing(&mut source, &studio);
        source.has_faint_emitters = settings.own_light.is_some_and(|judged| judged.is_faint());
        settings.view.place(&mut source, &settings.camera);
        let objects = source.objects.len();
        let has_backdrop = source.lights.iter().any(Spec::is_backdrop);
        let of_ground = scene_warnings::of_ground(&studio, objects > scene.objects.len(), has_backdrop);
        let catcher = presets::shadow_catcher(&source, &studio)
            .map(|ground| ShadowCatcher { ground: ground as u32, objects: objects as u32 });
        if settings.background.is_cut_out() {
            let nothing = Spec::new("nothing", "environment").with("radiance", Rgb::BLACK);
            presets::replace_backdrop(&mut source, nothing);
        }
        presets::add_fog(&mut source, studio.fog);
        let size = [settings.width, settings.height];
        bilux_scene::presets::set_stroke_widths(&mut source, &settings.camera, size, settings.time);
        Ok(Completed { source, alone, orientation, catcher, of_ground })
    }
}

/// Builds a scene, unless it was built already where its own light was measured.
fn built_scene(
    source: &SceneBuilder,
    alone: Option<(SceneBuilder, Scene)>,
    settings: &Settings,
    accel: &AccelChoice,
    known: &mut Built,
) -> Result<Scene, Error> {
    let (shutter, aspect) = (shutter_of(settings), aspect(settings));
    match alone {
        Some((alone, built)) if own_light::is_as_large(&alone, source) => {
            known.completed.clear();
            match settings.view.is_moved() {
                true => Ok(source.build_with(&mut known.alone, accel, shutter, aspect)?),
                false => Ok(built),
            }
        }
        _ => Ok(source.build_with(&mut known.completed, accel, shutter, aspect)?),
    }
}

fn accel_for(scene: &SceneBuilder, settings: &Settings) -> AccelChoice {
    settings.accel_for(scene.objects.iter().map(|object| object.mesh.triangles.len()).sum())
}

/// The width of the picture over its height.
fn aspect(settings: &Settings) -> f32 {
    settings.width as f32 / settings.height as f32
}

fn render_settings(settings: &Settings, request: &JobRequest) -> Result<RenderSettings, Error> {
    let guides = request.denoiser_name(settings).is_some();
    Ok(RenderSettings {
        width: settings.width,
        height: settings.height,
        samples: request.samples.clone().unwrap_or(0..settings.spp),
        spp: settings.spp,
        crop: request.crop,
        seed: settings.seed,
        threads: settings.threads,
        max_depth: settings.max_depth,
        pixel_anchor: if settings.corner_anchor { PixelAnchor::Corner } else { PixelAnchor::Centre },
        filter: Filter::from_name(&settings.filter)?,
        count_work: request.counts_work,
        stop: settings.stop,
        interval: request.layers.contains(&Aov::Interval),
        batch_means: guides || request.layers.contains(&Aov::Variance),
        readout: settings.readout,
    })
}

/// The tone curve that `auto` means for a scene that the studio has completed, and what to tell the user about it.
fn auto_curve(
    scene: &SceneBuilder,
    completed: &SceneBuilder,
    settings: &Settings,
) -> (&'static str, Option<String>) {
    // A background lights nothing.
    let lamps = |scene: &SceneBuilder| scene.lights.iter().filter(|light| !light.is_backdrop()).count();
    if lamps(completed) == lamps(scene) || settings.integrator.classic {
        return ("none", None);
    }
    if !bilux_scene::presets::is_unlit(scene) {
        return (STUDIO_TONEMAP, None);
    }
    let note = "the whole model is unlit, so its colours are shown as they are (--tonemap neutral adds the curve of \
                the studio)";
    ("none", (settings.tonemap == "auto").then(|| note.to_owned()))
}
