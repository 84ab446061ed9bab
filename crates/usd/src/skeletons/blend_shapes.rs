//! `BlendShape`: offsets of points and normals, with shapes in between.

use super::skeleton::Pose;
use crate::layers::value::{Array, Text};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::deformation::amounts;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::Vec3;

/// The blend shapes of a prim that are used, and how much there is of each.
pub(super) fn used(
    stage: &Stage,
    prim: u32,
    pose: &Pose,
    budget: &mut Budget,
) -> Result<Vec<(u32, f64)>, FormatError> {
    let targets = stage.targets(prim, "skel:blendShapeTargets");
    if targets.is_empty() {
        return Ok(Vec::new());
    }
    let names = stage.value(prim, "skel:blendShapes", budget)?.and_then(|value| value.texts());
    let names = names.iter().flat_map(|names| names.iter());
    let shape = |(name, path): (&Text, &Text)| {
        let weight = pose.shapes.get(name).filter(|weight| **weight != 0.0 && weight.is_finite())?;
        Some((stage.named(path)?, *weight))
    };
    Ok(names.zip(&targets).filter_map(shape).collect())
}

/// Adds what there is of a shape to points, and to what is added to their normals.
pub(super) fn add(
    stage: &Stage,
    (prim, weight): (u32, f64),
    points: &mut [Vec3],
    turns: &mut Vec<Vec3>,
    budget: &mut Budget,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    const BETWEEN: &str = "inbetweens:";
    let mut shapes: Vec<(f64, Text, Text)> = vec![(1.0, "offsets".into(), "normalOffsets".into())];
    for name in stage.names(prim, BETWEEN) {
        let at = stage.metadata(prim, &name, "weight").and_then(|value| value.number());
        if let Some(at) = at.filter(|_| !name[BETWEEN.len()..].contains(':')) {
            let normals = format!("{name}:normalOffsets").into();
            shapes.push((at, name, normals));
        }
    }
    let reached: Vec<f64> = shapes.iter().map(|(at, ..)| *at).collect();
    let indices = stage.array(prim, "pointIndices", budget)?.filter(|list| list.len() > 0);
    for ((_, offsets, normals), amount) in shapes.iter().zip(amounts(&reached, weight)) {
        if amount == 0.0 {
            continue;
        }
        let mut added = |to: &mut [Vec3], offsets: &Array| {
            for i in 0..offsets.len().min(indices.as_ref().map_or(usize::MAX, |list| list.len())) {
                let at = indices.as_ref().map_or(i, |list| list.numbers.at(i) as usize);
                match to.get_mut(at) {
                    Some(point) => *point += Vec3::from(offsets.floats::<3>(i)) * amount as f32,
                    None => {
                        let what = "a blend shape moves a point that the mesh does not have";
                        diagnostics.note(what, || stage.at(prim));
                    }
                }
            }
        };
        if let Some(offsets) = stage.array(prim, offsets, budget)? {
            added(points, &offsets);
        }
        let offsets = stage.array(prim, normals, budget)?;
        if let Some(offsets) = offsets.filter(|list| list.len() > 0) {
            if turns.is_empty() {
                budget.take_bytes(12 * points.len() as u64, &stage.layers[0].name)?;
                turns.resize(points.len(), Vec3::ZERO);
            }
            added(turns, &offsets);
        }
    }
    Ok(())
}
