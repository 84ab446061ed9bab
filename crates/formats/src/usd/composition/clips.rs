//! Value clips: layers whose samples take turns, as metadata of a prim says. [OpenUSD, UsdClipsAPI]

use super::layers::Layers;
use super::node::{Node, Opinion};
use crate::FormatError;
use crate::usd::value::{Text, TimeOffset, Value};
use std::collections::BTreeMap;
use std::sync::Arc;

/// More clips are a mistake of a template.
const MAX_CLIPS: f64 = 1e6;
/// Of numbers of steps.
const ROUNDING: f64 = 1e-9;

/// Clips for a prim and all below it.
#[derive(Debug)]
pub(in crate::usd) struct ClipSet {
    /// Of all sets of a read, which one it is.
    pub(in crate::usd) number: u32,
    /// What the time codes of the layer that states it are on the stage.
    offset: TimeOffset,
    active: Active,
    /// Times of that layer, and what they are in the clips.
    times: Vec<[f64; 2]>,
    /// Which attributes the clips have; without it, those that the clip of the time has.
    pub(in crate::usd) manifest: Option<u32>,
    /// The layers of those clips that are needed.
    opened: BTreeMap<usize, u32>,
}

/// Which clip is in use.
#[derive(Debug)]
enum Active {
    /// From a time on, until the next.
    From(Vec<[f64; 2]>),
    /// One for each step.
    Steps { start: f64, stride: f64, count: usize },
}

/// The files of clips.
enum Names {
    Listed(Arc<[Text]>),
    /// A name for each step of a time, with a place for it.
    Steps {
        name: Text,
        start: f64,
        stride: f64,
        times: [[f64; 2]; 2],
    },
}

/// The clips of a prim.
#[derive(Clone, Debug)]
pub(in crate::usd) struct Clipped {
    pub(in crate::usd) set: Arc<ClipSet>,
    /// How many opinions about the prim are stronger.
    pub(in crate::usd) stronger: usize,
    /// The prim in the clips.
    pub(in crate::usd) path: Text,
    /// The prim in the layers that state the clips.
    anchor: (u32, String),
}

/// The clip of a time, and the one that takes over from it.
#[derive(Clone, Copy, Debug)]
pub(in crate::usd) struct Turn {
    pub(in crate::usd) layer: u32,
    /// The time in it.
    pub(in crate::usd) time: f64,
    /// The layer that takes over and the time there, unless time jumps there.
    pub(in crate::usd) next: Option<(u32, f64)>,
    now: f64,
    /// When this clip or this piece of its time began, and when the next one takes over.
    since: f64,
    until: f64,
    /// How fast outer time goes when that of the clip does.
    speed: f64,
}

impl Turn {
    /// Where values go from this clip to the next: the time in this one that they go from, and how far they have come. `None`
    /// where samples of this clip are around its time, which is between `before` and `after`.
    pub(in crate::usd) fn across(&self, before: Option<f64>, after: Option<f64>) -> Option<(f64, f64)> {
        let outer = |time: f64| self.now + (time - self.time) * self.speed;
        if after.is_some_and(|after| outer(after) < self.until) || self.speed == 0.0 {
            return None;
        }
        let from = before.map_or(self.since, |before| outer(before).max(self.since));
        let part = (self.now - from) / (self.until - from);
        (0.0..1.0).contains(&part).then(|| (self.time + (from - self.now) / self.speed, part))
    }
}

impl ClipSet {
    /// The clip of a time of the stage.
    pub(in crate::usd) fn at(&self, time: f64) -> Option<Turn> {
        let now = self.offset.inverse(time);
        let index = self.active.at(now);
        let layer = *self.opened.get(&index)?;
        let [begin, until] = self.active.span(now);
        let jumps = self.times.windows(2).any(|pair| pair[0][0] == until && pair[1][0] == until);
        let next = self.opened.get(&self.active.at(until)).filter(|_| until.is_finite() && !jumps);
        let next = next.map(|next| (*next, self.inside(until)[0]));
        let [time, start, speed] = self.inside(now);
        Some(Turn { layer, time, next, now, since: begin.max(start), until, speed })
    }

    /// The time in the clips, when its piece began, and the speed of outer time: between two times that it is stated for, it goes
    /// on evenly; of two at once, the second counts.
    fn inside(&self, time: f64) -> [f64; 3] {
        let (Some(first), Some(last)) = (self.times.first(), self.times.last()) else {
            return [time, f64::NEG_INFINITY, 1.0];
        };
        if time < first[0] {
            return [first[1], f64::NEG_INFINITY, 0.0];
        }
        let next = self.times.partition_point(|[at, _]| *at <= time);
        let Some([until, end]) = self.times.get(next) else { return [last[1], last[0], 0.0] };
        let [from, start] = self.times[next - 1];
        let speed = if end == &start { 0.0 } else { (until - from) / (end - start) };
        [start + (end - start) * (time - from) / (until - from), from, speed]
    }

    /// The layers that a time needs.
    fn needed(&self, time: f64) -> [usize; 2] {
        let now = self.offset.inverse(time);
        [now, self.active.span(now)[1]].map(|time| self.active.at(time))
    }
}

impl Active {
    fn at(&self, time: f64) -> usize {
        match self {
            Active::From(list) => {
                let next = list.partition_point(|[at, _]| *at <= time);
                list.get(next.saturating_sub(1)).map_or(0, |[_, index]| *index as usize)
            }
            // A step that is reached but for rounding is reached.
            Active::Steps { start, stride, count } => {
                (((time - start) / stride + ROUNDING).max(0.0) as usize).min(count.saturating_sub(1))
            }
        }
    }

    /// When the clip of a time takes over and when the next one does; infinite at the ends.
    fn span(&self, time: f64) -> [f64; 2] {
        let ends = [f64::NEG_INFINITY, f64::INFINITY];
        match self {
            Active::From(list) => {
                let next = list.partition_point(|[at, _]| *at <= time);
                let begin = next.checked_sub(1).filter(|i| *i > 0).map_or(ends[0], |i| list[i][0]);
                // The first one is in use before its time too.
                [begin, list.get(next.max(1)).map_or(ends[1], |[at, _]| *at)]
            }
            Active::Steps { start, stride, count } => {
                let index = self.at(time);
                let at = |index: usize| start + index as f64 * stride;
                let begin = if index == 0 { ends[0] } else { at(index) };
                [begin, if index + 1 < *count { at(index + 1) } else { ends[1] }]
            }
        }
    }
}

/// The clips of a prim: its own before those of the prims above it.
pub(super) fn of(
    node: &Node,
    opinions: &[Opinion],
    above: &[Clipped],
    layers: &mut Layers,
) -> Result<Vec<Clipped>, FormatError> {
    let mut all = own(node, opinions, layers)?;
    let name = node.site.path.rsplit('/').next().unwrap_or_default();
    for clipped in above {
        let anchor = (clipped.anchor.0, format!("{}/{name}", clipped.anchor.1));
        let stronger = stronger(node, &anchor).unwrap_or(opinions.len());
        let path = format!("{}/{name}", clipped.path).into();
        all.push(Clipped { set: clipped.set.clone(), stronger, path, anchor });
    }
    all.sort_by_key(|clipped| clipped.stronger);
    Ok(all)
}

/// The number of opinions up to those of a place in some layers.
fn stronger(node: &Node, (stack, path): &(u32, String)) -> Option<usize> {
    let (mut count, mut found) = (0, None);
    node.visit(&mut |node: &Node| {
        count += node.specs.len();
        if found.is_none() && node.site.stack == *stack && node.site.path == *path {
            found = Some(count);
        }
    });
    found
}

fn own(node: &Node, opinions: &[Opinion], layers: &mut Layers) -> Result<Vec<Clipped>, FormatError> {
    let field = |opinion: &Opinion, key: &str, layers: &Layers| {
        layers.all[opinion.layer as usize].prims[opinion.prim as usize].fields.find(key).cloned()
    };
    if opinions.iter().any(|o| field(o, "clipAssetPaths", layers).is_some()) {
        let at = layers.all[0].at(0);
        layers.oddities.not_shown("value clips in the form without sets", || at);
    }
    let mut sets: BTreeMap<Text, Stated> = BTreeMap::new();
    for opinion in opinions {
        let stated = field(opinion, "clips", layers).map(|value| layers.unpacked(opinion.layer, value));
        let Some(Value::Dictionary(stated)) = stated.transpose()? else { continue };
        for (name, value) in stated {
            if let Value::Dictionary(entries) = layers.unpacked(opinion.layer, value)? {
                sets.entry(name).or_default().push((opinion, entries));
            }
        }
    }
    let mut all = Vec::new();
    for stated in sets.values() {
        match (Reader { stated, layers: &mut *layers }).read(node)? {
            Some(clipped) => all.push(clipped),
            None => {
                let opinion = stated[0].0;
                let at = layers.all[opinion.layer as usize].at(opinion.prim);
                let what = "value clips need assetPaths with active, or a template with start, end and stride, and a primPath: \
                            they are left out";
                layers.oddities.note(what, || at);
            }
        }
    }
    Ok(all)
}

/// The entries of a set, by the opinions that have them.
type Stated<'s> = Vec<(&'s Opinion, Vec<(Text, Value)>)>;

/// What several layers say of one set.
struct Reader<'s, 'l, 'r, 'o, 'b> {
    stated: &'s Stated<'s>,
    layers: &'l mut Layers<'r, 'o, 'b>,
}

impl<'s> Reader<'s, '_, '_, '_, '_> {
    /// The strongest value of an entry.
    fn entry(&mut self, key: &str) -> Result<Option<(&'s Opinion, Value)>, FormatError> {
        for (opinion, entries) in self.stated {
            if let Some((_, value)) = entries.iter().find(|(name, _)| &**name == key) {
                return Ok(Some((opinion, self.layers.unpacked(opinion.layer, value.clone())?)));
            }
        }
        Ok(None)
    }

    fn number(&mut self, key: &str) -> Result<Option<f64>, FormatError> {
        Ok(self.entry(key)?.and_then(|(_, value)| value.number()).filter(|x| x.is_finite()))
    }

    /// Pairs by their first numbers.
    fn pairs(&mut self, key: &str) -> Result<Vec<[f64; 2]>, FormatError> {
        let Some(array) = self.entry(key)?.and_then(|(_, value)| value.array()) else {
            return Ok(Vec::new());
        };
        self.layers.reading.budget.take::<[f64; 2]>(array.len(), &self.layers.all[0].name)?;
        let mut pairs: Vec<[f64; 2]> = (0..array.len()).map(|i| array.tuple::<2>(i)).collect();
        pairs.retain(|pair| pair.iter().all(|x| x.is_finite()));
        pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(pairs)
    }

    fn read(mut self, node: &Node) -> Result<Option<Clipped>, FormatError> {
        let path = self.entry("primPath")?.and_then(|(_, value)| value.text().cloned());
        let (Some(path), Some((opinion, names, active))) = (path, self.names()?) else { return Ok(None) };
        let times = match names {
            Names::Listed(_) => self.pairs("times")?,
            Names::Steps { times, .. } => times.to_vec(),
        };
        if self.number("interpolateMissingClipValues")?.is_some_and(|is| is != 0.0) {
            let at = self.layers.all[opinion.layer as usize].at(opinion.prim);
            self.layers.oddities.not_shown("interpolateMissingClipValues of value clips", || at);
        }
        let manifest = match self.entry("manifestAssetPath")? {
            Some((opinion, value)) => self.layer(opinion, value.text().cloned())?,
            None => None,
        };
        let anchor = (opinion.site.stack, opinion.site.path.clone());
        let stronger = stronger(node, &anchor).unwrap_or_default();
        let number = self.layers.clip_sets;
        self.layers.clip_sets += 1;
        let opened = BTreeMap::new();
        let mut set = ClipSet { number, offset: opinion.offset, active, times, manifest, opened };
        for moment in self.layers.moments.clone() {
            for index in set.needed(moment) {
                if !set.opened.contains_key(&index)
                    && let Some(layer) = self.layer(opinion, names.at(index))?
                {
                    set.opened.insert(index, layer);
                }
            }
        }
        Ok(Some(Clipped { set: Arc::new(set), stronger, path, anchor }))
    }

    /// The layers of the clips, when each is in use, and what says so.
    fn names(&mut self) -> Result<Option<(&'s Opinion, Names, Active)>, FormatError> {
        if let Some((opinion, value)) = self.entry("assetPaths")? {
            let (names, active) = (value.texts(), self.pairs("active")?);
            let names = names.filter(|_| !active.is_empty()).map(Names::Listed);
            return Ok(names.map(|names| (opinion, names, Active::From(active))));
        }
        let Some((opinion, value)) = self.entry("templateAssetPath")? else { return Ok(None) };
        let ends = [self.number("templateStartTime")?, self.number("templateEndTime")?];
        let (Some(name), [Some(start), Some(end)]) = (value.text().cloned(), ends) else { return Ok(None) };
        let stride = self.number("templateStride")?.filter(|stride| *stride > 0.0);
        let count = stride.map(|stride| (stride, (end - start) / stride + 1.0 + ROUNDING));
        let Some((stride, count)) = count.filter(|(_, count)| (1.0..MAX_CLIPS).contains(count)) else {
            return Ok(None);
        };
        let offset = self.number("templateActiveOffset")?.unwrap_or(0.0);
        let active = Active::Steps { start: start + offset, stride, count: count as usize };
        let times = [start - offset.abs(), end + offset.abs()].map(|time| [time; 2]);
        Ok(Some((opinion, Names::Steps { name, start, stride, times }, active)))
    }

    /// Opens a layer that an opinion names.
    fn layer(&mut self, opinion: &Opinion, name: Option<Text>) -> Result<Option<u32>, FormatError> {
        let at = self.layers.all[opinion.layer as usize].at(opinion.prim);
        let Some(name) = name.filter(|name| !name.is_empty()) else { return Ok(None) };
        match self.layers.locate(opinion.layer, &name, &at)? {
            Some(file) => self.layers.open(&file, &at),
            None => Ok(None),
        }
    }
}

impl Names {
    fn at(&self, index: usize) -> Option<Text> {
        match self {
            Names::Listed(names) => names.get(index).cloned(),
            Names::Steps { name, start, stride, .. } => {
                numbered(name, start + index as f64 * stride).map(Text::from)
            }
        }
    }
}

/// A name with a number in place of its `###`, or `##.##`, with as many digits at least; `None` without such a place.
fn numbered(name: &str, number: f64) -> Option<String> {
    let file = name.rfind('/').map_or(0, |slash| slash + 1);
    let (before, rest) = name.split_at(file + name[file..].find('#')?);
    let marks = |text: &str| text.bytes().take_while(|byte| *byte == b'#').count();
    let whole = marks(rest);
    let parts = rest[whole..].strip_prefix('.').map_or(0, marks);
    let rest = &rest[whole + if parts > 0 { parts + 1 } else { 0 }..];
    let width = if parts > 0 { whole + parts + 1 } else { whole };
    Some(format!("{before}{number:0width$.parts$}{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_the_place_of_marks() {
        let name = |name: &str, number: f64| numbered(name, number).unwrap_or_default();
        assert_eq!(name("a#/b.###.usd", 7.0), "a#/b.007.usd");
        assert_eq!(name("./b.#.usd", 1001.0), "./b.1001.usd");
        assert_eq!(name("b.##.##.usd", 1.25), "b.01.25.usd");
        assert_eq!(name("b.usd", 1.0), "");
    }
}
