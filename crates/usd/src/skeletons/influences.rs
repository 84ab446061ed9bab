//! Which joints move which points.

use super::binding::{Binding, INDICES, JOINTS, SHAPE, WEIGHTS};
use super::skeleton::Pose;
use crate::layers::value::{Array, Text, Value};
use crate::stage::Stage;
use crate::stage::transforms;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::deformation::{Blends, DualBlends, DualJoint};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::DMat4;
use std::sync::Arc;

/// The joints of a prim, and their weights.
pub(super) struct Influences {
    indices: Arc<Array>,
    weights: Arc<Array>,
    /// Joints of a point, if the file says so.
    each: Option<usize>,
    /// Whether the same joints move all points; `None` if the file does not say.
    is_rigid: Option<bool>,
    /// The matrix of each index.
    joints: Vec<Option<DMat4>>,
    /// Transform of the points to where they are when they are bound.
    shape: DMat4,
    /// Blends dual quaternions, not matrices.
    is_dual: bool,
}

impl Influences {
    /// Influences on a prim; `None` if joints do not move it.
    pub(super) fn read(
        stage: &Stage,
        prim: u32,
        binding: &Binding,
        pose: &Pose,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<Influences>, FormatError> {
        let (Some(of_indices), Some(of_weights)) = (binding.indices, binding.weights) else {
            return Ok(None);
        };
        let indices = stage.array(of_indices, INDICES, budget)?;
        let weights = stage.array(of_weights, WEIGHTS, budget)?;
        let (Some(indices), Some(weights)) = (indices, weights) else { return Ok(None) };
        if pose.moved.is_empty() || indices.len() == 0 {
            return Ok(None);
        }
        if indices.len() != weights.len() {
            let what =
                "a skinned prim has not as many weights as joints: it keeps the shape that it was bound in";
            diagnostics.note(what, || stage.at(prim));
            return Ok(None);
        }
        let interpolation = stage.metadata(of_indices, INDICES, "interpolation");
        let is_rigid =
            interpolation.as_ref().and_then(Value::text).map(|interpolation| &**interpolation == "constant");
        let each = stage.metadata(of_indices, INDICES, "elementSize").and_then(|value| value.number());
        let each = each.map(|each| each.max(0.0) as usize).filter(|each| *each > 0);
        let mut order: Option<Arc<[Text]>> = None;
        if let Some(at) = binding.joints {
            order = stage.value(at, JOINTS, budget)?.and_then(|value| value.texts());
        }
        let joints: Vec<Option<DMat4>> = match order.filter(|order| !order.is_empty()) {
            Some(order) => order
                .iter()
                .map(|name| pose.joints.get(name).and_then(|joint| pose.moved.get(*joint).copied()))
                .collect(),
            None => pose.moved.iter().copied().map(Some).collect(),
        };
        let shape = match binding.shape {
            Some(at) => stage.value(at, SHAPE, budget)?.and_then(|value| transforms::matrix(&value)),
            None => None,
        };
        let shape = shape.unwrap_or(DMat4::IDENTITY);
        let method = stage.text(prim, "primvars:skel:skinningMethod", budget)?;
        let is_dual = method.is_some_and(|method| &*method == "dualQuaternion");
        Ok(Some(Influences { indices, weights, each, is_rigid, joints, shape, is_dual }))
    }

    /// Matrix of all points from the space of the prim to that of the skeleton, if they move alike.
    pub(super) fn rigid(&self) -> Option<DMat4> {
        let count = self.indices.len();
        let is_rigid = self.is_rigid.unwrap_or(count == self.each.unwrap_or(1));
        is_rigid.then(|| self.blended(1, count).unwrap_or_default()[0])
    }

    /// Matrix of each point from the space of the prim to that of the skeleton; `None` if the joints are not those of as
    /// many points.
    pub(super) fn of_points(&self, points: usize) -> Option<Vec<DMat4>> {
        let count = self.indices.len();
        let each = if self.is_rigid == Some(true) { 0 } else { self.each.unwrap_or(count / points.max(1)) };
        (each > 0 && each.checked_mul(points) == Some(count)).then(|| self.blended(points, each))?
    }

    /// The size of what it takes to move points.
    pub(super) fn bytes(&self, points: usize) -> u64 {
        if self.is_dual { DualBlends::bytes(points) } else { Blends::bytes(points) }
    }

    fn blended(&self, points: usize, each: usize) -> Option<Vec<DMat4>> {
        let weights = || {
            let joint = |at| self.indices.numbers.at(at) as usize;
            (0..points * each).map(move |at| (at / each, joint(at), self.weights.numbers.at(at)))
        };
        let mut matrices = if self.is_dual {
            let motion = |joint: &Option<DMat4>| joint.as_ref().map(DualJoint::of);
            let joints: Vec<Option<DualJoint>> = self.joints.iter().map(motion).collect();
            let mut blends = DualBlends::new(points);
            for (point, joint, weight) in weights() {
                if let Some(Some(joint)) = joints.get(joint) {
                    blends.add(point, joint, weight);
                }
            }
            blends.matrices(|_| DMat4::IDENTITY)
        } else {
            let mut blends = Blends::new(points);
            for (point, joint, weight) in weights() {
                if let Some(Some(joint)) = self.joints.get(joint) {
                    blends.add(point, joint, weight);
                }
            }
            blends.matrices(|_| DMat4::IDENTITY)
        };
        matrices.iter_mut().for_each(|matrix| *matrix *= self.shape);
        Some(matrices)
    }
}
