//! `SkelAnimation`: where joints are, and how much there is of blend shapes.

use crate::layers::value::{Array, Text};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::choice::named_or_numbered;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::glam::DQuat;
use bilux_math::{DMat4, DVec3};
use bilux_scene::Animation;
use std::collections::HashMap;
use std::sync::Arc;

/// The animation at one time.
#[derive(Debug, Default)]
pub(super) struct Played {
    /// Places in the joint above, by the names of joints.
    pub(super) joints: HashMap<Text, DMat4>,
    /// Weights, by the names of blend shapes.
    pub(super) shapes: HashMap<Text, f64>,
}

/// True for prims that are animations of skeletons.
fn is_animation(stage: &Stage, prim: u32) -> bool {
    matches!(&*stage.prim(prim).type_name, "SkelAnimation" | "PackedJointAnimation")
}

/// The animations of skeletons, and which of them `wanted` names, which every skeleton plays then.
pub(crate) fn playing(
    stage: &Stage,
    seconds: f32,
    wanted: Option<&str>,
) -> Result<(Vec<Animation>, Option<u32>), FormatError> {
    let all: Vec<u32> = (0..stage.prims.len() as u32).filter(|&prim| is_animation(stage, prim)).collect();
    let name = |prim: &u32| stage.prim(*prim).path.rsplit('/').next().unwrap_or_default().to_owned();
    let names: Vec<String> = all.iter().map(name).collect();
    let chosen = match wanted {
        Some(wanted) => Some(all[named_or_numbered("animation", wanted, &names, &stage.layers[0].at(0))?]),
        None => None,
    };
    let skeletons = (0..stage.prims.len() as u32).filter(|&prim| &*stage.prim(prim).type_name == "Skeleton");
    let sources: Vec<Option<u32>> = match chosen {
        Some(_) => vec![chosen],
        None => skeletons.map(|skeleton| source(stage, skeleton)).collect(),
    };
    let animations = all.iter().zip(names).map(|(&prim, name)| Animation {
        name,
        seconds,
        plays: seconds > 0.0 && sources.contains(&Some(prim)),
    });
    Ok((animations.collect(), chosen))
}

/// The animation of a skeleton: the nearest one that it or a prim above it is bound to.
pub(super) fn source(stage: &Stage, skeleton: u32) -> Option<u32> {
    let mut at = skeleton;
    while !stage.states(at, "skel:animationSource") {
        at = stage.above(at)?;
    }
    let path = stage.targets(at, "skel:animationSource").into_iter().next()?;
    stage.named(&path).filter(|&prim| is_animation(stage, prim))
}

/// An animation at the time of the stage.
pub(super) fn played(
    stage: &Stage,
    prim: u32,
    budget: &mut Budget,
    diagnostics: &mut Diagnostics,
) -> Result<Played, FormatError> {
    let mut played = Played::default();
    let mut list = |name: &str| stage.array(prim, name, budget);
    let (moved, turned, scaled) = (list("translations")?, list("rotations")?, list("scales")?);
    let weights = list("blendShapeWeights")?;
    let mut names = |name: &str| -> Result<Arc<[Text]>, FormatError> {
        let texts = stage.value(prim, name, budget)?.and_then(|value| value.texts());
        Ok(texts.unwrap_or_else(|| Arc::from([])))
    };
    let (joints, shapes) = (names("joints")?, names("blendShapes")?);
    let has_all = |list: &Option<Arc<Array>>, width: usize| {
        list.as_ref().is_some_and(|list| list.len() == joints.len() && list.width == width)
    };
    if !joints.is_empty() {
        // Only the scales may be left out.
        let has_scales = scaled.as_ref().is_none_or(|list| list.len() == 0) || has_all(&scaled, 3);
        if has_all(&moved, 3) && has_all(&turned, 4) && has_scales {
            let scales = scaled.filter(|list| list.len() > 0);
            let joint = |i: usize| local(&moved, &turned, &scales, i);
            played.joints = joints.iter().enumerate().map(|(i, name)| (name.clone(), joint(i))).collect();
        } else {
            let what = "an animation of a skeleton has not as many translations, rotations or scales as joints: these rest";
            diagnostics.note(what, || stage.at(prim));
        }
    }
    if let Some(weights) = weights {
        let weight = |i: usize| weights.numbers.at(i);
        let all = shapes.iter().take(weights.len()).enumerate();
        played.shapes = all.map(|(i, name)| (name.clone(), weight(i))).collect();
    }
    Ok(played)
}

fn local(
    moved: &Option<Arc<Array>>,
    turned: &Option<Arc<Array>>,
    scales: &Option<Arc<Array>>,
    i: usize,
) -> DMat4 {
    let vector = |list: &Option<Arc<Array>>, unstated: DVec3| {
        list.as_ref().map_or(unstated, |list| DVec3::from(list.tuple::<3>(i)))
    };
    let turn = turned.as_ref().map_or(DQuat::IDENTITY, |list| DQuat::from_array(list.tuple::<4>(i)));
    let turn = if turn.length_squared() > 0.0 { turn.normalize() } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(vector(scales, DVec3::ONE), turn, vector(moved, DVec3::ZERO))
}
