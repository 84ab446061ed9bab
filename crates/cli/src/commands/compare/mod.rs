//! `bilux compare`: how much pictures differ from their references, one pair or two folders of them.

mod compared;
mod folders;
mod page;

use crate::arguments::{Common, Compare};
use crate::commands::DONE;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::checks::check_not_input;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::output;
use anyhow::bail;
use bilux::pictures::metrics::METRICS;
use compared::{BEYOND, Compared, TROUBLE, as_json, broken_bounds};
use std::path::Path;

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
