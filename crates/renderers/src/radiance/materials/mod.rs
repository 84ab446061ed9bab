//! Radiance's materials as those of Bilux. [Ward 1994]

mod clear;
mod glossy;
mod mix;
mod other;

use super::kinds::Finish;
use super::statement::Primitive;
use super::world::World;
use bilux_import::FormatError;
use bilux_scene::Spec;

/// A material of a primitive, by its index; `None` for one that is not seen. Lengths in it have this factor.
pub(super) fn material(
    world: &mut World,
    finish: Finish,
    of: &Primitive,
    scale: f64,
) -> Result<Option<usize>, FormatError> {
    let spec = match finish {
        Finish::Plastic | Finish::Plastic2 => glossy::plastic(world, of)?,
        Finish::Metal | Finish::Metal2 => glossy::metal(world, of)?,
        Finish::Trans | Finish::Trans2 => glossy::trans(world, of)?,
        Finish::Ashik2 => glossy::ashikhmin(world, of)?,
        Finish::Glass => clear::glass(of),
        Finish::Dielectric => clear::dielectric(of, scale),
        Finish::Interface => clear::interface(world, of, scale),
        Finish::Mist => match clear::mist(of, scale) {
            Some(spec) => spec,
            None => return Ok(None),
        },
        Finish::Mirror => other::mirror(of),
        Finish::Function | Finish::TransFunction | Finish::Brtd | Finish::Bsdf => {
            other::measured(world, finish, of)
        }
        Finish::Prism | Finish::Antimatter => {
            let what = format!("the {} '{}', which is not seen", of.word, of.name);
            world.diagnostics.not_shown(&what, || of.at.clone());
            return Ok(None);
        }
        Finish::Light | Finish::Illum | Finish::Glow | Finish::Spotlight => return Ok(None),
    };
    let spec = Spec { name: of.name.to_string(), ..spec };
    world.material(spec, &of.at).map(Some)
}
