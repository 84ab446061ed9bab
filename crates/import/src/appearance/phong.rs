//! Phong's, Blinn's and Lambert's materials as `principled`, for the formats that have them.

use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Texels};

/// The roughness that an exponent of Blinn's stands for. [Walter 2007]
pub fn roughness(exponent: f64) -> f32 {
    (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt() as f32
}

/// The opacity of a picture: its alpha if it has one, or else its brightness. `None` if it is the picture of the colours
/// and has no alpha: exporters then say that it is transparent, and do not mean it.
pub fn opacity(picture: Texture, is_of_colours: bool) -> Option<Texture> {
    let channel = match has_alpha(&picture) {
        true => Channel::A,
        false if is_of_colours => return None,
        false => Channel::G,
    };
    Some(Texture { channel: Some(channel), ..picture })
}

/// True if some texel lets light through.
pub fn has_alpha(texture: &Texture) -> bool {
    match &texture.image.texels {
        Texels::Bytes(bytes) => bytes.iter().any(|texel| texel[3] < 255),
        Texels::Floats { alpha, .. } => alpha.iter().any(|alpha| *alpha < 1.0),
        Texels::Formula(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;
    use bilux_scene::texture::Image;
    use std::sync::Arc;

    /// A picture with an alpha is as opaque as that; one without is as opaque as it is bright, unless it is the picture of the
    /// colours, as on a paper box whose exporter calls every material transparent.
    #[test]
    fn the_picture_of_the_colours_is_opaque_unless_it_has_an_alpha() {
        let picture = |alpha: f32| {
            let texels = Texels::Floats { colours: vec![Rgb::grey(0.2); 2], alpha: vec![1.0, alpha] };
            Texture::of("box", Arc::new(Image { width: 2, height: 1, texels }), false)
        };
        let channel =
            |alpha, is_of_colours| opacity(picture(alpha), is_of_colours).map(|t| t.channel.unwrap());
        assert_eq!(channel(0.5, true), Some(Channel::A));
        assert_eq!(channel(0.5, false), Some(Channel::A));
        assert_eq!(channel(1.0, false), Some(Channel::G));
        assert_eq!(channel(1.0, true), None);
    }
}
