//! Many copies of a few prototypes.

use crate::geometry::primvars::{Interpolation, Place, Primvar};
use crate::layers::value::{Array, Numbers};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_math::glam::DQuat;
use bilux_math::{DMat4, DVec3};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Copies of a `PointInstancer`, and where they are.
pub(crate) struct Copies {
    /// The prims that are copied.
    pub(crate) prototypes: Vec<u32>,
    indices: Arc<Array>,
    positions: Arc<Array>,
    turns: Option<Arc<Array>>,
    scales: Option<Arc<Array>>,
    hidden: HashSet<u64>,
    ids: Option<Arc<Array>>,
    /// `displayColor` and `displayOpacity`, if each copy has its own.
    looks: [Option<Primvar>; 2],
}

/// The bits of the colour and the opacity that a copy has, as if the root of its prototype were below a prim that states them.
/// [OpenUSD, UsdGeomPointInstancer]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Look([Option<[u32; 3]>; 2]);

impl Look {
    pub(crate) fn primvars(self) -> [Option<Primvar>; 2] {
        let constant = |bits: [u32; 3], width: usize| Primvar {
            values: Arc::new(Array {
                numbers: Numbers::Floats(bits[..width].iter().map(|x| f32::from_bits(*x)).collect()),
                width,
            }),
            indices: None,
            interpolation: Interpolation::Constant,
        };
        let [colour, opacity] = self.0;
        [colour.map(|bits| constant(bits, 3)), opacity.map(|bits| constant(bits, 1))]
    }
}

impl Copies {
    /// Memory of a copy in [`Copies::by_look`].
    pub(crate) const BYTES: u64 = (8 + 2 * size_of::<(Look, Vec<u32>, usize)>()) as u64;

    pub(crate) fn read(stage: &Stage, prim: u32, budget: &mut Budget) -> Result<Option<Copies>, FormatError> {
        let prototypes = stage.targets(prim, "prototypes");
        let prototypes = prototypes.iter().map(|path| stage.named(path).unwrap_or(0)).collect();
        let indices = stage.array(prim, "protoIndices", budget)?;
        let positions = stage.array(prim, "positions", budget)?;
        let (Some(indices), Some(positions)) = (indices, positions) else { return Ok(None) };
        let inactive = stage.numbers(prim, "inactiveIds", budget)?;
        let mut list = |name: &str| stage.array(prim, name, budget);
        let of = |list: &Array, i: usize| list.numbers.at(i).to_bits();
        let mut hidden = HashSet::new();
        if let Some(list) = list("invisibleIds")? {
            hidden.extend((0..list.len()).map(|i| of(&list, i)));
        }
        hidden.extend(inactive.iter().map(|&id| (id as f64).to_bits()));
        let turns = match list("orientationsf")? {
            Some(turns) if turns.len() > 0 => Some(turns),
            _ => list("orientations")?,
        };
        let [scales, ids] = [list("scales")?, list("ids")?];
        let mut looks = [None, None];
        for (slot, name) in looks.iter_mut().zip(["primvars:displayColor", "primvars:displayOpacity"]) {
            let found = Primvar::read(stage, prim, name, Interpolation::Constant, budget)?;
            // What is constant for all copies is inherited, as from any prim.
            *slot = found.filter(|primvar| primvar.interpolation != Interpolation::Constant);
        }
        let copies = Copies { prototypes, indices, positions, turns, scales, hidden, ids, looks };
        Ok(Some(copies))
    }

    pub(crate) fn len(&self) -> usize {
        self.indices.len().min(self.positions.len())
    }

    /// The numbers of the copies that are shown, by their looks, in the order of the first of each.
    pub(crate) fn by_look(&self) -> Vec<(Look, Vec<u32>)> {
        let mut groups: Vec<(Look, Vec<u32>)> = Vec::new();
        let mut known: HashMap<Look, usize> = HashMap::new();
        for i in (0..self.len()).filter(|i| !self.is_hidden(*i)) {
            let look = self.look(i);
            let group = *known.entry(look).or_insert_with(|| {
                groups.push((look, Vec::new()));
                groups.len() - 1
            });
            groups[group].1.push(i as u32);
        }
        groups
    }

    fn look(&self, i: usize) -> Look {
        // What is uniform is for all copies too.
        let place = Place { corner: i, vertex: i, face: 0 };
        let bits = |primvar: &Option<Primvar>, width: usize| {
            let primvar = primvar.as_ref().filter(|primvar| primvar.values.width == width)?;
            primvar.index(place).map(|at| {
                let mut values = primvar.values.floats::<3>(at);
                values[width..].fill(0.0);
                values.map(f32::to_bits)
            })
        };
        Look([bits(&self.looks[0], 3), bits(&self.looks[1], 1)])
    }

    /// The prim that a copy is of, if there is one.
    pub(crate) fn prototype(&self, i: usize) -> Option<u32> {
        let prototype = self.prototypes.get(self.indices.numbers.at(i) as usize).copied();
        prototype.filter(|prim| *prim != 0)
    }

    fn is_hidden(&self, i: usize) -> bool {
        let id = match &self.ids {
            Some(ids) if i < ids.len() => ids.numbers.at(i),
            _ => i as f64,
        };
        self.hidden.contains(&id.to_bits())
    }

    /// The prototype of a copy, and its place; `None` without a prototype.
    pub(crate) fn copy(&self, i: usize) -> Option<(u32, DMat4)> {
        let prototype = self.prototype(i)?;
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
