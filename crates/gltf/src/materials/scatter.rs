//! Scattering inside of materials, and in thin walls: `KHR_materials_scatter` and the draft before it,
//! `KHR_materials_volume_scatter`. Neither is ratified. [glTF 2579]

use crate::document::json::JsonNode;
use crate::materials::draft::Draft;
use crate::materials::textures::ChannelSelection;
use bilux_import::FormatError;
use bilux_import::input::images::mean;
use bilux_math::Rgb;
use bilux_math::transcendental::ln;
use bilux_scene::Value;

/// Values that either extension states.
struct Scattering {
    strength: f32,
    colour: Rgb,
    anisotropy: f32,
    /// The anisotropy counts in the albedo.
    is_similar: bool,
}

/// Reads them, after all else about transmission.
pub(crate) fn scatter<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let (newer, older) =
        (node.extension("KHR_materials_scatter"), node.extension("KHR_materials_volume_scatter"));
    let Some(extension) = newer.or(older) else { return Ok(()) };
    let what = "scattering in materials is a draft of an extension: its files may change their meaning";
    draft.remark(what, || extension.at());
    let strength = match newer {
        Some(newer) => newer.number("scatterStrengthFactor")?.unwrap_or(0.0) as f32,
        None => 1.0,
    };
    if extension.get("scatterStrengthTexture").is_some() {
        let what = "a texture of the strength of scattering is not used: its factor counts everywhere";
        draft.note(what, || extension.at());
    }
    let factor = extension.numbers::<3>("multiscatterColorFactor")?;
    let colour = factor.or(extension.numbers::<3>("multiscatterColor")?);
    let default = if newer.is_some() { 1.0 } else { 0.0 };
    let colour = Rgb::from_array(colour.unwrap_or([default; 3]).map(|c| c as f32)).clamp(0.0, 1.0);
    let anisotropy = extension.number("scatterAnisotropy")?.unwrap_or(0.0) as f32;
    let found = Scattering { strength, colour, anisotropy, is_similar: newer.is_some() };
    if strength <= 0.0 {
        return Ok(());
    }
    let volume = node.extension("KHR_materials_volume");
    let thickness = volume.map_or(Ok(None), |volume| volume.number("thicknessFactor"))?.unwrap_or(0.0);
    match volume.filter(|_| thickness > 0.0) {
        Some(volume) => scatter_inside(volume, extension, found, draft),
        None if newer.is_some() => scatter_in_wall(extension, &found, draft),
        None => {
            let what = "scattering in a material without a volume has no effect";
            draft.note(what, || extension.at());
            Ok(())
        }
    }
}

/// The attenuation of the volume is by absorption and scattering together.
fn scatter_inside<'d>(
    volume: JsonNode<'d>,
    extension: JsonNode<'d>,
    mut found: Scattering,
    draft: &mut Draft<'d, '_>,
) -> Result<(), FormatError> {
    let depth = volume.number("attenuationDistance")?.filter(|depth| *depth > 0.0 && depth.is_finite());
    let Some(depth) = depth else {
        let what = "scattering in a volume without an attenuation distance has no effect";
        draft.note(what, || extension.at());
        return Ok(());
    };
    if let Some(picture) = extension.get("multiscatterColorTexture") {
        let what = "an inside scatters the same everywhere: of a texture of its colour, the mean counts";
        draft.note(what, || picture.at());
        let texture = draft.looked_up(picture, ChannelSelection::colours(found.colour))?;
        found.colour = mean(&texture).clamp(0.0, 1.0);
    }
    let colour = volume.numbers::<3>("attenuationColor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
    let attenuation = Rgb::from_array(colour).map(|c| -ln(c.clamp(1e-6, 1.0)));
    let albedo = (found.colour * found.strength).map(|colour| {
        let albedo = found.albedo(colour);
        albedo.clamp(0.0, 1.0)
    });
    draft.set("transmission_color", Rgb::from_array(colour), volume.at());
    draft.set("transmission_depth", depth as f32, volume.at());
    draft.set("transmission_scatter", attenuation * albedo, extension.at());
    let anisotropy = found.anisotropy.clamp(-0.99, 0.99);
    draft.set("transmission_scatter_anisotropy", anisotropy, extension.at());
    Ok(())
}

/// Of what a thin wall transmits, a part is scattered to both sides.
fn scatter_in_wall<'d>(
    extension: JsonNode<'d>,
    found: &Scattering,
    draft: &mut Draft<'d, '_>,
) -> Result<(), FormatError> {
    let Some(weight) = draft.value("transmission_weight").cloned() else { return Ok(()) };
    let at = extension.at();
    let (straight, scattered) = match (weight, found.strength.min(1.0)) {
        (Value::Number(weight), strength) => {
            let straight = weight * (1.0 - f64::from(strength));
            (straight, Value::Number((weight - straight) / (1.0 - straight).max(f64::MIN_POSITIVE)))
        }
        (weight, strength) => {
            if strength < 1.0 {
                let what = "a wall with a texture for its transmission scatters all that it transmits";
                draft.note(what, || extension.at());
            }
            (0.0, weight)
        }
    };
    let straight = Value::Number(straight);
    draft.set("transmission_weight", straight, at.clone());
    draft.set("subsurface_weight", scattered, at.clone());
    draft.colour("subsurface_color", found.colour, extension.get("multiscatterColorTexture"), &at)?;
    draft.set("subsurface_scatter_anisotropy", found.anisotropy.clamp(-1.0, 1.0), at.clone());
    draft.set("thin_walled", true, at);
    Ok(())
}

impl Scattering {
    /// The albedo of an event, where many together have this colour: as the extensions say, which leave the boundary out. [Kulla 2017]
    fn albedo(&self, colour: f32) -> f32 {
        let s = 4.09712 + 4.20863 * colour - (9.59217 + 41.6808 * colour + 17.7126 * colour * colour).sqrt();
        let g = if self.is_similar { self.anisotropy.clamp(-0.99, 0.99) } else { 0.0 };
        (1.0 - s * s) / (1.0 - g * s * s)
    }
}
