//! The results as text: one table per scene, and one that compares `auto` with the others.

use super::measured::{Measured, Row};
use super::options::Options;
use super::scenes::SIZE;
use crate::table;

/// The error for which the table states times.
pub(super) const TARGET: f64 = 0.01;

pub(super) fn text(measured: &[Measured], options: &Options) -> String {
    let mut text = format!(
        "Light transport: {}x{}, medians over {} seeds, seconds of CPU on {}\n\n",
        SIZE.0,
        SIZE.1,
        options.seeds.max(1),
        match options.threads {
            0 => "all cores".to_owned(),
            1 => "one thread".to_owned(),
            n => format!("{n} threads"),
        }
    );
    for scene in measured {
        text += &of_scene(scene);
        text.push('\n');
    }
    text + &of_auto(measured)
}

/// The columns of a scene's table.
pub(super) const HEADER: [&str; 14] = [
    "integrator",
    "seconds",
    "took",
    "samples",
    "relMSE",
    "trimmed",
    "bias² of it",
    "mean",
    "/ path",
    "s to 0.01",
    "MB",
    "predicted",
    "measured",
    "and trimmed",
];

fn of_scene(scene: &Measured) -> String {
    let cells: Vec<Vec<String>> = scene.rows.iter().map(|row| cells(scene, row)).collect();
    let title = format!(
        "{}: {}\nreference: {}; its own relMSE {:.1e}, below which errors cannot be distinguished",
        scene.scene, scene.summary, scene.reference.origin, scene.reference.relmse
    );
    table(&title, &HEADER, &cells)
}

pub(super) fn cells(scene: &Measured, row: &Row) -> Vec<String> {
    let optional = |x: Option<f64>, digits: usize| x.map_or("–".to_owned(), |x| format!("{x:.digits$}"));
    let compared = scene.compared(row);
    let times = |x: Option<f64>| x.map_or("–".to_owned(), short);
    let path = scene.find("path", row.seconds).map(|path| row.relmse / path.relmse);
    vec![
        row.integrator.clone(),
        format!("{}", row.seconds),
        format!("{:.2}", row.took),
        row.samples.to_string(),
        short(row.relmse),
        short(row.relmse_trimmed),
        row.bias2.map_or("–".to_owned(), |bias2| format!("{:.1}%", 100.0 * bias2 / row.relmse)),
        format!("{:+.2}%", 100.0 * (row.mean / scene.reference.mean() - 1.0)),
        optional(path, 3),
        short(row.took * row.relmse / TARGET),
        optional(row.peak_mb, 0),
        times(compared.predicted),
        times(compared.measured),
        times(compared.measured_trimmed),
    ]
}

/// Compares `auto` with `path` and the best single integrator.
fn of_auto(measured: &[Measured]) -> String {
    let rows = measured.iter().flat_map(|scene| scene.rows.iter().map(move |row| (scene, row)));
    let cells: Vec<Vec<String>> = rows
        .filter(|(_, row)| row.integrator == "auto")
        .filter_map(|(scene, auto)| {
            let path = scene.find("path", auto.seconds)?;
            let best = scene.best_single(auto.seconds)?;
            Some(vec![
                scene.scene.clone(),
                format!("{}", auto.seconds),
                format!("{:.2}", path.relmse / auto.relmse),
                best.integrator.clone(),
                format!("{:.2}", auto.relmse / best.relmse),
            ])
        })
        .collect();
    if cells.is_empty() {
        return String::new();
    }
    let header = ["scene", "seconds", "path's error / auto's", "best single", "auto's error / best's"];
    table("auto against the others, by relMSE at equal time", &header, &cells)
}

/// Formats a number with three significant digits.
pub(super) fn short(x: f64) -> String {
    match x {
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x if x >= 1.0 => format!("{x:.2}"),
        x if x >= 0.1 => format!("{x:.3}"),
        x if x >= 0.01 => format!("{x:.4}"),
        x if x >= 0.001 => format!("{x:.5}"),
        x => format!("{x:.2e}"),
    }
}
