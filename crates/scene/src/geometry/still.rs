//! The triangles that do not move, in world space, numbered one object after the other.
//!
//! All are in one tree at first. Objects that are placed anew, or added, get trees of their own, so that the others
//! keep theirs: the answers are those of one tree (see [`Forest`]).

use super::object_trees::{ObjectTrees, StillKey, TreeWork, failed, tree};
use crate::geometry::accel_choice::AccelChoice;
use crate::geometry::corners::world_corners;
use crate::messages::error::SceneError;
use bilux_accel::{Accelerator, Forest, TriangleMesh};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// With more trees of single objects than this, all triangles are joined again: rays visit the trees one by one.
const MAX_TREES: usize = 64;

/// The triangles that do not move.
#[derive(Clone)]
pub(super) struct Still {
    /// The objects, in order.
    keys: Vec<StillKey>,
    /// All their triangles.
    pub(super) mesh: Arc<TriangleMesh>,
    /// For each triangle, the index of its object among these.
    pub(super) owners: Arc<[u32]>,
    /// The tree over all of them.
    pub(super) tree: Arc<dyn Accelerator>,
    /// The objects whose triangles are in one tree, in order, and that tree.
    joined: (Vec<StillKey>, Arc<dyn Accelerator>),
}

/// The triangles of each object.
type Ranges = [Range<u32>];

impl Still {
    /// The triangles of these objects, with those of the last build; `None` if there are none.
    pub(super) fn build(
        keys: Vec<StillKey>,
        last: Option<Still>,
        trees: &mut ObjectTrees,
        accel: &AccelChoice,
    ) -> Result<Option<Still>, SceneError> {
        if let Some(same) = last.as_ref().filter(|last| last.keys == keys) {
            // Trees of single objects are in use as long as the forest is.
            same.mark_used(trees);
            return Ok(last);
        }
        let mut end = 0usize;
        let mut ranges = Vec::with_capacity(keys.len());
        for (mesh, _) in &keys {
            let start = end;
            end += mesh.0.triangles.len();
            ranges.push(start as u32..end as u32);
        }
        if end == 0 {
            return Ok(None);
        }
        let corners = baked(&keys, last.as_ref(), end);
        let mesh = TriangleMesh::from_corners(corners).and_then(|m| m.with_groups(ranges.clone()));
        let mesh = Arc::new(mesh.map_err(|e| failed(&e))?);
        let owner = |(i, range): (usize, &Range<u32>)| std::iter::repeat_n(i as u32, range.len());
        let owners = ranges.iter().enumerate().flat_map(owner).collect();
        let (tree, joined) = match last.and_then(|last| last.kept_apart(&keys, &ranges)) {
            Some(apart) => apart.build(&keys, &ranges, &mesh, trees, accel)?,
            None => {
                let tree = tree(mesh.clone(), accel, &mut trees.work)?;
                (tree.clone(), (keys.clone(), tree))
            }
        };
        Ok(Some(Still { keys, mesh, owners, tree, joined }))
    }

    /// Which objects stay in the joined tree; `None` where all are best joined anew.
    fn kept_apart(self, keys: &[StillKey], ranges: &Ranges) -> Option<Apart> {
        let (members, tree) = self.joined;
        let mut is_joined = vec![false; keys.len()];
        let mut rest = members.iter();
        let mut next = rest.next();
        for (key, is_joined) in keys.iter().zip(&mut is_joined) {
            if next.is_some_and(|next| next == key) {
                *is_joined = true;
                next = rest.next();
            }
        }
        let tree = if next.is_none() {
            Some(tree)
        } else {
            // Some are gone: the others need a new tree.
            let mut left: HashMap<&StillKey, usize> = HashMap::new();
            members.iter().for_each(|key| *left.entry(key).or_default() += 1);
            for (key, is_joined) in keys.iter().zip(&mut is_joined) {
                *is_joined =
                    left.get_mut(key).is_some_and(|left| std::mem::replace(left, left.saturating_sub(1)) > 0);
            }
            None
        };
        let triangles = |joined: bool| -> usize {
            let of = is_joined.iter().zip(ranges).filter(|(is_joined, _)| **is_joined == joined);
            of.map(|(_, range)| range.len()).sum()
        };
        let alone =
            is_joined.iter().zip(ranges).filter(|(joined, range)| !**joined && !range.is_empty()).count();
        let is_worthwhile = alone <= MAX_TREES && triangles(true) >= triangles(false);
        is_worthwhile.then_some(Apart { is_joined, tree })
    }

    /// Marks the trees of single objects as used by this build.
    fn mark_used(&self, trees: &mut ObjectTrees) {
        let mut joined = self.joined.0.iter().peekable();
        for key in &self.keys {
            if joined.next_if(|next| *next == key).is_none() {
                trees.kept.touch(key);
            }
        }
    }
}

/// Some objects in one tree, the others in trees of their own.
struct Apart {
    is_joined: Vec<bool>,
    /// The joined tree, if it is the last build's.
    tree: Option<Arc<dyn Accelerator>>,
}

/// The tree over all triangles, and the joined one with its objects.
type Built = (Arc<dyn Accelerator>, (Vec<StillKey>, Arc<dyn Accelerator>));

impl Apart {
    fn build(
        self,
        keys: &[StillKey],
        ranges: &Ranges,
        mesh: &TriangleMesh,
        trees: &mut ObjectTrees,
        accel: &AccelChoice,
    ) -> Result<Built, SceneError> {
        let part = |chosen: &[Range<u32>], work: &mut TreeWork| {
            let corners = |range: &Range<u32>| &mesh.triangles()[range.start as usize..range.end as usize];
            let mut groups = Vec::with_capacity(chosen.len());
            let mut end = 0;
            for range in chosen {
                groups.push(end..end + range.len() as u32);
                end += range.len() as u32;
            }
            let corners = chosen.iter().flat_map(corners).copied().collect();
            let part = TriangleMesh::from_corners(corners).and_then(|part| part.with_groups(groups));
            tree(Arc::new(part.map_err(|e| failed(&e))?), accel, work)
        };
        let of = |joined: bool| {
            let all = self.is_joined.iter().zip(keys.iter().zip(ranges));
            all.filter(move |(is_joined, _)| **is_joined == joined).map(|(_, object)| object)
        };
        let (members, joined_ranges): (Vec<StillKey>, Vec<Range<u32>>) =
            of(true).map(|(key, range)| (key.clone(), range.clone())).unzip();
        let joined = match &self.tree {
            Some(tree) => tree.clone(),
            None => part(&joined_ranges, &mut trees.work)?,
        };
        let mut all = vec![(joined.clone(), joined_ranges)];
        for (key, range) in of(false).filter(|(_, range)| !range.is_empty()) {
            let ObjectTrees { kept, work } = &mut *trees;
            let own = std::slice::from_ref(range);
            all.push((kept.or_make(key.clone(), || part(own, work))?, own.to_vec()));
        }
        let whole: Arc<dyn Accelerator> =
            if all.len() == 1 { joined.clone() } else { Arc::new(Forest::new(all)) };
        Ok((whole, (members, joined)))
    }
}

/// The corners of all triangles in world space; those that the last build computed are copied.
fn baked(keys: &[StillKey], last: Option<&Still>, count: usize) -> Vec<[[f32; 3]; 3]> {
    let mut known = HashMap::new();
    if let Some(last) = last {
        let mut start = 0;
        for key in &last.keys {
            let end = start + key.0.0.triangles.len();
            known.insert(key, &last.mesh.triangles()[start..end]);
            start = end;
        }
    }
    let mut corners = Vec::with_capacity(count);
    for key in keys {
        match known.get(key) {
            Some(known) => corners.extend_from_slice(known),
            None => corners.extend(world_corners(&key.0.0, key.1.transform())),
        }
    }
    corners
}
