//! What OBJ and PLY files hold, and meshes made of it.

mod assemble;
mod faces;

pub(crate) use assemble::{assemble, material_of};
pub(crate) use faces::{FaceList, Steps};

use crate::FormatError;
use crate::normals::Smoothing;
use bilux_math::{Rgb, Vec2, Vec3};

/// An index that is not given.
pub(crate) const NONE: u32 = u32::MAX;

/// Position, texture coordinates and normal of a corner, as indices from 0; or [`NONE`].
pub(crate) type Corner = [u32; 3];

/// Faces over lists of positions, texture coordinates and normals, before they are cut into objects.
#[derive(Default)]
pub(crate) struct IndexedFaces {
    pub(crate) positions: Vec<Vec3>,
    /// As many as positions, or none.
    pub(crate) colours: Vec<Rgb>,
    /// The same for specular colours.
    pub(crate) specular: Vec<Rgb>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) faces: FaceList,
    /// Where in the file each face stands: in the words of whoever reads it, who turns them into a [`bilux_scene::Span`].
    pub(crate) places: Steps,
    /// Where the smoothing changes: the first face that has it.
    pub(crate) smoothing: Vec<(usize, Smoothing)>,
    pub(crate) runs: Vec<Run>,
    /// What the format calls its first vertex: 1 in OBJ, 0 elsewhere.
    pub(crate) first_vertex: u32,
    /// Faces that name vertices which do not exist are left out, with a warning.
    pub(crate) leaves_out: bool,
    /// The first that is wrong with an element that is left out: the error, where no face is left.
    pub(crate) first_fault: Option<FormatError>,
}

/// Faces one after another that have the same name and material.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) first_face: usize,
    pub(crate) name: String,
    /// The material's name and where it is asked for; `None` for a plain one.
    pub(crate) material: Option<(String, u64)>,
}

impl IndexedFaces {
    /// Says how the faces from here on join their neighbours.
    #[inline]
    pub(crate) fn smooth(&mut self, smoothing: Smoothing) {
        if self.smoothing.last().is_none_or(|(_, last)| *last != smoothing) {
            self.smoothing.push((self.faces.len(), smoothing));
        }
    }

    /// How each face joins its neighbours; one for all where all do it alike.
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
    pub(crate) fn material_name(&self) -> Option<&str> {
        self.material.as_ref().map(|(name, _)| name.as_str())
    }
}
