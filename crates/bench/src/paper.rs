//! The paper's Figure 1 and section 4.4, reproduced: one scene by `cast`, `whitted`, `cook` and `path`, how far each is
//! from a converged `path` inside the mirror, and what Monte Carlo samples cost.

use crate::{Options, ProgressFn, Report, table, timed};
use bilux::pictures::Picture;
use bilux::pictures::{label, side_by_side};
use bilux::scene::{CameraSample, Parameters, SceneBuilder, Spec, Tracer, Value as Setting};
use bilux::{Error, Job, Quiet};
use bilux_math::{Rgb, Vec2};
use serde_json::json;

/// The four pictures, each with its samples per pixel.
const PANELS: [(&str, u32); 4] = [("cast", 16), ("whitted", 16), ("cook", 64), ("path", 256)];
/// Samples per pixel of the converged picture that the others are compared with.
const CONVERGED: u32 = 1024;
/// The numbers of samples whose cost is measured.
const COSTS: [u32; 5] = [1, 4, 16, 64, 256];

/// Renders everything; the report's picture has the four panels side by side.
///
/// # Errors
/// If something cannot be rendered.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let scene = bilux::generate(&Spec::new("", "trio"))?;
    let size = options.size_or((256, 144));
    let mask = mirror_mask(&scene, size)?;
    progress(&format!("path, converged: {CONVERGED} samples"));
    let (_, converged) = render(&scene, "path", CONVERGED, 1, size)?;
    let (mut rows, mut cells, mut panels) = (Vec::new(), Vec::new(), Vec::new());
    for (name, spp) in PANELS {
        progress(&format!("{name}, {spp} samples"));
        let (seconds, picture) = render(&scene, name, spp, 0, size)?;
        let error = rmse(&picture, &converged, &mask);
        rows.push(json!({
            "figure": "1", "integrator": name, "spp": spp, "seconds": seconds, "mirror_rmse": error,
        }));
        cells.push(vec![name.to_owned(), spp.to_string(), format!("{seconds:.2}"), format!("{error:.4}")]);
        let mut panel =
            bilux::pictures::tonemap::to_display(&picture, 0.0, bilux::pictures::tonemap::tone_map("none")?)?;
        label(&mut panel, 8, 8, name, 2);
        panels.push(panel);
    }
    let whole = vec![true; mask.len()];
    let mut costs = Vec::new();
    for spp in COSTS {
        progress(&format!("path, {spp} samples"));
        let (seconds, picture) = render(&scene, "path", spp, 0, size)?;
        let error = rmse(&picture, &converged, &whole);
        rows.push(
            json!({ "figure": "4.4", "integrator": "path", "spp": spp, "seconds": seconds, "rmse": error }),
        );
        let product = error * f64::from(spp).sqrt();
        costs.push(vec![
            spp.to_string(),
            format!("{seconds:.2}"),
            format!("{error:.4}"),
            format!("{product:.3}"),
        ]);
    }
    let figure = table(
        "Figure 1 reproduced: error inside the mirror against a converged path",
        &["integrator", "spp", "seconds", "RMSE in the mirror"],
        &cells,
    );
    let cost = table(
        "The cost of Monte Carlo samples (the last column is constant if the error falls as 1/√N)",
        &["spp", "seconds", "RMSE", "RMSE × √spp"],
        &costs,
    );
    Ok(Report {
        rows,
        text: format!("{figure}\n{cost}"),
        picture: Some(side_by_side(&panels, 8)?),
        ..Report::default()
    })
}

fn render(
    scene: &SceneBuilder,
    integrator: &str,
    spp: u32,
    seed: i64,
    size: (u32, u32),
) -> Result<(f64, Picture), Error> {
    let mut settings = Parameters::default();
    settings.set("integrator", integrator);
    settings.set("spp", Setting::Integer(i64::from(spp)));
    settings.set("seed", Setting::Integer(seed));
    settings.set("size", Setting::Text(format!("{}x{}", size.0, size.1)));
    let job = Job::new(scene, &settings)?;
    let (seconds, outcome) = timed(|| job.render(&Quiet))?;
    Ok((seconds, outcome.picture()?))
}

/// The pixels whose centre shows a mirror.
fn mirror_mask(scene: &SceneBuilder, (width, height): (u32, u32)) -> Result<Vec<bool>, Error> {
    let mut settings = Parameters::default();
    settings.set("size", Setting::Text(format!("{width}x{height}")));
    let job = Job::new(scene, &settings)?;
    let built = job.scene();
    let camera = &built.cameras()[0].1;
    let mut tracer = Tracer::new(built, false);
    let mut mask = Vec::with_capacity((width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            let film = Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
            let surface = tracer.closest(&camera.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 }));
            mask.push(surface.is_some_and(|s| {
                let classic = built.material(&s).classic(&s);
                classic.kt.is_black() && classic.kd.is_black() && classic.reflectivity > 0.0
            }));
        }
    }
    Ok(mask)
}

/// The root mean square difference over a mask, of light as a display shows it: clamped to 0..=1.
fn rmse(a: &Picture, b: &Picture, mask: &[bool]) -> f64 {
    let (Some(a), Some(b)) = (a.to_rgb(), b.to_rgb()) else { return f64::NAN };
    let squared = |a: &Rgb, b: &Rgb| {
        let d = a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0);
        f64::from(d.r * d.r + d.g * d.g + d.b * d.b) / 3.0
    };
    let chosen = a.iter().zip(&b).zip(mask).filter(|(_, inside)| **inside);
    let (sum, n) = chosen.fold((0.0, 0u64), |(sum, n), ((a, b), _)| (sum + squared(a, b), n + 1));
    (sum / n.max(1) as f64).sqrt()
}
