//! `mirror`, and materials whose functions and data are not read.

use crate::radiance::kinds::Finish;
use crate::radiance::statement::Primitive;
use crate::radiance::units::share;
use crate::radiance::world::World;
use bilux_scene::Spec;

pub(super) fn mirror(of: &Primitive) -> Spec {
    Spec::new("", "mirror").with("reflectance", share(of.colour()))
}

/// The diffuse part of a material whose gloss is a function or data in a file.
pub(super) fn measured(world: &mut World, finish: Finish, of: &Primitive) -> Spec {
    let what = format!("the functions and data of the {} '{}'", of.word, of.name);
    world.diagnostics.not_shown(&what, || of.at.clone());
    let number = |i: usize| of.reals.get(i).copied().unwrap_or(0.0).clamp(0.0, 1.0);
    let triple = |first: usize| share([number(first), number(first + 1), number(first + 2)]);
    match finish {
        // Front and back reflect the same here; three numbers each for both of them, and for what passes.
        Finish::Brtd | Finish::Bsdf if of.reals.len() >= 9 => {
            Spec::new("", "translucent").with("reflectance", triple(0)).with("transmittance", triple(6))
        }
        Finish::Bsdf if of.reals.is_empty() => Spec::new("", "diffuse").with("reflectance", 0.5f32),
        Finish::TransFunction => {
            let rest = 1.0 - number(3);
            let part = |passed: f64| share(of.colour().map(|c| c * passed * rest));
            Spec::new("", "translucent")
                .with("reflectance", part(1.0 - number(4)))
                .with("transmittance", part(number(4)))
        }
        _ => Spec::new("", "diffuse").with("reflectance", share(of.colour())),
    }
}
