//! Colours in the two bytes after each triangle of a binary STL, by the two conventions that there are: that of VisCAM
//! and SolidView, and that of Materialise Magics.

use bilux_import::geometry::colours::decoded;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::Rgb;
use bilux_scene::Span;

/// The highest bit: for VisCAM the triangle has a colour, for Magics it has that of the whole.
const FLAG: u16 = 1 << 15;

/// The colours of a solid's triangles.
pub(super) struct FacetColours {
    convention: Convention,
    /// The reflectance that each of 32 levels means.
    levels: [f32; 32],
}

enum Convention {
    /// There are no colours.
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
    pub(super) fn of(header: &[u8], attributes: impl Iterator<Item = u16>) -> FacetColours {
        let levels = std::array::from_fn(|level| decoded(Rgb::grey(level as f32), 31.0).r);
        FacetColours { convention: Convention::of(header, attributes), levels }
    }

    pub(super) fn are_there(&self) -> bool {
        !matches!(self.convention, Convention::None { .. })
    }

    /// The reflectance of a triangle with these two bytes.
    pub(super) fn at(&self, attribute: u16) -> Rgb {
        let level = |shift: u16| self.levels[usize::from(attribute >> shift & 31)];
        match self.convention {
            Convention::VisCam if attribute & FLAG != 0 => Rgb::new(level(10), level(5), level(0)),
            Convention::Magics { has_own: true, .. } if attribute & FLAG == 0 => {
                Rgb::new(level(0), level(5), level(10))
            }
            Convention::Magics { whole, .. } => whole,
            _ => Rgb::WHITE,
        }
    }

    /// Names what is not shown.
    pub(super) fn report(&self, diagnostics: &mut Diagnostics, at: impl FnOnce() -> Span) {
        match self.convention {
            Convention::None { has_data: true } => diagnostics.not_used("two bytes after each triangle", at),
            Convention::Magics { has_more: true, .. } => {
                diagnostics
                    .not_shown("the opacity and the material of the header's COLOR= and MATERIAL=", at);
            }
            _ => {}
        }
    }
}

impl Convention {
    fn of(header: &[u8], mut attributes: impl Iterator<Item = u16>) -> Convention {
        let after = |key: &[u8]| {
            let at = header.windows(key.len()).position(|word| word == key)?;
            header.get(at + key.len()..)?.first_chunk::<4>().copied()
        };
        let (colour, material) = (after(b"COLOR="), after(b"MATERIAL="));
        if let Some([r, g, b, alpha]) = colour.or(material) {
            let whole = decoded(Rgb::from_array([r, g, b].map(f32::from)), 255.0);
            let has_own = attributes.any(|attribute| attribute != 0);
            return Convention::Magics { whole, has_own, has_more: material.is_some() || alpha != 255 };
        }
        let (is_coloured, has_data) =
            attributes.fold((false, false), |(flag, any), a| (flag || a & FLAG != 0, any || a != 0));
        if is_coloured { Convention::VisCam } else { Convention::None { has_data } }
    }
}
