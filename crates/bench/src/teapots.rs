//! The paper's Figure 2, reproduced: two to five teapots, with and without a tree.

use crate::{Options, ProgressFn, Report, median, table, timed};
use bilux::scene::{Parameters, SceneBuilder, Spec, Value as Setting};
use bilux::{Error, Job, Outcome, Quiet};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Seconds in the paper's Figure 2: the number of teapots, without and with its tree.
const PAPER: [(u32, f64, f64); 4] =
    [(2, 31.62, 29.64), (3, 47.43, 42.89), (4, 65.78, 56.12), (5, 86.95, 71.33)];

/// The result of one accelerator for one number of teapots.
struct Row {
    count: u32,
    accel: String,
    triangles: usize,
    seconds: f64,
    speedup: Option<f64>,
    build_seconds: f64,
    bytes_per_triangle: f64,
    outcome_counters: bilux::scene::Counters,
    picture: String,
}

/// Renders every number of teapots with every accelerator, on one thread, by `whitted` to depth 5.
///
/// # Errors
/// If an accelerator or a layout is unknown.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let counts = if options.counts.is_empty() { vec![2, 3, 4, 5] } else { options.counts.clone() };
    let mut accels = options.accels.clone();
    if accels.is_empty() {
        accels = ["brute", "bsp", "bsp-sah", "kd", "bvh"].map(str::to_owned).to_vec();
    }
    if accels.iter().any(|a| a == "brute") && !accels.iter().any(|a| a == "brute-simd") {
        accels.insert(1, "brute-simd".to_owned());
    }
    let mut rows: Vec<Row> = Vec::new();
    for &count in &counts {
        let scene = scene(count, &options.layout)?;
        let mut competitors = accels
            .iter()
            .map(|accel| Competitor::new(&scene, accel, options))
            .collect::<Result<Vec<_>, _>>()?;
        for round in 0..options.repeats.max(1) {
            for competitor in &mut competitors {
                // A loop over all triangles takes long enough for a single timing.
                if round == 0 || !competitor.is_loop {
                    progress(&format!("{count} teapots by {}, round {}", competitor.accel, round + 1));
                    competitor.time_round()?;
                }
            }
        }
        let first = rows.len();
        for competitor in competitors {
            rows.push(competitor.row(count, &scene)?);
        }
        let brute = rows[first..].iter().find(|r| r.accel == "brute").map(|r| r.seconds);
        for row in &mut rows[first..] {
            row.speedup = brute.map(|seconds| seconds / row.seconds);
        }
    }
    Ok(Report { rows: rows.iter().map(as_json).collect(), text: text(&rows, options), ..Report::default() })
}

/// The paper's teapots, or N of them.
pub fn scene(count: u32, layout: &str) -> Result<SceneBuilder, Error> {
    let spec = Spec::new("", "teapots")
        .with("count", Setting::Integer(i64::from(count)))
        .with("layout", if layout == "coverage" { "equal-coverage" } else { layout });
    bilux::generate(&spec)
}

/// The benchmark's settings: `whitted`, depth 5, one thread.
fn settings(accel: &str, size: (u32, u32)) -> Parameters {
    let mut settings = Parameters::default();
    settings.set("integrator", "whitted");
    settings.set("max_depth", Setting::Integer(5));
    settings.set("threads", Setting::Integer(1));
    settings.set("spp", Setting::Integer(1));
    settings.set("accel", accel);
    settings.set("size", Setting::Text(format!("{}x{}", size.0, size.1)));
    settings
}

/// An accelerator in the comparison.
struct Competitor {
    accel: String,
    job: Job,
    is_loop: bool,
    build_seconds: f64,
    seconds: Vec<f64>,
    outcome: Option<Outcome>,
}

impl Competitor {
    fn new(scene: &SceneBuilder, accel: &str, options: &Options) -> Result<Competitor, Error> {
        let (build_seconds, job) = timed(|| Job::new(scene, &settings(accel, options.size_or((512, 512)))))?;
        // Where counting costs nothing, one run provides both time and counts.
        let is_loop = accel.starts_with("brute");
        let job = if is_loop { job.counting_work() } else { job };
        let accel = accel.to_owned();
        Ok(Competitor { accel, job, is_loop, build_seconds, seconds: Vec::new(), outcome: None })
    }

    fn time_round(&mut self) -> Result<(), Error> {
        let (seconds, outcome) = timed(|| self.job.render(&Quiet))?;
        self.seconds.push(seconds);
        self.outcome = Some(outcome);
        Ok(())
    }

    fn row(mut self, count: u32, scene: &SceneBuilder) -> Result<Row, Error> {
        let outcome = match self.outcome.take().filter(|_| self.is_loop) {
            Some(counted) => counted,
            None => self.job.counting_work().render(&Quiet)?,
        };
        let trees = self.job.scene().geometry().instances();
        let bytes: usize = trees.iter().map(|tree| tree.accelerator.memory_bytes()).sum();
        let triangles: usize = scene.objects.iter().map(|o| o.mesh.triangles.len()).sum();
        Ok(Row {
            count,
            accel: self.accel,
            triangles,
            seconds: median(self.seconds),
            speedup: None,
            build_seconds: self.build_seconds,
            bytes_per_triangle: bytes as f64 / triangles as f64,
            outcome_counters: outcome.rendered.counters,
            picture: hash(&outcome)?,
        })
    }
}

/// A hash of the picture's samples, bit for bit.
fn hash(outcome: &Outcome) -> Result<String, Error> {
    let picture = outcome.picture()?;
    let mut hash = Sha256::new();
    for channel in picture.channels() {
        channel.samples.iter().for_each(|sample| hash.update(sample.to_le_bytes()));
    }
    Ok(hash.finalize().iter().take(12).map(|byte| format!("{byte:02x}")).collect())
}

fn as_json(row: &Row) -> Value {
    json!({
        "count": row.count, "accel": row.accel, "triangles": row.triangles, "seconds": row.seconds,
        "speedup": row.speedup, "build_seconds": row.build_seconds,
        "bytes_per_triangle": row.bytes_per_triangle, "rays": row.outcome_counters.rays,
        "node_visits": row.outcome_counters.nodes, "triangle_tests": row.outcome_counters.triangles,
        "early_outs": row.outcome_counters.early_outs, "picture": row.picture,
    })
}

/// The paper's Figure 2 with our columns next to it.
fn text(rows: &[Row], options: &Options) -> String {
    let header = [
        "teapots",
        "paper off",
        "paper BSP",
        "accel",
        "seconds",
        "vs brute",
        "build s",
        "bytes/tri",
        "nodes/ray",
        "tests/ray",
        "picture",
    ];
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let paper = PAPER.iter().find(|p| p.0 == row.count);
            let seconds = |s: Option<f64>| s.map_or("–".to_owned(), |s| format!("{s:.2}"));
            let rays = row.outcome_counters.rays.max(1) as f64;
            vec![
                row.count.to_string(),
                seconds(paper.map(|p| p.1)),
                seconds(paper.map(|p| p.2)),
                row.accel.clone(),
                format!("{:.4}", row.seconds),
                row.speedup.map_or("–".to_owned(), |s| format!("{s:.2}×")),
                format!("{:.3}", row.build_seconds),
                format!("{:.0}", row.bytes_per_triangle),
                format!("{:.1}", row.outcome_counters.nodes as f64 / rays),
                format!("{:.1}", row.outcome_counters.triangles as f64 / rays),
                row.picture[..8].to_owned(),
            ]
        })
        .collect();
    let (w, h) = options.size_or((512, 512));
    table(
        &format!("Figure 2 reproduced: {w}x{h}, whitted, depth 5, one thread, layout '{}'", options.layout),
        &header,
        &cells,
    )
}
