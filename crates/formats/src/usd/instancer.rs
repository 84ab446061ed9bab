//! Many copies of a few prototypes.

use super::stage::Stage;
use super::value::Array;
use crate::FormatError;
use crate::budget::Budget;
use bilux_math::glam::DQuat;
use bilux_math::{DMat4, DVec3};
use std::collections::HashSet;
use std::sync::Arc;

/// Where the copies of a `PointInstancer` are.
pub(super) struct Copies {
    /// The prims that are copied.
    pub(super) prototypes: Vec<u32>,
    indices: Arc<Array>,
    positions: Arc<Array>,
    turns: Option<Arc<Array>>,
    scales: Option<Arc<Array>>,
    hidden: HashSet<u64>,
    ids: Option<Arc<Array>>,
}

impl Copies {
    pub(super) fn read(stage: &Stage, prim: u32, budget: &mut Budget) -> Result<Option<Copies>, FormatError> {
        let prototypes = stage.targets(prim, "prototypes");
        let prototypes = prototypes.iter().map(|path| stage.named(path).unwrap_or(0)).collect();
        let indices = stage.array(prim, "protoIndices", budget)?;
        let positions = stage.array(prim, "positions", budget)?;
        let (Some(indices), Some(positions)) = (indices, positions) else { return Ok(None) };
        let mut list = |name: &str| stage.array(prim, name, budget);
        let of = |list: &Array, i: usize| list.numbers.at(i).to_bits();
        let mut hidden = HashSet::new();
        for name in ["invisibleIds", "inactiveIds"] {
            if let Some(list) = list(name)? {
                hidden.extend((0..list.len()).map(|i| of(&list, i)));
            }
        }
        let turns = match list("orientationsf")? {
            Some(turns) if turns.len() > 0 => Some(turns),
            _ => list("orientations")?,
        };
        let copies = Copies {
            prototypes,
            indices,
            positions,
            turns,
            scales: list("scales")?,
            hidden,
            ids: list("ids")?,
        };
        Ok(Some(copies))
    }

    pub(super) fn len(&self) -> usize {
        self.indices.len().min(self.positions.len())
    }

    /// The prototype of a copy, and its place; `None` for one that is hidden.
    pub(super) fn copy(&self, i: usize) -> Option<(u32, DMat4)> {
        let id = match &self.ids {
            Some(ids) if i < ids.len() => ids.numbers.at(i),
            _ => i as f64,
        };
        if self.hidden.contains(&id.to_bits()) {
            return None;
        }
        let prototype = *self.prototypes.get(self.indices.numbers.at(i) as usize)?;
        let turn = match &self.turns {
            Some(list) if i < list.len() && list.width == 4 => {
                let turn = DQuat::from_array(list.tuple::<4>(i));
                if turn.length_squared() > 0.0 { turn.normalize() } else { DQuat::IDENTITY }
            }
            _ => DQuat::IDENTITY,
        };
        let scale = match &self.scales {
            Some(list) if i < list.len() => DVec3::from(list.tuple::<3>(i)),
            _ => DVec3::ONE,
        };
        let position = DVec3::from(self.positions.tuple::<3>(i));
        Some((prototype, DMat4::from_scale_rotation_translation(scale, turn, position)))
    }
}
