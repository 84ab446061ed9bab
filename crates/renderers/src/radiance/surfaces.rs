//! Surfaces in their places.

use super::kinds::Kind;
use super::lights;
use super::look::{Emission, Lamp, Look};
use super::looks::look;
use super::place::Place;
use super::polygons;
use super::round::{Form, placed};
use super::sources;
use super::statement::Primitive;
use super::units::light;
use super::world::{World, turned};
use bilux_import::FormatError;
use bilux_math::{DMat4, DVec3, Transform};
use bilux_scene::{Object, Spec, Visibility};
use std::f64::consts::PI;

/// A surface with its points as they stand in the scene, with z still up.
enum Shape {
    /// Corners of a polygon, whose front is where they run counter-clockwise.
    Polygon(Vec<DVec3>),
    /// A form with the point that its origin comes to, what its axis comes to, and its radius.
    Round { form: Form, inwards: bool, origin: DVec3, along: DVec3, radius: f64 },
}

/// Adds a surface.
pub(super) fn add(world: &mut World, primitive: &Primitive, place: &Place) -> Result<(), FormatError> {
    let at = &primitive.at;
    if primitive.kind == Kind::Foreign {
        let file = primitive.strings.first().map_or("", |file| file);
        let what = format!("the {} '{file}': files of that kind are not read", primitive.word);
        world.diagnostics.not_shown(&what, || at.clone());
        return Ok(());
    }
    let name = place.modifier.as_deref().unwrap_or(&primitive.modifier);
    let reference = world.modifiers.named(name, primitive, &mut world.diagnostics);
    let look = look(world, reference, at)?;
    if primitive.kind == Kind::Source {
        let Look::Lamp(lamp) = look else {
            world.diagnostics.note("a source that emits no light is left out", || at.clone());
            return Ok(());
        };
        let direction = place.matrix.transform_vector3(DVec3::from_slice(&primitive.reals[..3]));
        return sources::add(world, &lamp, direction, primitive.reals[3], place, at);
    }
    let Some(shape) = shape(world, primitive, place) else { return Ok(()) };
    match look {
        Look::Nothing => {
            world.diagnostics.remark("surfaces without a material are not there", || at.clone());
            Ok(())
        }
        Look::Material(material) => draw(world, &shape, material, false, primitive, place),
        Look::Lamp(lamp) => shine(world, &shape, &lamp, primitive, place),
    }
}

/// The shape of a primitive; `None`, with a warning, if it has no extent.
fn shape(world: &mut World, primitive: &Primitive, place: &Place) -> Option<Shape> {
    let scale = place.scale();
    let reals = &primitive.reals[..];
    let point = |i: usize| place.matrix.transform_point3(DVec3::from_slice(&reals[i..i + 3]));
    let shape = match primitive.kind {
        Kind::Polygon => {
            let mut corners: Vec<DVec3> = (0..reals.len()).step_by(3).map(point).collect();
            if place.reverses() {
                corners.reverse();
            }
            return Some(Shape::Polygon(corners));
        }
        Kind::Sphere { inwards } => {
            let radius = reals[3] * scale;
            let inwards = (inwards != place.inverts) != (radius < 0.0);
            let along = DVec3::Z * radius.abs();
            Some(Shape::Round { form: Form::Sphere, inwards, origin: point(0), along, radius: radius.abs() })
        }
        Kind::Cylinder { inwards } => {
            let radii = [reals[6] * scale; 2];
            cone(inwards != place.inverts, [point(0), point(3)], radii)
        }
        Kind::Cone { inwards } => {
            let radii = [reals[6] * scale, reals[7] * scale];
            cone(inwards != place.inverts, [point(0), point(3)], radii)
        }
        Kind::Ring => {
            let direction = place.matrix.transform_vector3(DVec3::from_slice(&reals[3..6]));
            let along = direction.try_normalize().map(|n| if place.inverts { -n } else { n });
            let (inner, outer) = (reals[6].min(reals[7]) * scale, reals[6].max(reals[7]) * scale);
            let fits = inner >= 0.0 && outer > inner;
            along.filter(|_| fits).map(|along| {
                let form = Form::Ring(inner / outer);
                Shape::Round { form, inwards: false, origin: point(0), along, radius: outer }
            })
        }
        _ => None,
    };
    let fits = |shape: &Shape| match shape {
        Shape::Round { radius, along, .. } => *radius > 0.0 && along.length() > 0.0,
        Shape::Polygon(_) => true,
    };
    let shape = shape.filter(fits);
    if shape.is_none() {
        let what =
            format!("a {} of radius or length 0, or with radii that do not fit, is left out", primitive.word);
        world.diagnostics.note(&what, || primitive.at.clone());
    }
    shape
}

/// A cone between two points. Negative radii turn it inside out.
fn cone(inwards: bool, [a, b]: [DVec3; 2], radii: [f64; 2]) -> Option<Shape> {
    let is_negative = radii.iter().any(|radius| *radius < 0.0);
    if is_negative && radii.iter().any(|radius| *radius > 0.0) {
        return None;
    }
    let [first, second] = radii.map(f64::abs);
    let (origin, end, radius, top) =
        if first >= second { (a, b, first, second) } else { (b, a, second, first) };
    let form = Form::Cone(if radius > 0.0 { top / radius } else { 1.0 });
    Some(Shape::Round { form, inwards: inwards != is_negative, origin, along: end - origin, radius })
}

/// Adds a shape with a material.
fn draw(
    world: &mut World,
    shape: &Shape,
    material: usize,
    is_hidden: bool,
    primitive: &Primitive,
    place: &Place,
) -> Result<(), FormatError> {
    let at = &primitive.at;
    match *shape {
        Shape::Polygon(ref corners) => {
            let key = polygons::Key { material, prefix: place.prefix.clone(), is_hidden };
            let corners: Vec<DVec3> = corners.iter().map(|corner| world.point(*corner)).collect();
            let World { polygons, reading, diagnostics, .. } = world;
            polygons.add(key, &corners, at, &mut reading.budget, diagnostics)
        }
        Shape::Round { form, inwards, origin, along, radius } => {
            let matrix = match form {
                Form::Sphere => {
                    DMat4::from_translation(world.point(origin)) * DMat4::from_scale(DVec3::splat(radius))
                }
                _ => placed(world.point(origin), turned(along), radius),
            };
            let Some(transform) = Transform::from_matrix(matrix) else {
                let what = "a surface is too large or too small for 32-bit numbers: left out";
                world.diagnostics.note(what, || at.clone());
                return Ok(());
            };
            let mesh = world.round.mesh(form, inwards, &mut world.reading.budget, &at.file)?;
            let name = match &place.prefix {
                Some(prefix) => format!("{prefix}.{}", primitive.name),
                None => primitive.name.to_string(),
            };
            let visibility = if is_hidden { Visibility::NoCamera } else { Visibility::Full };
            let object = Object { visibility, ..Object::new(&name, mesh, material).placed(transform) };
            world.object(object, at)
        }
    }
}

/// Adds a shape that emits light.
fn shine(
    world: &mut World,
    shape: &Shape,
    lamp: &Lamp,
    primitive: &Primitive,
    place: &Place,
) -> Result<(), FormatError> {
    let at = &primitive.at;
    if lamp.sky.is_some() {
        let what = format!("the sky on the surfaces of '{}', which shine evenly", lamp.name);
        world.diagnostics.not_shown(&what, || lamp.at.clone());
    }
    world.has_glow = true;
    match &lamp.emission {
        Emission::Spot { degrees, aim } => {
            let (middle, area) = seen_along(shape, aim.normalize_or_zero());
            lights::spot(world, lamp, [*degrees, area], *aim, middle)
        }
        Emission::Even => {
            // A sphere light is round at any size.
            if let Shape::Round { form: Form::Sphere, inwards: false, origin, radius, .. } = *shape
                && ((radius * radius) as f32).is_normal()
            {
                let spec = Spec::new(&primitive.name, "sphere")
                    .with("position", world.point(origin).as_vec3())
                    .with("radius", radius as f32)
                    .with("radiance", light(lamp.colour));
                return world.light(spec, at);
            }
            let material = lights::material(world, lamp)?;
            draw(world, shape, material, false, primitive, place)
        }
        Emission::Illum(alternate) => {
            let what =
                "eyes look through the light of an 'illum', and what is behind it lights nothing through it";
            world.diagnostics.remark(what, || lamp.at.clone());
            let material = lights::material(world, lamp)?;
            draw(world, shape, material, true, primitive, place)?;
            match **alternate {
                Look::Material(material) => draw(world, shape, material, false, primitive, place),
                _ => Ok(()),
            }
        }
    }
}

/// The middle of a shape, and the area of its front as light in a direction leaves it.
fn seen_along(shape: &Shape, aim: DVec3) -> (DVec3, f64) {
    match *shape {
        Shape::Polygon(ref corners) => {
            let first = corners[0];
            let doubled: DVec3 =
                corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
            let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
            (middle, (0.5 * doubled.dot(aim)).max(0.0))
        }
        Shape::Round { form: Form::Sphere, origin, radius, .. } => (origin, PI * radius * radius),
        Shape::Round { form: Form::Ring(inner), origin, along, radius, .. } => {
            (origin, PI * radius * radius * (1.0 - inner * inner) * along.dot(aim).max(0.0))
        }
        Shape::Round { form: Form::Cone(top), origin, along, radius, .. } => {
            let across = along.cross(aim).length();
            (origin + along * 0.5, radius * (1.0 + top) * across)
        }
    }
}
