//! Hidden-surface removal: the algorithms that the paper compares with BSP trees, on its teapots.

use crate::{Options, ProgressFn, Report, median, table};
use bilux::accel::BuildOptions;
use bilux::scene::{CameraSample, Parameters, SceneError};
use bilux::visibility::{VISIBILITY, View, VisibilityOptions, VisibilityResult, wrong_pixels};
use bilux::{Error, Job};
use bilux_math::Vec2;
use serde_json::json;
use std::time::Instant;

/// Runs every algorithm on the same teapots, and counts the pixels that differ from rays through their centres.
///
/// # Errors
/// If the layout is unknown.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let count = options.counts.first().copied().unwrap_or(5);
    let mesh = crate::build::mesh(count, &options.layout)?;
    let view = view(count, options)?;
    progress("rays through the pixels' centres, the reference");
    let tree = bilux::accel::build("auto", mesh.clone(), &BuildOptions::default())
        .map_err(|e| Error::Settings(e.to_string()))?;
    let reference = view.cast(&*tree, VisibilityOptions::default().culling);
    let (mut rows, mut cells) = (Vec::new(), Vec::new());
    for row in VISIBILITY {
        progress(row.entry.name);
        let (seconds, result) =
            repeated(options.repeats, || (row.run)(&view, &mesh, &VisibilityOptions::default()));
        let (c, wrong) = (&result.counts, wrong_pixels(&result.ids, &reference));
        rows.push(json!({
            "algorithm": row.entry.name, "exact": row.exact, "seconds": seconds,
            "build_seconds": result.build_seconds, "depth_comparisons": c.depth_comparisons,
            "sort_comparisons": c.sort_comparisons, "splits": c.splits, "overdraw": c.overdraw, "side_tests": c.side_tests,
            "wrong_pixels": wrong, "pixel_tests": c.triangle_tests, "pieces": c.pieces,
            "skipped_subtrees": c.skipped_subtrees, "windows": c.windows,
        }));
        let numbers = [c.depth_comparisons, c.sort_comparisons, c.splits, c.overdraw, wrong as u64];
        let mut line = vec![row.entry.name.to_owned(), format!("{seconds:.4}")];
        line.extend(numbers.iter().map(u64::to_string));
        cells.push(line);
    }
    let (w, h) = options.size_or((512, 512));
    let title = format!("Hidden-surface removal: {count} teapots, {} triangles, {w}x{h}", mesh.len());
    let header = ["algorithm", "seconds", "depth cmp", "sort cmp", "splits", "overdraw", "wrong pixels"];
    Ok(Report { rows, text: table(&title, &header, &cells), ..Report::default() })
}

/// The median time of several runs, and the result, which is the same every time.
fn repeated(repeats: u32, work: impl Fn() -> VisibilityResult) -> (f64, VisibilityResult) {
    let mut seconds = Vec::new();
    let mut once = || {
        let begun = Instant::now();
        let result = work();
        seconds.push(begun.elapsed().as_secs_f64());
        result
    };
    let mut result = once();
    for _ in 1..repeats.max(1) {
        result = once();
    }
    (median(seconds), result)
}

/// The view of the teapots' camera through the pixels' centres.
fn view(count: u32, options: &Options) -> Result<View, Error> {
    let (width, height) = options.size_or((512, 512));
    let mut settings = Parameters::default();
    settings.set("size", bilux::scene::Value::Text(format!("{width}x{height}")));
    let job = Job::new(&crate::teapots::scene(count, &options.layout)?, &settings)?;
    let camera = &job.scene().cameras()[0].1;
    let ray = |x: u32, y: u32| {
        let film = Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        camera.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 })
    };
    let directions = (0..height).flat_map(|y| (0..width).map(move |x| ray(x, y).direction)).collect();
    View::new(ray(0, 0).origin, width as usize, height as usize, directions, 0.0)
        .map_err(|e| SceneError::invalid(e.to_string(), &Default::default()).into())
}
