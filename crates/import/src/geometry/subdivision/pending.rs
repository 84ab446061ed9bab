//! A cage that waits until the whole scene is known, so that it can be as fine as its pictures need.

use super::cage::Cage;
use bilux_scene::{Mesh, Span};
use std::sync::Arc;

/// A cage, and the meshes that stand for it in objects until it is refined: one for each of its groups.
pub struct PendingCage {
    pub cage: Cage,
    pub stand_ins: Vec<Arc<Mesh>>,
    pub at: Span,
}

impl PendingCage {
    /// A cage with a name for each group, for which objects have [`PendingCage::mesh`] for now.
    pub fn new(cage: Cage, names: impl IntoIterator<Item = String>, at: Span) -> PendingCage {
        let stand_in = |name| Arc::new(Mesh { name, ..Mesh::default() });
        PendingCage { cage, stand_ins: names.into_iter().map(stand_in).collect(), at }
    }

    /// The mesh of a group.
    pub fn mesh(&self, group: usize) -> &Arc<Mesh> {
        &self.stand_ins[group]
    }
}
