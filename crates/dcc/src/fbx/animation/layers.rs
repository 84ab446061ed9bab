//! Animation since version 7: stacks of layers of curves.

use super::clip::Clip;
use super::curve::Curve;
use crate::fbx::document::{Animated, Document, Index, Properties, display_name};
use crate::fbx::transform::RotationOrder;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::world::between_keys::slerp;
use bilux_math::glam::DQuat;
use bilux_math::transcendental::powf_f64;
use bilux_math::{DMat3, DVec3};
use std::collections::HashMap;

/// The name and the times of a stack.
pub(super) fn clip(document: &Document, stack: Index) -> Clip {
    let properties = document.properties(stack);
    let time = |names: [&str; 2]| names.iter().find_map(|name| properties.integer(name)).unwrap_or(0);
    let name = display_name(document.object(stack).name);
    Clip { name, begin: time(["LocalStart", "ReferenceStart"]), end: time(["LocalStop", "ReferenceStop"]) }
}

/// Blend mode of a layer over the layers below it.
#[derive(Clone, Copy, PartialEq)]
enum Blend {
    Replace,
    Add,
    Override,
}

/// Sets the values of a stack at a time in units of the file.
pub(super) fn play<'d>(
    document: &Document<'d>,
    stack: Index,
    time: f64,
    animated: &mut HashMap<Index, Animated<'d>>,
    budget: &mut Budget,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    // Objects may have many properties, and each many curves.
    let mut targets: HashMap<Index, Properties> = HashMap::new();
    let layers: Vec<Index> = document.sources_of_class(stack, "AnimationLayer").collect();
    for (number, &layer) in layers.iter().enumerate() {
        let properties = document.properties(layer);
        if properties.integer("Mute") == Some(1) {
            continue;
        }
        let blend = match properties.integer("BlendMode").unwrap_or(0) {
            _ if number == 0 => Blend::Replace,
            0 => Blend::Add,
            _ => Blend::Override,
        };
        let mut weight = properties.number("Weight").unwrap_or(100.0);
        for &node in &document
            .sources(layer)
            .iter()
            .filter(|link| link.property == Some(b"Weight"))
            .map(|l| l.source)
            .collect::<Vec<_>>()
        {
            weight = values(document, node, DVec3::splat(weight), time, budget)?.x;
        }
        let weight = (weight / 100.0).clamp(0.0, 1.0);
        for node in document.sources_of_class(layer, "AnimationCurveNode") {
            for link in document.targets(node) {
                let Some(property) = link.property else { continue };
                budget.take_bytes(size_of::<Properties>() as u64, document.file())?;
                let target = targets.entry(link.target).or_insert_with(|| document.properties(link.target));
                let known = animated.get(&link.target).and_then(|known| known.get(property)).copied();
                let below = known.unwrap_or_else(|| stated(target, property));
                let spent = budget.spent();
                let own = values(
                    document,
                    node,
                    if blend == Blend::Add { DVec3::ZERO } else { below },
                    time,
                    budget,
                );
                let own = match own {
                    Ok(own) => own,
                    Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                    Err(error) => {
                        let what = format!("part of an animation is left out: {}", error.without_place());
                        diagnostics.note(&what, || document.object(node).node.at());
                        continue;
                    }
                };
                budget.release(budget.spent() - spent);
                let order = RotationOrder::of(target);
                let combined = combined(blend, property, below, own, weight, &properties, order);
                budget.take::<(Index, &[u8], DVec3, [usize; 4])>(1, document.file())?;
                animated.entry(link.target).or_default().insert(property, combined);
            }
        }
    }
    Ok(())
}

/// The values that a property has without animation.
pub(super) fn stated(properties: &Properties, property: &[u8]) -> DVec3 {
    let name = std::str::from_utf8(property).unwrap_or_default();
    let number = properties.number(name);
    properties
        .vector(name)
        .or(number.map(DVec3::splat))
        .unwrap_or_else(|| if name == "Lcl Scaling" { DVec3::ONE } else { DVec3::ZERO })
}

/// The values of a curve node: those of its curves, or else its own, or else `below`.
fn values(
    document: &Document,
    node: Index,
    below: DVec3,
    time: f64,
    budget: &mut Budget,
) -> Result<DVec3, FormatError> {
    let mut values = below;
    let own = document.properties(node);
    for (axis, name) in ["d|X", "d|Y", "d|Z"].into_iter().enumerate() {
        if let Some(number) = own.number(name) {
            values[axis] = number;
        }
    }
    for link in document.sources(node) {
        let axis = match link.property {
            Some(b"d|Y") => 1,
            Some(b"d|Z") => 2,
            Some(_) => 0,
            None => continue,
        };
        if document.class(link.source) == b"AnimationCurve" {
            let curve = Curve::read(document.object(link.source).node, document.settings.ticks, budget)?;
            values[axis] = curve.at(time).unwrap_or(values[axis]);
        }
    }
    Ok(values)
}

/// Values after a layer, from the values below it. Rotations are by angle only if the layer says so.
fn combined(
    blend: Blend,
    property: &[u8],
    below: DVec3,
    own: DVec3,
    weight: f64,
    layer: &Properties,
    order: RotationOrder,
) -> DVec3 {
    let turns = property == b"Lcl Rotation" && layer.integer("RotationAccumulationMode").unwrap_or(0) == 0;
    let quaternion = |degrees: DVec3| DQuat::from_mat3(&order.matrix(degrees)).to_array();
    let part = |from: DQuat, to: DVec3| {
        let part = slerp(&from.to_array(), &quaternion(to), weight);
        DQuat::from_array([part[0], part[1], part[2], part[3]])
    };
    let from = || DQuat::from_array(quaternion(below));
    let angles = |rotation: DQuat| order.angles(&DMat3::from_quat(rotation));
    let multiplies = property == b"Lcl Scaling" && layer.integer("ScaleAccumulationMode").unwrap_or(0) == 0;
    let power = |values: DVec3, exponent: f64| {
        DVec3::from_array(values.to_array().map(|x| powf_f64(x.abs(), exponent) * x.signum()))
    };
    match blend {
        Blend::Replace => own,
        Blend::Add if multiplies => below * power(own, weight),
        Blend::Add if turns => angles(from() * part(DQuat::IDENTITY, own)),
        Blend::Override if turns && weight < 1.0 => angles(part(from(), own)),
        Blend::Add => below + own * weight,
        Blend::Override if multiplies => power(below, 1.0 - weight) * power(own, weight),
        Blend::Override => below * (1.0 - weight) + own * weight,
    }
}
