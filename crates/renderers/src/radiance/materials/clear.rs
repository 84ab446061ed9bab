//! `glass`, `dielectric`, `interface` and `mist`: what light passes.

use crate::radiance::statement::Primitive;
use crate::radiance::units::share;
use crate::radiance::world::World;
use bilux_math::Rgb;
use bilux_math::transcendental::ln_f64;
use bilux_scene::Spec;

/// The index of a pane that does not state one.
const OF_PANES: f64 = 1.52;

/// Transmission that is taken in place of 0.
const OPAQUE: f64 = 1e-40;

/// A pane: its numbers are what is left of light that crosses it once, between its faces.
pub(super) fn glass(of: &Primitive) -> Spec {
    let index = of.reals.get(3).copied().unwrap_or(OF_PANES);
    let spec = Spec::new("", "dielectric").with("thin", true).with("tint", share(of.colour()));
    spec.with("eta", held(index))
}

/// Solid glass. Its fifth number is the slope of Hartmann's equation, by wavelengths in nm.
pub(super) fn dielectric(of: &Primitive, scale: f64) -> Spec {
    let [_, _, _, base, slope] = of.reals[..] else { return Spec::new("", "dielectric") };
    let index = base + slope / YELLOW;
    let spec = Spec::new("", "dielectric").with("eta", held(index));
    let spec = spec.with("absorption", absorption(of.colour(), scale));
    if slope == 0.0 || index <= 1.0 {
        return spec;
    }
    // 20 over the Abbe number.
    let dispersion = 20.0 * slope * (1.0 / BLUE - 1.0 / RED) / (index - 1.0);
    spec.with("dispersion", dispersion.clamp(0.0, 20.0) as f32)
}

/// The lines d, F and C, by which dispersion is stated, in nm.
const YELLOW: f64 = 587.56;
const BLUE: f64 = 486.13;
const RED: f64 = 656.27;

/// The boundary between two dielectrics, the first of which is inside.
pub(super) fn interface(world: &mut World, of: &Primitive, scale: f64) -> Spec {
    let outside = &of.reals[4..7];
    if outside.iter().any(|passed| *passed < 1.0) {
        let what = "what is outside of an 'interface' absorbs nothing here";
        world.diagnostics.note(what, || of.at.clone());
    }
    let index = of.reals[3] / of.reals[7];
    Spec::new("", "dielectric").with("eta", held(index)).with("absorption", absorption(of.colour(), scale))
}

/// A medium; `None` if its boundary adds none.
pub(super) fn mist(of: &Primitive, scale: f64) -> Option<Spec> {
    let extinction = of.reals.get(..3)?;
    let amount = |of_albedo: fn(f64) -> f64| {
        let channel = |i: usize| {
            let albedo = of.reals.get(3 + i).copied().unwrap_or(0.0).clamp(0.0, 1.0);
            (extinction[i].max(0.0) / scale * of_albedo(albedo)) as f32
        };
        Rgb::new(channel(0), channel(1), channel(2)).clamp(0.0, 1e6)
    };
    let spec = Spec::new("", "interface").with("scattering", amount(|albedo| albedo));
    let spec = spec.with("absorption", amount(|albedo| 1.0 - albedo));
    let cosine = of.reals.get(6).copied().unwrap_or(0.0).clamp(-0.99, 0.99);
    Some(spec.with("scattering_anisotropy", cosine as f32))
}

/// An index within the supported range.
fn held(index: f64) -> f32 {
    if index.is_finite() { index.clamp(0.1, 10.0) as f32 } else { OF_PANES as f32 }
}

/// The absorption coefficient of what lets such a share pass along a unit of length.
fn absorption(passed: [f64; 3], scale: f64) -> Rgb {
    let [r, g, b] = passed.map(|share| (-ln_f64(share.clamp(OPAQUE, 1.0)) / scale) as f32);
    Rgb::new(r, g, b).clamp(0.0, 1e6)
}
