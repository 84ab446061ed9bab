//! State that all connections share.

use crate::open_scene::OpenScene;
use crate::visitors::Visitors;
use std::sync::Arc;

/// The scene, those who watch it, and what they may do.
pub(super) struct Shared {
    pub(super) open: Arc<OpenScene>,
    pub(super) visitors: Arc<Visitors>,
    pub(super) catalogue: String,
    /// Whether files may be dropped in.
    pub(super) may_drop: bool,
    /// Files that are dropped in come one at a time: each may be large.
    pub(super) opening: tokio::sync::Mutex<()>,
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.open.end();
        self.visitors.end();
    }
}
