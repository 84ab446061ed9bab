//! `bilux farm`: splits a picture by its samples, or an animation by its frames, into tasks that a farm's scheduler runs.
//! Nothing here opens a connection: the command writes files, and the tasks are ordinary commands.

mod farm_job;
mod files;
mod options;
mod readme;
mod shell;
mod split;
mod template;

use crate::arguments::farming::Farm;
use crate::arguments::settings_from;
use crate::arguments::{Common, Render};
use crate::commands::DONE;
use crate::commands::shared::reading::check_choices;
use crate::commands::shared::reading::load;
use crate::commands::shared::reading::read_options_with;
use crate::commands::shared::reading::report_warnings;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::{output, usage};
use anyhow::{Context, bail};
use bilux::Settings;
use bilux::budget::with_default_budget;
use bilux::formats::ReadOptions;
use farm_job::{FarmJob, Word};
use files::Files;
use split::Split;
use std::fs;
use std::path::Path;

pub fn run(arguments: &Farm, common: &Common) -> anyhow::Result<u8> {
    let folder = &arguments.output;
    check_new(folder).map_err(usage::wrong)?;
    if arguments.scene == Path::new("-") {
        return Err(usage::wrong(anyhow::anyhow!(
            "-: a farm's nodes cannot read standard input: write the scene to a file first"
        )));
    }
    let stem = arguments.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let picture = picture_name(arguments, &stem).map_err(usage::wrong)?;
    let render = options::parse(&arguments.options).map_err(usage::wrong)?;
    options::check(&render, arguments, &picture).map_err(usage::wrong)?;
    render.studio.check().map_err(usage::wrong)?;
    render.studio.check_files()?;
    fs::create_dir_all(folder).with_context(|| format!("{}: cannot make this folder", folder.display()))?;
    let made = job_of(arguments, stem, picture, &render, common)
        .and_then(|(job, files)| Ok((write(&job, &files, folder)?, job)));
    match made {
        Ok((bytes, job)) if !common.quiet => report(&job, arguments, bytes),
        Ok(_) => {}
        Err(error) => {
            // Leaves no folder behind, unless there is something in it.
            let _ = fs::remove_dir(folder);
            return Err(error);
        }
    }
    Ok(DONE)
}

/// Reads the scene, and splits the picture or the animation.
fn job_of(
    arguments: &Farm,
    name: String,
    picture: String,
    render: &Render,
    common: &Common,
) -> anyhow::Result<(FarmJob, Files)> {
    let mut user = settings_from::render(render).map_err(usage::wrong)?;
    let studio = &render.studio;
    let given = [studio.picture_around(), studio.picture_behind()];
    let given: Vec<&Path> = given.into_iter().flatten().collect();
    confine(arguments, &given, common)?;
    let read = ReadOptions { whole_movement: true, ..read_options_with(common, &render.choices, 0.0) };
    let scene = load(&arguments.scene, &read)?;
    check_choices(&scene, &render.choices).map_err(usage::wrong)?;
    report_warnings(&scene.warnings, common)?;
    let by_default = with_default_budget(&scene.settings, &mut user);
    let settings = Settings::of(&scene, &user)?;
    let split = Split::of(arguments, &settings, by_default).map_err(usage::wrong)?;
    if by_default && !common.quiet {
        output::warning(
            "without --spp a frame ends after 5 seconds, so its noise depends on the node: add `-- --spp 64`",
        );
    }
    let files = Files::of(&arguments.scene, scene.files.iter().map(AsRef::as_ref), &given)?;
    let scene = Word::File(String::new(), files.name_of(&arguments.scene)?);
    let options = options::words(&arguments.options, &files);
    let turntable = arguments.turntable;
    Ok((FarmJob { name, scene, picture, split, turntable, options }, files))
}

/// Refuses a folder that has something in it: files of another job would be mixed with those of this one.
fn check_new(folder: &Path) -> anyhow::Result<()> {
    if folder.is_file() {
        bail!("{}: this is a file: name a folder for the job", folder.display());
    }
    if folder.read_dir().is_ok_and(|mut files| files.next().is_some()) {
        bail!("{}: this folder is not empty: name a new one", folder.display());
    }
    Ok(())
}

/// The name of the picture, which lies in a folder of its own.
fn picture_name(arguments: &Farm, stem: &str) -> anyhow::Result<String> {
    let is_numbered = arguments.frames.is_some() || arguments.turntable.is_some();
    let usual = if is_numbered { format!("{stem}-{{frame}}.png") } else { format!("{stem}.png") };
    let name = arguments.picture.clone().unwrap_or(usual);
    let path = Path::new(&name);
    if path.file_name() != Some(path.as_os_str()) {
        bail!("--picture {name}: write a name without folders: pictures go into the job's folder 'pictures'");
    }
    if name.contains("{frame}") && !is_numbered {
        bail!(
            "--picture {name}: {{frame}} needs several frames: add --frames or --turntable, or leave it out"
        );
    }
    bilux::pictures::format_of_path(path)?;
    Ok(name)
}

/// Under `--sandbox`: allows reading the scene's folder and the files that options name, and writing to the job's folder.
fn confine(arguments: &Farm, given: &[&Path], common: &Common) -> anyhow::Result<()> {
    let mut confines = SandboxPaths::default().reading_scene(&arguments.scene);
    for file in given {
        confines = confines.reading(file);
    }
    confines.writing(&arguments.output.join("template.yaml")).enter(common)
}

/// Writes everything into the folder; returns the number of bytes that were copied.
fn write(job: &FarmJob, files: &Files, folder: &Path) -> anyhow::Result<u64> {
    let template = template::of(job)?;
    let bytes = files.copy_to(&folder.join("files"))?;
    for name in job.split.folders() {
        let made = folder.join(name);
        fs::create_dir_all(&made).with_context(|| format!("{}: cannot make this folder", made.display()))?;
    }
    let texts =
        [("template.yaml", template), ("slurm.sh", shell::array(job)), ("README.md", readme::of(job))];
    for (name, text) in texts {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("{}: cannot write it", path.display()))?;
    }
    Ok(bytes)
}

fn report(job: &FarmJob, arguments: &Farm, bytes: u64) {
    let tasks = output::counted(arguments.chunks, "task", "tasks");
    let (folder, megabytes) = (arguments.output.display(), bytes as f64 / 1e6);
    let what = job.split.describe();
    output::eprint(format_args!(
        "{folder}: {tasks} for {what}, {megabytes:.1} MB of scene files; {folder}/README.md says how to run them"
    ));
}
