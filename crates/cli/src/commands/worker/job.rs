//! A job: a line of JSON as the command line of `bilux render`.

use super::confines::Confines;
use super::lines::{LONGEST, Line};
use crate::arguments::values::{parse_bytes, parse_duration};
use crate::arguments::{Arguments, Command, Common, Worker};
use crate::commands::render::confines;
use crate::commands::render::denoisers::may_denoise;
use crate::commands::render::targets::targets;
use crate::process::output;
use bilux::scene::error::nearest_name;
use clap::{CommandFactory, Parser};
use serde_json::{Map, Value};
use std::time::Duration;

/// Options of `bilux render` that make no sense for a job: they print, or concern a terminal, or are the worker's to say.
const REFUSED: [&str; 11] = [
    "allow-outside",
    "help",
    "json",
    "preview",
    "progress",
    "quiet",
    "replay",
    "strict",
    "verbose",
    "version",
    "watch",
];

/// Limits of what a job may take, and how it is read.
pub struct Limits {
    timeout: Option<Duration>,
    max_memory: u64,
    sandbox: bool,
    strict: bool,
    allow_outside: bool,
    verbose: u8,
}

impl Limits {
    /// Limits that the command line sets.
    pub fn of(arguments: &Worker, common: &Common) -> Limits {
        let Common { max_memory, sandbox, strict, allow_outside, verbose, .. } = *common;
        Limits { timeout: arguments.timeout, max_memory, sandbox, strict, allow_outside, verbose }
    }

    /// Requests of a job that go beyond them.
    fn in_vain(&self, timeout: Option<Duration>, memory: Option<u64>, sandbox: Option<bool>) -> Vec<String> {
        let longer = timeout.zip(self.timeout).filter(|(own, most)| own > most);
        let longer = longer.map(|(own, most)| {
            format!(
                "timeout: the job asked for {} s, but the worker's limit is {} s",
                own.as_secs_f64(),
                most.as_secs_f64()
            )
        });
        let larger = memory.filter(|own| *own > self.max_memory).map(|own| {
            format!(
                "max_memory: the job asked for {own} bytes, but the worker's limit is {} bytes",
                self.max_memory
            )
        });
        let outside = (self.sandbox && sandbox == Some(false))
            .then(|| "sandbox: the job asked for none, but the worker puts every job in one".to_owned());
        [outside, larger, longer].into_iter().flatten().collect()
    }
}

/// Job: what is rendered, where to, and within which limits.
#[derive(Debug)]
pub struct Job {
    /// Whatever the job said, for its result.
    pub id: Value,
    /// The picture's name.
    pub output: String,
    /// When it is stopped.
    pub timeout: Option<Duration>,
    /// The command line.
    pub command: Vec<String>,
    /// The permissions that it needs in its sandbox, if it is to be in one.
    pub confines: Option<Confines>,
    /// Limits that it asked for and does not get, since the worker's are tighter: each is a sentence.
    pub in_vain: Vec<String>,
}

/// Why a line is no job, with its `id` as far as it has one.
type Refused = (Value, String);

impl Job {
    /// Reads a line.
    ///
    /// # Errors
    /// Says what is wrong with it.
    pub fn read(line: Line, limits: &Limits) -> Result<Job, Refused> {
        let text = match line {
            Line::Text(text) => text,
            Line::NoText => return Err((Value::Null, "this line is not UTF-8: send JSON".to_owned())),
            Line::TooLong => {
                return Err((Value::Null, format!("this line has more than {LONGEST} bytes: shorten it")));
            }
        };
        let mut fields: Map<String, Value> = serde_json::from_str(&text).map_err(|error| {
            (
                Value::Null,
                format!("this line is no JSON object: {error}; a job is {{\"scene\": …, \"output\": …}}"),
            )
        })?;
        // As in the names of options.
        fields = fields.into_iter().map(|(key, value)| (key.replace('-', "_"), value)).collect();
        let id = fields.remove("id").unwrap_or(Value::Null);
        Job::of(&id, fields, limits).map_err(|error| (id, error))
    }

    fn of(id: &Value, mut fields: Map<String, Value>, limits: &Limits) -> Result<Job, String> {
        let scene = file(&mut fields, "scene", "model.glb")?;
        let output = file(&mut fields, "output", "model.png")?;
        let timeout =
            limited(&mut fields, "timeout", |text| parse_duration(text).map_err(|e| e.to_string()))?;
        let memory = limited(&mut fields, "max_memory", parse_bytes)?;
        let wants_sandbox = match fields.remove("sandbox") {
            None | Some(Value::Null) => None,
            Some(value) => Some(value.as_bool().ok_or("sandbox: write true or false")?),
        };
        let in_vain = limits.in_vain(timeout, memory, wants_sandbox);
        let mut command = vec!["bilux".to_owned(), "render".to_owned(), "--json".to_owned()];
        command.push(format!(
            "--max-memory={}",
            memory.map_or(limits.max_memory, |own| own.min(limits.max_memory))
        ));
        command.push(if limits.verbose > 0 { "--verbose" } else { "--quiet" }.to_owned());
        let switches = [
            ("--strict", limits.strict),
            ("--allow-outside", limits.allow_outside),
            ("--sandbox", limits.sandbox || wants_sandbox == Some(true)),
        ];
        command.extend(switches.iter().filter(|(_, is_on)| *is_on).map(|(flag, _)| (*flag).to_owned()));
        for (key, value) in fields {
            command.extend(option(&key, &value)?);
        }
        command.extend([format!("--output={output}"), "--".to_owned(), scene]);
        let confines = needed(&command)?;
        let timeout = [timeout, limits.timeout].into_iter().flatten().min();
        Ok(Job { id: id.clone(), output, timeout, command, confines, in_vain })
    }
}

/// Permissions that the sandbox of a render has to contain, if it is to be in one.
fn needed(command: &[String]) -> Result<Option<Confines>, String> {
    let Arguments { common, command, .. } =
        Arguments::try_parse_from(command).map_err(|error| first_line(&error))?;
    let Command::Render(render) = command else { return Err("this is no render".to_owned()) };
    if !common.sandbox {
        return Ok(None);
    }
    let targets = targets(&render).map_err(|error| output::message(&error))?;
    Ok(Some(Confines::of(&confines(&targets, &render), may_denoise(&render))))
}

/// The first line of what is wrong with a command line.
fn first_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    line.strip_prefix("error: ").unwrap_or(line).to_owned()
}

/// The name of a file.
fn file(fields: &mut Map<String, Value>, key: &str, example: &str) -> Result<String, String> {
    match fields.remove(key) {
        Some(Value::String(name)) if name == "-" => {
            Err(format!("{key}: '-' is of the worker's own streams: name a file, such as \"{example}\""))
        }
        Some(Value::String(name)) if !name.is_empty() && !name.contains('\0') => Ok(name),
        Some(other) => Err(format!("{key}: {other} is no name of a file: write \"{example}\"")),
        None => Err(format!("the job has no {key}: add one, such as \"{key}\": \"{example}\"")),
    }
}

/// A limit of the job's own.
fn limited<T>(
    fields: &mut Map<String, Value>,
    key: &str,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<Option<T>, String> {
    match fields.remove(key) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => parse(&plain(key, &value)?).map(Some).map_err(|error| format!("{key}: {error}")),
    }
}

/// A field as options of `bilux render`.
fn option(key: &str, value: &Value) -> Result<Vec<String>, String> {
    let flag = key.replace('_', "-");
    let known = known();
    if REFUSED.contains(&&*flag) {
        return Err(format!(
            "{key}: a job cannot set this: leave it out, or give it to bilux worker if it is its option"
        ));
    }
    if !known.contains(&flag) {
        let names: Vec<String> = known.iter().map(|flag| flag.replace('-', "_")).collect();
        let near = nearest_name(key, &names).map(|near| format!(": did you mean '{near}'?"));
        let near = near.unwrap_or_else(|| "; `bilux render --help` lists its options".to_owned());
        return Err(format!("there is no option '{key}'{near}"));
    }
    Ok(match (&*flag, value) {
        (_, Value::Null | Value::Bool(false)) => Vec::new(),
        (_, Value::Bool(true)) => vec![format!("--{flag}")],
        ("set", Value::Object(settings)) => {
            let set = |(key, value): (&String, &Value)| Ok(format!("--set={key}={}", plain(key, value)?));
            settings.iter().map(set).collect::<Result<_, String>>()?
        }
        ("set" | "change", Value::Array(all)) => all
            .iter()
            .map(|one| Ok(format!("--{flag}={}", plain(key, one)?)))
            .collect::<Result<_, String>>()?,
        ("size", Value::Array(sides)) => {
            let sides = sides.iter().map(|side| plain(key, side)).collect::<Result<Vec<_>, _>>()?;
            vec![format!("--size={}", sides.join("x"))]
        }
        _ => vec![format!("--{flag}={}", plain(key, value)?)],
    })
}

/// A value as an option takes it: lists with commas.
fn plain(key: &str, value: &Value) -> Result<String, String> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        Value::Bool(yes) => Ok(yes.to_string()),
        Value::Array(all) if !all.is_empty() && !all.iter().any(Value::is_array) => {
            Ok(all.iter().map(|one| plain(key, one)).collect::<Result<Vec<_>, _>>()?.join(","))
        }
        _ => {
            Err(format!("{key}: {value} is no value: write a text, a number, true, false or a list of them"))
        }
    }
}

/// The long options of `bilux render`.
fn known() -> Vec<String> {
    let mut all = Arguments::command();
    all.build();
    let render = all.find_subcommand("render");
    let options = render.into_iter().flat_map(clap::Command::get_arguments);
    options.filter_map(|option| option.get_long().map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    const FREE: Limits = Limits {
        timeout: Some(Duration::from_secs(9)),
        max_memory: 1 << 30,
        sandbox: false,
        strict: false,
        allow_outside: false,
        verbose: 0,
    };

    fn read(text: &str) -> Result<Job, Refused> {
        read_within(text, &FREE)
    }

    fn read_within(text: &str, limits: &Limits) -> Result<Job, Refused> {
        Job::read(Line::Text(text.to_owned()), limits)
    }

    #[test]
    fn fields_are_the_options_of_render() {
        let job = read(
            r#"{"id": {"a": [1]}, "scene": "--help", "output": "-x.png", "size": [64, 48], "spp": 4, "timeout": 60,
            "max_memory": "512M", "fast": false, "denoise": true, "aov": ["albedo", "depth"], "set": {"fps": 30},
            "change": ["light:0:intensity=5", "light:1:scale=2"], "orbit": [-30, 10], "seed": null}"#,
        )
        .unwrap();
        assert_eq!(job.id["a"][0], 1);
        assert_eq!(job.timeout, Some(Duration::from_secs(9)), "the worker's limit holds");
        let parsed = Arguments::try_parse_from(&job.command).unwrap();
        let Command::Render(render) = parsed.command else { panic!("{:?}", job.command) };
        assert_eq!(render.scenes, [PathBuf::from("--help")], "a name is no option");
        assert_eq!(render.output, Some(PathBuf::from("-x.png")));
        let settings = &render.settings;
        assert_eq!((settings.text("size"), settings.number("spp")), (Some("64x48"), Some(4.0)));
        assert_eq!(
            (settings.text("denoise"), settings.has("seed"), render.fast),
            (Some("auto"), false, false)
        );
        assert_eq!(render.aov, ["albedo", "depth"]);
        assert_eq!(
            (render.set, render.studio.change),
            (
                vec!["fps=30".to_owned()],
                ["light:0:intensity=5", "light:1:scale=2"].map(str::to_owned).to_vec()
            )
        );
        assert_eq!(render.studio.settings.text("orbit"), Some("-30,10"));
        assert_eq!(parsed.common.max_memory, 512 << 20);
        assert!(render.json && !parsed.common.sandbox && !parsed.common.allow_outside);
    }

    #[test]
    fn the_worker_s_limits_are_the_most() {
        let strict = Limits { sandbox: true, strict: true, ..FREE };
        let line =
            r#"{"scene": "a.glb", "output": "a.png", "max_memory": "64G", "sandbox": false, "timeout": 2}"#;
        for line in [line.to_owned(), line.replace("max_memory", "max-memory")] {
            let job = Job::read(Line::Text(line), &strict).unwrap();
            let named: Vec<_> = job.in_vain.iter().filter_map(|why| why.split(':').next()).collect();
            assert_eq!(named, ["sandbox", "max_memory"], "{:?}", job.in_vain);
            let parsed = Arguments::try_parse_from(&job.command).unwrap();
            assert!(parsed.common.sandbox && parsed.common.strict);
            assert_eq!(parsed.common.max_memory, 1 << 30);
            assert_eq!(job.timeout, Some(Duration::from_secs(2)));
            assert!(job.confines.is_some());
        }
        // Each limit by itself.
        for (name, limits) in [
            ("strict", Limits { strict: true, ..FREE }),
            ("sandbox", Limits { sandbox: true, ..FREE }),
            ("allow-outside", Limits { allow_outside: true, ..FREE }),
        ] {
            let job = read_within(r#"{"scene": "a.glb", "output": "a.png"}"#, &limits).unwrap();
            let common = Arguments::try_parse_from(&job.command).unwrap().common;
            let found = [common.strict, common.sandbox, common.allow_outside];
            assert_eq!(found, ["strict", "sandbox", "allow-outside"].map(|one| one == name), "{name}");
        }
    }

    #[test]
    fn only_what_is_asked_for_in_vain_is_said() {
        let said = |more: &str, sandbox: bool| {
            let line = format!(r#"{{"scene": "a.glb", "output": "a.png"{more}}}"#);
            Job::read(Line::Text(line), &Limits { sandbox, ..FREE }).unwrap().in_vain.join("; ")
        };
        assert_eq!(
            said(r#", "timeout": 999"#, true),
            "timeout: the job asked for 999 s, but the worker's limit is 9 s"
        );
        assert!(said(r#", "sandbox": false"#, true).starts_with("sandbox: "));
        for less in
            ["", r#", "timeout": 9"#, r#", "max_memory": "1G", "sandbox": true"#, r#", "sandbox": null"#]
        {
            assert_eq!((said(less, false), said(less, true)), (String::new(), String::new()), "{less}");
        }
        assert_eq!(said(r#", "sandbox": false"#, false), "");
    }

    #[test]
    fn what_is_no_job_is_refused_with_its_id() {
        for (line, wanted) in [
            ("{", "no JSON object"),
            ("[1]", "no JSON object"),
            (r#"{"output": "a.png"}"#, "no scene"),
            (r#"{"scene": 5, "output": "a.png"}"#, "scene: 5"),
            (r#"{"scene": "-", "output": "a.png"}"#, "name a file"),
            (r#"{"scene": "a.glb", "output": "-"}"#, "name a file"),
            (r#"{"scene": "a.glb", "output": "a.png", "sze": 5}"#, "did you mean 'size'?"),
            (r#"{"scene": "a.glb", "output": "a.png", "allow_outside": true}"#, "cannot set this"),
            (r#"{"scene": "a.glb", "output": "a.png", "json": true}"#, "cannot set this"),
            (r#"{"scene": "a.glb", "output": "a.png", "spp": {"a": 1}}"#, "spp: "),
            (r#"{"scene": "a.glb", "output": "a.png", "spp": "many"}"#, "--spp"),
            (r#"{"scene": "a.glb", "output": "a.png", "timeout": "soon"}"#, "timeout: "),
        ] {
            let (id, error) = read(line).unwrap_err();
            assert!(error.contains(wanted), "{line}: {error}");
            assert!(id.is_null());
        }
        assert_eq!(read(r#"{"id": "x7"}"#).unwrap_err().0, "x7");
        assert_eq!(Job::read(Line::TooLong, &FREE).unwrap_err().0, Value::Null);
    }
}
