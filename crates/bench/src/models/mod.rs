//! Pictures of a newcomer: models as they come, rendered with default settings, in one second and with `--fast`, each by
//! a process of its own, and compared with converged pictures by perceptual metrics.

mod blotches;
mod files;

use crate::{ProgressFn, Report, table};
use bilux::Error;
use bilux::math::Rgb;
use bilux::pictures::{Picture, compare};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Files to measure, and the time to spend.
#[derive(Clone, Debug)]
pub struct Options {
    /// The program `bilux` itself.
    pub program: PathBuf,
    /// The model files; if there are none, the built-in ones and those in `../shared/scenes`.
    pub files: Vec<PathBuf>,
    /// The seconds for each of the two halves of a reference.
    pub seconds: f64,
    /// The folder where references are kept from one run to the next.
    pub references: Option<PathBuf>,
}

/// The default number of seconds for each half of a reference.
pub const SECONDS: f64 = 8.0;

/// Arguments of a render, and the maximum mean FLIP of a good picture.
struct Setting {
    name: &'static str,
    arguments: &'static [&'static str],
    goal: f64,
}

const SETTINGS: [Setting; 3] = [
    Setting { name: "nothing said", arguments: &[], goal: 0.08 },
    Setting { name: "--time-limit 1", arguments: &["--time-limit", "1"], goal: 0.12 },
    Setting { name: "--fast", arguments: &["--fast"], goal: 0.12 },
];

/// A converged picture: the mean of two independent ones.
struct Reference {
    picture: Picture,
    /// The FLIP between the two halves: about that much is uncertain, and the mean is closer to the truth.
    noise: f64,
}

/// One picture compared with its reference.
struct Row {
    model: String,
    setting: &'static Setting,
    seconds: f64,
    flip: f64,
    blotched: f64,
    noise: f64,
}

impl Row {
    fn json(&self) -> Value {
        json!({
            "model": self.model, "setting": self.setting.name, "seconds": self.seconds, "flip": self.flip,
            "blotched": self.blotched, "reference_flip": self.noise, "goal": self.setting.goal,
        })
    }

    fn cells(&self) -> Vec<String> {
        vec![
            self.model.clone(),
            self.setting.name.to_owned(),
            format!("{:.2}", self.seconds),
            format!("{:.3}", self.flip),
            format!("{:.1}%", 100.0 * self.blotched),
            format!("{:.3}", self.noise),
            (if self.flip <= self.setting.goal { "" } else { "above" }).to_owned(),
        ]
    }
}

/// Runs the benchmark.
///
/// # Errors
/// If a picture cannot be rendered, or a file cannot be written.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let scratch = std::env::temp_dir().join(format!("bilux-models-{}", std::process::id()));
    make_folder(&scratch)?;
    if let Some(folder) = &options.references {
        make_folder(folder)?;
    }
    let bench = Bench { options, scratch: &scratch, progress };
    let rows = bench.rows();
    // The generated files are no longer needed.
    let _ = std::fs::remove_dir_all(&scratch);
    let rows = rows?;
    let cells: Vec<Vec<String>> = rows.iter().map(Row::cells).collect();
    let header = ["model", "asked for", "seconds", "FLIP", "blotched", "reference", "goal"];
    let title = format!(
        "Models as they are: 512x512, wall seconds of the whole program; FLIP against the mean of two pictures of {} \
         s each\n\
         ('reference' is the FLIP of these two); blotched: pixels whose surroundings are off by {} L* and more",
        options.seconds,
        blotches::SEEN
    );
    Ok(Report {
        text: table(&title, &header, &cells) + &summary(&rows),
        rows: rows.iter().map(Row::json).collect(),
        ..Report::default()
    })
}

/// A line for each setting.
fn summary(rows: &[Row]) -> String {
    let of_setting = |setting: &Setting| {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.setting.name == setting.name).collect();
        let mean =
            |of: fn(&Row) -> f64| rows.iter().map(|row| of(row)).sum::<f64>() / rows.len().max(1) as f64;
        format!(
            "{}: FLIP at most {} in {} of {}; means: FLIP {:.3}, {:.1}% blotched, {:.2} s\n",
            setting.name,
            setting.goal,
            rows.iter().filter(|row| row.flip <= setting.goal).count(),
            rows.len(),
            mean(|row| row.flip),
            100.0 * mean(|row| row.blotched),
            mean(|row| row.seconds)
        )
    };
    SETTINGS.iter().map(of_setting).collect()
}

struct Bench<'a> {
    options: &'a Options,
    scratch: &'a Path,
    progress: ProgressFn<'a>,
}

impl Bench<'_> {
    fn rows(&self) -> Result<Vec<Row>, Error> {
        let files = match self.options.files.as_slice() {
            [] => files::all(&self.options.program, self.scratch)?,
            given => given.to_vec(),
        };
        let mut rows = Vec::new();
        for file in files {
            let model = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
            (self.progress)(&model);
            let reference = self.reference(&file, &model)?;
            for setting in &SETTINGS {
                let output = self.scratch.join("picture.png");
                let seconds = self.render(&file, &output, setting.arguments)?;
                let picture = bilux::pictures::formats::read(&output)?;
                let pair = [&picture, &reference.picture];
                let (flip, blotched) = (flip(pair)?, blotches::share(pair));
                rows.push(Row {
                    model: model.clone(),
                    setting,
                    seconds,
                    flip,
                    blotched,
                    noise: reference.noise,
                });
            }
        }
        Ok(rows)
    }

    /// The mean of two pictures with different seeds, rendered now or kept from an earlier run.
    fn reference(&self, file: &Path, model: &str) -> Result<Reference, Error> {
        let folder = self.options.references.as_deref().unwrap_or(self.scratch);
        let seconds = self.options.seconds.to_string();
        let half = |seed: &str| {
            let path = folder.join(format!("{model}.{seconds}s.{seed}.png"));
            if !path.exists() {
                self.render(file, &path, &["--time-limit", &seconds, "--seed", seed])?;
            }
            Ok::<_, Error>(bilux::pictures::formats::read(&path)?)
        };
        let (a, b) = (half("101")?, half("202")?);
        let noise = flip([&a, &b])?;
        let (width, height) = (a.width(), a.height());
        let light = [a, b].map(|half| half.into_linear().to_rgb().unwrap_or_default());
        let mean: Vec<Rgb> = light[0].iter().zip(&light[1]).map(|(&a, &b)| (a + b) * 0.5).collect();
        Ok(Reference { picture: Picture::from_rgb(width, height, mean)?, noise })
    }

    /// The seconds from the start of the program to its end.
    fn render(&self, file: &Path, output: &Path, more: &[&str]) -> Result<f64, Error> {
        let begun = Instant::now();
        let mut command = Command::new(&self.options.program);
        command.arg("render").arg(file).arg("-o").arg(output).arg("--quiet").args(more);
        files::finish(command)?;
        Ok(begun.elapsed().as_secs_f64())
    }
}

fn flip([picture, reference]: [&Picture; 2]) -> Result<f64, Error> {
    Ok(compare(picture, reference)?.value("flip").unwrap_or(f64::NAN))
}

fn make_folder(folder: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::Settings(format!("cannot make the folder '{}': {e}", folder.display())))
}
