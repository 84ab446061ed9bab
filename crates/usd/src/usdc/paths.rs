//! Paths, which crate files store as a tree of names.

use super::bytes::Bytes;
use super::integers::integers;
use crate::layers::layer::MAX_DEPTH;
use crate::layers::value::Text;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// A path as its parent and its last name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    /// Index of the parent; for the root, its own index.
    pub(super) parent: u32,
    /// Index of a token: a name, or a chosen variant in braces.
    pub(super) name: u32,
    pub(super) is_property: bool,
    depth: u16,
}

/// All paths of a file.
#[derive(Debug, Default)]
pub(super) struct Paths(pub(super) Vec<Path>);

/// A path that no spec has.
const NOWHERE: Path = Path { parent: u32::MAX, name: 0, is_property: false, depth: 0 };

impl Paths {
    /// Reads the section of version 0.4 and later.
    pub(super) fn read(bytes: &mut Bytes, tokens: usize, budget: &mut Budget) -> Result<Paths, FormatError> {
        let count = bytes.u64()?;
        let encoded = bytes.u64()?;
        if encoded > count || count > u64::from(u32::MAX) {
            return Err(bytes.error("its paths are more than it says"));
        }
        // Each has at least two bits in its sections, packed up to 256 times.
        let left = (bytes.all.len() - bytes.at) as u64;
        if count / 1024 > left {
            return Err(bytes.error("it states more paths than it has bytes for"));
        }
        let encoded = encoded as usize;
        budget.take_bytes(count * size_of::<Path>() as u64, bytes.name)?;
        let indices = integers(bytes, encoded, budget)?;
        let names = integers(bytes, encoded, budget)?;
        let jumps = integers(bytes, encoded, budget)?;
        let mut paths = Paths(vec![NOWHERE; count as usize]);
        paths.link(&indices, &names, &jumps, tokens, bytes)?;
        budget.release(12 * encoded as u64);
        Ok(paths)
    }

    /// Turns the tree, which lists parents before children and says where siblings are, into links to parents.
    fn link(
        &mut self,
        indices: &[i32],
        names: &[i32],
        jumps: &[i32],
        tokens: usize,
        bytes: &Bytes,
    ) -> Result<(), FormatError> {
        let mut waiting: Vec<(usize, Option<u32>)> = Vec::new();
        let mut seen = 0;
        let (mut at, mut parent) = (0, None);
        while at < indices.len() {
            seen += 1;
            if seen > indices.len() {
                return Err(bytes.error("its paths form a circle"));
            }
            let index = indices[at] as u32;
            let name = names[at].unsigned_abs();
            let Some(path) = self.0.get(index as usize).copied() else {
                return Err(bytes.error("a path has a number beyond the last"));
            };
            if parent.is_some() && name as usize >= tokens || path.parent != u32::MAX {
                return Err(bytes.error("a path has a name that is not there, or occurs twice"));
            }
            let depth = parent.map_or(0, |parent: u32| self.0[parent as usize].depth + 1);
            if usize::from(depth) > 4 * MAX_DEPTH {
                return Err(bytes.error("prims are nested too deeply to be read"));
            }
            let own = Path { parent: parent.unwrap_or(index), name, is_property: names[at] < 0, depth };
            self.0[index as usize] = own;
            let jump = jumps[at];
            let (has_child, has_sibling) = (jump > 0 || jump == -1, jump >= 0);
            if has_child {
                if has_sibling {
                    waiting.push((at + jump as usize, parent));
                }
                (at, parent) = (at + 1, Some(index));
            } else if has_sibling {
                at += 1;
            } else {
                match waiting.pop() {
                    Some(next) => (at, parent) = next,
                    None => return Ok(()),
                }
            }
        }
        if indices.is_empty() { Ok(()) } else { Err(bytes.error("its paths end too early")) }
    }

    pub(super) fn find(&self, index: u32) -> Option<Path> {
        self.0.get(index as usize).copied().filter(|path| path.parent != u32::MAX)
    }

    /// A path as text, without the variants in it.
    pub(super) fn text(&self, index: u32, tokens: &[Text]) -> Option<Text> {
        let mut parts = Vec::new();
        let mut at = index;
        loop {
            let path = self.find(at)?;
            if path.parent == at {
                break;
            }
            let name: &str = tokens.get(path.name as usize)?;
            if !name.starts_with('{') {
                parts.push((if path.is_property { '.' } else { '/' }, name));
            }
            at = path.parent;
        }
        if parts.is_empty() {
            return Some(Text::from("/"));
        }
        let mut text = String::new();
        for (separator, name) in parts.into_iter().rev() {
            text.push(separator);
            text.push_str(name);
        }
        Some(text.into())
    }
}
