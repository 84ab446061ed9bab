//! Folders of pictures, in pairs by their names.

use super::compared::{BEYOND, Compared, TROUBLE, as_json, broken_bounds};
use super::page;
use crate::arguments::{Common, Compare};
use crate::commands::DONE;
use crate::commands::shared::checks::is_picture;
use crate::process::output;
use anyhow::{Context, bail};
use bilux::pictures::Report;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A pair of pictures.
struct Row {
    name: String,
    report: Report,
    broken: Vec<String>,
    page: Option<page::Entry>,
}

/// Compares all pictures of a folder with those of the same names in the other. A picture that has no partner, or that
/// cannot be compared with it, is trouble; but the others are compared.
pub(super) fn compare(arguments: &Compare, common: &Common) -> anyhow::Result<u8> {
    let folders = [&*arguments.picture, &*arguments.reference];
    let [ours, theirs] = [names(folders[0])?, names(folders[1])?];
    if ours.is_disjoint(&theirs) {
        let folders = folders.map(|folder| folder.display());
        bail!(
            "{} and {} have no picture of the same name: name two folders with pairs",
            folders[0],
            folders[1]
        );
    }
    let missing: Vec<String> = [(&theirs, &ours, folders[0]), (&ours, &theirs, folders[1])]
        .into_iter()
        .flat_map(|(there, here, folder)| there.difference(here).map(move |name| folder.join(name)))
        .map(|path| format!("{}: there is no such picture", path.display()))
        .collect();
    let (mut rows, mut troubles) = (Vec::new(), missing);
    for name in ours.intersection(&theirs) {
        match row(arguments, name, common) {
            Ok(row) => rows.push(row),
            Err(error) => troubles.push(format!("{}: {error:#}", name.display())),
        }
    }
    rows.sort_by(|a, b| flip(&b.report).total_cmp(&flip(&a.report)).then_with(|| a.name.cmp(&b.name)));
    if arguments.json {
        output::print(serde_json::to_string_pretty(&json(&rows, &troubles))?)?;
    } else {
        print(&rows)?;
    }
    for trouble in &troubles {
        output::eprint(format_args!("error: {trouble}"));
    }
    for (name, bound) in rows.iter().flat_map(|row| row.broken.iter().map(|bound| (&row.name, bound))) {
        output::eprint(format_args!("{name}: out of bounds: {bound}"));
    }
    if let Some(path) = &arguments.html {
        let entries: Vec<page::Entry> = rows.iter_mut().filter_map(|row| row.page.take()).collect();
        page::write(path, &entries, &troubles)?;
    }
    Ok(match (troubles.is_empty(), rows.iter().all(|row| row.broken.is_empty())) {
        (false, _) => TROUBLE,
        (true, false) => BEYOND,
        (true, true) => DONE,
    })
}

/// The names of the pictures in a folder.
fn names(folder: &Path) -> anyhow::Result<BTreeSet<PathBuf>> {
    let mut names = BTreeSet::new();
    collect(folder, Path::new(""), &mut names)?;
    if names.is_empty() {
        bail!("{}: there are no pictures in this folder", folder.display());
    }
    Ok(names)
}

/// Adds the pictures in a folder within a folder, and in those within it. Links to folders are not followed: they may lead in a circle.
fn collect(root: &Path, within: &Path, names: &mut BTreeSet<PathBuf>) -> anyhow::Result<()> {
    let folder = root.join(within);
    for entry in std::fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
        let entry = entry.with_context(|| folder.display().to_string())?;
        let (path, name) = (entry.path(), within.join(entry.file_name()));
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            collect(root, &name, names)?;
        } else if is_picture(&path) && path.is_file() {
            names.insert(name);
        }
    }
    Ok(())
}

fn row(arguments: &Compare, name: &Path, common: &Common) -> anyhow::Result<Row> {
    let (picture, reference) = (arguments.picture.join(name), arguments.reference.join(name));
    let layer = arguments.layer.as_deref();
    let pair = Compared::of(&name.to_string_lossy(), [&picture, &reference], layer, common)?;
    let broken = broken_bounds(arguments, &pair.report);
    let page = arguments.html.is_some().then(|| page::Entry::of(&pair, &broken)).transpose()?;
    Ok(Row { name: pair.name, report: pair.report, broken, page })
}

/// The error by which rows are sorted; NaN is the worst.
fn flip(report: &Report) -> f64 {
    let error = report.value("flip").unwrap_or(f64::NAN);
    if error.is_nan() { f64::INFINITY } else { error }
}

fn json(rows: &[Row], troubles: &[String]) -> Value {
    let row = |row: &Row| {
        let mut value = as_json(&row.report);
        value["name"] = json!(row.name);
        value["out_of_bounds"] = json!(row.broken);
        value
    };
    json!({ "pairs": rows.iter().map(row).collect::<Vec<_>>(), "errors": troubles })
}

/// A table, the worst pair first.
fn print(rows: &[Row]) -> anyhow::Result<()> {
    let width = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max("picture".len());
    let Some(first) = rows.first() else { return Ok(()) };
    let metrics: Vec<String> =
        first.report.values.iter().rev().map(|(name, _)| format!("{name:>10}")).collect();
    output::print(format_args!("{:<width$}{}", "picture", metrics.join("")))?;
    for row in rows {
        let values: Vec<String> =
            row.report.values.iter().rev().map(|(_, value)| format!("{value:>10.5}")).collect();
        let bounds = if row.broken.is_empty() { "" } else { "  out of bounds" };
        output::print(format_args!("{:<width$}{}{bounds}", row.name, values.join("")))?;
    }
    Ok(())
}
