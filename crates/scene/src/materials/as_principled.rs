//! Materials as `principled`, for writers of files that know no other.

use crate::parameters::Spec;

/// Conversion of a material to `principled`.
#[derive(Clone, Copy, Debug)]
pub struct AsPrincipled {
    /// The parameters that [`AsPrincipled::convert`] takes into account; the [`SHARED`] ones stay as they are.
    pub keeps: &'static [&'static str],
    /// Difference from the material, as the end of a sentence for users; empty where it looks the same.
    pub differs: &'static str,
    /// Adds its parameters to a spec of `principled`.
    pub convert: fn(material: &Spec, principled: Spec) -> Spec,
}

/// Parameters that mean the same for every material.
pub const SHARED: &[&str] =
    &["emission", "emission_scale", "emission_sides", "normal", "normal_scale", "opacity", "visible_sides"];

impl AsPrincipled {
    pub(super) fn apply(&self, material: &Spec) -> Spec {
        let mut principled = Spec::new(&material.name, "principled");
        for &key in SHARED {
            if let Some((value, at)) = material.parameters.find(key) {
                principled.parameters.set_at(key, value.clone(), at.clone());
            }
        }
        (self.convert)(material, principled)
    }
}
