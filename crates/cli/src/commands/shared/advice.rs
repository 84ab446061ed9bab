//! Advice in the parser's messages, which say what is missing or unknown, but not what to write.

use super::checks::is_picture;
use crate::arguments::Arguments;
use bilux::scene::error::nearest_name;
use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;

/// A message of the parser, with advice on the mistakes of first-time users.
pub fn added(mut error: clap::Error) -> clap::Error {
    let line = Line::of_process();
    let tip =
        match (error.kind(), error.get(ContextKind::InvalidArg), error.get(ContextKind::InvalidSubcommand)) {
            (ErrorKind::MissingRequiredArgument, Some(ContextValue::Strings(missing)), _) => {
                line.about_missing(&missing.join(" "))
            }
            (ErrorKind::UnknownArgument, Some(ContextValue::String(name)), _) => {
                line.about_renamed(name).or_else(|| line.about_unknown(name, &error))
            }
            (ErrorKind::InvalidSubcommand, _, Some(ContextValue::String(name))) => line.about_command(name),
            (ErrorKind::MissingSubcommand, ..) => line.about_missing(KIND),
            _ => None,
        };
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedSubcommand);
        if error.remove(ContextKind::SuggestedArg).is_some() {
            // It shows the option that the parser took for the intended one.
            error.remove(ContextKind::Usage);
        }
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// The command line.
struct Line {
    words: Vec<String>,
    /// The first word that is a command, or nothing.
    command: String,
}

impl Line {
    fn of_process() -> Line {
        let words: Vec<String> =
            std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
        let known = Arguments::command();
        let command = words.iter().find(|word| known.find_subcommand(word).is_some());
        Line { command: command.cloned().unwrap_or_default(), words }
    }

    /// Advice for an argument that is missing.
    fn about_missing(&self, missing: &str) -> Option<String> {
        let whole = EXAMPLES
            .iter()
            .find(|(command, argument, _)| self.command == *command && missing.contains(*argument));
        if let Some((.., advice)) = whole {
            return Some((*advice).to_owned());
        }
        if !missing.contains("--output") {
            return None;
        }
        // A picture that follows a scene, and not an option.
        let picture = self.words.windows(2).find(|pair| {
            pair[0] != self.command && !pair[0].starts_with('-') && is_picture(Path::new(&pair[1]))
        });
        Some(match (picture, &*self.command) {
            (Some([_, picture]), "render") => format!("name the file to write after -o: `-o {picture}`"),
            (_, "generate") => "name the file to write, such as `-o scene.toml`".to_owned(),
            (_, "farm") => "name the folder to make, such as `-o job`".to_owned(),
            (_, "convert") => "name the file to write, such as `-o model.glb`".to_owned(),
            _ => "name the file to write, such as `-o picture.png`".to_owned(),
        })
    }

    /// Advice on what to write instead of an unknown command, or an unknown benchmark.
    fn about_command(&self, name: &str) -> Option<String> {
        let known = Arguments::command();
        // That of the benchmarks, if the word is in the place of one.
        let of = known.find_subcommand(&self.command).filter(|command| command.has_subcommands());
        let names = of.unwrap_or(&known).get_subcommands().map(|one| one.get_name().to_owned());
        let near = nearest_name(name, &names.collect::<Vec<_>>());
        let in_place_of_command = if of.is_none() { of_file(name) } else { None };
        in_place_of_command.or_else(|| near.map(|near| format!("a similar subcommand exists: '{near}'")))
    }

    /// Advice on what to write instead of an option that other programs have.
    fn about_renamed(&self, name: &str) -> Option<String> {
        let (.., advice) =
            RENAMED.iter().filter(|_| self.command == "render").find(|(names, _)| names.contains(&name))?;
        Some((*advice).to_owned())
    }

    /// Advice on what to write instead of an unknown argument, unless the message already names a similar one.
    fn about_unknown(&self, name: &str, error: &clap::Error) -> Option<String> {
        if error.get(ContextKind::SuggestedArg).is_some() {
            return None;
        }
        let suggested = error.get(ContextKind::Suggested).map(ToString::to_string).unwrap_or_default();
        let is_file = !name.starts_with('-') && Path::new(name).extension().is_some();
        match &*self.command {
            "" => Some("name a command first, such as `bilux render model.glb -o picture.png`".to_owned()),
            "convert" | "denoise" | "sensor" | "generate" if is_file => {
                Some(format!("name the file to write after -o: `-o {name}`"))
            }
            "farm" if name.starts_with('-') => {
                Some("options of `bilux render` come last, after `--`: `… -- --spp 64`".to_owned())
            }
            "serve" if name == "--turntable" => {
                Some("drag the picture to see the model from all around".to_owned())
            }
            "list" if !name.starts_with('-') => Some("name only the list: all of it is printed".to_owned()),
            // An option is not meant as the name of a file.
            command if suggested.contains("as a value") => {
                Some(format!("`bilux {command} --help` lists the options"))
            }
            _ => None,
        }
    }
}

/// Name of a benchmark in the help.
const KIND: &str = "<KIND>";

/// Commands, arguments that may be missing, and the advice for them.
const EXAMPLES: &[(&str, &str, &str)] = &[
    ("render", "<SCENE>", "name the scene and the picture, such as `bilux render model.glb -o picture.png`"),
    ("info", "<SCENE>", "name the scene, such as `bilux info model.glb`"),
    ("convert", "<INPUT>", "name both files, such as `bilux convert model.obj -o model.glb`"),
    ("denoise", "<INPUT>", "name both pictures, such as `bilux denoise noisy.exr -o clean.png`"),
    ("sensor", "<INPUT>", "name both pictures, such as `bilux sensor light.exr -o shot.png`"),
    ("compare", "<REFERENCE>", "name both pictures, such as `bilux compare a.png reference.png`"),
    (
        "generate",
        "<NAME>",
        "name a scene and the file to write, such as `bilux generate trio -o trio.toml`; \
         `bilux list generators` lists the scenes",
    ),
    (
        "merge",
        "<PART>",
        "name the partial renders and the picture, such as `bilux merge a.exr b.exr -o scene.png`",
    ),
    (
        "farm",
        "<SCENE>",
        "name the scene and a folder, such as `bilux farm walk.toml --frames 0-47 --chunks 8 -o job`",
    ),
    ("farm", "--chunks", "say how many tasks there are, such as `--chunks 8`"),
    ("bench", KIND, "name a benchmark, such as `bilux bench rays`; `bilux bench --help` lists them"),
    ("list", "<WHAT>", "name a list, such as `bilux list integrators`; `bilux list --help` lists them"),
    ("completions", "<SHELL>", "name a shell: bash, elvish, fish, powershell or zsh"),
];

/// Options of other renderers, and what to write instead.
const RENAMED: &[(&[&str], &str)] = &[
    (
        &["--width", "--height", "--resolution", "--res", "-r", "-w"],
        "write the width and the height in pixels as `--size 640x480`",
    ),
    (&["--time", "--seconds", "--max-time"], "write the time in seconds as `--time-limit 10`"),
    (&["--depth", "--bounces", "--max-bounces"], "write the number of bounces as `--max-depth 8`"),
    (&["--environment", "--envmap", "--hdri", "--sky"], "name the environment map as `--env sky.hdr`"),
    (&["--jobs", "-j", "-t"], "write the number of threads as `--threads 4`"),
    (
        &["--material", "--materials"],
        "materials come from the scene file; `bilux list materials` lists those of a .toml",
    ),
    (&["--format"], "the extension of the picture sets its format, as in `-o picture.exr`"),
    (&["--gpu", "--device"], "leave it out: Bilux renders on the CPU"),
    (&["--force", "-f", "-y", "--overwrite"], "leave it out: an older picture is replaced without it"),
];

/// Advice on what to write instead of a file in the place of a command.
fn of_file(name: &str) -> Option<String> {
    let path = Path::new(name);
    let extension = path.extension()?.to_str()?;
    let is_scene = bilux::formats::format_named(extension).is_some() || path.is_file();
    is_scene.then(|| format!("to render a scene, write `bilux render {name} -o picture.png`"))
}
