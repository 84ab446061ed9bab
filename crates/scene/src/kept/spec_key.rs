//! Keys of materials and lights: all that one is made from.

use super::Same;
use crate::grid::Grid;
use crate::parameters::intensity_distribution::IntensityDistribution;
use crate::parameters::{Spec, Value};
use crate::texture::Texture;
use std::sync::Arc;

/// A spec with everything that it refers to: numbers by their bits, textures by their addresses, other materials by
/// their own specs. Its place in the file and its name do not count.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
pub(crate) struct SpecKey {
    bytes: Vec<u8>,
    textures: Vec<Same<Texture>>,
    grids: Vec<Same<Grid>>,
    distributions: Vec<Same<IntensityDistribution>>,
}

/// Materials that refer to others more deeply than this are not compared.
const DEEPEST: usize = 32;
/// Nor are specs that take more bytes than this to write down, such as mixes of mixes of mixes.
const LONGEST: usize = 1 << 16;

impl SpecKey {
    /// The key of a spec in a scene with these textures and materials; `None` where it refers to one that there is
    /// not, or to too many.
    pub(crate) fn of(spec: &Spec, textures: &[Arc<Texture>], materials: &[Spec]) -> Option<SpecKey> {
        let mut key = SpecKey::default();
        key.push_spec(spec, textures, materials, 0)?;
        Some(key)
    }

    fn push_spec(
        &mut self,
        spec: &Spec,
        textures: &[Arc<Texture>],
        materials: &[Spec],
        depth: usize,
    ) -> Option<()> {
        if depth > DEEPEST || self.bytes.len() > LONGEST {
            return None;
        }
        self.push_text(&spec.kind);
        self.push_number(spec.parameters.0.len() as u64);
        for (name, value, _) in &spec.parameters.0 {
            self.push_text(name);
            self.push_value(value, textures, materials, depth)?;
        }
        Some(())
    }

    fn push_value(
        &mut self,
        value: &Value,
        textures: &[Arc<Texture>],
        materials: &[Spec],
        depth: usize,
    ) -> Option<()> {
        self.bytes.push(match value {
            Value::Bool(_) => 0,
            Value::Integer(_) => 1,
            Value::Number(_) => 2,
            Value::Text(_) => 3,
            Value::List(_) => 4,
            Value::Texture(_) => 5,
            Value::Material(_) => 6,
            Value::Grid(_) => 7,
            Value::Distribution(_) => 8,
        });
        match value {
            Value::Bool(yes) => self.bytes.push(u8::from(*yes)),
            Value::Integer(i) => self.push_number(*i as u64),
            Value::Number(x) => self.push_number(x.to_bits()),
            Value::Text(text) => self.push_text(text),
            Value::List(list) => {
                self.push_number(list.len() as u64);
                for value in list {
                    self.push_value(value, textures, materials, depth)?;
                }
            }
            Value::Grid(grid) => self.grids.push(Same(grid.clone())),
            Value::Distribution(distribution) => self.distributions.push(Same(distribution.clone())),
            Value::Texture(index) => self.textures.push(Same(textures.get(*index)?.clone())),
            Value::Material(index) => {
                self.push_spec(materials.get(*index)?, textures, materials, depth + 1)?;
            }
        }
        Some(())
    }

    fn push_number(&mut self, bits: u64) {
        self.bytes.extend(bits.to_le_bytes());
    }

    fn push_text(&mut self, text: &str) {
        self.push_number(text.len() as u64);
        self.bytes.extend(text.as_bytes());
    }
}
