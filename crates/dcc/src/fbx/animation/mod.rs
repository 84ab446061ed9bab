//! Animation: the values of properties at a time, of the animation that plays.

mod clip;
mod curve;
mod key;
mod layers;
mod takes;
mod tangents;

use super::document::{Animated, Document, Index};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::choice::named_or_numbered;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_scene::Animation;
use clip::Clip;
use std::collections::HashMap;

/// The values of properties at a time, and the animations of the file.
#[derive(Default)]
pub(super) struct Pose<'d> {
    pub(super) animated: HashMap<Index, Animated<'d>>,
    pub(super) animations: Vec<Animation>,
    /// The time in seconds on the clock of the file, on which animations may begin later than at 0.
    pub(super) seconds: f64,
}

impl<'d> Pose<'d> {
    /// The pose at a time in seconds after the beginning of the animation that `wanted` names, or else of the one that the
    /// file names, or the first.
    pub(super) fn read(
        document: &Document<'d>,
        time: f32,
        wanted: Option<&str>,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Pose<'d>, FormatError> {
        let stacks: Vec<Index> =
            document.indices().filter(|&index| document.class(index) == b"AnimationStack").collect();
        let takes = takes::nodes(document);
        let clips: Vec<Clip> = match stacks.is_empty() {
            false => stacks.iter().map(|&stack| layers::clip(document, stack)).collect(),
            true => takes.iter().map(|take| takes::clip(*take)).collect(),
        };
        let names: Vec<String> = clips.iter().map(|clip| clip.name.clone()).collect();
        let chosen = match wanted {
            Some(wanted) => named_or_numbered("animation", wanted, &names, &document.tree.whole())?,
            None => {
                let active = document.active_animation();
                names.iter().position(|name| Some(name) == active.as_ref()).unwrap_or(0)
            }
        };
        let mut pose = Pose { seconds: f64::from(time), ..Pose::default() };
        if let Some(clip) = clips.get(chosen) {
            let ticks = clip.begin as f64 + f64::from(time) * document.settings.ticks;
            pose.seconds = ticks / document.settings.ticks;
            match stacks.get(chosen) {
                Some(&stack) => {
                    layers::play(document, stack, ticks, &mut pose.animated, budget, diagnostics)?
                }
                None => takes::play(document, takes[chosen], ticks, &mut pose.animated, budget, diagnostics)?,
            }
        }
        let is_cache = |index| document.object(index).kind == b"VertexCacheDeformer";
        let does_play = !pose.animated.is_empty() || document.indices().any(is_cache);
        for (number, clip) in clips.into_iter().enumerate() {
            let seconds =
                (clip.end.saturating_sub(clip.begin) as f64 / document.settings.ticks).max(0.0) as f32;
            pose.animations.push(Animation {
                name: clip.name,
                seconds,
                plays: number == chosen && does_play,
            });
        }
        Ok(pose)
    }
}
