//! Looks of surfaces that follow from their modifiers.

use super::kinds::{Finish, Kind};
use super::look::{Emission, Lamp, Look, PlacedSky};
use super::materials;
use super::modifiers::Reference;
use super::world::World;
use bilux_import::FormatError;
use bilux_math::DVec3;
use bilux_scene::{Span, Spec, Value};
use std::rc::Rc;

/// Longer chains of modifiers, and mixtures of mixtures that are deeper, are refused.
const MAX_CHAIN: usize = 1000;
const MAX_DEPTH: usize = 32;

/// Look that a reference comes to.
pub(super) fn look(world: &mut World, reference: Reference, at: &Span) -> Result<Look, FormatError> {
    resolved(world, reference, at, 0)
}

fn resolved(world: &mut World, reference: Reference, at: &Span, depth: usize) -> Result<Look, FormatError> {
    let index = match reference {
        Reference::Void => return Ok(Look::Nothing),
        Reference::Unknown => return undefined(world, at),
        Reference::To(index) => index,
    };
    if let Some(known) = world.looks.known.get(&index) {
        return Ok(known.clone());
    }
    if depth > MAX_DEPTH {
        let message = format!("mixtures of mixtures are more than {MAX_DEPTH} levels deep");
        return Err(FormatError::malformed(message, at.clone()));
    }
    let made = made(world, index, at, depth)?;
    world.reading.budget.take_bytes(2 * size_of::<(usize, Look)>() as u64, &at.file)?;
    world.looks.known.insert(index, made.clone());
    Ok(made)
}

/// The grey of what is not defined.
fn undefined(world: &mut World, at: &Span) -> Result<Look, FormatError> {
    let index = match world.looks.undefined {
        Some(index) => index,
        None => world.material(Spec::new("undefined", "diffuse").with("reflectance", 0.5f32), at)?,
    };
    world.looks.undefined = Some(index);
    Ok(Look::Material(index))
}

/// Goes down from a modifier to its material, and past it: patterns may stand on either side.
fn made(world: &mut World, first: usize, at: &Span, depth: usize) -> Result<Look, FormatError> {
    let (mut next, mut base, mut sky) = (Reference::To(first), None, None);
    for _ in 0..MAX_CHAIN {
        let Reference::To(index) = next else {
            return match base {
                Some(index) => finished(world, index, sky, at, depth),
                None if next == Reference::Unknown => undefined(world, at),
                None => Ok(Look::Nothing),
            };
        };
        let modifier = &world.modifiers.list[index];
        let primitive = modifier.primitive.clone();
        let matrix = modifier.matrix;
        next = modifier.under;
        match (primitive.kind, &primitive.sky) {
            (Kind::Pattern, Some(of)) => {
                let sun = matrix.transform_vector3(of.sun).normalize_or(DVec3::Z);
                sky = Some(PlacedSky { sky: of.clone(), sun });
            }
            (Kind::Pattern, None) => {
                let what = format!("the {} '{}'", primitive.word, primitive.name);
                world.diagnostics.not_shown(&what, || primitive.at.clone());
            }
            _ if base.is_none() => base = Some(index),
            // Only the first material counts.
            _ => {}
        }
    }
    let message = format!("modifiers of modifiers are more than {MAX_CHAIN} levels deep");
    Err(FormatError::malformed(message, at.clone()))
}

/// A material, a lamp, or a mixture.
fn finished(
    world: &mut World,
    index: usize,
    sky: Option<PlacedSky>,
    at: &Span,
    depth: usize,
) -> Result<Look, FormatError> {
    let modifier = &world.modifiers.list[index];
    let (primitive, parts) = (modifier.primitive.clone(), modifier.parts.clone());
    let (matrix, scale) = (modifier.matrix, modifier.scale);
    let Kind::Material(finish) = primitive.kind else {
        let what = format!("the mixture of the {} '{}', which is even", primitive.word, primitive.name);
        world.diagnostics.not_shown(&what, || primitive.at.clone());
        let [a, b] = [0, 1].map(|i| parts.get(i).copied().unwrap_or(Reference::Void));
        let (a, b) = (resolved(world, a, at, depth + 1)?, resolved(world, b, at, depth + 1)?);
        return mixed(world, &primitive.name, a, b, &primitive.at);
    };
    let emission = match finish {
        Finish::Light | Finish::Glow => Some(Emission::Even),
        Finish::Illum => {
            let alternate = parts.first().copied().unwrap_or(Reference::Void);
            let alternate = resolved(world, alternate, at, depth + 1)?;
            Some(Emission::Illum(Box::new(alternate)))
        }
        Finish::Spotlight => {
            let aim = DVec3::from_slice(&primitive.reals[4..7]);
            Some(Emission::Spot { degrees: primitive.reals[3], aim: matrix.transform_vector3(aim) })
        }
        _ => None,
    };
    if let Some(emission) = emission {
        let (name, colour, at) = (primitive.name.clone(), primitive.colour(), primitive.at.clone());
        if finish == Finish::Glow && primitive.reals[3] < 0.0 {
            let what = "a glow of negative radius lights its surroundings here";
            world.diagnostics.note(what, || at.clone());
        }
        return Ok(Look::Lamp(Rc::new(Lamp { index, name, colour, emission, sky, at })));
    }
    let found = materials::material(world, finish, &primitive, scale)?;
    Ok(found.map_or(Look::Nothing, Look::Material))
}

/// Half of one look and half of another.
fn mixed(world: &mut World, name: &str, a: Look, b: Look, at: &Span) -> Result<Look, FormatError> {
    match (a, b) {
        (Look::Material(a), Look::Material(b)) => {
            let mix = Spec::new(name, "mix").with("a", Value::Material(a)).with("b", Value::Material(b));
            world.material(mix.with("amount", 0.5f32), at).map(Look::Material)
        }
        // Half of it is not there.
        (Look::Material(index), Look::Nothing) | (Look::Nothing, Look::Material(index)) => {
            let spec = Spec { name: name.to_owned(), ..world.materials[index].clone() };
            world.material(spec.with("opacity", 0.5f32), at).map(Look::Material)
        }
        (lamp @ Look::Lamp(_), _) | (_, lamp @ Look::Lamp(_)) => Ok(lamp),
        (Look::Nothing, Look::Nothing) => Ok(Look::Nothing),
    }
}
