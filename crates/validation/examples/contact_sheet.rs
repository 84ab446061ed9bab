//! Our pictures of models next to the screenshots that come with them, on one sheet.
//!
//! ```text
//! cargo run --release -p bilux-validation --example contact_sheet -- MODELS OUT [--spp N] [--at SECONDS] [--only A,B]
//! ```
//! MODELS is a folder of models in the layout of the Khronos group: NAME/glTF-Binary/NAME.glb or NAME/glTF/NAME.gltf,
//! and NAME/screenshot. OUT is a folder: OUT/NAME.png is rendered if it does not exist yet, with no options except its
//! size and samples, and OUT/sheet.png shows them all, ours on the left. Animated screenshots (GIF) are not shown.
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux::Job;
use bilux::formats::ReadOptions;
use bilux::pictures::{downscaled, label, side_by_side, stacked};
use bilux::prelude::*;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Side of a picture, in pixels.
const SIZE: usize = 256;
/// Pairs of pictures per row.
const ACROSS: usize = 4;

type Failure = Box<dyn Error>;

struct Arguments {
    models: PathBuf,
    out: PathBuf,
    spp: i64,
    at: f32,
    only: Vec<String>,
}

impl Arguments {
    fn read() -> Result<Arguments, Failure> {
        let mut read =
            Arguments { models: PathBuf::new(), out: PathBuf::new(), spp: 32, at: 0.0, only: Vec::new() };
        let mut folders = Vec::new();
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--spp" => read.spp = value()?.parse()?,
                "--at" => read.at = value()?.parse()?,
                "--only" => read.only = value()?.split(',').map(str::to_owned).collect(),
                _ => folders.push(PathBuf::from(argument)),
            }
        }
        let [models, out] =
            folders.try_into().map_err(|_| "name the folder of models, and one for the pictures")?;
        Ok(Arguments { models, out, ..read })
    }
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read()?;
    fs::create_dir_all(&arguments.out)?;
    let mut names: Vec<String> = fs::read_dir(&arguments.models)?
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
        .filter(|name| arguments.only.is_empty() || arguments.only.contains(name))
        .collect();
    names.sort();
    let mut pairs = Vec::new();
    for name in names {
        let Some(model) = model_of(&arguments.models.join(&name)) else { continue };
        let ours = match rendered(&model, &arguments.out.join(format!("{name}.png")), &arguments) {
            Ok(picture) => fitted(&picture)?,
            Err(error) => {
                println!("{name}: {error}");
                said("refused")?
            }
        };
        let theirs = match screenshot(&arguments.models.join(&name).join("screenshot")) {
            Some(picture) => fitted(&picture)?,
            None => said("no still screenshot")?,
        };
        let mut pair = side_by_side(&[ours, theirs], 2)?.into_srgb();
        label(&mut pair, 0, 0, &name, 1);
        pairs.push(pair);
    }
    let rows = pairs.chunks(ACROSS).map(|row| side_by_side(row, 10)).collect::<Result<Vec<_>, _>>()?;
    let sheet = arguments.out.join("sheet.png");
    bilux::pictures::write(&sheet, &stacked(&rows, 10)?, &Default::default())?;
    println!("{}", sheet.display());
    Ok(())
}

/// The scene file in a model's folder.
fn model_of(folder: &Path) -> Option<PathBuf> {
    let with_extension = |sub: &str, wanted: &str| {
        let entries = fs::read_dir(folder.join(sub)).ok()?;
        entries.flatten().map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == wanted))
    };
    with_extension("glTF-Binary", "glb").or_else(|| with_extension("glTF", "gltf"))
}

fn rendered(model: &Path, out: &Path, arguments: &Arguments) -> Result<Picture, Failure> {
    if !out.exists() {
        let options = ReadOptions { time: arguments.at, ..ReadOptions::default() };
        let mut settings = Parameters::default();
        settings.set("size", format!("{SIZE}x{SIZE}").as_str());
        settings.set("spp", Value::Integer(arguments.spp));
        let job = Job::new(&bilux::load(model, &options)?, &settings)?;
        job.write(&job.render(&bilux::Quiet)?, out)?;
    }
    Ok(bilux::pictures::read(out)?)
}

fn screenshot(folder: &Path) -> Option<Picture> {
    let paths = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e != "gif"))
        .find_map(|path| bilux::pictures::read(path).ok())
}

/// A picture, reduced to the size of the others, in the middle of a square.
fn fitted(picture: &Picture) -> Result<Picture, Failure> {
    let small = downscaled(picture, picture.width().max(picture.height()).div_ceil(SIZE))?;
    let mut pixels = vec![Rgb::grey(0.05); SIZE * SIZE];
    let (left, top) = ((SIZE - small.width()) / 2, (SIZE - small.height()) / 2);
    for (y, x) in (0..small.height()).flat_map(|y| (0..small.width()).map(move |x| (y, x))) {
        pixels[(top + y) * SIZE + left + x] = small.rgb(x, y);
    }
    Ok(Picture::from_rgb(SIZE, SIZE, pixels)?)
}

/// Words in place of a picture.
fn said(words: &str) -> Result<Picture, Failure> {
    let mut picture = Picture::from_rgb(SIZE, SIZE, vec![Rgb::grey(0.05); SIZE * SIZE])?;
    label(&mut picture, 70, SIZE / 2, words, 1);
    Ok(picture)
}
