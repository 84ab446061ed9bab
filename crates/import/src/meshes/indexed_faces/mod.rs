//! The data model that OBJ, PLY and OFF share, and its conversion to meshes.

mod assemble;
mod cage;
mod corners;
mod face_colours;
mod faces;

pub use assemble::{assemble, material_of};
pub use corners::{Corner, NONE};
pub use face_colours::{FaceColour, FaceColours};
pub use faces::{FaceList, Steps};

use crate::FormatError;
use crate::geometry::normals::Smoothing;
use bilux_math::{Rgb, Vec2, Vec3};

/// Faces with lists of positions, texture coordinates and normals, before they are split into objects.
#[derive(Default)]
pub struct IndexedFaces {
    pub positions: Vec<Vec3>,
    /// One per position, or none.
    pub colours: Vec<Rgb>,
    /// Specular colours: one per position, or none.
    pub specular: Vec<Rgb>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub faces: FaceList,
    pub face_colours: FaceColours,
    /// The location of each face in the file, as a number that the reader converts to a [`bilux_scene::Span`].
    pub places: Steps,
    /// Changes of smoothing: the first face that each applies to.
    pub smoothing: Vec<(usize, Smoothing)>,
    pub runs: Vec<Run>,
    /// The number of the first vertex in the format: 1 in OBJ, 0 elsewhere.
    pub first_vertex: u32,
    /// If true, faces that refer to missing vertices are left out with a warning.
    pub leaves_out: bool,
    /// The first fault of an element that was left out: the error if no face is left.
    pub first_fault: Option<FormatError>,
}

/// Consecutive faces with the same name and material.
#[derive(Clone, Debug)]
pub struct Run {
    pub first_face: usize,
    pub name: String,
    /// The material's name and where it is used; `None` for a plain one.
    pub material: Option<(String, u64)>,
}

impl IndexedFaces {
    /// True if vertices or faces have diffuse colours.
    pub fn has_colours(&self) -> bool {
        !self.colours.is_empty() || !self.face_colours.is_empty()
    }

    /// Sorts the faces by a number that each has, and returns the first face of each number. Faces of one number stay
    /// in their order; all faces share one smoothing.
    pub fn sort_by(&mut self, numbers: &[u32]) -> Vec<(usize, u32)> {
        let (mut corners, mut ends) = (Vec::with_capacity(self.faces.corner_count()), vec![0]);
        for face in std::mem::take(&mut self.faces).iter() {
            corners.extend_from_slice(face);
            ends.push(corners.len());
        }
        let mut order: Vec<usize> = (0..ends.len() - 1).collect();
        let number_of = |face: usize| numbers.get(face).copied().unwrap_or(NONE);
        order.sort_by_key(|&face| number_of(face));
        let places = std::mem::take(&mut self.places);
        let mut groups: Vec<(usize, u32)> = Vec::new();
        for (now, &face) in order.iter().enumerate() {
            self.faces.push(&corners[ends[face]..ends[face + 1]]);
            self.places.push(places.at(face));
            if groups.last().is_none_or(|(_, number)| *number != number_of(face)) {
                groups.push((now, number_of(face)));
            }
        }
        self.face_colours.reorder(&order);
        groups
    }

    /// Sets the smoothing of the following faces.
    #[inline]
    pub fn smooth(&mut self, smoothing: Smoothing) {
        if self.smoothing.last().is_none_or(|(_, last)| *last != smoothing) {
            self.smoothing.push((self.faces.len(), smoothing));
        }
    }

    /// The smoothing of each face; a single entry if all faces share it.
    fn smoothing_of_each(&self) -> Vec<Smoothing> {
        if let [(_, all)] = self.smoothing[..] {
            return vec![all];
        }
        let mut of_each = Vec::with_capacity(self.faces.len());
        let ends = self.smoothing.iter().skip(1).map(|(first, _)| *first).chain([self.faces.len()]);
        for ((_, smoothing), end) in self.smoothing.iter().zip(ends) {
            of_each.resize(end, *smoothing);
        }
        of_each
    }
}

impl Run {
    pub fn material_name(&self) -> Option<&str> {
        self.material.as_ref().map(|(name, _)| name.as_str())
    }
}
