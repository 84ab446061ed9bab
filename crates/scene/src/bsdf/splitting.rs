//! A [`Bsdf`] for light of one wavelength.

use super::Bsdf;
use crate::bsdf::wavelength::Wavelength;

impl Bsdf {
    /// Sets the indices for light of one wavelength, where the outside has this refractive index rather than that of air.
    /// If the wavelength matters, the BSDF [splits](Bsdf::splits) paths.
    pub fn refracting(mut self, wavelength: &Wavelength, eta_outside: f32) -> Bsdf {
        for lobe in self.lobes.iter_mut().flatten() {
            let Some((eta, dispersion)) = lobe.index() else { continue };
            let inside = if dispersion == 0.0 { eta } else { wavelength.index(eta, dispersion) };
            self.splits |= dispersion != 0.0;
            *lobe = lobe.of_index(inside / eta_outside);
        }
        self
    }

    /// Marks the BSDF when the outside medium depends on the wavelength.
    pub fn splitting(self, splits: bool) -> Bsdf {
        Bsdf { splits: self.splits || splits, ..self }
    }

    /// True when other wavelengths scatter differently: a path through here carries a single wavelength.
    #[inline]
    pub fn splits(&self) -> bool {
        self.splits
    }
}
