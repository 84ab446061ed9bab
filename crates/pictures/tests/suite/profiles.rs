//! Pictures whose profile has other primaries than sRGB, such as those of telephones and cameras, in every format that holds
//! profiles.

use bilux_math::transcendental::powf;
use bilux_pictures::{
    Alpha, ColourSpace, Limits, Picture, WriteOptions, read_bytes, read_rgba8, read_stored_bytes, write_bytes,
};
use std::io::Cursor;

/// A colour that is within sRGB by all of these profiles, in bytes.
const COLOUR: [u8; 3] = [200, 120, 50];

/// Two of the colour, of which the second is half transparent where the format can say that.
fn picture() -> Picture {
    let mut picture = Picture::new(16, 16).unwrap();
    for (name, byte) in ["R", "G", "B"].into_iter().zip(COLOUR) {
        picture.push_channel(name, vec![f32::from(byte) / 255.0; 256]).unwrap();
    }
    (picture.colour_space, picture.alpha) = (ColourSpace::Srgb, Alpha::Straight);
    picture
}

/// A profile of tags, each with its data. [ICC.1:2022, 7.2 and 7.3]
fn profile(tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut profile = vec![0; 128];
    profile[12..20].copy_from_slice(b"mntrRGB ");
    profile[20..24].copy_from_slice(b"XYZ ");
    profile[36..40].copy_from_slice(b"acsp");
    profile.extend((tags.len() as u32).to_be_bytes());
    let mut at = 132 + 12 * tags.len();
    for (name, data) in tags {
        profile.extend(*name);
        profile.extend((at as u32).to_be_bytes());
        profile.extend((data.len() as u32).to_be_bytes());
        at += data.len();
    }
    tags.iter().for_each(|(_, data)| profile.extend(data));
    let length = profile.len() as u32;
    profile[..4].copy_from_slice(&length.to_be_bytes());
    profile
}

fn fixed(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| ((x * 65536.0).round() as i32).to_be_bytes()).collect()
}

/// A profile of primaries, which are adapted to D50, and of one curve.
fn of_primaries([r, g, b]: [[f64; 3]; 3], curve: &[u8]) -> Vec<u8> {
    let xyz = |of: [f64; 3]| [b"XYZ \0\0\0\0".to_vec(), fixed(&of)].concat();
    let curves = [b"rTRC", b"gTRC", b"bTRC"].map(|name| (name, curve.to_vec()));
    let columns = [(b"rXYZ", xyz(r)), (b"gXYZ", xyz(g)), (b"bXYZ", xyz(b))];
    profile(&[&columns[..], &curves].concat())
}

/// The curve of sRGB as a function.
fn srgb_curve() -> Vec<u8> {
    let numbers = fixed(&[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045]);
    [b"para\0\0\0\0\0\x03\0\0".to_vec(), numbers].concat()
}

/// Apple's Display P3 and Adobe RGB (1998) as their makers publish them, and sRGB. With what their primaries are in Rec. 709,
/// by rows, as the literature has it.
fn profiles() -> [(&'static str, Vec<u8>, [f32; 3]); 3] {
    let srgb = COLOUR.map(|byte| bilux_math::colour::srgb_decode(f32::from(byte) / 255.0));
    let adobe = COLOUR.map(|byte| powf(f32::from(byte) / 255.0, 563.0 / 256.0));
    let by = |rows: [[f32; 3]; 3], light: [f32; 3]| rows.map(|m| (0..3).map(|i| m[i] * light[i]).sum());
    let power = [&b"curv\0\0\0\0\0\0\0\x01"[..], &563u16.to_be_bytes()].concat();
    [
        (
            "Display P3",
            of_primaries(
                [[0.51512, 0.24120, -0.00105], [0.29198, 0.69225, 0.04189], [0.15710, 0.06657, 0.78407]],
                &srgb_curve(),
            ),
            by([[1.2249, -0.2247, 0.0], [-0.0420, 1.0419, 0.0], [-0.0197, -0.0786, 1.0979]], srgb),
        ),
        (
            "Adobe RGB",
            of_primaries(
                [[0.60974, 0.31111, 0.01947], [0.20528, 0.62567, 0.06087], [0.14919, 0.06322, 0.74457]],
                &power,
            ),
            by([[1.3984, -0.3984, 0.0], [0.0, 1.0, 0.0], [0.0, -0.0429, 1.0429]], adobe),
        ),
        (
            "sRGB",
            of_primaries(
                [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.71410]],
                &srgb_curve(),
            ),
            srgb,
        ),
    ]
}

/// A chunk `iCCP` before the first of pixels; the chunk `sRGB` goes.
fn png(profile: &[u8]) -> Vec<u8> {
    let plain = write_bytes("png", &picture(), &WriteOptions::default()).unwrap();
    let mut bytes = Vec::new();
    let mut info = png::Info::with_size(16, 16);
    (info.color_type, info.bit_depth) = (png::ColorType::Rgb, png::BitDepth::Eight);
    info.icc_profile = Some(profile.to_vec().into());
    let mut writer = png::Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
    let pixels = read_rgba8(&plain, None, &Limits::default()).unwrap().unwrap();
    let pixels: Vec<u8> = pixels.texels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

/// The profile in two segments, as large ones are. [ICC.1:2022, B.4]
fn jpeg(profile: &[u8]) -> Vec<u8> {
    let options = WriteOptions { quality: 100, ..WriteOptions::default() };
    let mut bytes = write_bytes("jpeg", &picture(), &options).unwrap();
    let (first, second) = profile.split_at(profile.len() / 2);
    let segment = |number: u8, part: &[u8]| {
        let length = (2 + 14 + part.len()) as u16;
        [&[0xff, 0xe2][..], &length.to_be_bytes(), b"ICC_PROFILE\0", &[number, 2], part].concat()
    };
    bytes.splice(2..2, [segment(1, first), segment(2, second)].concat());
    bytes
}

fn webp(profile: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = image_webp::WebPEncoder::new(&mut bytes);
    encoder.set_icc_profile(profile.to_vec());
    encoder.encode(&COLOUR.repeat(256), 16, 16, image_webp::ColorType::Rgb8).unwrap();
    bytes
}

fn tiff(profile: &[u8]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<tiff::encoder::colortype::RGB8>(16, 16).unwrap();
    image.encoder().write_tag(tiff::tags::Tag::IccProfile, profile).unwrap();
    image.write_data(&COLOUR.repeat(256)).unwrap();
    bytes.into_inner()
}

#[test]
fn colours_of_other_primaries_are_converted_in_every_format() {
    for (name, profile, wanted) in profiles() {
        for (format, bytes, off) in [
            ("png", png(&profile), 2e-3),
            ("jpeg", jpeg(&profile), 1e-2),
            ("webp", webp(&profile), 2e-3),
            ("tiff", tiff(&profile), 2e-3),
        ] {
            let read = read_bytes(&bytes, None, &Limits::default()).unwrap();
            let got = read.clone().into_linear().rgb(7, 9).to_array();
            let is_near = got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < off);
            assert!(is_near, "{name} in {format}: {got:?}, not {wanted:?}");
            // Bytes that are not sRGB are not handed on as if they were.
            let at_once = read_rgba8(&bytes, None, &Limits::default()).unwrap();
            assert_eq!(at_once.is_some(), name == "sRGB", "{name} in {format}");
            // Numbers are what they are, whatever a program has written beside them.
            let stored = read_stored_bytes(&bytes, None, &Limits::default()).unwrap();
            let numbers = stored.rgb(7, 9).to_array().map(|c| c * 255.0);
            let are_same = numbers.iter().zip(COLOUR).all(|(a, b)| (a - f32::from(b)).abs() < 1.5);
            assert!(are_same, "{name} in {format}: {numbers:?}");
        }
    }
}

/// Colours that sRGB cannot show have no negative light, and white stays white.
#[test]
fn white_stays_white_and_no_light_is_negative() {
    for (name, profile, _) in profiles() {
        let shown = |colour: [u8; 3]| {
            let mut bytes = Vec::new();
            let mut encoder = image_webp::WebPEncoder::new(&mut bytes);
            encoder.set_icc_profile(profile.clone());
            encoder.encode(&colour.repeat(2), 2, 1, image_webp::ColorType::Rgb8).unwrap();
            let read = read_bytes(&bytes, None, &Limits::default()).unwrap();
            read.into_linear().rgb(1, 0).to_array()
        };
        assert!(shown([255; 3]).iter().all(|c| (c - 1.0).abs() < 1e-5), "{name}: {:?}", shown([255; 3]));
        for pure in [[255, 0, 0], [0, 255, 0], [0, 0, 255]] {
            let light = shown(pure);
            assert!(light.iter().all(|c| *c >= 0.0), "{name}: {light:?}");
            assert!(light.iter().any(|c| *c > 0.99), "{name}: {light:?}");
        }
    }
}

/// A profile that ends early, at any byte, harms nothing.
#[test]
fn damaged_profiles_are_harmless() {
    let (_, profile, _) = &profiles()[0];
    for end in (0..profile.len()).step_by(7) {
        let read = read_bytes(&webp(&profile[..end]), None, &Limits::default()).unwrap();
        assert!(read.into_linear().rgb(3, 3).to_array().iter().all(|c| c.is_finite()), "{end}");
    }
}
