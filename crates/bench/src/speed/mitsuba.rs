//! Mitsuba, asked through Python: a process that loads a scene once and renders it as often as it is told to.

use super::options::Options;
use bilux::Error;
use bilux::formats::{WriteOptions, write};
use bilux::math::{Rgb, Vec3};
use bilux::scene::{Mesh, Object, SceneBuilder, Spec, Texture};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;

/// Script that runs in Python.
const SCRIPT: &str = include_str!("render_by_mitsuba.py");

/// A folder for files that the other side reads, removed at the end.
pub(super) struct Scratch(PathBuf);

impl Scratch {
    pub(super) fn new(name: &str) -> Result<Scratch, Error> {
        let folder = std::env::temp_dir().join(format!("bilux-speed-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).map_err(|e| failed("make the folder", &folder, &e))?;
        Ok(Scratch(folder))
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, Error> {
        let path = self.path(name);
        fs::write(&path, bytes).map_err(|e| failed("write", &path, &e))?;
        Ok(path)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // The files are no longer needed.
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn failed(what: &str, path: &Path, why: &dyn std::fmt::Display) -> Error {
    Error::Settings(format!("cannot {what} '{}': {why}", path.display()))
}

/// Writes a mesh for Mitsuba; returns the file's name.
pub(super) fn ply(scratch: &Scratch, name: &str, mesh: Mesh) -> Result<String, Error> {
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(Spec::new("plain", "diffuse"));
    scene.objects.push(Object::new(name, Arc::new(mesh), material));
    let path = scratch.path(&format!("{name}.ply"));
    write(&path, &scene, &WriteOptions::default())?;
    Ok(path.display().to_string())
}

/// Writes a texture's texels for Mitsuba, of colours three numbers and otherwise one, and returns what its script reads as
/// a bitmap.
pub(super) fn bitmap(
    scratch: &Scratch,
    name: &str,
    texture: &Texture,
    channels: usize,
) -> Result<Value, Error> {
    let numbers = texture.texels().flat_map(|c| c.to_array().into_iter().take(channels));
    let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    let path = scratch.write(name, &bytes)?;
    let shape = [texture.height(), texture.width(), channels];
    Ok(json!({ "texels": path.display().to_string(), "shape": shape }))
}

/// A scene with a camera and the integrator `path`, to which shapes and lights are added. Mitsuba counts the edges of a
/// path, which are one more than its scattering events.
pub(super) fn scene(eye: Vec3, target: Vec3, fov: f32, size: [u32; 2], max_depth: u32) -> Value {
    let look_at = [eye, target, Vec3::Y].map(|v| v.to_array());
    json!({
        "type": "scene",
        "integrator": { "type": "path", "max_depth": max_depth + 1 },
        "sensor": {
            "type": "perspective", "fov": fov, "to_world": { "look_at": look_at },
            "film": {
                "type": "hdrfilm", "width": size[0], "height": size[1], "pixel_format": "rgb",
                "rfilter": { "type": "box" },
            },
            "sampler": { "type": "independent" },
        },
    })
}

/// The process, with its scene loaded.
pub(super) struct Mitsuba {
    child: Child,
    asks: ChildStdin,
    answers: BufReader<ChildStdout>,
    version: String,
    output: PathBuf,
}

/// A picture and what it took.
pub(super) struct PeerShot {
    pub(super) cpu_seconds: f64,
    pub(super) pixels: Vec<Rgb>,
}

impl Mitsuba {
    /// Starts it and loads a scene; otherwise says why the rows have our side only.
    pub(super) fn start(options: &Options, scratch: &Scratch, scene: &Value) -> Result<Mitsuba, String> {
        let start = || -> Result<Mitsuba, String> {
            let script = scratch.write("render.py", SCRIPT.as_bytes()).map_err(|e| e.to_string())?;
            let file =
                scratch.write("scene.json", scene.to_string().as_bytes()).map_err(|e| e.to_string())?;
            let mut command = Command::new(&options.python);
            command.arg(script).arg(file).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
            let mut child = command.spawn().map_err(|e| e.to_string())?;
            let (Some(asks), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
                return Err("it cannot be spoken to".to_owned());
            };
            let (answers, output) = (BufReader::new(answers), scratch.path("pixels"));
            let mut mitsuba = Mitsuba { child, asks, answers, version: String::new(), output };
            let first = mitsuba.answer().map_err(|e| e.to_string())?;
            match (first["ready"].as_str(), first["error"].as_str()) {
                (Some(version), _) => version.clone_into(&mut mitsuba.version),
                (None, why) => return Err(why.unwrap_or("it does not answer").to_owned()),
            }
            Ok(mitsuba)
        };
        start().map_err(|why| {
            format!(
                "our side only: '{}' does not run Mitsuba ({why}); --python names one that does",
                options.python.display()
            )
        })
    }

    /// Description of the other side, for the notes.
    pub(super) fn name(&self) -> String {
        format!("the other side is Mitsuba {}, llvm_ad_rgb, path, independent sampler", self.version)
    }

    /// Renders the scene once.
    pub(super) fn render(&mut self, samples: u32, seed: u32) -> Result<PeerShot, Error> {
        let output = self.output.display().to_string();
        let task = json!({ "samples": samples, "seed": seed, "output": output });
        writeln!(self.asks, "{task}").map_err(|e| stopped(&e))?;
        let cpu_seconds = self.answer()?["cpu_seconds"].as_f64().ok_or_else(|| stopped(&"no times"))?;
        let bytes = fs::read(&self.output).map_err(|e| stopped(&e))?;
        let numbers: Vec<f32> =
            bytes.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
        let pixels = numbers.as_chunks::<3>().0.iter().map(|&rgb| Rgb::from_array(rgb)).collect();
        Ok(PeerShot { cpu_seconds, pixels })
    }

    /// The next line of JSON; other lines are Mitsuba's own messages.
    fn answer(&mut self) -> Result<Value, Error> {
        let mut line = String::new();
        loop {
            line.clear();
            if self.answers.read_line(&mut line).map_err(|e| stopped(&e))? == 0 {
                return Err(stopped(&"it ended"));
            }
            if let Ok(value @ Value::Object(_)) = serde_json::from_str(&line) {
                return Ok(value);
            }
        }
    }
}

impl Drop for Mitsuba {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn stopped(why: &dyn std::fmt::Display) -> Error {
    Error::Settings(format!("Mitsuba has stopped: {why}"))
}
