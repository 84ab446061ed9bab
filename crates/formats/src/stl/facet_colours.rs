//! Colours in the two bytes after each triangle of a binary STL, by the two conventions that there are: that of VisCAM
//! and SolidView, and that of Materialise Magics.

use crate::colours::{decoded, five_bits};
use crate::oddities::Oddities;
use bilux_math::Rgb;
use bilux_scene::Span;

/// The highest bit: for VisCAM the triangle has a colour, for Magics it has that of the whole.
const FLAG: u16 = 1 << 15;

/// The colours of a solid's triangles.
pub(super) enum FacetColours {
    /// None.
    None {
        /// Whether the two bytes hold something else.
        has_data: bool,
    },
    /// Blue in the lowest bits; valid where the highest bit is set.
    VisCam,
    /// Red in the lowest bits, unless the highest bit is set or no triangle has a colour of its own.
    Magics {
        /// The colour of the whole, after `COLOR=` in the header.
        whole: Rgb,
        has_own: bool,
        /// Whether the header has more: opacity, or other colours than diffuse.
        has_more: bool,
    },
}

impl FacetColours {
    pub(super) fn of(header: &[u8], mut attributes: impl Iterator<Item = u16> + Clone) -> FacetColours {
        let after = |key: &[u8]| {
            let at = header.windows(key.len()).position(|word| word == key)?;
            header.get(at + key.len()..)?.first_chunk::<4>().copied()
        };
        let (colour, material) = (after(b"COLOR="), after(b"MATERIAL="));
        if let Some([r, g, b, alpha]) = colour.or(material) {
            let whole = decoded(Rgb::from_array([r, g, b].map(f32::from)), 255.0);
            let has_own = attributes.any(|attribute| attribute != 0);
            return FacetColours::Magics { whole, has_own, has_more: material.is_some() || alpha != 255 };
        }
        let (is_coloured, has_data) =
            attributes.fold((false, false), |(flag, any), a| (flag || a & FLAG != 0, any || a != 0));
        if is_coloured { FacetColours::VisCam } else { FacetColours::None { has_data } }
    }

    pub(super) fn are_there(&self) -> bool {
        !matches!(self, FacetColours::None { .. })
    }

    /// The reflectance of a triangle with these two bytes.
    pub(super) fn at(&self, attribute: u16) -> Rgb {
        let [low, middle, high] = five_bits(attribute);
        let own = |red, blue| decoded(Rgb::new(red, middle, blue), 31.0);
        match self {
            FacetColours::VisCam if attribute & FLAG != 0 => own(high, low),
            FacetColours::Magics { has_own: true, .. } if attribute & FLAG == 0 => own(low, high),
            FacetColours::Magics { whole, .. } => *whole,
            _ => Rgb::WHITE,
        }
    }

    /// Names what is not shown.
    pub(super) fn report(&self, oddities: &mut Oddities, at: impl FnOnce() -> Span) {
        match self {
            FacetColours::None { has_data: true } => oddities.not_used("two bytes after each triangle", at),
            FacetColours::Magics { has_more: true, .. } => {
                oddities.not_shown("the opacity and the material of the header's COLOR= and MATERIAL=", at);
            }
            _ => {}
        }
    }
}
