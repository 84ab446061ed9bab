//! `bilux compare`: how much a picture differs from its reference.

use super::{DONE, check_folder, check_not_input};
use crate::arguments::{Common, Compare};
use crate::output;
use crate::sandbox::SandboxPaths;
use bilux::pictures::metrics::{HeatMap, METRICS, Pair, Report, heat_map};
use bilux::pictures::{Picture, TONEMAPS};
use std::path::Path;

/// The exit status when a bound is exceeded.
const BEYOND: u8 = 1;
/// The exit status when there is no answer.
const TROUBLE: u8 = 2;

/// Exits with 0 within the bounds, 1 outside them, and 2 if the pictures cannot be compared.
pub fn run(arguments: &Compare, common: &Common) -> anyhow::Result<u8> {
    match compare(arguments, common) {
        Err(error) if output::is_closed_pipe(&error) => Err(error),
        Ok(code) => Ok(code),
        Err(error) => {
            output::error(&error);
            Ok(TROUBLE)
        }
    }
}

fn compare(arguments: &Compare, common: &Common) -> anyhow::Result<u8> {
    let mut confines = SandboxPaths::default().reading(&arguments.picture).reading(&arguments.reference);
    if let Some(path) = &arguments.heat_map {
        check_folder(path)?;
        bilux::pictures::format_of_path(path)?;
        check_not_input(path, [&*arguments.picture, &*arguments.reference])?;
        confines = confines.writing(path);
        confines.check_written(path, common)?;
    }
    confines.enter(common)?;
    let picture = bilux::pictures::read(&arguments.picture)?;
    let reference = bilux::pictures::read(&arguments.reference)?;
    let report = bilux::pictures::compare(&picture, &reference)?;
    if arguments.json {
        output::print(serde_json::to_string_pretty(&as_json(&report))?)?;
    } else {
        for (name, value) in &report.values {
            let summary =
                METRICS.iter().find(|row| row.entry.name == *name).map_or("", |row| row.entry.summary);
            output::print(format_args!("{name:<7} {value:<12.6} {summary}"))?;
        }
    }
    if report.non_finite != [0, 0] {
        let [a, b] = report.non_finite;
        output::warning(format_args!("{a} samples of the picture and {b} of the reference are not finite"));
    }
    if let Some(path) = &arguments.heat_map {
        write_heat_map(&picture, &reference, path)?;
    }
    let broken = broken_bounds(arguments, &report);
    broken.iter().for_each(|bound| output::eprint(format_args!("out of bounds: {bound}")));
    Ok(if broken.is_empty() { DONE } else { BEYOND })
}

fn as_json(report: &Report) -> serde_json::Value {
    let values = report.values.iter().map(|(name, _)| ((*name).to_owned(), report.finite(name).into()));
    serde_json::Value::Object(values.collect())
}

fn write_heat_map(picture: &Picture, reference: &Picture, path: &Path) -> anyhow::Result<()> {
    let pair = Pair::new(picture, reference, 0.0, &TONEMAPS[0])?;
    Ok(bilux::pictures::write(path, &heat_map(&pair, HeatMap::Flip)?, &Default::default())?)
}

/// Every bound that does not hold; NaN satisfies no bound.
fn broken_bounds(arguments: &Compare, report: &Report) -> Vec<String> {
    let most = [
        ("flip", arguments.max_flip),
        ("rmse", arguments.max_rmse),
        ("relmse", arguments.max_relmse),
        ("max", arguments.max_error),
    ];
    let least = [("ssim", arguments.min_ssim), ("psnr", arguments.min_psnr)];
    let value = |name| report.value(name).unwrap_or(f64::NAN);
    let above = most.iter().filter_map(|&(name, bound)| {
        let (value, bound) = (value(name), bound?);
        let holds = value <= bound;
        (!holds).then(|| format!("{name} is {value}, more than {bound}"))
    });
    let below = least.iter().filter_map(|&(name, bound)| {
        let (value, bound) = (value(name), bound?);
        let holds = value >= bound;
        (!holds).then(|| format!("{name} is {value}, less than {bound}"))
    });
    above.chain(below).collect()
}
