//! Converts decoded pictures to the texels of textures.

use bilux_math::Rgb;
use bilux_pictures::{Alpha, ColourSpace, Limits, Picture, PictureError, Rgba8, read_bytes, read_rgba8};
use bilux_scene::texture::{Image, Texels};

/// How to interpret the samples of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleMeaning {
    /// Colours, encoded as the file states.
    Colours,
    /// Colours with the sRGB curve, whatever the file states.
    SrgbColours,
    /// Raw numbers.
    Numbers,
}

/// The texels of a picture file; `None` if it has no colour channels.
pub(crate) fn decoded(
    bytes: &[u8],
    hint: Option<&str>,
    means: SampleMeaning,
    limits: &Limits,
) -> Result<Option<Image>, PictureError> {
    if let Some(Rgba8 { width, height, texels }) = read_rgba8(bytes, hint, limits)? {
        return Ok(Some(Image { width, height, texels: Texels::Bytes(texels) }));
    }
    Ok(image_of(read_bytes(bytes, hint, limits)?, means))
}

/// The texels of a picture, as bytes if it was 8-bit; `None` if it has no colour channels.
fn image_of(mut picture: Picture, means: SampleMeaning) -> Option<Image> {
    let is_data = means == SampleMeaning::Numbers;
    if means == SampleMeaning::SrgbColours && matches!(picture.colour_space, ColourSpace::Gamma(_)) {
        picture.colour_space = ColourSpace::Srgb;
    }
    let (width, height) = (picture.width(), picture.height());
    let alpha = |picture: &Picture| picture.channel("A").map(<[f32]>::to_vec);
    if picture.colour_space == ColourSpace::Srgb || is_data {
        let planes = picture.rgb_planes()?;
        if planes.into_iter().chain(picture.channel("A")).all(are_bytes) {
            return Some(Image { width, height, texels: Texels::Bytes(bytes(planes, picture.channel("A"))) });
        }
    }
    // Texels hold the colours without their alpha, which materials apply separately.
    picture.alpha = Alpha::Premultiplied;
    let picture = if is_data { picture } else { picture.into_linear() };
    let alpha = alpha(&picture).unwrap_or_default();
    let texels = Texels::Floats { colours: picture.to_rgb()?, alpha };
    Some(Image { width, height, texels })
}

fn are_bytes(samples: &[f32]) -> bool {
    samples.iter().all(|&sample| f32::from(byte(sample)) / 255.0 == sample)
}

/// The nearest of the 256 steps.
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

/// True for texels that do not fit into an 8-bit image.
pub(crate) fn is_bright(texel: Rgb) -> bool {
    !texel.is_finite() || texel.max_channel() > 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_pictures::{BitDepth, WriteOptions, write_bytes};

    /// Covers every 8-bit form of PNG, and those that are not 8-bit.
    #[test]
    fn bytes_decoded_directly_equal_those_decoded_via_planes() {
        let plane =
            |k: usize| (0..35).map(|i| ((i * 37 + k * 91) % 256) as f32 / 255.0).collect::<Vec<f32>>();
        for channels in [&["Y"][..], &["Y", "A"], &["R", "G", "B"], &["R", "G", "B", "A"]] {
            let mut picture = Picture::new(7, 5).unwrap();
            picture.colour_space = ColourSpace::Srgb;
            picture.alpha = bilux_pictures::Alpha::Straight;
            for (k, name) in channels.iter().enumerate() {
                picture.push_channel(*name, plane(k)).unwrap();
            }
            for bit_depth in [BitDepth::Eight, BitDepth::Sixteen] {
                let options = WriteOptions { bit_depth, ..WriteOptions::default() };
                let bytes = write_bytes("png", &picture, &options).unwrap();
                let limits = Limits::default();
                let is_bytes = read_rgba8(&bytes, None, &limits).unwrap().is_some();
                assert_eq!(is_bytes, bit_depth == BitDepth::Eight);
                for means in [SampleMeaning::Colours, SampleMeaning::SrgbColours, SampleMeaning::Numbers] {
                    let by_planes = image_of(read_bytes(&bytes, None, &limits).unwrap(), means).unwrap();
                    let at_once = decoded(&bytes, None, means, &limits).unwrap().unwrap();
                    assert_eq!(
                        format!("{at_once:?}"),
                        format!("{by_planes:?}"),
                        "{channels:?} {bit_depth:?}"
                    );
                }
            }
        }
    }

    /// Covers eight and sixteen bits, and thus both representations of texels.
    #[test]
    fn colours_are_what_they_are_beneath_their_alpha() {
        let mut picture = Picture::new(1, 1).unwrap();
        picture.colour_space = ColourSpace::Srgb;
        picture.alpha = Alpha::Straight;
        for (name, sample) in [("R", 1.0), ("G", 0.2), ("B", 0.0), ("A", 0.4)] {
            picture.push_channel(name, vec![sample]).unwrap();
        }
        for bit_depth in [BitDepth::Eight, BitDepth::Sixteen] {
            let options = WriteOptions { bit_depth, ..WriteOptions::default() };
            let bytes = write_bytes("png", &picture, &options).unwrap();
            let image = decoded(&bytes, None, SampleMeaning::Colours, &Limits::default()).unwrap().unwrap();
            let texture = bilux_scene::Texture::of("", std::sync::Arc::new(image), false);
            assert!((texture.texel(0, 0).r - 1.0).abs() < 1e-4, "{bit_depth:?}: {:?}", texture.texel(0, 0));
        }
    }
}
