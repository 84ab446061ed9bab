//! Features that any material may have in addition to its BSDF: a normal map, emission, opacity, and backs hidden from
//! the camera.

use super::emission::{self, SurfaceEmission};
use super::normal_map::{self, NormalMap};
use super::visible::VISIBLE_SIDES;
use super::{Material, MaterialInputs, Nested, opacity};
use crate::bsdf::{Bsdf, OpaqueBaseInputs, SmoothLobe};
use crate::classic::ClassicMaterial;
use crate::media::Medium;
use crate::mesh::sides::Sides;
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

/// Wraps the material in the modifiers that its parameters ask for; without any it stays the same.
pub(super) fn apply(
    material: Arc<dyn Material>,
    row: &Entry,
    reader: &Reader,
    inputs: &MaterialInputs,
) -> Result<Arc<dyn Material>, SceneError> {
    let has = |name: &str| row.parameters.iter().any(|parameter| parameter.name == name);
    let normals = if has(normal_map::NORMAL.name) { normal_map::read(reader, inputs)? } else { None };
    let glow = if has(emission::EMISSION.name) { emission::read(reader, inputs)? } else { None };
    let opacity = if has(opacity::OPACITY.name) { opacity::read(reader, inputs)? } else { None };
    let visible = if has(VISIBLE_SIDES.name) {
        Sides::from_name(&reader.text(VISIBLE_SIDES.name))
    } else {
        Sides::Both
    };
    if normals.is_none() && glow.is_none() && opacity.is_none() && visible == Sides::Both {
        return Ok(material);
    }
    Ok(Arc::new(ModifiedMaterial { material, normals, glow, opacity, visible }))
}

struct ModifiedMaterial {
    material: Arc<dyn Material>,
    normals: Option<NormalMap>,
    glow: Option<SurfaceEmission>,
    opacity: Option<NumberMap>,
    visible: Sides,
}

impl Material for ModifiedMaterial {
    fn n_shade(&self, surface: &Surface) -> Vec3 {
        self.normals.as_ref().map_or(surface.n_shade, |normals| normals.at(surface))
    }

    fn set_normals(&self, surfaces: &mut [Surface]) {
        if let Some(normals) = &self.normals {
            normals.set_on(surfaces);
        }
    }

    fn bsdf(&self, surface: &Surface) -> Bsdf {
        self.material.bsdf(surface)
    }

    fn is_lambertian(&self) -> bool {
        self.normals.is_none() && self.material.is_lambertian()
    }

    fn lambertian_reflectance(&self, surface: &Surface) -> Rgb {
        self.material.lambertian_reflectance(surface)
    }

    fn constant_lambertian_reflectance(&self) -> Option<Rgb> {
        self.material.constant_lambertian_reflectance().filter(|_| self.is_lambertian())
    }

    fn is_opaque_base(&self) -> bool {
        self.material.is_opaque_base()
    }

    fn opaque_base(&self, surface: &Surface) -> Option<OpaqueBaseInputs> {
        self.material.opaque_base(surface)
    }

    fn opaque_bases(&self, surfaces: &[Surface], inputs: &mut Vec<Option<OpaqueBaseInputs>>) {
        self.material.opaque_bases(surfaces, inputs);
    }

    fn smooth_lobe(&self) -> Option<SmoothLobe> {
        self.material.smooth_lobe().filter(|_| self.normals.is_none())
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        self.material.classic(surface)
    }

    fn needs_tangents(&self) -> bool {
        self.normals.is_some() || self.material.needs_tangents()
    }

    fn max_lobes(&self) -> usize {
        self.material.max_lobes()
    }

    fn emission(&self) -> Rgb {
        self.glow.as_ref().map_or(Rgb::BLACK, |glow| glow.brightest)
    }

    fn emission_map(&self) -> Option<&ColourMap> {
        self.glow.as_ref().map(|glow| &glow.map).filter(|map| map.texture.is_some())
    }

    fn emission_sides(&self) -> Sides {
        self.glow.as_ref().map_or(Sides::Both, |glow| glow.sides)
    }

    fn opacity(&self) -> Option<&NumberMap> {
        // Nothing is left of what is not there.
        self.material.opacity().or(self.opacity.as_ref())
    }

    fn visible_sides(&self) -> Sides {
        self.visible
    }

    fn disperses(&self) -> bool {
        self.material.disperses()
    }

    fn nested(&self) -> Option<Nested> {
        self.material.nested()
    }

    fn in_contact(&self) -> Option<Nested> {
        self.material.in_contact()
    }

    fn only_refracts(&self) -> bool {
        self.glow.is_none() && self.material.only_refracts()
    }

    fn is_pane(&self) -> bool {
        self.material.is_pane()
    }

    fn is_interface(&self) -> bool {
        self.material.is_interface()
    }

    fn medium(&self) -> Option<Medium<'_>> {
        self.material.medium()
    }
}
