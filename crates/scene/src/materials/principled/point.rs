//! The parameters at a point, and the lobes made from them.

use crate::bsdf::{
    Albedo, CoatedDielectric, CoatedDiffuse, Coating, Fresnel, Fuzz, FuzzAlbedo, Ggx, Lambert, Lobe,
    MicrofacetReflection, ThinFilm,
};
use bilux_math::{Rgb, Vec3};
use std::f32::consts::TAU;

/// The parameters at a point.
pub(super) struct Point {
    pub(super) base_color: Rgb,
    pub(super) base_roughness: f32,
    pub(super) metalness: f32,
    pub(super) specular_weight: f32,
    pub(super) specular_color: Rgb,
    pub(super) roughness: f32,
    pub(super) ior: f32,
    pub(super) anisotropy: f32,
    pub(super) rotation: f32,
    pub(super) transmission: f32,
    pub(super) passed: Rgb,
    pub(super) subsurface: Subsurface,
    /// The index of the boundary that light enters through.
    pub(super) body_ior: f32,
    pub(super) thin: bool,
    pub(super) dispersion: f32,
    pub(super) coat: f32,
    pub(super) coat_color: Rgb,
    pub(super) coat_roughness: f32,
    pub(super) coat_ior: f32,
    /// The coat's normal, in a frame where the normal of the rest is the z axis.
    pub(super) coat_up: Vec3,
    pub(super) fuzz: f32,
    pub(super) fuzz_color: Rgb,
    pub(super) fuzz_roughness: f32,
    /// The fraction of the diffuse part that is transmitted to the back.
    pub(super) passing: f32,
    pub(super) passing_color: Rgb,
    pub(super) film: ThinFilm,
}

/// Scattering below the surface of the opaque part, at a point.
#[derive(Clone, Copy)]
pub(super) enum Subsurface {
    None,
    /// A medium scatters it; light that enters or leaves has the factor `entering`.
    Body {
        weight: f32,
        colour: Rgb,
        entering: Rgb,
    },
    /// At once, to both sides.
    Sheet {
        weight: f32,
        reflected: Rgb,
        passed: Rgb,
    },
}

/// Fuzz, coat, boundary, base, clear part.
type Lobes = [Option<Lobe>; 5];

impl Point {
    pub(super) fn lobes(&self) -> Lobes {
        let ggx = Ggx::from_roughness(self.roughness, self.anisotropy, self.rotation * TAU);
        let (fuzz, bloom) = self.fuzz_and_cover();
        let (coat, cover) = self.coat_and_cover(bloom);
        let tint = Rgb::WHITE.lerp(self.coat_color, self.coat);
        let (opaque, clear) = (tint * self.opaque(), tint * (self.clear() + self.body()));
        let into = self.passed * (tint * self.clear()) + self.entering() * (tint * self.body());
        let eta = self.eta();
        let glass = if eta > 1.0 { self.specular_color * opaque } else { Rgb::BLACK };
        let metal = Fresnel::tinted(self.base_color * self.specular_weight, self.specular_color);
        let metal_weight = tint * self.metalness;
        let gloss = (!metal_weight.is_black() || !glass.is_black()).then(|| {
            let gloss = MicrofacetReflection::new(ggx, eta, glass, metal, metal_weight, cover);
            Lobe::MicrofacetReflection(if self.film.weight > 0.0 { gloss.below(self.film) } else { gloss })
        });
        let [albedo, passing] = self.diffuse(opaque);
        let is_bare = eta <= 1.0 && cover.is_none() && passing.is_black() && self.base_roughness == 0.0;
        let base = (!albedo.is_black() || !passing.is_black()).then(|| {
            if is_bare {
                return Lobe::Lambert(Lambert { albedo });
            }
            // What a film reflects at its brightest colour is withheld from the base at every colour.
            let most = if self.film.weight > 0.0 { self.film.most(eta) } else { eta };
            let rough = (self.base_roughness > 0.0).then_some((self.base_roughness, self.base_color));
            let boundary = Albedo::new(&ggx, most);
            Lobe::CoatedDiffuse(CoatedDiffuse::sheet_of([albedo, passing], boundary, cover, rough))
        });
        let clear = (!clear.is_black()).then(|| {
            let (reflected, index) = (self.specular_color * clear, (self.body_ior, self.dispersion));
            let clear = CoatedDielectric::new(index, ggx, self.thin, reflected, into, cover);
            Lobe::CoatedDielectric(if self.film.weight > 0.0 { clear.below(self.film) } else { clear })
        });
        [fuzz, coat, gloss, base, clear]
    }

    /// The fraction of the surface that is neither metal nor clear, and scatters where it is.
    pub(super) fn opaque(&self) -> f32 {
        self.covered() - self.body()
    }

    /// The fraction of the surface that is neither metal nor clear.
    fn covered(&self) -> f32 {
        (1.0 - self.metalness) * (1.0 - self.transmission)
    }

    /// The fraction of the surface below which a medium scatters light.
    pub(super) fn body(&self) -> f32 {
        match self.subsurface {
            Subsurface::Body { weight, .. } => self.covered() * weight,
            _ => 0.0,
        }
    }

    /// The colour of that medium.
    pub(super) fn body_color(&self) -> Rgb {
        if let Subsurface::Body { colour, .. } = self.subsurface { colour } else { Rgb::BLACK }
    }

    fn entering(&self) -> Rgb {
        if let Subsurface::Body { entering, .. } = self.subsurface { entering } else { Rgb::BLACK }
    }

    /// Diffuse reflectance and transmittance of the opaque part.
    fn diffuse(&self, opaque: Rgb) -> [Rgb; 2] {
        let base =
            [self.base_color * opaque * (1.0 - self.passing), self.passing_color * opaque * self.passing];
        match self.subsurface {
            Subsurface::Sheet { weight, reflected, passed } => {
                [base[0].lerp(reflected * opaque, weight), base[1].lerp(passed * opaque, weight)]
            }
            _ => base,
        }
    }

    pub(super) fn clear(&self) -> f32 {
        (1.0 - self.metalness) * self.transmission
    }

    /// The index of the boundary of the opaque base. Below a coat it is relative to the coat's index; if that is
    /// larger, the ratio is inverted, or there would be too much total internal reflection. [OpenPBR 1.1]
    fn eta(&self) -> f32 {
        let ratio = self.ior / self.coat_ior;
        let eta = self.ior + (ratio.max(1.0 / ratio) - self.ior) * self.coat;
        weakened(eta, self.specular_weight)
    }

    /// The fuzz lobe, and the coating that it forms.
    fn fuzz_and_cover(&self) -> (Option<Lobe>, Coating) {
        if self.fuzz == 0.0 {
            return (None, Coating::NONE);
        }
        let albedo = FuzzAlbedo::new(self.fuzz_roughness);
        let fuzz = Fuzz::new(self.fuzz_color * self.fuzz, albedo).from_below(self.outside());
        (Some(Lobe::Fuzz(fuzz)), Coating::NONE.below(self.fuzz, albedo))
    }

    /// The coat below the layers `above`, and the coating of all of them together.
    fn coat_and_cover(&self, above: Coating) -> (Option<Lobe>, Coating) {
        if self.coat == 0.0 || self.coat_ior <= 1.0 {
            return (None, above);
        }
        let ggx = Ggx::from_roughness(self.coat_roughness, 0.0, 0.0);
        let none = Fresnel::tinted(Rgb::BLACK, Rgb::WHITE);
        let coat =
            MicrofacetReflection::new(ggx, self.coat_ior, Rgb::grey(self.coat), none, Rgb::BLACK, above);
        let cover = above.coated(self.coat, Albedo::new(&ggx, self.coat_ior)).about(self.coat_up);
        (Some(Lobe::MicrofacetReflection(coat.from_below(self.outside()))), cover)
    }

    /// Share of the coat and fuzz that is visible from below: a viewer inside the clear part sees neither.
    fn outside(&self) -> f32 {
        if self.thin { 1.0 } else { 1.0 - self.clear() - self.body() }
    }
}

/// The index of a boundary that reflects `weight` times as much at normal incidence. [OpenPBR 1.1, eq. 27]
pub(super) fn weakened(eta: f32, weight: f32) -> f32 {
    let amplitude = weight.sqrt() * (eta - 1.0) / (eta + 1.0);
    (1.0 + amplitude) / (1.0 - amplitude)
}
