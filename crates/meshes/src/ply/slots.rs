//! The meaning of vertex properties.

use super::header::{Element, Property, Scalar};
use bilux_import::geometry::colours::Stored;

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
pub(super) struct Slots {
    /// The meaning of each property.
    pub(super) meaning: Vec<Option<usize>>,
    /// Stored forms of diffuse and specular colours.
    pub(super) stored: [Stored; 2],
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
        let stored = |slot| {
            let property = meaning.iter().position(|&m| m == Some(slot));
            property.map_or(Stored::Numbers, |p| element.properties[p].scalar.stored())
        };
        let (normals, uvs, kd, ks) = (all(3..6), all(6..8), all(8..11), all(11..14));
        Slots { stored: [stored(8), stored(11)], normals, uvs, kd, ks, meaning }
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

/// The properties of faces that show, apart from lists.
pub(super) struct FaceSlots {
    /// The properties that are red, green and blue.
    pub(super) colour: Option<[usize; 3]>,
    /// Stored form of the colour.
    pub(super) stored: Option<Stored>,
    /// The property that is the number of the texture.
    pub(super) texture: Option<usize>,
    strips: bool,
}

/// True for the list of a face's vertices, by its two names.
pub(super) fn lists_vertices(property: &Property) -> bool {
    property.count.is_some() && matches!(&*property.name, "vertex_indices" | "vertex_index")
}

/// True for the list of the texture coordinates of a face's corners.
pub(super) fn lists_uvs(property: &Property) -> bool {
    property.count.is_some() && property.name == "texcoord"
}

impl FaceSlots {
    pub(super) fn of(element: &Element, strips: bool) -> FaceSlots {
        let find = |names: &[&str]| {
            element.properties.iter().position(|p| p.count.is_none() && names.contains(&&*p.name))
        };
        let channels = [8, 9, 10].map(|slot| find(MEANINGS[slot]));
        let colour = match channels {
            [Some(r), Some(g), Some(b)] if !strips => Some([r, g, b]),
            _ => None,
        };
        let stored = colour.map(|[r, ..]| element.properties[r].scalar.stored());
        let texture = find(&["texnumber", "texture_index"]).filter(|_| !strips);
        FaceSlots { colour, stored, texture, strips }
    }

    /// The channel of a property.
    #[inline]
    pub(super) fn channel(&self, property: usize) -> Option<usize> {
        self.colour?.iter().position(|&p| p == property)
    }

    /// True if the property shows.
    pub(super) fn uses(&self, index: usize, property: &Property) -> bool {
        self.channel(index).is_some()
            || self.texture == Some(index)
            || lists_vertices(property)
            || (lists_uvs(property) && !self.strips)
    }
}
