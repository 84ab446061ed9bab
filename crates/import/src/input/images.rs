//! Converts decoded pictures to the texels of textures.

use bilux_math::Rgb;
use bilux_pictures::{
    Alpha, ColourSpace, Limits, Picture, PictureError, Rgba8, read_bytes, read_interleaved_bytes, read_rgba8,
    read_stored_bytes,
};
use bilux_scene::Texture;
use bilux_scene::texture::{Image, Texels};

/// Interpretation of the samples of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleMeaning {
    /// Colours, encoded as the file states.
    Colours,
    /// Colours with the sRGB curve, whatever the file states.
    SrgbColours,
    /// Raw numbers.
    Numbers,
}

/// A picture file's texels, and what is wrong with the file though it could be read.
pub struct Decoded {
    pub image: Image,
    pub warnings: Vec<String>,
}

/// The texels of a picture file, or of one of its layers; `None` if it has no colour channels.
pub fn decoded(
    bytes: &[u8],
    hint: Option<&str>,
    layer: Option<&str>,
    means: SampleMeaning,
    limits: &Limits,
) -> Result<Option<Decoded>, PictureError> {
    if layer.is_none()
        && let Some(Rgba8 { width, height, texels, warnings }) = read_rgba8(bytes, hint, limits)?
    {
        let image = Image { width, height, texels: Texels::Bytes(texels) };
        return Ok(Some(Decoded { image, warnings }));
    }
    let mut picture = match means {
        SampleMeaning::Colours => read_bytes(bytes, hint, limits)?,
        // What a file says of its colours counts neither where a format says what they are, nor for numbers.
        SampleMeaning::SrgbColours | SampleMeaning::Numbers => read_stored_bytes(bytes, hint, limits)?,
    };
    picture = picture.with_main(layer)?;
    let warnings = std::mem::take(&mut picture.warnings);
    Ok(image_of(picture, means).map(|image| Decoded { image, warnings }))
}

/// True for a picture whose samples programs take as numbers if nobody says what they are: those of more than 8 bits, and those
/// of one channel, unless the file says that they are colours. [UsdPreviewSurface, `sourceColorSpace`: auto]
pub fn is_raw_unless_said(bytes: &[u8], hint: Option<&str>, limits: &Limits) -> bool {
    if says_colours(bytes) {
        return false;
    }
    match read_interleaved_bytes(bytes, hint, limits) {
        Ok(Some(stored)) => stored.is_grey(),
        // What is not in sRGB is light already, such as the floats of an EXR.
        Ok(None) => read_bytes(bytes, hint, limits).is_ok_and(|it| it.colour_space == ColourSpace::Srgb),
        Err(_) => false,
    }
}

/// True for a PNG with a chunk about its colours, all of which come before the pixels.
fn says_colours(bytes: &[u8]) -> bool {
    let Some(mut rest) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") else { return false };
    while let Some((length, behind)) = rest.split_first_chunk::<4>() {
        let Some((name, behind)) = behind.split_first_chunk::<4>() else { return false };
        match name {
            b"sRGB" | b"gAMA" | b"iCCP" | b"cICP" => return true,
            b"IDAT" => return false,
            _ => {}
        }
        // The data, and four bytes of a check sum.
        let length = u32::from_be_bytes(*length) as usize;
        let Some(next) = length.checked_add(4).and_then(|length| behind.get(length..)) else { return false };
        rest = next;
    }
    false
}

/// The texels of a picture, as bytes if it was 8-bit; `None` if it has no colour channels.
fn image_of(mut picture: Picture, means: SampleMeaning) -> Option<Image> {
    let is_data = means == SampleMeaning::Numbers;
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

/// The largest number of half floats. Programs that write them turn what is brighter, such as the sun, into infinity.
const BRIGHTEST_HALF: f32 = 65504.0;
/// As bright as light may be that is given as a number.
const BRIGHTEST: f32 = 1e12;

/// A kind of number that no texel can have, and what is used in its place.
struct Fault {
    words: &'static str,
    is: fn(f32) -> bool,
    instead: f32,
}

/// All that is wrong with numbers: the first with alpha too, the first three with data, all with colours.
const FAULTS: [Fault; 5] = [
    Fault { words: "NaN", is: f32::is_nan, instead: 0.0 },
    Fault { words: "infinite", is: |x| x == f32::INFINITY, instead: BRIGHTEST_HALF },
    Fault { words: "minus infinity", is: |x| x == f32::NEG_INFINITY, instead: 0.0 },
    Fault { words: "negative", is: |x| x < 0.0, instead: 0.0 },
    Fault { words: "above 1e12", is: |x| x > BRIGHTEST, instead: BRIGHTEST },
];

/// Replaces numbers that no texel can have; returns what was wrong, where first, and what is used instead.
pub fn mend(image: &mut Image, is_data: bool) -> Option<String> {
    let Texels::Floats { colours, alpha } = &mut image.texels else { return None };
    let faults = &FAULTS[..if is_data { 3 } else { 5 }];
    let fault_of = |c: f32| faults.iter().position(|fault| (fault.is)(c));
    let mut found = [(0usize, 0usize); FAULTS.len()];
    for (i, colour) in colours.iter_mut().enumerate() {
        let hole = alpha.get_mut(i).filter(|opacity| opacity.is_nan());
        let [r, g, b] = colour.to_array().map(fault_of);
        let wrong = [r, g, b, hole.as_ref().map(|_| 0)];
        if wrong == [None; 4] {
            continue;
        }
        *colour = colour.map(|c| fault_of(c).map_or(c, |k| faults[k].instead));
        hole.into_iter().for_each(|opacity| *opacity = FAULTS[0].instead);
        for (_, (count, first)) in found.iter_mut().enumerate().filter(|(k, _)| wrong.contains(&Some(*k))) {
            *first = if *count == 0 { i } else { *first };
            *count += 1;
        }
    }
    let (width, said) = (image.width.max(1), faults.iter().zip(found).filter(|(_, (count, _))| *count > 0));
    let said: Vec<String> = said
        .map(|(Fault { words, instead, .. }, (count, first))| {
            let (texels, x, y) =
                (if count == 1 { "texel is" } else { "texels are" }, first % width, first / width);
            let first = if count == 1 { "at" } else { "the first at" };
            format!("{count} {texels} {words}, {first} ({x}, {y}), and taken as {instead}")
        })
        .collect();
    (!said.is_empty()).then(|| said.join("; "))
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

/// The mean of a texture: of its texels, or of many points of a procedural one.
pub fn mean(texture: &Texture) -> Rgb {
    let sum = |(sums, count): ([f64; 3], usize), texel: Rgb| {
        (std::array::from_fn(|c| sums[c] + f64::from(texel[c])), count + 1)
    };
    let (sums, count) = match texture.formula() {
        Some(_) => texture.spread(64).fold(([0.0; 3], 0), sum),
        None => texture.texels().fold(([0.0; 3], 0), sum),
    };
    Rgb::from_array(sums.map(|sum| (sum / count.max(1) as f64) as f32))
}

/// True for texels that do not fit into an 8-bit image.
pub fn is_bright(texel: Rgb) -> bool {
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
                    let at_once = decoded(&bytes, None, None, means, &limits).unwrap().unwrap().image;
                    assert_eq!(
                        format!("{at_once:?}"),
                        format!("{by_planes:?}"),
                        "{channels:?} {bit_depth:?}"
                    );
                }
            }
        }
    }

    /// Each fault is named with the place of its first texel, counted from the upper left, and replaced; sound texels stay.
    #[test]
    fn impossible_texels_are_named_and_replaced() {
        let image = |fault: f32| {
            let mut colours = vec![Rgb::new(0.25, 3.0, 900.0); 12];
            colours[7].g = fault;
            colours[9].b = fault;
            Image { width: 4, height: 3, texels: Texels::Floats { colours, alpha: Vec::new() } }
        };
        for (fault, words, instead) in [
            (f32::NAN, "NaN", 0.0),
            (f32::INFINITY, "infinite", 65504.0),
            (f32::NEG_INFINITY, "minus infinity", 0.0),
            (-0.5, "negative", 0.0),
            (3e38, "above 1e12", 1e12),
        ] {
            let mut light = image(fault);
            let said = mend(&mut light, false).unwrap();
            assert!(said.contains(&format!("2 texels are {words}, the first at (3, 1)")), "{said}");
            assert_eq!(light, image(instead));
            let mut data = image(fault);
            assert_eq!(mend(&mut data, true).is_some(), !fault.is_finite(), "{fault} as a number");
        }
        let alpha = [&[1.0, 0.25, f32::NAN][..], &[1.0; 9]].concat();
        let colours = vec![Rgb::WHITE; 12];
        let mut holes = Image { width: 4, height: 3, texels: Texels::Floats { colours, alpha } };
        let said = mend(&mut holes, true).unwrap();
        assert!(said.contains("1 texel is NaN, at (2, 0), and taken as 0"), "{said}");
        assert!(matches!(holes.texels, Texels::Floats { alpha, .. } if alpha[..4] == [1.0, 0.25, 0.0, 1.0]));
        assert_eq!(mend(&mut image(1e12), false), None);
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
            let decoded = decoded(&bytes, None, None, SampleMeaning::Colours, &Limits::default());
            let image = decoded.unwrap().unwrap().image;
            let texture = bilux_scene::Texture::of("", std::sync::Arc::new(image), false);
            assert!((texture.texel(0, 0).r - 1.0).abs() < 1e-4, "{bit_depth:?}: {:?}", texture.texel(0, 0));
        }
    }
}
