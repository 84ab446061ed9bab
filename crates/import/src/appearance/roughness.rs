//! Roughness along u and v. Bilux has the square root of one alpha, and an anisotropy that reduces it along the
//! direction of brushing.

use bilux_scene::{Span, Spec};

/// The parameter names in Bilux: roughness, anisotropy, rotation; and the value of a quarter turn.
pub type Keys = ([&'static str; 3], f32);
pub const PLAIN: Keys = (["roughness", "anisotropy", "rotation"], 90.0);
pub const PRINCIPLED: Keys =
    (["specular_roughness", "specular_roughness_anisotropy", "anisotropy_rotation"], 0.25);

/// Sets the roughness of a spec from the alphas along u and v.
pub fn set_alphas(spec: &mut Spec, keys: Keys, [u, v]: [f32; 2], at: &Span) {
    let ([roughness, anisotropy, rotation], quarter) = keys;
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let ratio = if u == v { 1.0 } else { u.min(v) / u.max(v) };
    let even = u.max(v) * ((1.0 + ratio * ratio) * 0.5).sqrt();
    spec.parameters.set_at(roughness, even.sqrt().into(), at.clone());
    if ratio < 1.0 {
        spec.parameters.set_at(anisotropy, (1.0 - ratio).into(), at.clone());
    }
    if u > v {
        spec.parameters.set_at(rotation, quarter.into(), at.clone());
    }
}
