//! Speed and size of Bilux, in one table of goals: a row for each thing that a goal was set for, with the same
//! thing by another renderer where one can be asked.
//!
//! Both sides of a row are measured in the same run and take turns; medians are reported. Where the other renderer is
//! not installed, or is none that a program could start, the row has our side only and says so.

mod auto;
mod cornell;
mod cornell_rows;
mod cpu;
mod embree;
mod lamps;
mod lobes;
mod measurement;
mod memory;
mod mitsuba;
mod model;
mod options;
mod row;
mod shots;
mod studio;
mod threads;

use crate::{ProgressFn, Report};
use bilux::Error;
use bilux::scene::error::nearest_name;
use cpu::cpu;
use measurement::Context;
pub use measurement::Measurement;
pub use options::Options;
use row::Row;

/// Everything that can be measured, in the order of the table.
pub static MEASUREMENTS: &[Measurement] = &[
    cornell_rows::PATH,
    cornell_rows::BIDIRECTIONAL,
    model::MEASUREMENT,
    studio::MEASUREMENT,
    auto::MEASUREMENT,
    lamps::MEASUREMENT,
    threads::MEASUREMENT,
    memory::MEASUREMENT,
    lobes::MEASUREMENT,
    embree::MEASUREMENT,
];

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
