//! Participating media that are the same everywhere.

use super::parameters::ParameterList;
use super::reader::Pbrt;
use super::texture_or_value::SpectrumType;
use super::unknown;
use crate::FormatError;
use bilux_math::Rgb;
use bilux_scene::{Span, Spec};
use std::sync::Arc;

/// The supported properties of a medium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Medium {
    /// Absorption per unit of length.
    pub(super) absorption: Rgb,
    /// Scattering per unit of length.
    pub(super) scattering: Rgb,
    /// The mean cosine of Henyey and Greenstein's phase function.
    pub(super) anisotropy: f32,
}

impl Medium {
    /// True when it changes nothing.
    pub(super) fn is_clear(&self) -> bool {
        self.absorption.is_black() && self.scattering.is_black()
    }

    /// Sets the parameters of a material that it fills.
    pub(super) fn fill(&self, spec: &mut Spec) {
        spec.parameters.set("absorption", self.absorption.clamp(0.0, 1e6));
        if !self.scattering.is_black() {
            spec.parameters.set("scattering", self.scattering.clamp(0.0, 1e6));
            spec.parameters.set("scattering_anisotropy", self.anisotropy.clamp(-0.99, 0.99));
        }
    }
}

/// Measured media: scattering (reduced) and absorption per millimetre. [Jensen 2001, figure 5]
const MEASURED: &[(&str, [f32; 3], [f32; 3])] = &[
    ("Apple", [2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046]),
    ("Chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19]),
    ("Chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.20]),
    ("Cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]),
    ("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    ("Marble", [2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071]),
    ("Potato", [0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12]),
    ("Skimmilk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
    ("Skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    ("Skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
    ("Spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0]),
    ("Wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
];

/// Scattering and absorption of a measured medium.
pub(super) fn measured(name: &str) -> Option<[Rgb; 2]> {
    let (_, scattering, absorption) = MEASURED.iter().find(|(known, ..)| *known == name)?;
    Some([Rgb::from_array(*scattering), Rgb::from_array(*absorption)])
}

impl Pbrt<'_, '_> {
    /// Defines a medium.
    pub(super) fn add_medium(&mut self, name: String, list: &ParameterList) -> Result<(), FormatError> {
        let kind = list.text("type")?.unwrap_or("homogeneous").to_owned();
        if kind != "homogeneous" {
            let what = format!("a medium of type '{kind}' is not supported");
            self.oddities.note(&what, || list.at.clone());
            self.media.insert(name.into(), Medium::default());
            return Ok(());
        }
        let preset = list.text("preset")?;
        let preset = match preset.map(|name| (name, measured(name))) {
            Some((name, None)) => {
                let what = format!("the measured medium '{name}' is not known and is ignored");
                self.oddities.note(&what, || list.place("preset"));
                None
            }
            Some((_, known)) => known,
            None => None,
        };
        let [scattering, absorption] = preset.map_or([None; 2], |known| known.map(Some));
        let absorption = match absorption {
            Some(absorption) => absorption,
            None => self.spectrum(list, "sigma_a", SpectrumType::Number)?.unwrap_or(Rgb::WHITE),
        };
        let scattering = match scattering {
            Some(scattering) => scattering,
            None => self.spectrum(list, "sigma_s", SpectrumType::Number)?.unwrap_or(Rgb::WHITE),
        };
        let anisotropy = list.finite("g", 0.0)?;
        if list.has("Le") {
            self.oddities.note("emission by a medium is not supported", || list.place("Le"));
            list.has("Lescale");
        }
        let scale = list.finite("scale", 1.0)?;
        list.report_unused(&mut self.oddities);
        self.media.insert(
            name.into(),
            Medium { absorption: absorption * scale, scattering: scattering * scale, anisotropy },
        );
        Ok(())
    }

    /// The medium on one side of a surface; an error if it is not defined.
    pub(super) fn medium_of(&mut self, name: &Arc<str>, at: &Span) -> Result<Medium, FormatError> {
        if name.is_empty() {
            return Ok(Medium::default());
        }
        match self.media.get(name) {
            Some(medium) => Ok(*medium),
            None => {
                let names = self.media.keys().map(|name| &**name);
                Err(unknown("medium", name, names, at))
            }
        }
    }
}
