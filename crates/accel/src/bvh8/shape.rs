//! The statistics of a tree.

use super::kernel::{NodeFormat, TreeView};
use super::layout::{LANES, Ref, WIDTH};
use crate::accelerator::TreeShape;

/// The nodes and leaves of a tree, whatever its layout.
pub(super) fn shape<F: NodeFormat>(view: Option<TreeView>) -> TreeShape {
    let mut shape = TreeShape::default();
    let Some(TreeView { units, outline }) = view else { return shape };
    let mut stack = vec![(outline.root, 1)];
    while let Some((reference, depth)) = stack.pop() {
        if reference.is_node() {
            shape.nodes += 1;
            let children = (0..WIDTH).map(|k| F::child(&units[reference.unit()..], k).1);
            stack.extend(children.filter(|child| *child != Ref::EMPTY).map(|child| (child, depth + 1)));
        } else {
            shape.add_leaf(depth, reference.blocks() * LANES);
        }
    }
    shape
}
