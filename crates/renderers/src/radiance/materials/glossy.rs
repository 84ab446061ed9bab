//! `plastic`, `metal` and `trans`: a diffuse part and gloss. [Ward 1992]
//!
//! Ward's gloss has the microfacets of Beckmann's distribution with the same alpha, and reflects the same share of the light from
//! all directions; only gloss without roughness grows towards grazing angles, about as Fresnel's equations have it.

use super::mix::mix;
use crate::radiance::statement::Primitive;
use crate::radiance::units::share;
use crate::radiance::world::World;
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_scene::Spec;

/// Smooth gloss of less than this is the same at all angles.
const LEAST_FRESNEL: f64 = 0.018;

/// The greatest reflectance that `principled` has at normal incidence, with an index of 10.
const HIGHEST_BY_INDEX: f64 = 0.66;

/// The colour, the share of gloss, and its roughness; that of the types that are brushed is the mean.
fn parts(world: &mut World, of: &Primitive, brushed: bool) -> ([f64; 3], f64, f64) {
    let specular = of.reals[3].clamp(0.0, 1.0);
    let [u, v] = [of.reals[4], of.reals[if brushed { 5 } else { 4 }]].map(|alpha| alpha.clamp(0.0, 1.0));
    if brushed && u != v {
        let what = "brushed surfaces (plastic2, metal2, trans2) are as rough along as across";
        world.diagnostics.note(what, || of.at.clone());
    }
    (of.colour(), specular, (u * v).sqrt())
}

fn diffuse(colour: [f64; 3]) -> Spec {
    Spec::new("", "diffuse").with("reflectance", share(colour))
}

/// Gloss that reflects this share of each colour.
fn gloss(reflectance: Rgb, alpha: f64) -> Spec {
    let spec = Spec::new("", "conductor").with("reflectance", reflectance);
    if alpha <= 0.0 {
        return spec.with("roughness", 0.0f32);
    }
    // What Schlick's approximation adds at 82 degrees is taken off, so that all angles reflect about as much.
    const ADDED: f32 = 0.473;
    let edge = reflectance.map(|r| r / (r + (1.0 - r) * ADDED));
    spec.with("edge", edge).with("roughness", (alpha as f32).sqrt()).with("distribution", "beckmann")
}

fn is_brushed(of: &Primitive) -> bool {
    of.word.ends_with('2')
}

pub(super) fn plastic(world: &mut World, of: &Primitive) -> Result<Spec, FormatError> {
    let (colour, specular, alpha) = parts(world, of, is_brushed(of));
    if alpha <= 0.0 && (LEAST_FRESNEL..=HIGHEST_BY_INDEX).contains(&specular) {
        let root = specular.sqrt() as f32;
        let spec =
            Spec::new("", "principled").with("base_color", share(colour)).with("specular_roughness", 0.0f32);
        return Ok(spec.with("specular_ior", (1.0 + root) / (1.0 - root)));
    }
    mix(world, diffuse(colour), gloss(Rgb::WHITE, alpha), specular, &of.at)
}

pub(super) fn metal(world: &mut World, of: &Primitive) -> Result<Spec, FormatError> {
    let (colour, specular, alpha) = parts(world, of, is_brushed(of));
    mix(world, diffuse(colour), gloss(share(colour), alpha), specular, &of.at)
}

/// The part that is not gloss reflects, lets through and spreads, or lets straight through, and colours all of it.
pub(super) fn trans(world: &mut World, of: &Primitive) -> Result<Spec, FormatError> {
    let brushed = is_brushed(of);
    let (colour, specular, alpha) = parts(world, of, brushed);
    let [passed, straight] = [5, 6].map(|i| of.reals[i + usize::from(brushed)].clamp(0.0, 1.0));
    let straight = passed * straight;
    if straight > 0.0 && alpha > 0.0 {
        let what = "what a rough 'trans' lets straight through is not spread";
        world.diagnostics.note(what, || of.at.clone());
    }
    let of_rest = |amount: f64| share(colour.map(|c| c * amount / (1.0 - straight).max(1e-9)));
    let spread = Spec::new("", "translucent")
        .with("reflectance", of_rest(1.0 - passed))
        .with("transmittance", of_rest(passed - straight));
    let filter =
        Spec::new("", "dielectric").with("eta", 1.0f32).with("thin", true).with("tint", share(colour));
    let base = mix(world, spread, filter, straight, &of.at)?;
    mix(world, base, gloss(Rgb::WHITE, alpha), specular, &of.at)
}

/// Ashikhmin and Shirley's, whose powers are those of a cosine: the microfacets of Beckmann's distribution that are as wide.
pub(super) fn ashikhmin(world: &mut World, of: &Primitive) -> Result<Spec, FormatError> {
    let specular = share([of.reals[3], of.reals[4], of.reals[5]]);
    let most = specular.max_channel();
    let power = (of.reals[6].max(0.0) * of.reals[7].max(0.0)).sqrt();
    let tint = if most > 0.0 { specular * (1.0 / most) } else { specular };
    if of.reals[6] != of.reals[7] {
        let what = "brushed surfaces (ashik2) are as rough along as across";
        world.diagnostics.note(what, || of.at.clone());
    }
    mix(world, diffuse(of.colour()), gloss(tint, (2.0 / (power + 2.0)).sqrt()), f64::from(most), &of.at)
}
