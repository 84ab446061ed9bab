//! Pictures of what each parameter of each material, light and procedural texture does: one strip for each, with a low, a
//! middle and a high value, for the reference pages. `cargo xtask strips` runs it.
//!
//! ```text
//! cargo run --release -p bilux-validation --example strips -- OUT [--only WORD] [--spp N]
//! ```
//! Writes OUT/TABLE/KIND-PARAMETER.jpg; with `--only`, those whose path contains WORD.
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

mod stage;
mod values;

use bilux::Job;
use bilux::formats::{ReadOptions, read_bytes};
use bilux::pictures::{WriteOptions, label, side_by_side, stacked, to_display, tone_map, write};
use bilux::prelude::*;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::lights::LIGHTS;
use bilux_scene::materials::MATERIALS;
use bilux_scene::texture::TEXTURES;
use stage::{Table, folder, scene};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use values::shown;

/// The side of each picture, in pixels.
const SIDE: usize = 160;
/// Pictures in a row.
const ACROSS: usize = 5;
/// Samples per pixel, before denoising.
const SAMPLES: i64 = 16;

type Failure = Box<dyn Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let out = PathBuf::from(arguments.next().ok_or("name the folder for the strips")?);
    let (mut only, mut spp) = (String::new(), SAMPLES);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{argument} needs a value"))?;
        match argument.as_str() {
            "--only" => only = value,
            "--spp" => spp = value.parse()?,
            _ => return Err(format!("there is no option {argument}").into()),
        }
    }
    let materials = MATERIALS.iter().map(|row| (Table::Materials, row.entry));
    let textures = TEXTURES.iter().map(|row| (Table::Textures, row.entry));
    let lights = LIGHTS.iter().map(|row| (Table::Lights, row.entry));
    let files = tempfile::tempdir()?;
    write_textures(files.path())?;
    write_grids(files.path())?;
    write_lamps(files.path())?;
    for (table, entry) in materials.chain(textures).chain(lights) {
        for parameter in entry.parameters {
            let path = format!("{}/{}-{}.jpg", folder(table), entry.name, parameter.name);
            // A name changes nothing that a picture could show.
            if path.contains(&only) && parameter.kind != ParameterKind::Text {
                let path = out.join(path);
                fs::create_dir_all(path.parent().unwrap_or(&out))?;
                strip(table, &entry, parameter, spp, files.path(), &path)
                    .map_err(|error| format!("{}: {error}", path.display()))?;
                println!("{}", path.display());
            }
        }
    }
    Ok(())
}

/// Renders and writes one strip.
fn strip(
    table: Table,
    entry: &Entry,
    parameter: &Parameter,
    spp: i64,
    files: &Path,
    path: &Path,
) -> Result<(), Failure> {
    let list = match table {
        Table::Materials => include_str!("materials.txt"),
        Table::Textures => include_str!("textures.txt"),
        Table::Lights => include_str!("lights.txt"),
    };
    let shown = shown(list, entry, parameter);
    let mut pictures = Vec::new();
    for value in &shown.values {
        let text = scene(table, entry.name, parameter.name, value, &shown);
        let mut picture =
            rendered(&text, table, spp, files).map_err(|error| format!("{value}: {error}\n{text}"))?;
        let words = words(value);
        if !words.is_empty() {
            label(&mut picture, 3, SIDE - 12, &words, 1);
        }
        pictures.push(picture.into_linear());
    }
    let rows = pictures.chunks(ACROSS).map(|row| side_by_side(row, 2)).collect::<Result<Vec<_>, _>>()?;
    write(path, &stacked(&rows, 2)?, &WriteOptions { quality: 86, ..WriteOptions::default() })?;
    Ok(())
}

/// A value as it is written under its picture.
fn words(value: &str) -> String {
    let kind = value.split("kind = ").nth(1).map(|rest| rest.trim_matches(|c| "\" }".contains(c)));
    let words = kind.map_or_else(
        || value.trim_matches('"').to_owned(),
        |kind| kind.split('"').next().unwrap_or(kind).to_owned(),
    );
    if words.len() > 24 { String::new() } else { words }
}

fn rendered(text: &str, table: Table, spp: i64, files: &Path) -> Result<Picture, Failure> {
    let scene = read_bytes(text.as_bytes(), "toml", Some(files), "strip.toml", &ReadOptions::default())?;
    let mut settings = Parameters::default();
    settings.set("size", format!("{SIDE}x{SIDE}"));
    settings.set("spp", Value::Integer(if table == Table::Textures { 16 } else { spp }));
    let is_smooth = table != Table::Textures && !text.contains("\"whitted\"") && !text.contains("\"cast\"");
    settings.set("denoise", if is_smooth { "builtin" } else { "off" });
    let job = Job::new(&scene, JobRequest::from(&settings).denoised(Denoised::ForDisplay))?;
    let outcome = job.render(&Quiet)?;
    let light = match job.denoiser()? {
        Some(chosen) => outcome.denoised(chosen)?,
        None => outcome.picture()?,
    };
    let curve = if table == Table::Textures { "none" } else { "neutral" };
    Ok(to_display(&light, 0.0, tone_map(curve)?)?)
}

/// Grids of 32³ voxels: puffs, and a heat that falls with the height, in kelvin.
fn write_grids(folder: &Path) -> Result<(), Failure> {
    const SIDE: usize = 32;
    let wave = |i: usize| bilux_math::transcendental::sin((i as f32 + 0.5) * 0.55);
    let puffs = |[x, y, z]: [usize; 3]| (2.5 * wave(x) * wave(y) * wave(z)).max(0.0);
    let heat = |[_, y, _]: [usize; 3]| 2200.0 - 1200.0 * y as f32 / SIDE as f32;
    let write = |name: &str, value: &dyn Fn([usize; 3]) -> f32| {
        let header =
            format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({SIDE}, {SIDE}, {SIDE}), }}");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(118u16.to_le_bytes());
        bytes.extend(format!("{header:<117}\n").bytes());
        for i in 0..SIDE * SIDE * SIDE {
            bytes.extend(value([i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)]).to_le_bytes());
        }
        fs::write(folder.join(name), bytes)
    };
    write("smoke.npy", &puffs)?;
    Ok(write("heat.npy", &heat)?)
}

/// Lamps: a narrow beam, a wide one with a gap below, and one that shines to one side.
fn write_lamps(folder: &Path) -> Result<(), Failure> {
    let polar = "0 15 30 45 60 75 90";
    for (name, planes, azimuths, candela) in [
        ("narrow.ies", 1, "0", "2000 900 60 0 0 0 0"),
        ("wide.ies", 1, "0", "100 180 500 700 400 90 0"),
        (
            "wall.ies",
            3,
            "0 90 180",
            "300 700 1200 900 500 200 0\n300 300 200 100 40 10 0\n300 100 20 5 0 0 0",
        ),
    ] {
        let text = format!(
            "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 7 {planes} 1 2 0 0 0 1 1 0\n{polar}\n{azimuths}\n{candela}\n"
        );
        fs::write(folder.join(name), text)?;
    }
    Ok(())
}

/// A normal map of round bumps, and a sky with a sun.
fn write_textures(folder: &Path) -> Result<(), Failure> {
    let side = 64;
    let at = |i: usize| (i as f32 + 0.5) / side as f32 * std::f32::consts::TAU;
    let bumps = (0..side * side).map(|i| {
        let (x, y) = (at(i % side), at(i / side));
        let slope = [0.8 * bilux_math::transcendental::sin(x), 0.8 * bilux_math::transcendental::sin(y)];
        let normal = Vec3::new(slope[0], slope[1], 1.0).normalize();
        Rgb::new(0.5 + 0.5 * normal.x, 0.5 + 0.5 * normal.y, 0.5 + 0.5 * normal.z)
    });
    let bumps = Picture::from_rgb(side, side, bumps.map(decoded).collect())?;
    write(folder.join("bumps.png"), &bumps, &WriteOptions::default())?;
    let (width, height) = (128, 64);
    let sky = (0..width * height).map(|i| {
        let (u, v) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
        let is_sun = (u - 0.3).abs() < 0.03 && (v - 0.28).abs() < 0.05;
        match v {
            _ if is_sun => Rgb::new(60.0, 42.0, 24.0),
            v if v > 0.5 => Rgb::new(0.12, 0.1, 0.08),
            v => Rgb::new(0.25 + v, 0.4 + 0.6 * v, 0.8) * 0.9,
        }
    });
    write(
        folder.join("sky.hdr"),
        &Picture::from_rgb(width, height, sky.collect())?,
        &WriteOptions::default(),
    )?;
    Ok(())
}

/// Light whose sRGB code is this value: a PNG of it then holds the value itself.
fn decoded(code: Rgb) -> Rgb {
    code.map(bilux_math::colour::srgb_decode)
}
