//! `bilux generate`: the built-in procedural scenes.

use crate::arguments::assignments::{assignment_of, from_flag};
use crate::arguments::{Common, Generate};
use crate::commands::DONE;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::checks::check_not_input;
use crate::commands::shared::checks::is_picture;
use crate::commands::shared::reading::load;
use crate::commands::shared::reading::read_options;
use crate::commands::shared::reading::report_warnings;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::usage;
use anyhow::anyhow;
use bilux::formats::WriteOptions;
use bilux::math::Vec3;
use bilux::scene::{Spec, Value};

pub fn run(arguments: &Generate, common: &Common) -> anyhow::Result<u8> {
    check_folder(&arguments.output).map_err(usage::wrong)?;
    if is_picture(&arguments.output) {
        let output = arguments.output.display();
        return Err(usage::wrong(anyhow!(
            "{output}: this command writes a scene, not a picture: write a .toml, and render it with `bilux render`"
        )));
    }
    bilux::formats::format_of_path(&arguments.output).map_err(usage::wrong)?;
    let mut confines = SandboxPaths::default().writing(&arguments.output);
    confines.check_written(&arguments.output, common).map_err(usage::wrong)?;
    if let Some(file) = &arguments.from {
        confines = confines.reading_scene(file);
    }
    check_not_input(&arguments.output, arguments.from.as_deref()).map_err(usage::wrong)?;
    confines.enter(common)?;
    let scene = match &arguments.from {
        Some(file) => {
            let model = load(file, &read_options(common))?;
            let offset = arguments.offset.map_or(Vec3::X, Vec3::from);
            bilux::gallery::copies(&model, arguments.count.unwrap_or(1), offset)
        }
        None => bilux::generate(&spec(arguments).map_err(usage::wrong)?).map_err(usage::wrong)?,
    };
    report_warnings(&scene.warnings, common)?;
    let lost = bilux::formats::write(&arguments.output, &scene, &WriteOptions::default())?;
    report_warnings(&lost, common)?;
    Ok(DONE)
}

fn spec(arguments: &Generate) -> anyhow::Result<Spec> {
    let mut spec = Spec::new("", &arguments.name);
    spec.span = from_flag("generate");
    if let Some(count) = arguments.count {
        spec.parameters.set_at("count", Value::Integer(i64::from(count)), from_flag("--count"));
    }
    if let Some(offset) = arguments.offset {
        spec.parameters.set_at("offset", Value::triple(offset), from_flag("--offset"));
    }
    for assignment in &arguments.set {
        let (key, value) = assignment_of(assignment)?;
        spec.parameters.set_at(&key, value, from_flag(&format!("--set {key}")));
    }
    Ok(spec)
}
