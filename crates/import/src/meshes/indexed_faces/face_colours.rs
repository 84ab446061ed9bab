//! Colours of faces, each distinct one once: vertices are shared by the faces of one colour only.

use super::corners::NONE;
use crate::geometry::colours::{Stored, decode};
use bilux_math::Rgb;
use std::collections::HashMap;

/// The size of a face's colour, with its entry in the table of distinct ones.
pub type FaceColour = [u32; 12];

/// The colours of faces, as far as they have any.
#[derive(Default)]
pub struct FaceColours {
    distinct: Vec<Rgb>,
    /// The index of each face's colour.
    of_faces: Vec<u32>,
    /// The index of each colour, by its bits.
    known: HashMap<[u32; 3], u32>,
}

impl FaceColours {
    pub fn is_empty(&self) -> bool {
        self.of_faces.is_empty()
    }

    /// Sets the colour of a face, which comes after all that have one.
    pub fn set(&mut self, face: usize, colour: Rgb) {
        let next = self.distinct.len() as u32;
        let index = *self.known.entry(colour.to_array().map(f32::to_bits)).or_insert(next);
        if index == next {
            self.distinct.push(colour);
        }
        self.of_faces.resize(face, NONE);
        self.of_faces.push(index);
    }

    /// Replaces stored colours by the reflectances that they mean.
    pub fn decode(&mut self, stored: Stored) {
        decode(&mut self.distinct, stored);
    }

    /// The index of a face's colour, or [`NONE`].
    #[inline]
    pub fn of(&self, face: usize) -> u32 {
        self.of_faces.get(face).copied().unwrap_or(NONE)
    }

    /// The colour with this index; white for a face without one.
    pub fn colour(&self, index: u32) -> Rgb {
        self.distinct.get(index as usize).copied().unwrap_or(Rgb::WHITE)
    }

    /// Sorts the faces: each is now that at an index of `order`.
    pub fn reorder(&mut self, order: &[usize]) {
        if !self.is_empty() {
            self.of_faces = order.iter().map(|&face| self.of(face)).collect();
        }
    }

    /// Forgets all colours.
    pub fn clear(&mut self) {
        *self = FaceColours::default();
    }
}
