//! Bindings of prims below a `SkelRoot`.

use crate::stage::Stage;
use bilux_math::DMat4;

/// Binding of a prim, by itself or by those above it: the prims that state each part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Binding {
    /// The `SkelRoot`, outside of which nothing is bound, and where it is.
    pub(super) root: u32,
    pub(super) root_world: DMat4,
    /// The skeleton itself.
    pub(crate) skeleton: Option<u32>,
    pub(super) joints: Option<u32>,
    pub(super) indices: Option<u32>,
    pub(super) weights: Option<u32>,
    pub(super) shape: Option<u32>,
}

pub(super) const JOINTS: &str = "skel:joints";
pub(super) const INDICES: &str = "primvars:skel:jointIndices";
pub(super) const WEIGHTS: &str = "primvars:skel:jointWeights";
pub(super) const SHAPE: &str = "primvars:skel:geomBindTransform";

impl Binding {
    /// The binding of a prim, given that of the one above it.
    pub(crate) fn of(stage: &Stage, prim: u32, world: &DMat4, above: Option<Binding>) -> Option<Binding> {
        let is_root = &*stage.prim(prim).type_name == "SkelRoot";
        let own = Binding {
            root: prim,
            root_world: *world,
            skeleton: None,
            joints: None,
            indices: None,
            weights: None,
            shape: None,
        };
        let above = above.or(is_root.then_some(own))?;
        let stated = |name: &str, inherited: Option<u32>| {
            if stage.states(prim, name) { Some(prim) } else { inherited }
        };
        let skeleton = match stage.states(prim, "skel:skeleton") {
            true => stage.targets(prim, "skel:skeleton").first().and_then(|path| stage.named(path)),
            false => above.skeleton,
        };
        Some(Binding {
            skeleton: skeleton.filter(|skeleton| &*stage.prim(*skeleton).type_name == "Skeleton"),
            joints: stated(JOINTS, above.joints),
            indices: stated(INDICES, above.indices),
            weights: stated(WEIGHTS, above.weights),
            shape: stated(SHAPE, above.shape),
            ..above
        })
    }
}
