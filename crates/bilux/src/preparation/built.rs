//! Parts of scenes that jobs have built, kept for the jobs that follow.

use bilux_scene::{BuiltParts, TreeWork};

/// The trees, materials and light tables of the last job, so that the next one, after an edit, does not build again
/// what did not change. Pictures are the same with it as without, byte for byte.
#[derive(Clone, Default)]
pub struct Built {
    /// The scene as it is shown.
    pub(crate) completed: BuiltParts,
    /// The scene without the studio, where its own light was measured. It is kept apart, so that the studio's ground
    /// does not split the tree of the scene that is shown.
    pub(crate) alone: BuiltParts,
}

impl Built {
    /// The trees that were built so far, for all jobs together.
    pub fn tree_work(&self) -> TreeWork {
        let [a, b] = [&self.completed, &self.alone].map(BuiltParts::tree_work);
        TreeWork { trees: a.trees + b.trees, triangles: a.triangles + b.triangles }
    }

    /// The number of parts that are kept.
    pub fn len(&self) -> usize {
        self.completed.len() + self.alone.len()
    }

    /// True before the first job.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Forgets the scene without the studio, if the last job had no use for it.
    pub(crate) fn keep_alone(&mut self, has_use: bool) {
        if !has_use {
            self.alone.clear();
        }
    }
}
