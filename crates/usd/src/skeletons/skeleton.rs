//! Skeletons in a pose.

use super::animation::{played, source};
use crate::layers::value::{Array, Text};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::DMat4;
use std::collections::HashMap;
use std::sync::Arc;

/// A skeleton at one time.
#[derive(Debug)]
pub(crate) struct Pose {
    /// Indices of the joints, by their names.
    pub(super) joints: HashMap<Text, usize>,
    /// From where each joint was bound to where it is, in the space of the skeleton; none if that cannot be told.
    pub(super) moved: Vec<DMat4>,
    /// Weights of blend shapes.
    pub(super) shapes: HashMap<Text, f64>,
    /// The prims that say all this.
    pub(super) from: Vec<u32>,
}

impl Pose {
    /// A skeleton, moved by its animation, or by the one that all play.
    pub(crate) fn read(
        stage: &Stage,
        skeleton: u32,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Pose, FormatError> {
        let names = stage.value(skeleton, "joints", budget)?.and_then(|value| value.texts());
        let names: Arc<[Text]> = names.unwrap_or_else(|| Arc::from([]));
        budget.take_bytes(
            (names.len() * (3 * size_of::<DMat4>() + 4 * size_of::<(Text, usize)>())) as u64,
            &stage.layers[0].name,
        )?;
        let joints: HashMap<Text, usize> =
            names.iter().enumerate().map(|(i, name)| (name.clone(), i)).collect();
        let animation = stage.animation.or_else(|| source(stage, skeleton));
        let animated = match animation {
            Some(animation) => played(stage, animation, budget, diagnostics)?,
            None => Default::default(),
        };
        let of_all = |list: Option<Arc<Array>>| {
            list.filter(|list| list.width == 16 && list.len() == names.len() && list.len() > 0)
        };
        let bound = of_all(stage.array(skeleton, "bindTransforms", budget)?);
        let rest = of_all(stage.array(skeleton, "restTransforms", budget)?);
        let from = [skeleton].into_iter().chain(animation).collect();
        let mut pose = Pose { joints, moved: Vec::new(), shapes: animated.shapes, from };
        let has_places = rest.is_some() || names.iter().all(|name| animated.joints.contains_key(name));
        let Some(bound) = bound.filter(|_| has_places) else {
            if !names.is_empty() {
                let what = "a skeleton does not say where each joint was bound and rests: meshes keep the shape that they were bound in";
                diagnostics.note(what, || stage.at(skeleton));
            }
            return Ok(pose);
        };
        let at_rest = |joint: usize| rest.as_ref().map_or(DMat4::IDENTITY, |rest| matrix(rest, joint));
        let local =
            |joint: usize| animated.joints.get(&names[joint]).copied().unwrap_or_else(|| at_rest(joint));
        let places = places(&names, &pose.joints, local);
        let mut is_sound = true;
        let moved = |(joint, place): (usize, DMat4)| {
            let inverse = matrix(&bound, joint).inverse();
            let moved = place * inverse;
            is_sound &= moved.is_finite();
            if moved.is_finite() { moved } else { DMat4::IDENTITY }
        };
        pose.moved = places.into_iter().enumerate().map(moved).collect();
        if !is_sound {
            let what =
                "some joints have transforms that cannot be inverted or are not finite: they move nothing";
            diagnostics.note(what, || stage.at(skeleton));
        }
        Ok(pose)
    }
}

fn matrix(list: &Array, i: usize) -> DMat4 {
    DMat4::from_cols_array(&list.tuple::<16>(i))
}

/// The places of joints in the skeleton. Their names are paths, and a joint moves with the nearest one above it.
fn places(names: &[Text], joints: &HashMap<Text, usize>, local: impl Fn(usize) -> DMat4) -> Vec<DMat4> {
    let above = |name: &str| {
        let mut name = name;
        while let Some((parent, _)) = name.rsplit_once('/') {
            if let Some(found) = joints.get(parent) {
                return Some(*found);
            }
            name = parent;
        }
        None
    };
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by_key(|&joint| names[joint].len());
    let mut places = vec![DMat4::IDENTITY; names.len()];
    for joint in order {
        places[joint] = above(&names[joint]).map_or(local(joint), |above| places[above] * local(joint));
    }
    places
}
