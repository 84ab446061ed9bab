//! `bilux convert`: converts between scene formats, and between picture formats.

pub(in crate::commands) mod contours;
pub(in crate::commands) mod plan;

use crate::arguments::streams::named;
use crate::arguments::{Common, Convert};
use crate::commands::DONE;
use crate::commands::render::targets::is_stdout;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::checks::check_not_input;
use crate::commands::shared::checks::is_picture;
use crate::commands::shared::checks::warn_lost_alpha;
use crate::commands::shared::given::Given;
use crate::commands::shared::outputs;
use crate::commands::shared::pictures::with_main;
use crate::commands::shared::reading::check_choices;
use crate::commands::shared::reading::read_options_with;
use crate::commands::shared::reading::report_warnings;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::usage;
use anyhow::{anyhow, bail};
use bilux::formats::check_not_read;
use bilux::pictures::formats::WriteOptions;
use bilux::pictures::{Limits, Picture, Source};
use plan::Plan;
use std::path::Path;

pub fn run(arguments: &Convert, common: &Common) -> anyhow::Result<u8> {
    let (input, output) = (&arguments.input, &arguments.output);
    let given = Given::open(input, &arguments.posed.input_format, common)?;
    let confines = SandboxPaths::default().reading_scene(Given::place(input));
    let confines = if is_stdout(output) { confines } else { confines.writing(output) };
    if !is_stdout(output) {
        check_folder(output).map_err(usage::wrong)?;
        check_not_input(output, [&**input]).map_err(usage::wrong)?;
        confines.check_written(output, common).map_err(usage::wrong)?;
    }
    let to_picture =
        is_stdout(output) || is_picture(output) || arguments.heat_map.is_some() && is_table(output);
    match (given.holds_picture(), to_picture) {
        (true, true) => {
            if !is_table(output) {
                let format = arguments.output_format.as_deref();
                outputs::check(output, format, arguments.quality).map_err(usage::wrong)?;
            }
            confines.enter(common)?;
            convert_picture(&given, arguments, common)?;
        }
        (false, false) => {
            check_scene_options(arguments).map_err(usage::wrong)?;
            confines.enter(common)?;
            convert_scene(&given, arguments, common)?;
        }
        (false, true) => {
            return Err(mismatch(input, output, "a scene", "is a picture: use `bilux render`"));
        }
        (true, false) => {
            if is_table(output) {
                let message = "a .csv holds the numbers of one channel: name it with --heat-map";
                return Err(usage::wrong(anyhow!("{}: {message}", output.display())));
            }
            if bilux::formats::format_of_path(output).is_err() {
                bilux::pictures::format_of_path(output).map_err(usage::wrong)?;
            }
            return Err(mismatch(input, output, "a picture", "is a scene: write a picture, such as out.png"));
        }
    }
    Ok(DONE)
}

/// True for a file of comma-separated values.
fn is_table(output: &Path) -> bool {
    output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

fn convert_picture(given: &Given, arguments: &Convert, common: &Common) -> anyhow::Result<()> {
    let (output, format) = (&arguments.output, arguments.output_format.as_deref());
    let limits = Limits::new(common.max_memory);
    if arguments.heat_map.is_none()
        && arguments.layer.is_none()
        && let Some(stored) = given.stored_picture(&limits, common)?
    {
        // As numbers it would take four times as much memory.
        let lost = bilux::lost_transparency(stored.is_transparent(), &named(output, format), None)?;
        report_warnings(lost.as_slice(), common)?;
        return outputs::write_source(output, format, Source::Bytes(&stored), &options_of(arguments));
    }
    let picture = given.picture(&limits, common)?;
    if let Some(channel) = &arguments.heat_map {
        let plan = Plan::of(&picture, channel, arguments)?;
        if !common.quiet {
            plan.explain();
        }
        if is_table(output) {
            return Ok(bilux::pictures::write_atomically(output, plan.table().as_bytes())
                .map_err(|error| error.in_file(output))?);
        }
        return outputs::write(output, format, &plan.picture()?, &WriteOptions::default());
    }
    let named = named(output, format);
    let picture = converted(picture, arguments, &named, common)?;
    warn_lost_alpha(&picture, &named, None, common)?;
    outputs::write(output, format, &picture, &options_of(arguments))
}

fn options_of(arguments: &Convert) -> WriteOptions {
    let options = WriteOptions::default();
    WriteOptions { quality: arguments.quality.unwrap_or(options.quality), ..options }
}

/// Refuses what only pictures have.
fn check_scene_options(arguments: &Convert) -> anyhow::Result<()> {
    bilux::formats::format_of_path(&arguments.output)?;
    if arguments.quality.is_some() {
        bail!("--quality is only for JPEG pictures: leave it out");
    }
    let of_pictures = [
        ("--layer", arguments.layer.is_some()),
        ("--heat-map", arguments.heat_map.is_some()),
        ("--output-format", arguments.output_format.is_some()),
    ];
    match of_pictures.iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) => bail!("{flag} is of a picture, not of a scene: leave it out"),
        None => Ok(()),
    }
}

fn convert_scene(given: &Given, arguments: &Convert, common: &Common) -> anyhow::Result<()> {
    let (output, posed) = (&arguments.output, &arguments.posed);
    let scene = given.scene(&read_options_with(common, &posed.choices, posed.at))?;
    check_choices(&scene, &posed.choices).map_err(usage::wrong)?;
    check_not_read(output, &scene.files).map_err(usage::wrong)?;
    report_warnings(&scene.warnings, common)?;
    let options = bilux::formats::WriteOptions { ascii: arguments.ascii };
    report_warnings(&bilux::formats::write(output, &scene, &options)?, common)
}

/// Picture as it is to be written in the format of this name.
fn converted(
    picture: Picture,
    arguments: &Convert,
    named: &Path,
    common: &Common,
) -> anyhow::Result<Picture> {
    let layer = arguments.layer.as_deref();
    let holds_layers = bilux::pictures::format_of_path(named)?.entry.name == "exr";
    if holds_layers && layer.is_none() {
        return Ok(picture);
    }
    let metadata = picture.metadata.clone();
    let mut main = with_main(picture, layer, &arguments.input, common)?.main();
    main.metadata = metadata;
    Ok(main)
}

fn mismatch(input: &Path, output: &Path, one: &str, other: &str) -> anyhow::Error {
    usage::wrong(anyhow!("{} is {one}, but {} {other}", input.display(), output.display()))
}
