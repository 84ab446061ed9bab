//! `bilux convert`: converts between scene formats, and between picture formats.

use super::heat_map::heat_map;
use super::pictures::{holds_picture, read_picture, with_main};
use super::{
    DONE, check_choices, check_folder, check_not_input, check_quality, is_picture, load, read_options_with,
    report_warnings, warn_lost_alpha,
};
use crate::arguments::{Common, Convert};
use crate::sandbox_paths::SandboxPaths;
use crate::usage;
use anyhow::anyhow;
use bilux::formats::{WriteOptions, check_not_read};
use bilux::pictures::{Limits, Picture};
use std::path::Path;

pub fn run(arguments: &Convert, common: &Common) -> anyhow::Result<u8> {
    let (input, output) = (&arguments.input, &arguments.output);
    check_folder(output).map_err(usage::wrong)?;
    check_not_input(output, [&**input]).map_err(usage::wrong)?;
    let confines = SandboxPaths::default().reading_scene(input).writing(output);
    confines.check_written(output, common).map_err(usage::wrong)?;
    match (holds_picture(input), is_picture(output)) {
        (true, true) => {
            bilux::pictures::format_of_path(output).map_err(usage::wrong)?;
            check_quality(arguments.quality, output).map_err(usage::wrong)?;
            confines.enter(common)?;
            let picture = converted(arguments, common)?;
            warn_lost_alpha(&picture, output, None, common)?;
            let mut options = bilux::pictures::WriteOptions::default();
            options.quality = arguments.quality.unwrap_or(options.quality);
            bilux::pictures::write(output, &picture, &options)?;
        }
        (false, false) => {
            bilux::formats::format_of_path(output).map_err(usage::wrong)?;
            if arguments.quality.is_some() {
                return Err(usage::wrong(anyhow!("--quality is only for JPEG pictures: leave it out")));
            }
            if arguments.layer.is_some() {
                return Err(usage::wrong(anyhow!("--layer is of a picture, not of a scene: leave it out")));
            }
            if arguments.heat_map.is_some() {
                return Err(usage::wrong(anyhow!(
                    "--heat-map is of a picture, not of a scene: leave it out"
                )));
            }
            confines.enter(common)?;
            let scene =
                load(input, &read_options_with(common, &arguments.posed.choices, arguments.posed.at))?;
            check_choices(&scene, &arguments.posed.choices).map_err(usage::wrong)?;
            check_not_read(output, &scene.files).map_err(usage::wrong)?;
            report_warnings(&scene.warnings, common)?;
            let options = WriteOptions { ascii: arguments.ascii };
            let lost = bilux::formats::write(output, &scene, &options)?;
            report_warnings(&lost, common)?;
        }
        (false, true) => {
            return Err(mismatch(input, output, "a scene", "is a picture: use `bilux render`"));
        }
        (true, false) => {
            if bilux::formats::format_of_path(output).is_err() {
                bilux::pictures::format_of_path(output).map_err(usage::wrong)?;
            }
            return Err(mismatch(input, output, "a picture", "is a scene: write a picture, such as out.png"));
        }
    }
    Ok(DONE)
}

/// What becomes of a picture before it is written in another format.
fn converted(arguments: &Convert, common: &Common) -> anyhow::Result<Picture> {
    let (input, layer) = (&arguments.input, arguments.layer.as_deref());
    let picture = read_picture(input, &Limits::new(common.max_memory), common)?;
    if let Some(channel) = &arguments.heat_map {
        return heat_map(&picture, channel, arguments, common.quiet);
    }
    let holds_layers = bilux::pictures::format_of_path(&arguments.output)?.entry.name == "exr";
    if holds_layers && layer.is_none() {
        return Ok(picture);
    }
    let metadata = picture.metadata.clone();
    let mut main = with_main(picture, layer, input, common)?.main();
    main.metadata = metadata;
    Ok(main)
}

fn mismatch(input: &Path, output: &Path, one: &str, other: &str) -> anyhow::Error {
    usage::wrong(anyhow!("{} is {one}, but {} {other}", input.display(), output.display()))
}
