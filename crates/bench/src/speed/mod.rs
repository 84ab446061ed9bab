//! How fast Bilux is, and how small, in one table of goals: a row for each thing that a goal was set for, with the same
//! thing by another renderer where one can be asked.
//!
//! Both sides of a row are measured in the same run and take turns; medians are reported. Where the other renderer is
//! not installed, or is none that a program could start, the row has our side only and says so.

mod auto;
mod cornell;
mod cornell_rows;
mod embree;
mod lobes;
mod memory;
mod mitsuba;
mod model;
mod row;
mod shots;
mod studio;
mod threads;

use crate::{ProgressFn, Report};
use bilux::Error;
use bilux::accel::CpuLevel;
use bilux::formats::ReadOptions;
use bilux::scene::error::nearest_name;
use row::Row;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// What is measured, and with what.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names from [`MEASUREMENTS`]; if empty, all of them.
    pub rows: Vec<String>,
    /// The model of the rows about models; they are skipped without one.
    pub model: Option<PathBuf>,
    /// How the model is read.
    pub read: ReadOptions,
    /// The Python that can import Mitsuba.
    pub python: PathBuf,
    /// Embree's library.
    pub embree: PathBuf,
    /// The program `bilux` itself, which measures memory in a process of its own.
    pub program: PathBuf,
    /// The number of repeats; the median is reported.
    pub repeats: u32,
    /// The CPU seconds per picture where integrators are compared at equal time.
    pub seconds: f64,
    /// The share of the usual samples, seconds and rays, above 0 and at most 1: less is quicker, and less accurate.
    pub share: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            rows: Vec::new(),
            model: None,
            read: ReadOptions::default(),
            python: "python3".into(),
            embree: "libembree4.so.4".into(),
            program: "bilux".into(),
            repeats: 3,
            seconds: 1.0,
            share: 1.0,
        }
    }
}

impl Options {
    /// A share of what is usual, at least 1.
    fn part_of(&self, usual: u32) -> u32 {
        ((f64::from(usual) * self.share).round() as u32).max(1)
    }
}

/// One way of filling rows of the table.
pub struct Measurement {
    /// Its name for the user.
    pub name: &'static str,
    /// What it measures.
    pub summary: &'static str,
    run: fn(&Context) -> Result<Vec<Row>, Error>,
}

/// Everything that can be measured, in the order of the table.
pub const MEASUREMENTS: &[Measurement] = &[
    cornell_rows::PATH,
    cornell_rows::BIDIRECTIONAL,
    model::MEASUREMENT,
    studio::MEASUREMENT,
    auto::MEASUREMENT,
    threads::MEASUREMENT,
    memory::MEASUREMENT,
    lobes::MEASUREMENT,
    embree::MEASUREMENT,
];

/// What a measurement is given.
struct Context<'a> {
    options: &'a Options,
    progress: ProgressFn<'a>,
    /// Nothing else is measured by this process.
    is_alone: bool,
}

impl Context<'_> {
    /// Says what is being measured.
    fn say(&self, what: &str) {
        (self.progress)(what);
    }

    /// Numbers of rounds, from 0.
    fn rounds(&self) -> std::ops::Range<u32> {
        0..self.options.repeats.max(1)
    }
}

/// Measures the rows.
///
/// # Errors
/// If there is no row of a name, or a scene cannot be rendered.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let chosen = chosen(&options.rows)?;
    let context = Context { options, progress, is_alone: chosen.len() == 1 };
    let mut rows = Vec::new();
    for measurement in chosen {
        rows.extend((measurement.run)(&context)?);
    }
    let cpu = cpu();
    let text = row::text(&rows, &format!("Speed and size on {cpu}; medians of {}", options.repeats.max(1)));
    Ok(Report { rows: rows.iter().map(Row::json).collect(), text, cpu: Some(cpu), ..Report::default() })
}

/// The measurements with these names, in the order of the table.
fn chosen(names: &[String]) -> Result<Vec<&'static Measurement>, Error> {
    let known: Vec<String> = MEASUREMENTS.iter().map(|m| m.name.to_owned()).collect();
    if let Some(wrong) = names.iter().find(|name| !known.contains(name)) {
        let hint = match nearest_name(wrong, &known) {
            Some(nearest) => format!("did you mean '{nearest}'?"),
            None => format!("there are {}", known.join(", ")),
        };
        return Err(Error::Settings(format!("bench speed has no rows '{wrong}'; {hint}")));
    }
    let is_wanted = |m: &&Measurement| names.is_empty() || names.iter().any(|name| name == m.name);
    Ok(MEASUREMENTS.iter().filter(is_wanted).collect())
}

/// The processor, the number of its cores that there are for us, and the instructions that kernels use.
fn cpu() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |key: &str| {
        let of_line = |line: &str| line.split_once(':').map(|(k, v)| (k.trim() == key, v.trim().to_owned()));
        text.lines().filter_map(of_line).find(|(is_it, _)| *is_it).map(|(_, value)| value)
    };
    let name = field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let kind = match (field("cpu family"), field("model")) {
        (Some(family), Some(model)) => format!(" (family {family}, model {model})"),
        _ => String::new(),
    };
    let cores = match cores() {
        1 => "1 core".to_owned(),
        n => format!("{n} cores"),
    };
    format!("{name}{kind}, {cores}, {}", CpuLevel::detect().name())
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The rows as another process has printed them.
fn rows_of(printed: &Value) -> Vec<Row> {
    printed["rows"].as_array().into_iter().flatten().map(Row::from_json).collect()
}
