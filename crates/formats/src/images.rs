//! Decoded pictures as the texels of textures.

use bilux_math::Rgb;
use bilux_pictures::{ColourSpace, Picture};
use bilux_scene::texture::{Image, Texels};

/// The texels of a picture, in bytes where it came in bytes; `None` where it has no colours. `is_data` keeps
/// numbers as they are.
pub(crate) fn image_of(picture: Picture, is_data: bool) -> Option<Image> {
    let (width, height) = (picture.width(), picture.height());
    let alpha = |picture: &Picture| picture.channel("A").map(<[f32]>::to_vec);
    if picture.colour_space == ColourSpace::Srgb || is_data {
        let planes = picture.rgb_planes()?;
        if planes.into_iter().chain(picture.channel("A")).all(are_bytes) {
            return Some(Image { width, height, texels: Texels::Bytes(bytes(planes, picture.channel("A"))) });
        }
    }
    let picture = if is_data { picture } else { picture.into_linear() };
    let alpha = alpha(&picture).unwrap_or_default();
    let texels = Texels::Floats { colours: picture.to_rgb()?, alpha };
    Some(Image { width, height, texels })
}

fn are_bytes(samples: &[f32]) -> bool {
    samples.iter().all(|&sample| f32::from(byte(sample)) / 255.0 == sample)
}

/// The nearest step of 256.
fn byte(sample: f32) -> u8 {
    (sample * 255.0 + 0.5) as u8
}

fn bytes([r, g, b]: [&[f32]; 3], alpha: Option<&[f32]>) -> Vec<[u8; 4]> {
    let colours = r.iter().zip(g).zip(b);
    let with = |((r, g), b): ((&f32, &f32), &f32), a: u8| [byte(*r), byte(*g), byte(*b), a];
    match alpha {
        Some(alpha) => colours.zip(alpha).map(|(rgb, &a)| with(rgb, byte(a))).collect(),
        None => colours.map(|rgb| with(rgb, 255)).collect(),
    }
}

/// True for what no picture in bytes can hold.
pub(crate) fn is_bright(texel: Rgb) -> bool {
    !texel.is_finite() || texel.max_channel() > 1.0
}
