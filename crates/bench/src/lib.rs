//! The benchmarks that `bilux bench` runs, one per file. Each returns a [`Report`] that prints as a table or as JSON.
//!
//! A speed is a ratio measured within one run: the competitors take turns, and the medians are reported.

mod accels;
pub mod build;
pub mod frames;
pub mod load;
pub mod models;
pub mod paper;
pub mod rays;
pub mod render;
pub mod speed;
pub mod teapots;
pub mod visibility;

use bilux::Error;
use bilux::pictures::Picture;
use serde_json::{Value, json};
use std::time::Instant;

/// Called with a line about what is being measured.
pub type ProgressFn<'a> = &'a dyn Fn(&str);

/// The result of a benchmark.
#[derive(Default)]
pub struct Report {
    /// One JSON object per row.
    pub rows: Vec<Value>,
    /// The rows as text.
    pub text: String,
    /// A picture of what was rendered, if there is one.
    pub picture: Option<Picture>,
    /// The processor that it was measured on, if the report states it.
    pub cpu: Option<String>,
}

impl Report {
    /// `{"rows": […]}`, or `{"cpu": …, "rows": […]}`.
    pub fn json(&self) -> Value {
        match &self.cpu {
            Some(cpu) => json!({ "cpu": cpu, "rows": self.rows }),
            None => json!({ "rows": self.rows }),
        }
    }
}

/// The options that all benchmarks share.
#[derive(Clone, Debug)]
pub struct Options {
    /// The numbers of teapots; empty for the benchmark's defaults.
    pub counts: Vec<u32>,
    /// The accelerators; empty for the benchmark's defaults.
    pub accels: Vec<String>,
    /// The width and height of pictures; `None` for the benchmark's default.
    pub size: Option<(u32, u32)>,
    /// The number of repeats; the median is reported.
    pub repeats: u32,
    /// `paper`: at the paper's fixed offset, seen by its camera; `coverage`: always covering the same part of the
    /// picture.
    pub layout: String,
}

impl Default for Options {
    fn default() -> Options {
        Options { counts: Vec::new(), accels: Vec::new(), size: None, repeats: 3, layout: "paper".to_owned() }
    }
}

impl Options {
    fn size_or(&self, own: (u32, u32)) -> (u32, u32) {
        self.size.unwrap_or(own)
    }
}

/// The seconds that `work` takes, and its result.
fn timed<T>(work: impl FnOnce() -> Result<T, Error>) -> Result<(f64, T), Error> {
    let begun = Instant::now();
    let result = work()?;
    Ok((begun.elapsed().as_secs_f64(), result))
}

/// The median; for an even number of values, the lower of the two in the middle.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(f64::NAN)
}

/// A table with a title and right-aligned columns.
fn table(title: &str, header: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.chain([header[column].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &[String]| {
        let padded: Vec<String> = cells.iter().zip(&widths).map(|(cell, &w)| format!("{cell:>w$}")).collect();
        padded.join("  ")
    };
    let header: Vec<String> = header.iter().map(ToString::to_string).collect();
    let body: Vec<String> = rows.iter().map(|row| line(row)).collect();
    format!("{title}\n{}\n{}\n", line(&header), body.join("\n"))
}
