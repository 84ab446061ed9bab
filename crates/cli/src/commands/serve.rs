//! `bilux serve`: shows a scene in browsers while it is rendered.

use crate::arguments::Common;
use crate::arguments::choices::{Choices, GlassArgument, defined};
use crate::arguments::serving::Serve;
use crate::arguments::settings_from;
use crate::arguments::studio::{StudioArguments, surround};
use crate::commands::DONE;
use crate::commands::render::denoisers;
use crate::commands::shared::reading::check_choices;
use crate::commands::shared::reading::load;
use crate::commands::shared::reading::read_options_with;
use crate::commands::shared::reading::report_notes;
use crate::commands::shared::reading::report_warnings;
use crate::commands::shared::sandbox_paths::{SandboxPaths, folder_of};
use crate::process::interrupt::interrupt;
use crate::process::{output, usage};
use anyhow::bail;
use bilux::formats::ReadOptions;
use bilux::scene::SceneBuilder;
use bilux_viewer::{Opening, Options, Server};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

/// The maximum number of visitors, each of whom has a picture of their own.
const VISITORS: u32 = 24;
/// The maximum number of visitors if all see the same picture.
const SHARED_VISITORS: u32 = 64;

/// The maximum number of environments to choose from.
const ENVIRONMENTS: usize = 200;

pub fn run(arguments: Serve, common: &Common) -> anyhow::Result<u8> {
    let settings = settings_from::serve(&arguments).map_err(usage::wrong)?;
    arguments.studio.check().map_err(usage::wrong)?;
    arguments.studio.check_files()?;
    denoisers::load(0, common);
    confine(&arguments, common)?;
    let read = read_options_with(common, &arguments.choices, arguments.studio.time());
    let scene = open(&arguments, &read)?;
    report_warnings(&scene.warnings, common)?;
    report_notes(&scene.notes, common);
    let visitors = arguments.visitors.unwrap_or(if arguments.shared { SHARED_VISITORS } else { VISITORS });
    let name = arguments.scene.file_name().unwrap_or(arguments.scene.as_os_str());
    let options = Options {
        address: SocketAddr::new(arguments.listen, arguments.port),
        title: name.to_string_lossy().into_owned(),
        shared: arguments.shared,
        visitors: visitors as usize,
        sandboxed: common.sandbox,
        environments: environments(&arguments),
        may_edit: arguments.edit,
        // The sandbox was entered before there was a folder to allow.
        may_drop: !common.sandbox,
        settings,
        max_memory: common.max_memory,
        command: command(&arguments),
        open: Box::new(move |opening| {
            open_again(&arguments, &read, opening).map_err(|error| format!("{error:#}"))
        }),
    };
    let server = Server::start(options)?;
    // Before anybody who reads the address can end it.
    interrupt().ends_itself(true);
    output::print(server.address())?;
    server.run(|| interrupt().is_requested())?;
    Ok(DONE)
}

/// Environments that may light the scene, as `--env` names them: those that need no file, and the pictures of light next to it.
fn environments(arguments: &Serve) -> Vec<String> {
    let is_light = |path: &PathBuf| {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        path.is_file() && ["hdr", "exr", "pfm"].iter().any(|own| extension.eq_ignore_ascii_case(own))
    };
    let files = std::fs::read_dir(folder_of(&arguments.scene)).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = files.map(|file| file.path()).filter(is_light).collect();
    found.extend(arguments.studio.picture_around().map(Path::to_owned));
    found.sort();
    found.dedup();
    found.truncate(ENVIRONMENTS);
    let named = bilux::presets::SURROUNDINGS.iter().map(|row| row.name.to_owned());
    named.chain(found.iter().map(|path| path.display().to_string())).collect()
}

fn open(arguments: &Serve, read: &ReadOptions) -> anyhow::Result<SceneBuilder> {
    if arguments.scene == Path::new("-") {
        bail!("a scene on standard input cannot be watched: name a file");
    }
    let mut scene = load(&arguments.scene, read)?;
    check_choices(&scene, &arguments.choices).map_err(usage::wrong)?;
    arguments.studio.set_up(&mut scene, read)?;
    Ok(scene)
}

/// Opens the scene, or another file in its place, as those who watch ask for it.
fn open_again(arguments: &Serve, read: &ReadOptions, opening: &Opening) -> anyhow::Result<SceneBuilder> {
    let mut read = read.clone();
    read.time = opening.time.unwrap_or(read.time);
    read.variant = opening.variant.clone().or(read.variant);
    read.animation = opening.animation.clone().or(read.animation);
    let env = opening.environment.as_ref().map(PathBuf::from);
    let Some(file) = &opening.file else {
        let mut scene = load(&arguments.scene, &read)?;
        arguments.studio.with_env(env).set_up(&mut scene, &read)?;
        return Ok(scene);
    };
    // The choices are those among what is in the scene that the viewer was started with.
    read.animation.clone_from(&opening.animation);
    read.variant = opening.variant.clone();
    read.picture_layer.clone_from(&arguments.studio.layer);
    let mut scene = load(file, &read)?;
    surround(env.as_deref(), &mut scene, &read)?;
    Ok(scene)
}

/// Under `--sandbox`: allows reading the scene, its folder and the files that options name. Nothing is written.
fn confine(arguments: &Serve, common: &Common) -> anyhow::Result<()> {
    let confines = SandboxPaths::default().reading_scene(&arguments.scene);
    confines.reading_options(&arguments.studio).enter(common)
}

/// The words of the command line that renders the scene as it is opened here, without settings.
fn command(arguments: &Serve) -> Vec<String> {
    let Serve { scene, studio, choices, .. } = arguments;
    let mut words = vec!["bilux".to_owned(), "render".to_owned(), scene.display().to_string()];
    let mut say = |option: &str, value: Option<String>| {
        if let Some(value) = value {
            words.extend([option.to_owned(), value]);
        }
    };
    for change in &studio.change {
        say("--change", Some(change.clone()));
    }
    let StudioArguments { env, preset, layer, intrinsics, .. } = studio;
    say("--intrinsics", intrinsics.as_ref().map(|path| path.display().to_string()));
    say("--env", env.as_ref().map(|path| path.display().to_string()));
    say("--layer", layer.clone());
    say("--background", studio.picture_behind().map(|path| path.display().to_string()));
    say("--preset", preset.clone());
    let Choices { animation, variant, definitions, glass, subdivide, light_radius } = choices;
    say("--animation", animation.clone());
    say("--variant", variant.clone());
    for definition in defined(definitions) {
        say("--define", Some(definition));
    }
    say(
        "--glass",
        match glass {
            GlassArgument::Auto => None,
            GlassArgument::Thin => Some("thin".to_owned()),
            GlassArgument::Solid => Some("solid".to_owned()),
        },
    );
    say("--subdivide", subdivide.map(|scheme| scheme.name().to_owned()));
    say("--light-radius", (*light_radius > 0.0).then(|| light_radius.to_string()));
    words
}
