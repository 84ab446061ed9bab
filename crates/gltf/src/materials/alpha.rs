//! Opacity of a material by its alpha.

use crate::document::json::JsonNode;
use crate::materials::draft::{Alpha, Draft};
use crate::materials::textures::ChannelSelection;
use bilux_import::FormatError;
use bilux_scene::texture::Channel;

/// Sets the opacity from the alpha channel of the base colour texture, times `alpha`.
pub(crate) fn opacity<'d>(
    node: JsonNode<'d>,
    picture: Option<JsonNode<'d>>,
    alpha: f32,
    draft: &mut Draft<'d, '_>,
) -> Result<(), FormatError> {
    let mode = node.text("alphaMode")?.unwrap_or("OPAQUE");
    draft.alpha = match mode {
        "OPAQUE" => return Ok(()),
        "BLEND" => Alpha::Blend,
        "MASK" => Alpha::Mask(node.number("alphaCutoff")?.unwrap_or(0.5) as f32),
        other => {
            return Err(node.error(format!("'{other}' is not an alphaMode: use OPAQUE, MASK or BLEND")));
        }
    };
    let threshold = match draft.alpha {
        Alpha::Mask(cutoff) if !draft.on.has_alpha => Some(cutoff),
        _ => None,
    };
    let opacity = match (picture, threshold) {
        (Some(info), _) => {
            let taken =
                ChannelSelection { threshold, ..ChannelSelection::channel(Channel::A, f64::from(alpha)) };
            draft.texture(info, taken)?
        }
        (None, Some(threshold)) => (if alpha < threshold { 0.0 } else { 1.0 }).into(),
        (None, None) => alpha.into(),
    };
    draft.set("opacity", opacity, node.at());
    Ok(())
}
