//! Destinations of the pictures of a render. Mistakes are found before anything is rendered.

use crate::arguments::Render;
pub use crate::arguments::streams::is_stdout;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::outputs;
use anyhow::bail;
use bilux::pictures::formats::format_of_path;
use bilux::scene::error::nearest_name;
use bilux::scene::{SceneBuilder, Span, Warning};
use std::path::{Path, PathBuf};

/// A scene, and where its picture goes.
pub struct Target {
    pub scene: PathBuf,
    /// `-` for standard output.
    pub output: PathBuf,
    /// The destination of its statistics, if they were asked for.
    pub stats: Option<PathBuf>,
}

/// The names allowed in braces in the name of a picture.
const NAMES: [&str; 2] = ["stem", "frame"];

/// Pairs every scene with the name of its picture.
pub fn targets(arguments: &Render) -> anyhow::Result<Vec<Target>> {
    check_result(arguments)?;
    let pattern = arguments.output_or_stdout();
    check_names("-o", pattern, arguments)?;
    if let Some(stats) = arguments.stats.as_deref().filter(|path| !is_stdout(path)) {
        check_names("--stats", stats, arguments)?;
        check_folder(stats)?;
    }
    let mut targets: Vec<Target> = Vec::new();
    for scene in &arguments.scenes {
        let stem =
            scene.file_stem().filter(|_| !is_stdout(scene)).map_or("stdin".into(), |s| s.to_string_lossy());
        let named = |pattern: &Path| PathBuf::from(pattern.to_string_lossy().replace("{stem}", &stem));
        let output = named(pattern);
        check_output(&output, arguments)?;
        if targets.iter().any(|other| other.output == output) && !is_stdout(&output) {
            bail!(
                "{}: two scenes would write this file: rename one of them, or put them in separate commands",
                output.display()
            );
        }
        targets.push(Target { scene: scene.clone(), output, stats: arguments.stats.as_deref().map(named) });
    }
    Ok(targets)
}

/// Checks that at most one thing is written to standard output: a picture, or text about pictures.
fn check_result(arguments: &Render) -> anyhow::Result<()> {
    let stats = arguments.stats.as_deref().is_some_and(is_stdout);
    let takers = [
        ("-o -", arguments.output.as_deref().is_some_and(is_stdout)),
        ("--json", arguments.json),
        ("--stats -", stats),
        ("--replay", arguments.replay.is_some()),
    ];
    let takers: Vec<&str> = takers.iter().filter(|(_, takes)| *takes).map(|(flag, _)| *flag).collect();
    if let [one, other, ..] = takers[..] {
        bail!("{one} and {other} both write to standard output: leave out one of them, or name a file");
    }
    Ok(())
}

/// Refuses unknown names in braces, and one file name for several pictures.
fn check_names(flag: &str, pattern: &Path, arguments: &Render) -> anyhow::Result<()> {
    let text = pattern.to_string_lossy();
    let numbered = arguments.frames.is_some() || arguments.turntable.is_some();
    if let (Some(count), Some((_, last))) = (arguments.turntable, arguments.frames)
        && last >= count
    {
        bail!(
            "--frames: picture {last} is none of --turntable {count}, whose pictures are 0 to {}",
            count - 1
        );
    }
    for name in text.split('{').skip(1).filter_map(|rest| rest.split_once('}').map(|(name, _)| name)) {
        if !NAMES.contains(&name) {
            let names = NAMES.map(str::to_owned);
            let hint = nearest_name(name, &names)
                .map(|near| format!(" (did you mean {{{near}}}?)"))
                .unwrap_or_default();
            bail!(
                "{flag} {text}: {{{name}}} is not a known placeholder{hint}; known are {{stem}}, the scene's name, \
                 and {{frame}}, the frame's number"
            );
        }
        if name == "frame" && !numbered {
            bail!(
                "{flag} {text}: {{frame}} needs several frames: add --frames or --turntable, or leave it out"
            );
        }
    }
    if numbered && flag == "-o" && is_stdout(pattern) {
        bail!("-o -: standard output takes one picture: name files, such as -o '{{stem}}-{{frame}}.png'");
    }
    if arguments.scenes.len() > 1 && !text.contains("{stem}") && !(flag == "--stats" && is_stdout(pattern)) {
        let extension = pattern.extension().unwrap_or_default().to_string_lossy();
        let scenes = arguments.scenes.len();
        bail!("{flag} {text}: this names one file for {scenes} scenes: write {flag} '{{stem}}.{extension}'");
    }
    Ok(())
}

/// Warns about frames that will all be the same.
pub fn still_frames(arguments: &Render, scene: &SceneBuilder) -> Vec<Warning> {
    let moves = scene.inventory.moves()
        || scene.objects.iter().any(|object| !object.motion.is_still())
        || scene.cameras.iter().any(|camera| !camera.keyframes.is_empty());
    let wants_frames = arguments.moments().is_some_and(|(first, last)| first < last);
    let message = "--frames: nothing in this scene moves, so all frames show the same; --turntable N turns the camera \
                   around a model";
    let warning = Warning { message: message.to_owned(), at: Span::default() };
    if wants_frames && !moves { vec![warning] } else { Vec::new() }
}

/// Refuses a picture that cannot be written.
fn check_output(output: &Path, arguments: &Render) -> anyhow::Result<()> {
    if is_stdout(output) && arguments.output.is_none() {
        // Text alone.
        return Ok(());
    }
    outputs::check(output, arguments.output_format.as_deref(), arguments.quality)?;
    let named = arguments.named(output);
    let (name, path) = (format_of_path(&named)?.entry.name, named.display());
    if arguments.samples.is_some() && name != "exr" {
        bail!(
            "{path}: --samples needs an .exr, which keeps exact sums: write an .exr, and merge the parts with \
               `bilux merge`"
        );
    }
    if arguments.bits == "16" && ["jpeg", "webp"].contains(&name) {
        bail!(
            "{path}: --bits 16 is only for PNG and PPM, and {name} has 8 bits: write a .png, or leave out --bits"
        );
    }
    Ok(())
}

/// Replaces `{frame}` by four digits; if it is missing, puts them before the extension.
pub fn frame_path(pattern: &Path, frame: u32) -> PathBuf {
    if is_stdout(pattern) { pattern.to_owned() } else { named_by(pattern, &format!("{frame:04}")) }
}

/// Replaces `{frame}` by a word; if it is missing, puts that before the extension.
pub fn named_by(pattern: &Path, word: &str) -> PathBuf {
    let text = pattern.to_string_lossy();
    if text.contains("{frame}") {
        return PathBuf::from(text.replace("{frame}", word));
    }
    let stem = pattern.file_stem().unwrap_or_default().to_string_lossy();
    let extension = pattern.extension().unwrap_or_default().to_string_lossy();
    pattern.with_file_name(format!("{stem}-{word}.{extension}"))
}
