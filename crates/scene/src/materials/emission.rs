//! Emission of surfaces.

use super::{MaterialInputs, texture};
use crate::mesh::sides::Sides;
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::texture::{ColourMap, Texture};
use bilux_math::Rgb;
use bilux_math::registry::{Parameter, ParameterKind};

/// Emitted radiance; shared by the materials.
pub(super) const EMISSION: Parameter = Parameter {
    name: "emission",
    summary: "emitted radiance",
    unit: "W/(m² sr)",
    kind: ParameterKind::ColourTexture { min: 0.0, max: 1e12 },
    default: "0",
};

/// A factor on the emission.
pub(super) const EMISSION_SCALE: Parameter = Parameter {
    name: "emission_scale",
    summary: "factor on the emission",
    unit: "",
    kind: ParameterKind::Colour { min: 0.0, max: 1e12 },
    default: "1",
};

/// The emitting sides.
pub(super) const EMISSION_SIDES: Parameter = Parameter {
    name: "emission_sides",
    summary: "which sides emit light: both, or the front, where a triangle's vertices run counter-clockwise in its \
              own mesh; a mirrored copy keeps its front",
    unit: "",
    kind: ParameterKind::Choice(Sides::NAMES),
    default: "both",
};

/// The emission of a surface.
pub(super) struct SurfaceEmission {
    /// The emitted colour, or an emission texture and the factor on it.
    pub(super) map: ColourMap,
    /// The maximum of each channel.
    pub(super) brightest: Rgb,
    pub(super) sides: Sides,
}

/// Reads the emission of a material, if it has any.
pub(super) fn read(reader: &Reader, inputs: &MaterialInputs) -> Result<Option<SurfaceEmission>, SceneError> {
    let picture = texture(reader, "emission", inputs)?;
    // White where a texture is given.
    let scale = reader.colour("emission") * reader.colour("emission_scale");
    let brightest = picture.as_deref().map_or(scale, |picture| brightest(picture) * scale);
    let sides = Sides::from_name(&reader.text("emission_sides"));
    let map = ColourMap { colour: scale, texture: picture };
    Ok((!brightest.is_black()).then_some(SurfaceEmission { map, brightest, sides }))
}

/// The maximum of each channel.
fn brightest(picture: &Texture) -> Rgb {
    let greater = |a: Rgb, b: Rgb| Rgb::new(a.r.max(b.r), a.g.max(b.g), a.b.max(b.b));
    match picture.formula() {
        Some(_) => picture.spread(256).fold(Rgb::BLACK, greater),
        None => picture.maximum(),
    }
}
