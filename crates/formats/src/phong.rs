//! Phong's, Blinn's and Lambert's materials as `principled`, for the formats that have them.

use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Texels};

/// The roughness that an exponent of Blinn's stands for. [Walter 2007]
pub(crate) fn roughness(exponent: f64) -> f32 {
    (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt() as f32
}

/// The opacity of a picture: its alpha if it has one, or else its brightness. `None` if it is the picture of the colours
/// and has no alpha: exporters then say that it is transparent, and do not mean it.
pub(crate) fn opacity(picture: Texture, is_of_colours: bool) -> Option<Texture> {
    let channel = match has_alpha(&picture) {
        true => Channel::A,
        false if is_of_colours => return None,
        false => Channel::G,
    };
    Some(Texture { channel: Some(channel), ..picture })
}

/// True if some texel lets light through.
pub(crate) fn has_alpha(texture: &Texture) -> bool {
    match &texture.image.texels {
        Texels::Bytes(bytes) => bytes.iter().any(|texel| texel[3] < 255),
        Texels::Floats { alpha, .. } => alpha.iter().any(|alpha| *alpha < 1.0),
        Texels::Formula(_) => false,
    }
}
