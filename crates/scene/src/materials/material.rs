//! Interface of a material.

use crate::bsdf::wavelength::Wavelength;
use crate::bsdf::{Bsdf, OpaqueBaseInputs, SmoothLobe};
use crate::classic::ClassicMaterial;
use crate::media::Medium;
use crate::mesh::sides::Sides;
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap};
use bilux_math::{Rgb, Vec3};

/// The material of a surface.
pub trait Material: Send + Sync {
    /// BSDF at a point.
    fn bsdf(&self, surface: &Surface) -> Bsdf;
    /// True when its [`Bsdf`] is, everywhere, a single Lambertian lobe about the shading normal.
    fn is_lambertian(&self) -> bool {
        false
    }
    /// The reflectance of that lobe at a point.
    fn lambertian_reflectance(&self, _surface: &Surface) -> Rgb {
        Rgb::BLACK
    }
    /// Reflectance of that lobe where it is the same everywhere, on meshes without colours at their vertices.
    fn constant_lambertian_reflectance(&self) -> Option<Rgb> {
        None
    }
    /// True when its [`Bsdf`] is a single [`OpaqueBase`](crate::bsdf::OpaqueBase) about the shading normal wherever
    /// [`Material::opaque_base`] gives its inputs, and hardly anything else elsewhere.
    fn is_opaque_base(&self) -> bool {
        false
    }
    /// The inputs of that lobe at a point; `None` where the surface is polished.
    fn opaque_base(&self, _surface: &Surface) -> Option<OpaqueBaseInputs> {
        None
    }
    /// [`Material::opaque_base`] at many points, in their order.
    fn opaque_bases(&self, surfaces: &[Surface], inputs: &mut Vec<Option<OpaqueBaseInputs>>) {
        inputs.extend(surfaces.iter().map(|surface| self.opaque_base(surface)));
    }
    /// The lobe, if its [`Bsdf`] is the same [`SmoothLobe`] everywhere, about the shading normal.
    fn smooth_lobe(&self) -> Option<SmoothLobe> {
        None
    }
    /// Material at a point under Equations 1 and 2.
    fn classic(&self, surface: &Surface) -> ClassicMaterial;
    /// The shading normal at a point, on the same side as `n_geom`: interpolated, or from a normal map.
    ///
    /// Tracers call it where there are tangents; the other functions read the result from the surface.
    fn n_shade(&self, surface: &Surface) -> Vec3 {
        surface.n_shade
    }
    /// Sets the shading normals of many points that have tangents, as [`Material::n_shade`] gives them; they have interpolated ones.
    fn set_normals(&self, surfaces: &mut [Surface]) {
        surfaces.iter_mut().for_each(|surface| surface.n_shade = self.n_shade(surface));
    }
    /// True when it is anisotropic, and so needs [`Surface::tangent`].
    fn needs_tangents(&self) -> bool {
        false
    }
    /// The maximum number of lobes of its [`Bsdf`].
    fn max_lobes(&self) -> usize {
        1
    }
    /// Emitted radiance, black for no emission; the maximum, if a texture varies it.
    fn emission(&self) -> Rgb {
        Rgb::BLACK
    }
    /// The emission texture.
    fn emission_map(&self) -> Option<&ColourMap> {
        None
    }
    /// The sides of its triangles from which a surface emits.
    fn emission_sides(&self) -> Sides {
        Sides::Both
    }
    /// The opacity mask, if it has one.
    fn opacity(&self) -> Option<&NumberMap> {
        None
    }
    /// The sides of its triangles that a camera sees.
    fn visible_sides(&self) -> Sides {
        Sides::Both
    }
    /// True when it refracts each wavelength differently.
    fn disperses(&self) -> bool {
        false
    }
    /// Interior medium for overlapping objects; `None` if it takes no part in nesting.
    fn nested(&self) -> Option<Nested> {
        None
    }
    /// [`Material::nested`] in contact with another such medium: then it takes part even without a priority, as of priority 1.
    fn in_contact(&self) -> Option<Nested> {
        self.nested()
    }
    /// True when its surface does nothing but bend light: between media of the same index nothing is there.
    fn only_refracts(&self) -> bool {
        false
    }
    /// True for the boundary of a medium without a surface: light passes straight through, without an event.
    fn is_interface(&self) -> bool {
        false
    }
    /// True for panes: clear walls so thin that light passes them straight, as [`Bsdf::straight`] says.
    fn is_pane(&self) -> bool {
        false
    }
    /// Medium of the inside; `None` where there is no inside that light enters: behind opaque surfaces and thin walls.
    fn medium(&self) -> Option<Medium<'_>> {
        None
    }
}

/// A nested medium; where several overlap, only the one of the highest priority exists. [Schmidt 2002]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nested {
    /// At least 1.
    pub priority: u32,
    /// Refractive index relative to air.
    pub eta: f32,
    /// 1 over the Abbe number.
    pub dispersion: f32,
}

impl Nested {
    /// Air, where nothing else is.
    pub const AIR: Nested = Nested { priority: 0, eta: 1.0, dispersion: 0.0 };

    /// True when all wavelengths have the same index in both.
    pub fn bends_like(&self, other: &Nested) -> bool {
        self.eta == other.eta && self.dispersion == other.dispersion
    }

    /// The index at a wavelength.
    pub fn index(&self, wavelength: &Wavelength) -> f32 {
        if self.dispersion == 0.0 { self.eta } else { wavelength.index(self.eta, self.dispersion) }
    }
}
