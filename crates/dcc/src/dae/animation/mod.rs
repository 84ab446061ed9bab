//! Animation: the numbers of elements at a time.

mod curve;

use super::data::inputs;
use super::document::Document;
use super::element::Element;
use super::targets::target;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::choice::named_or_numbered;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_scene::Animation;
use curve::Curve;
use roxmltree::NodeId;
use std::collections::{HashMap, HashSet};

/// Numbers that replace those of an element.
pub(super) struct Set {
    /// The first of them; all without one.
    pub(super) first: Option<usize>,
    pub(super) values: Vec<f64>,
}

/// The numbers of elements at a time, and the animations of the file.
#[derive(Default)]
pub(super) struct Pose {
    animated: HashMap<NodeId, Vec<Set>>,
    pub(super) animations: Vec<Animation>,
}

/// A part of the timeline with a name: the file's clips, or all of it.
struct Clip<'d> {
    name: String,
    start: f64,
    end: f64,
    /// The animations that it plays; all of them if it is none of the file's.
    plays: Option<Vec<Element<'d>>>,
}

impl Pose {
    /// The pose at a time in seconds after the beginning of the clip that `wanted` names, or else of the first.
    pub(super) fn read(
        document: &Document,
        time: f32,
        wanted: Option<&str>,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Pose, FormatError> {
        let mut pose = Pose::default();
        let all: Vec<Element> =
            document.library("library_animations").filter(|a| a.name() == "animation").collect();
        let mut clips = clips(document, diagnostics);
        if clips.is_empty() && !all.is_empty() {
            clips.push(Clip { name: String::new(), start: 0.0, end: f64::NAN, plays: None });
        }
        let names: Vec<String> = clips.iter().map(|clip| clip.name.clone()).collect();
        let chosen = match wanted {
            Some(wanted) => named_or_numbered("animation", wanted, &names, &document.root.at())?,
            None => 0,
        };
        let Some(clip) = clips.get(chosen) else { return Ok(pose) };
        let in_clips: HashSet<NodeId> =
            clips.iter().flat_map(|c| &c.plays).flatten().map(|a| a.key()).collect();
        // Animations of no clip always play.
        let is_chosen = |animation: &Element| match &clip.plays {
            Some(plays) => {
                plays.iter().any(|played| played.key() == animation.key())
                    || !in_clips.contains(&animation.key())
            }
            None => true,
        };
        let mut end = 0.0f64;
        for animation in all.into_iter().filter(is_chosen) {
            for channel in animation.descendants().filter(|element| element.name() == "channel") {
                let spent = budget.spent();
                let last = pose.play(channel, clip.start + f64::from(time), document, budget, diagnostics);
                match last {
                    Ok(last) => end = end.max(last.unwrap_or(0.0)),
                    Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                    Err(error) => {
                        let what = format!("part of an animation is left out: {}", error.without_place());
                        diagnostics.note(&what, || channel.at());
                    }
                }
                budget.release(budget.spent() - spent);
                budget.take::<(NodeId, Set, [f64; 16])>(1, channel.file())?;
            }
        }
        let does_play = !pose.animated.is_empty();
        for (number, clip) in clips.into_iter().enumerate() {
            let end = if clip.end.is_nan() { end } else { clip.end };
            let seconds = (end - clip.start).max(0.0) as f32;
            pose.animations.push(Animation {
                name: clip.name,
                seconds,
                plays: number == chosen && does_play,
            });
        }
        Ok(pose)
    }

    /// The values that replace numbers of an element, in order.
    pub(super) fn of(&self, element: Element) -> &[Set] {
        self.animated.get(&element.key()).map_or(&[], |sets| sets)
    }

    /// Sets what a channel says at a time; returns when its last key is.
    fn play(
        &mut self,
        channel: Element,
        time: f64,
        document: &Document,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<f64>, FormatError> {
        let Some(sampler) = document.referred(channel, "source", diagnostics) else { return Ok(None) };
        let Some(target) = target(channel.attribute("target").unwrap_or_default(), document) else {
            let what = "an animation is of something that the picture does not have, or that is not there";
            diagnostics.remark(what, || channel.at());
            return Ok(None);
        };
        let curve = Curve::read(sampler, &inputs(sampler, document), document, budget, diagnostics)?;
        let Some(curve) = curve else { return Ok(None) };
        let values = curve.at(time);
        let sets = self.animated.entry(target.element.key()).or_default();
        // One of the same numbers takes the place of an earlier one.
        sets.retain(|set| set.first != target.first || set.first.is_none() != target.first.is_none());
        sets.push(Set { first: target.first, values });
        Ok(curve.end())
    }
}

/// The clips of a file.
fn clips<'d>(document: &Document<'d>, diagnostics: &mut Diagnostics) -> Vec<Clip<'d>> {
    let library = document.library("library_animation_clips");
    let elements = library.filter(|element| element.name() == "animation_clip").take(MAX_CLIPS);
    let mut clips = Vec::new();
    for element in elements {
        let time = |name: &str| element.attribute(name)?.trim().parse::<f64>().ok().filter(|t| t.is_finite());
        let instances = element.children_named("instance_animation");
        let plays = instances.filter_map(|one| document.referred(one, "url", diagnostics)).collect();
        clips.push(Clip {
            name: element.label(),
            start: time("start").unwrap_or(0.0),
            end: time("end").unwrap_or(f64::NAN),
            plays: Some(plays),
        });
    }
    clips
}

/// Further clips are not listed.
const MAX_CLIPS: usize = 1000;
