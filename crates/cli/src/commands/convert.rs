//! `bilux convert`: between scene formats, and between picture formats.

use super::{DONE, check_choices, check_folder, read_options_with, tell_warnings};
use crate::arguments::{Common, Convert};
use crate::usage;
use anyhow::anyhow;
use bilux::formats::WriteOptions;
use bilux::pictures::Limits;
use bilux::pictures::format_named;
use std::path::Path;

pub fn run(arguments: &Convert, common: &Common) -> anyhow::Result<u8> {
    let (input, output) = (&arguments.input, &arguments.output);
    check_folder(output).map_err(usage::wrong)?;
    match (is_picture(input), is_picture(output)) {
        (true, true) => {
            bilux::pictures::format_of_path(output).map_err(usage::wrong)?;
            let picture = bilux::pictures::read_with(input, &Limits::new(common.max_memory))?;
            bilux::pictures::write(output, &picture, &Default::default())?;
        }
        (false, false) => {
            bilux::formats::format_of_path(output).map_err(usage::wrong)?;
            let scene =
                bilux::load(input, &read_options_with(common, &arguments.posed.choices, arguments.posed.at))?;
            check_choices(&scene, &arguments.posed.choices).map_err(usage::wrong)?;
            tell_warnings(&scene.warnings, common)?;
            let options = WriteOptions { ascii: arguments.ascii };
            let lost = bilux::formats::write(output, &scene, &options)?;
            tell_warnings(&lost, common)?;
        }
        (false, true) => {
            return Err(mismatch(input, output, "a scene", "a picture: that is what `bilux render` does"));
        }
        (true, false) => {
            return Err(mismatch(input, output, "a picture", "a scene: name a picture, such as out.png"));
        }
    }
    Ok(DONE)
}

/// True for what is read as a picture, even if it is never written.
fn is_picture(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| format_named(extension).is_some())
}

fn mismatch(input: &Path, output: &Path, one: &str, other: &str) -> anyhow::Error {
    usage::wrong(anyhow!("{} is {one}, and {} {other}", input.display(), output.display()))
}
