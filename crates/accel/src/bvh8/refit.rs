//! Moves triangles without a rebuild: the same tree, with its boxes and corners updated.

use super::Bvh8;
use super::layout::{
    BLOCK_UNITS, EMPTY, LANES, NO_TRIANGLE, NODE_UNITS, Planes, Ref, Unit, WIDTH, children, triangles,
    write_leaf, write_node,
};
use super::summary::TreeSummary;
use crate::bvh::tree::union;
use crate::mesh::TriangleMesh;

/// Why a tree cannot be refitted to a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RefitError {
    /// The triangles of the tree are not the finite triangles of the mesh.
    #[error(
        "triangle {0} is in the tree but is not a finite triangle of the mesh, or the reverse: build a new tree"
    )]
    OtherTriangles(u32),
    /// The boxes of cut triangles cannot be computed from the corners.
    #[error(
        "the tree was built with spatial splits (quality 'best') and cannot be refitted: build it with another \
             quality"
    )]
    Pieces,
}

impl Bvh8 {
    /// Refits the tree to triangles that have moved, in about a third of the time of a build on one thread. The
    /// further triangles have moved from their neighbours, the slower rays become.
    ///
    /// # Errors
    /// Returns an error when the finite triangles of the mesh are not the triangles of the tree, by number, or when
    /// the tree was built with [`Quality::Best`](crate::registry::Quality::Best) and has cut some. The tree is then
    /// unchanged.
    pub fn refit(&mut self, mesh: &TriangleMesh) -> Result<(), RefitError> {
        self.check(mesh)?;
        if !self.units.is_empty() {
            let root = self.outline.root;
            let planes = self.units.change(|units| fit(units, root, mesh.triangles()));
            self.outline = TreeSummary::new(root, planes);
        }
        Ok(())
    }

    fn check(&self, mesh: &TriangleMesh) -> Result<(), RefitError> {
        let mut is_in = vec![false; mesh.len()];
        let mut stack = if self.units.is_empty() { Vec::new() } else { vec![self.outline.root] };
        while let Some(reference) = stack.pop() {
            if reference.is_node() {
                stack.extend(children(&self.units[reference.unit()..]).map(|(_, child)| child));
                continue;
            }
            let blocks = self.units[reference.leaf_units()].chunks_exact(BLOCK_UNITS);
            for (_, primitive) in blocks.flat_map(triangles) {
                let place = is_in.get_mut(primitive as usize).ok_or(RefitError::OtherTriangles(primitive))?;
                if std::mem::replace(place, true) {
                    return Err(RefitError::Pieces);
                }
            }
        }
        let is_finite = |triangle: &[[f32; 3]; 3]| triangle.iter().flatten().all(|x| x.is_finite());
        let differ = |(triangle, &is_in): (&[[f32; 3]; 3], &bool)| is_finite(triangle) != is_in;
        match mesh.triangles().iter().zip(&is_in).position(differ) {
            Some(triangle) => Err(RefitError::OtherTriangles(triangle as u32)),
            None => Ok(()),
        }
    }
}

/// Refits a subtree and returns its box.
fn fit(units: &mut [Unit], reference: Ref, meshed: &[[[f32; 3]; 3]]) -> Planes {
    if !reference.is_node() {
        return fit_leaf(&mut units[reference.leaf_units()], meshed);
    }
    let mut fitted = [(EMPTY, Ref::EMPTY); WIDTH];
    let node = reference.unit()..reference.unit() + NODE_UNITS;
    for ((_, child), slot) in children(&units[node.clone()]).zip(&mut fitted) {
        slot.1 = child;
    }
    let mut whole = EMPTY;
    for (planes, child) in fitted.iter_mut().filter(|(_, child)| *child != Ref::EMPTY) {
        *planes = fit(units, *child, meshed);
        whole = union(&whole, planes);
    }
    write_node(&mut units[node], &fitted);
    whole
}

fn fit_leaf(units: &mut [Unit], meshed: &[[[f32; 3]; 3]]) -> Planes {
    let mut planes = EMPTY;
    for block in units.chunks_exact_mut(BLOCK_UNITS) {
        let mut moved = [([[0.0; 3]; 3], NO_TRIANGLE); LANES];
        let mut count = 0;
        for ((_, primitive), moved) in triangles(block).zip(&mut moved) {
            *moved = (meshed[primitive as usize], primitive);
            count += 1;
        }
        for point in moved[..count].iter().flat_map(|(corners, _)| corners) {
            planes = union(&planes, &[*point, *point]);
        }
        write_leaf(block, moved.into_iter().take(count));
    }
    planes
}
