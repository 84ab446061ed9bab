//! Sources: what is infinitely far away, as suns and skies.

use super::distant::DistantSource;
use super::look::{Emission, Lamp, PlacedSky};
use super::place::Place;
use super::sky_model::Form;
use super::units::light;
use super::world::{World, turned, turned_f32};
use bilux_import::FormatError;
use bilux_math::transcendental::{asin_f64, atan2_f64, cos_f64, sin_cos_f64};
use bilux_math::{DVec3, Rgb};
use bilux_scene::{Span, Spec, Texture, Value};
use std::f64::consts::{PI, TAU};
use std::rc::Rc;
use std::sync::Arc;

/// Sources of this diameter and more are parts of a sky.
const LEAST_SKY: f64 = 90.0;

/// A sky that reaches this far below the horizon, as a sine, shows more than its half.
const SHARP: f64 = 1e-3;

/// The height in texels of the map of what is neither a sun nor half of a sky.
const ROWS: usize = 512;

/// Adds a source.
pub(super) fn add(
    world: &mut World,
    lamp: &Lamp,
    direction: DVec3,
    degrees: f64,
    place: &Place,
    at: &Span,
) -> Result<(), FormatError> {
    let Some(direction) = direction.try_normalize().filter(|_| degrees > 0.0) else {
        world.diagnostics.note("a source without a direction or a size is left out", || at.clone());
        return Ok(());
    };
    if let Emission::Spot { .. } = lamp.emission {
        world.diagnostics.note("a source that is a spotlight shines everywhere", || at.clone());
    }
    if lamp.sky.is_some() && place.matrix.transform_vector3(DVec3::Z).normalize_or_zero().z < 0.999 {
        let what = "skies are turned about the vertical only";
        world.diagnostics.note(what, || at.clone());
    }
    world.reading.budget.take::<DistantSource>(1, &at.file)?;
    let (name, colour, sky) = (lamp.name.clone(), lamp.colour, lamp.sky.clone());
    world.sources.push(DistantSource { name, direction, degrees, colour, sky, at: at.clone() });
    Ok(())
}

/// The sources of a scene by what they are here.
#[derive(Default)]
struct Sorted {
    suns: Vec<DistantSource>,
    /// Sources that fill the upper and the lower half.
    halves: [Option<Rc<DistantSource>>; 2],
    /// Sources that are neither suns nor halves.
    others: Vec<Rc<DistantSource>>,
}

/// Makes lights of all sources.
pub(super) fn finish(world: &mut World) -> Result<(), FormatError> {
    let mut sorted = sorted(std::mem::take(&mut world.sources), world);
    match sorted.halves.clone() {
        [Some(upper), lower] if upper.sky.is_some() => {
            let sun = own_sun(&upper, &mut sorted.suns);
            sky(world, &upper, lower.as_deref(), sun.as_ref())?;
        }
        halves => {
            if !even(world, &halves)? {
                sorted.others.extend(halves.into_iter().flatten());
            }
        }
    }
    for sun in &sorted.suns {
        let spec = Spec::new(&sun.name, "directional")
            .with("direction", turned_f32(-sun.direction))
            .with("irradiance", light(sun.irradiance()))
            .with("diameter", sun.degrees as f32);
        world.light(spec, &sun.at)?;
    }
    caps(world, &sorted.others)
}

fn sorted(sources: Vec<DistantSource>, world: &mut World) -> Sorted {
    let mut sorted = Sorted::default();
    for source in sources {
        if source.sky.is_none() && source.degrees < LEAST_SKY {
            sorted.suns.push(source);
            continue;
        }
        let source = Rc::new(source);
        let is_whole = source.degrees >= 350.0;
        let is_half = (170.0..=190.0).contains(&source.degrees) && source.direction.z.abs() > 0.999;
        if !is_whole && !is_half && source.sky.is_some() {
            let what = "a part of a sky that is no half of it is taken as one";
            world.diagnostics.note(what, || source.at.clone());
        } else if !is_whole && !is_half {
            sorted.others.push(source);
            continue;
        }
        let mut is_used = false;
        for (half, is_upper) in sorted.halves.iter_mut().zip([true, false]) {
            let reaches = is_whole || is_upper == (source.direction.z > 0.0);
            if reaches && half.is_none() {
                *half = Some(source.clone());
                is_used = true;
            }
        }
        if !is_used && source.sky.is_some() {
            world.diagnostics.note("a second sky is left out", || source.at.clone());
        } else if !is_used {
            sorted.others.push(source);
        }
    }
    sorted
}

/// Takes the sun that stands where that of a sky does.
fn own_sun(sky: &DistantSource, suns: &mut Vec<DistantSource>) -> Option<DistantSource> {
    let PlacedSky { sky, sun: towards } = sky.sky.as_ref()?;
    if let Form::Formula(_) = sky.form {
        return None;
    }
    let index = suns.iter().position(|sun| sun.direction.dot(*towards) > 0.9999 && sun.degrees < 10.0)?;
    Some(suns.swap_remove(index))
}

/// Adds a sky with its sun and its ground.
fn sky(
    world: &mut World,
    upper: &DistantSource,
    lower: Option<&DistantSource>,
    sun: Option<&DistantSource>,
) -> Result<(), FormatError> {
    let Some(PlacedSky { sky, sun: towards }) = &upper.sky else { return Ok(()) };
    let ground = lower.map_or([0.0; 3], DistantSource::ground);
    let times = |factor: f64| upper.colour.map(|c| c * factor);
    let reach = cos_f64((0.5 * upper.degrees.clamp(180.0, 360.0)).to_radians());
    let is_wider = lower.is_none() && reach < -SHARP;
    let below = |direction: DVec3| match is_wider && direction.y > reach {
        true => times(sky.below_horizon(in_file(direction), *towards)),
        false => ground,
    };
    let kind = if matches!(sky.form, Form::Perez { .. }) { "perez-sky" } else { "cie-sky" };
    let spec = Spec::new(&upper.name, kind)
        .with("elevation", asin_f64(towards.z.clamp(-1.0, 1.0)).to_degrees() as f32)
        .with("azimuth", atan2_f64(towards.x, towards.y).to_degrees() as f32);
    let sunlight = sun.map_or([0.0; 3], DistantSource::irradiance);
    let mut spec = match sky.form {
        Form::Formula(formula) => {
            let towards = turned(*towards);
            return map(world, &upper.name, &upper.at, |direction| match direction.y > 0.0 {
                true => times(formula.at(direction, towards)),
                false => below(direction),
            });
        }
        Form::Cie { standard, zenith } => spec
            .with("standard", standard)
            .with("zenith", light(times(zenith)))
            .with("irradiance", light(times(sky.level)))
            .with("sun", light(sunlight)),
        Form::Perez { clearness, brightness } => spec
            .with("direct", light(sunlight))
            .with("diffuse", light(times(sky.level)))
            .with("clearness", clearness as f32)
            .with("brightness", brightness as f32),
    };
    if let Some(sun) = sun {
        spec = spec.with("sun_diameter", sun.degrees.clamp(0.01, 90.0) as f32);
    }
    // What the ground reflects, of the sky and of the sun that shines here.
    let received = [0, 1, 2].map(|i| upper.colour[i] * sky.level + sunlight[i] * towards.z.max(0.0));
    spec = spec.with("ground", ratio(ground.map(|c| c * PI), received));
    world.light(spec, &upper.at)?;
    if !is_wider {
        return Ok(());
    }
    map(world, &format!("{} below the horizon", upper.name), &upper.at, |direction| match direction.y > 0.0 {
        true => [0.0; 3],
        false => below(direction),
    })
}

/// A direction of the scene, with y up, as the file has it, with z up.
fn in_file(direction: DVec3) -> DVec3 {
    DVec3::new(direction.x, -direction.z, direction.y)
}

/// Adds halves of a sky that are the same all over; false if they are not described so.
fn even(world: &mut World, halves: &[Option<Rc<DistantSource>>; 2]) -> Result<bool, FormatError> {
    let Some(first) = halves.iter().flatten().next() else { return Ok(true) };
    let [upper, lower] = halves.each_ref().map(|half| half.as_ref().map_or([0.0; 3], |half| half.ground()));
    let kind = if upper == lower {
        Spec::new(&first.name, "environment").with("radiance", light(upper))
    } else if upper.iter().all(|c| *c > 0.0) {
        Spec::new(&first.name, "cie-sky")
            .with("standard", 5)
            .with("zenith", light(upper))
            .with("ground", ratio(lower, upper))
    } else {
        return Ok(false);
    };
    world.light(kind, &first.at)?;
    Ok(true)
}

/// One colour over another; 0 where that is black.
fn ratio(a: [f64; 3], b: [f64; 3]) -> Rgb {
    let [r, g, b] = [0, 1, 2].map(|i| if b[i] > 0.0 { (a[i] / b[i]) as f32 } else { 0.0 });
    Rgb::new(r, g, b).clamp(0.0, 1e12)
}

/// Adds sources of any direction and size.
fn caps(world: &mut World, sources: &[Rc<DistantSource>]) -> Result<(), FormatError> {
    let Some(first) = sources.first() else { return Ok(()) };
    let cap = |source: &Rc<DistantSource>| {
        let cos = cos_f64((0.5 * source.degrees.min(360.0)).to_radians());
        (turned(source.direction), cos, source.ground())
    };
    let caps: Vec<(DVec3, f64, [f64; 3])> = sources.iter().map(cap).collect();
    map(world, &first.name, &first.at, |direction| {
        let seen = caps.iter().filter(|(middle, cos, _)| middle.dot(direction) >= *cos);
        seen.fold([0.0; 3], |sum, (.., colour)| [0, 1, 2].map(|i| sum[i] + colour[i]))
    })
}

/// Adds a map of all directions.
fn map(
    world: &mut World,
    name: &str,
    at: &Span,
    radiance: impl Fn(DVec3) -> [f64; 3],
) -> Result<(), FormatError> {
    world.reading.budget.take::<Rgb>(2 * ROWS * ROWS, &at.file)?;
    // Each texel is the mean of four places in it.
    let towards = |column: usize, row: usize, part: usize| {
        let [x, y] = [column * 2 + part % 2, row * 2 + part / 2].map(|i| 0.5 * (i as f64 + 0.5));
        let (across, up) = sin_cos_f64(PI * y / ROWS as f64);
        let (sin, cos) = sin_cos_f64(TAU * (x / (2 * ROWS) as f64 - 0.5));
        DVec3::new(across * sin, up, -across * cos)
    };
    let texel = |i: usize| {
        let parts = [0, 1, 2, 3].map(|part| radiance(towards(i % (2 * ROWS), i / (2 * ROWS), part)));
        light([0, 1, 2].map(|c| 0.25 * parts.iter().map(|part| part[c]).sum::<f64>()))
    };
    let texels = (0..2 * ROWS * ROWS).map(texel).collect();
    world.textures.push(Arc::new(Texture::new(name, 2 * ROWS, ROWS, texels, true)));
    let spec = Spec::new(name, "environment");
    let spec = spec.with("radiance", Value::Texture(world.textures.len() - 1));
    world.light(spec, at)
}
