//! Light that a surface gives out: what any material can say of it, and the wrapper of one that does.

use super::{Ingredients, Material, Nested, texture};
use crate::bsdf::Bsdf;
use crate::classic::ClassicMaterial;
use crate::error::SceneError;
use crate::lights::Sides;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{ColourMap, Texture};
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

/// Shared by all materials: what a surface gives out by itself.
pub(super) const EMISSION: Parameter = Parameter {
    name: "emission",
    summary: "radiance that the surface gives out",
    unit: "W/(m² sr)",
    kind: ParameterKind::ColourTexture { min: 0.0, max: 1e12 },
    default: "0",
};

/// How bright a picture of that is.
pub(super) const EMISSION_SCALE: Parameter = Parameter {
    name: "emission_scale",
    summary: "what a picture as emission is multiplied by",
    unit: "",
    kind: ParameterKind::Colour { min: 0.0, max: 1e12 },
    default: "1",
};

/// On which sides it is.
pub(super) const EMISSION_SIDES: Parameter = Parameter {
    name: "emission_sides",
    summary: "where it gives light out: on both sides, or in front, where a triangle's corners run counter-clockwise",
    unit: "",
    kind: ParameterKind::Choice(Sides::NAMES),
    default: "both",
};

/// A material that gives out light, if it is told to.
pub(super) fn apply(
    material: Arc<dyn Material>,
    reader: &Reader,
    ingredients: &Ingredients,
) -> Result<Arc<dyn Material>, SceneError> {
    let picture = texture(reader, "emission", ingredients)?;
    let scale = reader.colour(if picture.is_some() { "emission_scale" } else { "emission" });
    let brightest = picture.as_deref().map_or(scale, |picture| brightest(picture) * scale);
    if brightest.is_black() {
        return Ok(material);
    }
    let sides = Sides::named(&reader.text("emission_sides"));
    Ok(Arc::new(Glowing { material, map: ColourMap { colour: scale, texture: picture }, brightest, sides }))
}

/// The greatest of each channel.
fn brightest(picture: &Texture) -> Rgb {
    let greater = |a: Rgb, b: Rgb| Rgb::new(a.r.max(b.r), a.g.max(b.g), a.b.max(b.b));
    picture.texels().fold(Rgb::BLACK, greater)
}

struct Glowing {
    material: Arc<dyn Material>,
    map: ColourMap,
    brightest: Rgb,
    sides: Sides,
}

impl Material for Glowing {
    fn emission(&self) -> Rgb {
        self.brightest
    }

    fn emission_map(&self) -> Option<&ColourMap> {
        Some(&self.map).filter(|map| map.texture.is_some())
    }

    fn emission_sides(&self) -> Sides {
        self.sides
    }

    fn n_shade(&self, surface: &Surface) -> Vec3 {
        self.material.n_shade(surface)
    }

    fn bsdf(&self, surface: &Surface) -> Bsdf {
        self.material.bsdf(surface)
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        self.material.classic(surface)
    }

    fn needs_tangents(&self) -> bool {
        self.material.needs_tangents()
    }

    fn most_lobes(&self) -> usize {
        self.material.most_lobes()
    }

    fn nested(&self) -> Option<Nested> {
        self.material.nested()
    }

    fn sigma_a(&self) -> Rgb {
        self.material.sigma_a()
    }
}
