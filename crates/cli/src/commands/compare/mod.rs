//! `bilux compare`: how much pictures differ from their references, one pair or two folders of them.

mod folders;
mod page;

use super::pictures::{read_picture, with_main};
use super::{DONE, check_folder, check_not_input};
use crate::arguments::{Common, Compare};
use crate::output;
use crate::sandbox::SandboxPaths;
use anyhow::bail;
use bilux::pictures::metrics::{HeatMap, METRICS, Pair, Report, heat_map};
use bilux::pictures::{Limits, Picture, TONEMAPS};
use serde_json::Value;
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
    let sides = [&*arguments.picture, &*arguments.reference];
    let [a, b] = sides.map(Path::is_dir);
    if a != b {
        let (folder, file) = if a { (sides[0], sides[1]) } else { (sides[1], sides[0]) };
        bail!(
            "{} is a folder and {} is not: compare two pictures, or two folders of them",
            folder.display(),
            file.display()
        );
    }
    if a && arguments.heat_map.is_some() {
        bail!("--heat-map is of one pair of pictures: use --html to see the errors of folders");
    }
    let mut confines = SandboxPaths::default().reading(sides[0]).reading(sides[1]);
    for path in [&arguments.heat_map, &arguments.html].into_iter().flatten() {
        check_folder(path)?;
        check_not_input(path, sides)?;
        confines = confines.writing(path);
        confines.check_written(path, common)?;
    }
    if let Some(path) = &arguments.heat_map {
        bilux::pictures::format_of_path(path)?;
    }
    confines.enter(common)?;
    if a { folders::compare(arguments, common) } else { compare_one(arguments, common) }
}

fn compare_one(arguments: &Compare, common: &Common) -> anyhow::Result<u8> {
    let paths = [&*arguments.picture, &*arguments.reference];
    let pair = Compared::of("", paths, arguments.layer.as_deref(), common)?;
    let report = &pair.report;
    if arguments.json {
        output::print(serde_json::to_string_pretty(&as_json(report))?)?;
    } else {
        for (name, value) in &report.values {
            let summary =
                METRICS.iter().find(|row| row.entry.name == *name).map_or("", |row| row.entry.summary);
            output::print(format_args!("{name:<7} {value:<12.6} {summary}"))?;
        }
    }
    if let Some(path) = &arguments.heat_map {
        bilux::pictures::write(path, &pair.heat_map()?, &Default::default())?;
    }
    let broken = broken_bounds(arguments, report);
    broken.iter().for_each(|bound| output::eprint(format_args!("out of bounds: {bound}")));
    if let Some(path) = &arguments.html {
        let name = arguments.picture.display().to_string();
        page::write(path, &[page::Entry::of(&Compared { name, ..pair }, &broken)?], &[])?;
    }
    Ok(if broken.is_empty() { DONE } else { BEYOND })
}

/// Two pictures, and how they differ.
struct Compared {
    /// What people call them.
    name: String,
    picture: Picture,
    reference: Picture,
    report: Report,
}

impl Compared {
    /// Reads and compares them; warns of samples that are not finite.
    fn of(name: &str, paths: [&Path; 2], layer: Option<&str>, common: &Common) -> anyhow::Result<Compared> {
        let [picture, reference] = read_pair(paths, layer, common)?;
        let report = bilux::pictures::compare(&picture, &reference)?;
        if report.non_finite != [0, 0] {
            let ([a, b], of) = (report.non_finite, if name.is_empty() { "" } else { ": " });
            output::warning(format_args!(
                "{name}{of}{a} samples of the picture and {b} of the reference are not finite"
            ));
        }
        Ok(Compared { name: name.to_owned(), picture, reference, report })
    }

    fn heat_map(&self) -> anyhow::Result<Picture> {
        let pair = Pair::new(&self.picture, &self.reference, 0.0, &TONEMAPS[0])?;
        Ok(heat_map(&pair, HeatMap::Flip)?)
    }
}

/// Reads two pictures: of two crops only these, but as the picture that a crop belongs to if the other one is that.
fn read_pair(paths: [&Path; 2], layer: Option<&str>, common: &Common) -> anyhow::Result<[Picture; 2]> {
    // Two pictures are read at a time.
    let limits = Limits::new(common.max_memory / 2);
    let read = |path: &Path| {
        let picture = read_picture(path, &limits, common)?;
        with_main(picture, layer, path, common)
    };
    let (a, b) = (read(paths[0])?, read(paths[1])?);
    if [a.width(), a.height()] == [b.width(), b.height()]
        && (a.crop == b.crop || a.crop.is_none() || b.crop.is_none())
    {
        return Ok([a, b]);
    }
    let whole = |path: &Path| anyhow::Ok(bilux::pictures::read_with(path, &limits)?.with_main(layer)?);
    Ok([whole(paths[0])?, whole(paths[1])?])
}

fn as_json(report: &Report) -> Value {
    let values = report.values.iter().map(|(name, _)| ((*name).to_owned(), report.finite(name).into()));
    Value::Object(values.collect())
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
