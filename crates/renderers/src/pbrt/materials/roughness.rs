//! Roughness. pbrt has one alpha along u and one along v, or their squares. Bilux has the square root of alpha,
//! and an anisotropy that reduces it along the direction of brushing.

use super::super::parameters::ParameterList;
use super::maker::MaterialMaker;
use bilux_import::FormatError;
use bilux_import::appearance::roughness::set_alphas;
pub(super) use bilux_import::appearance::roughness::{Keys, PLAIN, PRINCIPLED};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::Rgb;
use bilux_math::transcendental::ln;
use bilux_scene::Spec;

/// The parameter names in pbrt: for both directions, along u, along v.
pub(super) type Names = [&'static str; 3];
pub(super) const OWN: Names = ["roughness", "uroughness", "vroughness"];

/// Conversion of numbers to alphas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Remap {
    /// They are alphas already.
    Never,
    /// By their square root.
    Root,
    /// By the polynomial of version 3.
    Polynomial,
}

impl Remap {
    fn alpha(self, roughness: f32) -> f32 {
        match self {
            Remap::Never => roughness,
            Remap::Root => roughness.max(0.0).sqrt(),
            Remap::Polynomial => {
                let x = ln(roughness.max(1e-3));
                1.621_42 + x * (0.819_955 + x * (0.1734 + x * (0.017_120_1 + x * 0.000_640_711)))
            }
        }
    }
}

impl MaterialMaker<'_, '_, '_> {
    /// Sets the roughness of a spec.
    pub(super) fn set_roughness(
        &mut self,
        spec: &mut Spec,
        list: &ParameterList,
        [both, along, across]: Names,
        default: f32,
        is_old: bool,
        keys: Keys,
    ) -> Result<(), FormatError> {
        let remap = match (list.flag("remaproughness", true)?, is_old) {
            (false, _) => Remap::Never,
            (true, false) => Remap::Root,
            (true, true) => Remap::Polynomial,
        };
        let even =
            self.textures.float_texture(list, both)?.unwrap_or(TextureOrValue::Colour(Rgb::grey(default)));
        let u = self.textures.float_texture(list, along)?.unwrap_or_else(|| even.clone());
        let v = self.textures.float_texture(list, across)?.unwrap_or(even);
        let at = list.place(both);
        if let (TextureOrValue::Colour(u), TextureOrValue::Colour(v)) = (&u, &v) {
            set_alphas(spec, keys, [remap.alpha(u.r), remap.alpha(v.r)], &at);
            return Ok(());
        }
        let is_same = match (&u, &v) {
            (TextureOrValue::Picture(u), TextureOrValue::Picture(v)) => std::sync::Arc::ptr_eq(u, v),
            _ => false,
        };
        if !is_same {
            let what =
                "roughness that differs along u and v is supported only for numbers: the one along u is used";
            self.note(what, || at.clone());
        }
        let root = |c: Rgb| Rgb::grey(remap.alpha(c.luminance()).clamp(0.0, 1.0).sqrt());
        let source = u.mapped(root, self.loader().reading)?;
        self.set(spec, keys.0[0], source, at);
        Ok(())
    }
}
