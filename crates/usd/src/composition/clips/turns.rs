//! Which clip is in use, and at which of its times.

use crate::layers::value::{Text, TimeOffset};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Number of clips before and after one that are opened in search of values that it has not.
pub(super) const MAX_REACH: usize = 64;
/// Of numbers of steps.
pub(super) const ROUNDING: f64 = 1e-9;

/// Clips for a prim and all below it.
#[derive(Debug)]
pub(crate) struct ClipSet {
    /// Of all sets of a read, which one it is.
    pub(crate) number: u32,
    /// Map of the time codes of the layer that states it to those of the stage.
    pub(super) offset: TimeOffset,
    pub(super) active: Active,
    /// Times of that layer, and what they are in the clips.
    pub(super) times: Vec<[f64; 2]>,
    /// Which attributes the clips have; without it, those that the clip of the time has.
    pub(crate) manifest: Option<u32>,
    /// Whether values that a clip has not come from those before and after it.
    pub(crate) bridges: bool,
    /// The layers of those clips that are needed.
    pub(super) opened: BTreeMap<usize, u32>,
}

/// Which clip is in use.
#[derive(Debug)]
pub(super) enum Active {
    /// From a time on, until the next.
    From(Vec<[f64; 2]>),
    /// One for each step.
    Steps { start: f64, stride: f64, count: usize },
}
/// The clips of a prim.
#[derive(Clone, Debug)]
pub(crate) struct Clipped {
    pub(crate) set: Arc<ClipSet>,
    /// Number of opinions about the prim that are stronger.
    pub(crate) stronger: usize,
    /// The prim in the clips.
    pub(crate) path: Text,
    /// The prim in the layers that state the clips.
    pub(super) anchor: (u32, String),
}

/// The clip of a time, and the one that takes over from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) layer: u32,
    /// The time in it.
    pub(crate) time: f64,
    /// The layer that takes over and the time there, unless time jumps there.
    pub(crate) next: Option<(u32, f64)>,
    now: f64,
    /// Now, or the end of the clip if that has passed.
    moment: f64,
    /// When this clip or this piece of its time began, when the clip ends, and when the next one takes over.
    since: f64,
    end: f64,
    until: f64,
    /// Speed of outer time over that of the clip.
    speed: f64,
    /// Other clips, which have no values, are in use.
    is_over: bool,
    /// Time jumps at the end of the clip.
    jumps: bool,
}

impl Turn {
    /// Transition of values from this clip to the next: the time in this one that they go from, and how far they have come. `None`
    /// where samples of this clip are around its time, which is between `before` and `after`.
    pub(crate) fn across(&self, before: Option<f64>, after: Option<f64>) -> Option<(f64, f64)> {
        let outer = |time: f64| self.moment + (time - self.time) * self.speed;
        let stands = self.speed == 0.0;
        if !self.is_over && (stands || after.is_some_and(|after| outer(after) < self.end)) {
            return None;
        }
        let from = match before {
            _ if self.is_over && self.jumps => self.end,
            Some(before) if !stands => outer(before).max(self.since),
            _ => self.since,
        };
        let part = (self.now - from) / (self.until - from);
        let time = if stands { self.time } else { self.time + (from - self.moment) / self.speed };
        (0.0..1.0).contains(&part).then_some((time, part))
    }
}

impl ClipSet {
    /// The clip of a time of the stage. With `has`, it is the last one up to then that has values, and the next one that has some
    /// takes over from it; the first one that has some is in use before its time.
    pub(crate) fn at(&self, time: f64, has: Option<&dyn Fn(u32) -> bool>) -> Option<Turn> {
        let now = self.offset.inverse(time);
        let here = self.active.turn(now);
        let layer = |turn: usize| self.opened.get(&self.active.clip(turn)?).copied();
        let (first, last) = match has {
            None => (Some(here), Some(here + 1)),
            Some(has) => {
                let has = |turn: &usize| layer(*turn).is_some_and(has);
                let near = [here.saturating_sub(MAX_REACH), here + MAX_REACH];
                ((near[0]..=here).rev().find(has), (here + 1..=near[1]).find(has))
            }
        };
        let start = |turn: usize| self.active.start(turn);
        let next = last.and_then(|turn| Some((layer(turn)?, self.inside(start(turn), false)[0])));
        let Some(first) = first else {
            let (layer, time) = next?;
            let [since, end] = [f64::NEG_INFINITY, f64::INFINITY];
            let (is_over, jumps, speed) = (false, false, 0.0);
            return Some(Turn {
                layer,
                time,
                next: None,
                now,
                moment: now,
                since,
                end,
                until: end,
                speed,
                is_over,
                jumps,
            });
        };
        let (end, is_over) = (start(first + 1), first < here);
        let moment = now.min(end);
        let [time, piece, speed] = self.inside(moment, is_over);
        let jumps = self.times.windows(2).any(|pair| pair[0][0] == end && pair[1][0] == end);
        let next = next.filter(|_| is_over || !jumps);
        let until = last.map_or(f64::INFINITY, start);
        let since = start(first).max(piece);
        Some(Turn { layer: layer(first)?, time, next, now, moment, since, end, until, speed, is_over, jumps })
    }

    /// The time in the clips, when its piece began, and the speed of outer time: between two times that it is stated for, it goes
    /// on evenly; of two at once, the second counts, or the first if the clip ends there.
    fn inside(&self, time: f64, ends: bool) -> [f64; 3] {
        let (Some(first), Some(last)) = (self.times.first(), self.times.last()) else {
            return [time, f64::NEG_INFINITY, 1.0];
        };
        let next = self.times.partition_point(|[at, _]| *at < time || (*at == time && !ends));
        let Some(before) = next.checked_sub(1) else { return [first[1], f64::NEG_INFINITY, 0.0] };
        let Some([until, end]) = self.times.get(next) else { return [last[1], last[0], 0.0] };
        let [from, start] = self.times[before];
        let speed = if *end == start { 0.0 } else { (until - from) / (end - start) };
        [start + (end - start) * (time - from) / (until - from), from, speed]
    }
}

impl Active {
    /// The clip whose turn it is.
    pub(super) fn clip(&self, turn: usize) -> Option<usize> {
        match self {
            Active::From(list) => list.get(turn).map(|[_, index]| *index as usize),
            Active::Steps { count, .. } => Some(turn).filter(|turn| turn < count),
        }
    }

    /// Whose turn it is at a time; the first one's before that too.
    pub(super) fn turn(&self, time: f64) -> usize {
        match self {
            Active::From(list) => list.partition_point(|[at, _]| *at <= time).saturating_sub(1),
            // A step that is reached but for rounding is reached.
            Active::Steps { start, stride, count } => {
                (((time - start) / stride + ROUNDING).max(0.0) as usize).min(count.saturating_sub(1))
            }
        }
    }

    /// When a turn begins; infinite at the ends.
    fn start(&self, turn: usize) -> f64 {
        match self {
            _ if turn == 0 => f64::NEG_INFINITY,
            Active::From(list) => list.get(turn).map_or(f64::INFINITY, |[at, _]| *at),
            Active::Steps { start, stride, count } if turn < *count => start + turn as f64 * stride,
            Active::Steps { .. } => f64::INFINITY,
        }
    }
}
