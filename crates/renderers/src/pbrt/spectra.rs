//! The spectra that have names.

use bilux_import::appearance::spectra::colours::of_chromaticity;
use bilux_math::Rgb;
use bilux_scene::materials::glass_indices;

/// Named illuminants with their chromaticities. [CIE 15; SMPTE 2065]
const LIGHTS: &[(&str, [f64; 2])] = &[
    ("stdillum-A", [0.44758, 0.40745]),
    ("stdillum-D50", [0.34567, 0.35850]),
    ("stdillum-D65", [0.3127, 0.3290]),
    ("stdillum-F1", [0.31310, 0.33727]),
    ("stdillum-F2", [0.37208, 0.37529]),
    ("stdillum-F3", [0.40910, 0.39430]),
    ("stdillum-F4", [0.44018, 0.40329]),
    ("stdillum-F5", [0.31379, 0.34531]),
    ("stdillum-F6", [0.37790, 0.38835]),
    ("stdillum-F7", [0.31292, 0.32933]),
    ("stdillum-F8", [0.34588, 0.35875]),
    ("stdillum-F9", [0.37417, 0.37281]),
    ("stdillum-F10", [0.34609, 0.35986]),
    ("stdillum-F11", [0.38052, 0.37713]),
    ("stdillum-F12", [0.43695, 0.40441]),
    ("illum-acesD60", [0.32168, 0.33767]),
];

/// Named glasses, and their names in the table of Bilux.
pub(super) const GLASSES: &[(&str, &str)] = &[
    ("glass-BK7", "bk7"),
    ("glass-BAF10", "baf10"),
    ("glass-FK51A", "fk51a"),
    ("glass-LASF9", "lasf9"),
    ("glass-F5", "sf5"),
    ("glass-F10", "sf10"),
    ("glass-F11", "sf11"),
];

/// Name prefixes of metals, and their names in the table of Bilux.
const METALS: &[(&str, &str)] = &[
    ("metal-Ag", "silver"),
    ("metal-Al", "aluminium"),
    ("metal-Au", "gold"),
    ("metal-Cu", "copper"),
    ("metal-CuZn", "brass"),
];

/// Oxides with names that begin with `metal-`, and their indices of refraction; they have no extinction. [DeVore
/// 1951; Stephens 1952]
const OXIDES: &[(&str, f32)] = &[("metal-MgO", 1.737), ("metal-TiO2", 2.613)];

/// A named spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Named {
    /// The colour of an illuminant with luminance 1.
    Light(Rgb),
    /// An index of refraction at 587.6 nm, and the Abbe number.
    Glass { index: f32, abbe_number: f32 },
    /// The index of refraction, or the extinction, of a metal in the table of Bilux.
    Metal { metal: &'static str, is_extinction: bool },
    /// A constant spectrum.
    Even(f32),
}

/// The spectrum with this name.
pub(super) fn named(name: &str) -> Option<Named> {
    if let Some((_, xy)) = LIGHTS.iter().find(|(known, _)| *known == name) {
        return Some(Named::Light(of_chromaticity(*xy)));
    }
    let glass = GLASSES.iter().find(|(known, _)| *known == name);
    if let Some((index, abbe_number)) = glass.and_then(|(_, ours)| glass_indices(ours)) {
        return Some(Named::Glass { index, abbe_number });
    }
    let (element, part) = name.rsplit_once('-')?;
    let is_extinction = match part {
        "eta" => false,
        "k" => true,
        _ => return None,
    };
    let metal = METALS.iter().find(|(known, _)| *known == element);
    let metal = metal.map(|(_, metal)| Named::Metal { metal, is_extinction });
    let oxide = || OXIDES.iter().find(|(known, _)| *known == element);
    metal.or_else(|| oxide().map(|(_, index)| Named::Even(if is_extinction { 0.0 } else { *index })))
}

/// All names, for messages.
pub(super) fn names() -> impl Iterator<Item = String> {
    let metals = METALS.iter().map(|(name, _)| name).chain(OXIDES.iter().map(|(name, _)| name));
    let metals = metals.flat_map(|name| ["eta", "k"].map(|part| format!("{name}-{part}")));
    let others = LIGHTS.iter().map(|(name, _)| *name).chain(GLASSES.iter().map(|(name, ..)| *name));
    others.map(str::to_owned).chain(metals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_metals_and_glasses() {
        assert_eq!(named("metal-CuZn-k"), Some(Named::Metal { metal: "brass", is_extinction: true }));
        assert_eq!(named("glass-BK7"), Some(Named::Glass { index: 1.5168, abbe_number: 64.17 }));
        assert_eq!(named("metal-Cu"), None);
        assert!(names().all(|name| named(&name).is_some()));
        let Some(Named::Light(white)) = named("stdillum-D65") else { panic!() };
        assert!((0..3).all(|i| (white[i] - 1.0).abs() < 5e-3), "{white:?}");
    }
}
