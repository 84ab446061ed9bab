//! Statements of layers about clips, and the layers of the clips themselves.

use super::turns::{Active, ClipSet, Clipped, MAX_REACH, ROUNDING};
use crate::composition::layers::Layers;
use crate::composition::node::{Node, Opinion};
use crate::layers::value::{Text, Value};
use bilux_import::FormatError;
use std::collections::BTreeMap;
use std::sync::Arc;

/// More clips are a mistake of a template.
const MAX_CLIPS: f64 = 1e6;

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
/// The number of opinions up to those of a place in some layers.
pub(super) fn stronger(node: &Node, (stack, path): &(u32, String)) -> Option<usize> {
    let (mut count, mut found) = (0, None);
    node.visit(&mut |node: &Node| {
        count += node.specs.len();
        if found.is_none() && node.site.stack == *stack && node.site.path == *path {
            found = Some(count);
        }
    });
    found
}
/// The entries of a set, by the opinions that have them.
pub(super) type Stated<'s> = Vec<(&'s Opinion, Vec<(Text, Value)>)>;

/// Reader of one set, from what several layers say of it.
pub(super) struct Reader<'s, 'l, 'r, 'o, 'b> {
    pub(super) stated: &'s Stated<'s>,
    pub(super) layers: &'l mut Layers<'r, 'o, 'b>,
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

    pub(super) fn read(mut self, node: &Node) -> Result<Option<Clipped>, FormatError> {
        let path = self.entry("primPath")?.and_then(|(_, value)| value.text().cloned());
        let (Some(path), Some((opinion, names, active))) = (path, self.names()?) else { return Ok(None) };
        let times = match names {
            Names::Listed(_) => self.pairs("times")?,
            Names::Steps { times, .. } => times.to_vec(),
        };
        let bridges = self.number("interpolateMissingClipValues")?.is_some_and(|is| is != 0.0);
        let manifest = match self.entry("manifestAssetPath")? {
            Some((opinion, value)) => self.layer(opinion, value.text().cloned())?,
            None => None,
        };
        let anchor = (opinion.site.stack, opinion.site.path.clone());
        let stronger = stronger(node, &anchor).unwrap_or_default();
        let number = self.layers.clip_sets;
        self.layers.clip_sets += 1;
        let opened = BTreeMap::new();
        let mut set = ClipSet { number, offset: opinion.offset, active, times, manifest, bridges, opened };
        for moment in self.layers.moments.clone() {
            let here = set.active.turn(set.offset.inverse(moment));
            for turn in [here, here + 1] {
                self.open(&mut set, opinion, &names, turn)?;
            }
            if bridges {
                self.reach(&mut set, opinion, (&names, &path), here)?;
            }
        }
        Ok(Some(Clipped { set: Arc::new(set), stronger, path, anchor }))
    }

    /// Opens the clip of a turn.
    fn open(
        &mut self,
        set: &mut ClipSet,
        opinion: &Opinion,
        names: &Names,
        turn: usize,
    ) -> Result<Option<u32>, FormatError> {
        let Some(clip) = set.active.clip(turn) else { return Ok(None) };
        if let Some(known) = set.opened.get(&clip) {
            return Ok(Some(*known));
        }
        let layer = self.layer(opinion, names.at(clip))?;
        set.opened.extend(layer.map(|layer| (clip, layer)));
        Ok(layer)
    }

    /// Opens clips before and after one, until all that the manifest leaves to clips has values on both sides; without a manifest,
    /// all that are near.
    fn reach(
        &mut self,
        set: &mut ClipSet,
        opinion: &Opinion,
        (names, path): (&Names, &str),
        here: usize,
    ) -> Result<(), FormatError> {
        for backwards in [true, false] {
            let mut wanted = match set.manifest {
                Some(manifest) => Some(self.left_to_clips(manifest, path)?),
                None => None,
            };
            for step in 0..=MAX_REACH {
                let turn = if backwards { here.checked_sub(step) } else { Some(here + 1 + step) };
                let Some(turn) = turn.filter(|turn| set.active.clip(*turn).is_some()) else { break };
                if step == MAX_REACH {
                    let at = self.layers.all[opinion.layer as usize].at(opinion.prim);
                    let what = "values of clips that are missing in more than 64 clips, or in clips without a manifest";
                    self.layers.diagnostics.not_shown(what, || at);
                    break;
                }
                let opened = self.open(set, opinion, names, turn)?;
                if let (Some(layer), Some(wanted)) = (opened, &mut wanted) {
                    let layer = &self.layers.all[layer as usize];
                    wanted.retain(|(path, name)| {
                        layer.property(path, name).is_none_or(|p| p.samples.is_none())
                    });
                    if wanted.is_empty() {
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    /// The attributes of a manifest without values, by the paths of their prims.
    fn left_to_clips(&mut self, manifest: u32, path: &str) -> Result<Vec<(String, Text)>, FormatError> {
        let file = &self.layers.all[manifest as usize];
        let mut waiting: Vec<(u32, String)> =
            file.named(path).map(|prim| (prim, path.to_owned())).into_iter().collect();
        let mut found = Vec::new();
        while let Some((prim, path)) = waiting.pop() {
            let spec = &file.prims[prim as usize];
            for property in spec.properties.iter().filter(|p| matches!(p.value, None | Some(Value::Blocked)))
            {
                let bytes = size_of::<(String, Text)>() + path.len();
                self.layers.reading.budget.take_bytes(bytes as u64, &file.name)?;
                found.push((path.clone(), property.name.clone()));
            }
            let below = |child: &u32| (*child, format!("{path}/{}", file.prims[*child as usize].name));
            waiting.extend(spec.children.iter().map(below));
        }
        Ok(found)
    }

    /// The layers of the clips, when each is in use, and what says so.
    fn names(&mut self) -> Result<Option<(&'s Opinion, Names, Active)>, FormatError> {
        if let Some((opinion, value)) = self.entry("assetPaths")? {
            let (names, mut active) = (value.texts(), self.pairs("active")?);
            // Of two at once, the second counts.
            active.dedup_by(|next, known| {
                next[0] == known[0] && {
                    *known = *next;
                    true
                }
            });
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
