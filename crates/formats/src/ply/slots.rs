//! The meaning of vertex properties.

use super::header::{Element, Property, Scalar};

/// The known meanings of vertex properties, with the names that programs use for them.
pub(super) const MEANINGS: [&[&str]; 14] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["u", "s", "texture_u", "texture_s"],
    &["v", "t", "texture_v", "texture_t"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["specular_red"],
    &["specular_green"],
    &["specular_blue"],
];

/// The meanings that a file's vertices have.
#[derive(Default)]
pub(super) struct Slots {
    /// The meaning of each property.
    pub(super) meaning: Vec<Option<usize>>,
    /// The values that mean 1 in diffuse and specular colours.
    pub(super) colour: [Option<f32>; 2],
    pub(super) normals: bool,
    pub(super) uvs: bool,
    pub(super) kd: bool,
    pub(super) ks: bool,
}

impl Slots {
    pub(super) fn new(element: &Element) -> Slots {
        let meaning_of = |p: &Property| {
            MEANINGS.iter().position(|names| names.contains(&p.name.as_str())).filter(|_| p.count.is_none())
        };
        let meaning: Vec<Option<usize>> = element.properties.iter().map(meaning_of).collect();
        let all = |slots: std::ops::Range<usize>| slots.into_iter().all(|slot| meaning.contains(&Some(slot)));
        let scale = |slot| {
            let property = meaning.iter().position(|&m| m == Some(slot));
            property.and_then(|p| element.properties[p].scalar.colour_scale())
        };
        let (normals, uvs, kd, ks) = (all(3..6), all(6..8), all(8..11), all(11..14));
        Slots { colour: [scale(8), scale(11)], normals, uvs, kd, ks, meaning }
    }

    /// The offset of each meaning in a binary row, and the row's length.
    ///
    /// `None` if any of them is not a 32-bit float, or if the row contains a list.
    pub(super) fn offsets(&self, element: &Element) -> Option<(Vec<(usize, usize)>, usize)> {
        let (mut offsets, mut at) = (Vec::new(), 0);
        for (property, meaning) in element.properties.iter().zip(&self.meaning) {
            if property.count.is_some() || (meaning.is_some() && property.scalar != Scalar::F32) {
                return None;
            }
            offsets.extend(meaning.map(|slot| (slot, at)));
            at += property.scalar.size();
        }
        Some((offsets, at))
    }
}
