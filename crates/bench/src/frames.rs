//! Moving scenes: a walk through static teapots, and one teapot moving among them, compared with rebuilding everything
//! for every frame.

use crate::{Options, ProgressFn, Report, table, timed};
use bilux::scene::{Parameters, SceneBuilder, Spec, Value as Setting};
use bilux::{Error, Job, Quiet};
use serde_json::json;

/// The number of frames in each animation.
const FRAMES: u32 = 24;

/// Renders both animations both ways and checks that the pictures are the same.
///
/// # Errors
/// If an accelerator is unknown.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let size = options.size_or((512, 512));
    let count = options.counts.first().copied().unwrap_or(5);
    let default = ["bsp-sah", "bvh"].map(str::to_owned).to_vec();
    let accels = if options.accels.is_empty() { default } else { options.accels.clone() };
    let (mut rows, mut cells) = (Vec::new(), Vec::new());
    for motion in ["walk", "moving"] {
        let scene = scene(count, motion)?;
        for accel in &accels {
            progress(&format!("{motion}, {accel}"));
            let settings = settings(accel, size);
            let (kept, kept_pictures) = timed(|| kept(&scene, &settings))?;
            let (rebuilt, rebuilt_pictures) = timed(|| rebuilt(&scene, &settings))?;
            let same = kept_pictures == rebuilt_pictures;
            let ratio = rebuilt / kept;
            rows.push(json!({
                "scene": motion, "teapots": count, "accel": accel, "frames": FRAMES, "seconds": kept,
                "rebuilding_seconds": rebuilt, "speedup": ratio, "same_pictures": same,
            }));
            cells.push(vec![
                motion.to_owned(),
                accel.clone(),
                format!("{kept:.3}"),
                format!("{rebuilt:.3}"),
                format!("{ratio:.2}×"),
                if same { "the same".to_owned() } else { "DIFFERENT".to_owned() },
            ]);
        }
    }
    let title = format!("{FRAMES} frames of {count} teapots, {}x{}, whitted", size.0, size.1);
    let header = ["scene", "accel", "seconds", "all rebuilt", "gain", "pictures"];
    Ok(Report { rows, text: table(&title, &header, &cells), ..Report::default() })
}

fn scene(count: u32, motion: &str) -> Result<SceneBuilder, Error> {
    let spec = Spec::new("", "teapots").with("count", Setting::Integer(i64::from(count))).with(motion, true);
    bilux::generate(&spec)
}

fn settings(accel: &str, size: (u32, u32)) -> Parameters {
    let mut settings = Parameters::default();
    settings.set("integrator", "whitted");
    settings.set("max_depth", Setting::Integer(5));
    settings.set("spp", Setting::Integer(1));
    settings.set("accel", accel);
    settings.set("size", Setting::Text(format!("{}x{}", size.0, size.1)));
    settings
}

/// One job for all frames: only what has moved is updated.
fn kept(scene: &SceneBuilder, settings: &Parameters) -> Result<Vec<Vec<u32>>, Error> {
    let mut job = Job::new(scene, settings)?;
    let mut pictures = Vec::new();
    for frame in 0..FRAMES {
        job = job.at_time(frame as f32 / job.settings().fps);
        pictures.push(bits(&job)?);
    }
    Ok(pictures)
}

/// One job per frame: every tree is rebuilt.
fn rebuilt(scene: &SceneBuilder, settings: &Parameters) -> Result<Vec<Vec<u32>>, Error> {
    let mut pictures = Vec::new();
    for frame in 0..FRAMES {
        let job = Job::new(scene, settings)?;
        let job = job.at_time(frame as f32 / job.settings().fps);
        pictures.push(bits(&job)?);
    }
    Ok(pictures)
}

fn bits(job: &Job) -> Result<Vec<u32>, Error> {
    let picture = job.render(&Quiet)?.picture()?;
    Ok(picture.channels().iter().flat_map(|c| c.samples.iter().map(|s| s.to_bits())).collect())
}
