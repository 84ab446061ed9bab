//! Statements of files about their samples: curves, primaries, alpha, and which way up they are.

use bilux_math::Rgb;
use bilux_pictures::{
    Alpha, ColourSpace, Limits, Picture, WriteOptions, read_bytes, read_rgba8, write_bytes,
};

fn read(bytes: &[u8], format: &str) -> Picture {
    read_bytes(bytes, Some(format), &Limits::default()).unwrap()
}

/// The only pixel as light.
fn light(picture: Picture) -> [f32; 3] {
    picture.into_linear().rgb(0, 0).to_array()
}

#[track_caller]
fn near(got: [f32; 3], wanted: [f32; 3]) {
    assert!(got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 2e-3), "{got:?}, not {wanted:?}");
}

/// A PNG of one grey pixel, 128 of 255, without the chunk `sRGB`, and with others.
fn png(chunks: &[(&[u8], &[u8])]) -> Vec<u8> {
    png_of([128.0; 3], chunks)
}

/// A PNG of one pixel of these samples, of 255, without the chunk `sRGB`, and with others.
fn png_of(samples: [f32; 3], chunks: &[(&[u8], &[u8])]) -> Vec<u8> {
    let mut picture = Picture::new(1, 1).unwrap();
    for (name, sample) in ["R", "G", "B"].into_iter().zip(samples) {
        picture.push_channel(name, vec![sample / 255.0]).unwrap();
    }
    picture.colour_space = ColourSpace::Srgb;
    let plain = write_bytes("png", &picture, &WriteOptions::default()).unwrap();
    let srgb = plain.windows(4).position(|name| name == b"sRGB").unwrap() - 4;
    let mut bytes = [&plain[..srgb], &plain[srgb + 13..]].concat();
    for (name, data) in chunks.iter().rev() {
        let body = [*name, *data].concat();
        let crc = body.iter().fold(!0u32, |crc, &byte| {
            (0..8)
                .fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
        });
        let chunk = [&(data.len() as u32).to_be_bytes()[..], &body, &(!crc).to_be_bytes()].concat();
        bytes.splice(33..33, chunk);
    }
    bytes
}

/// A profile whose only tag is a curve, as the chunk `iCCP` holds it: a name, and zlib's stored block. [ICC.1:2022, 7.2 and 7.3]
fn profile(tag: &[u8; 4], curve: &[u8]) -> Vec<u8> {
    let mut profile = vec![0; 128];
    profile[36..40].copy_from_slice(b"acsp");
    profile.extend(1u32.to_be_bytes());
    profile.extend(tag);
    profile.extend(144u32.to_be_bytes());
    profile.extend((curve.len() as u32).to_be_bytes());
    profile.extend(curve);
    let length = profile.len() as u32;
    profile[..4].copy_from_slice(&length.to_be_bytes());
    let (low, high) = profile.iter().fold((1u32, 0u32), |(low, high), byte| {
        let low = (low + u32::from(*byte)) % 65521;
        (low, (high + low) % 65521)
    });
    let adler = high << 16 | low;
    let size = profile.len() as u16;
    [b"p\0\0\x78\x01\x01", &size.to_le_bytes()[..], &(!size).to_le_bytes(), &profile, &adler.to_be_bytes()]
        .concat()
}

fn power(gamma: f32) -> Vec<u8> {
    [b"curv\0\0\0\0\0\0\0\x01", &((gamma * 256.0) as u16).to_be_bytes()[..]].concat()
}

/// s15Fixed16 numbers of `parametricCurveType`. [ICC.1:2022, 10.18]
fn function(kind: u8, numbers: &[f64]) -> Vec<u8> {
    let numbers = numbers.iter().flat_map(|x| ((x * 65536.0) as i32).to_be_bytes());
    [b"para\0\0\0\0\0", &[kind, 0, 0][..]].concat().into_iter().chain(numbers).collect()
}

#[test]
fn the_curve_of_a_profile_counts() {
    // 128 of 255 by each curve: itself, to the power of 1.8, by sRGB.
    let (half, srgb) = (128.0 / 255.0, 0.2159);
    let table: Vec<u8> = (0..=4u16).flat_map(|i| (i * 16383).to_be_bytes()).collect();
    let straight = [&b"curv\0\0\0\0\0\0\0\x05"[..], &table].concat();
    for (tag, curve, wanted) in [
        (b"rTRC", power(1.0), half),
        (b"rTRC", b"curv\0\0\0\0\0\0\0\0".to_vec(), half),
        (b"rTRC", straight, half),
        (b"kTRC", power(1.8), bilux_math::transcendental::powf(half, 1.8)),
        (b"rTRC", power(2.2), srgb),
        (b"rTRC", function(0, &[1.0]), half),
        (b"rTRC", function(3, &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045]), srgb),
        // Nothing below where it begins, or a constant there, which is added above too.
        (b"rTRC", function(1, &[1.0, 0.6, 0.4 * 128.0 / 255.0]), half),
        (b"rTRC", function(2, &[1.0, 0.6, 0.0, 0.4 * 128.0 / 255.0]), half),
        (b"rTRC", function(2, &[1.0, 1.0, -0.7, 128.0 / 255.0]), half),
        // An offset above, and another one below the straight part.
        (b"rTRC", function(4, &[1.0, 0.6, 0.0, 1.0, 0.0, 0.2 - 0.6 / 510.0, 0.0]), half),
        (b"rTRC", function(4, &[2.0, 1.0, 0.0, 0.6, 0.9, 0.1, 0.4 * 128.0 / 255.0]), half),
        // No curve at all, and a damaged one.
        (b"desc", power(1.0), srgb),
        (b"rTRC", b"curv\0\0\0\0\0\0\xff\xff\0\0".to_vec(), srgb),
    ] {
        let bytes = png(&[(b"iCCP", &profile(tag, &curve))]);
        near(light(read(&bytes, "png")), [wanted; 3]);
        let at_once = read_rgba8(&bytes, None, &Limits::default()).unwrap();
        assert_eq!(at_once.is_some(), wanted == srgb, "{wanted}");
    }
}

#[test]
fn code_points_count_before_profiles_and_gammas() {
    let half = 128.0 / 255.0;
    let straight = profile(b"rTRC", &power(1.0));
    // Linear light, and the sRGB curve beside a chunk that says otherwise. [ITU-T H.273, table 3]
    near(light(read(&png(&[(b"cICP", &[1, 8, 0, 1])]), "png")), [half; 3]);
    let both = png(&[(b"cICP", &[1, 13, 0, 1]), (b"iCCP", &straight)]);
    near(light(read(&both, "png")), [0.2159; 3]);
    let gamma = png(&[(b"gAMA", &100_000u32.to_be_bytes()), (b"iCCP", &straight)]);
    near(light(read(&gamma, "png")), [half; 3]);
    // What is not shown is said: PQ, HLG, and primaries that are not converted, of film.
    for (codes, word) in [([9, 16, 0, 1], "PQ"), ([1, 18, 0, 1], "HLG"), ([8, 1, 0, 1], "primaries")] {
        let bytes = png(&[(b"cICP", &codes)]);
        let warnings = read(&bytes, "png").warnings;
        assert!(warnings.len() == 1 && warnings[0].contains(word), "{warnings:?}");
        assert_eq!(read_rgba8(&bytes, None, &Limits::default()).unwrap(), None);
    }
    assert!(read(&png(&[(b"cICP", &[1, 13, 0, 1])]), "png").warnings.is_empty());
}

/// Primaries of Rec. 2020 and of P3 are converted, by the tables of ITU-R BT.2087 and of SMPTE EG 432-1: of equal samples white, and
/// of others by the rows of the matrix to Rec. 709. [ITU-R BT.2087, table 3: inverse of the matrix there]
#[test]
fn code_points_of_wide_primaries_are_converted() {
    for code in [9, 12] {
        let bytes = png(&[(b"cICP", &[code, 13, 0, 1])]);
        let picture = read(&bytes, "png");
        assert!(picture.warnings.is_empty(), "{:?}", picture.warnings);
        assert_eq!(picture.colour_space, ColourSpace::LinearRec709);
        near(light(picture), [0.2159; 3]);
    }
    let to_709 = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
    let samples = [180.0, 150.0, 25.0].map(|byte| byte / 255.0);
    let wanted = to_709.map(|row: [f32; 3]| row.iter().zip(samples).map(|(m, sample)| m * sample).sum());
    let bytes = png_of([180.0, 150.0, 25.0], &[(b"cICP", &[9, 8, 0, 1])]);
    near(light(read(&bytes, "png")), wanted);
}

fn hdr(header: &str, rgbe: [u8; 4]) -> Vec<u8> {
    [format!("#?RADIANCE\n{header}\n-Y 1 +X 1\n").as_bytes(), &rgbe].concat()
}

/// Green of Rec. 2020 in Rec. 709. [ITU-R BT.2087, table 3: inverse of the matrix there]
#[test]
fn radiance_states_primaries() {
    let of = |header: &str| light(read(&hdr(header, [0, 128, 0, 129]), "hdr"));
    near(of("PRIMARIES= .708 .292 .170 .797 .131 .046 .3127 .3290\n"), [-0.5876, 1.1329, -0.1006]);
    near(of("PRIMARIES=0.6400 0.3300 0.2900 0.6000 0.1500 0.0600 0.3333 0.3333\n"), [0.0, 1.0, 0.0]);
    near(of(""), [0.0, 1.0, 0.0]);
    let wrong = hdr("PRIMARIES=.7 .3 .2\n", [0, 128, 0, 129]);
    let error = read_bytes(&wrong, None, &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("eight numbers"), "{error}");
}

/// Corrections have a factor for each channel, and all of them multiply. [Radiance, file formats]
#[test]
fn corrections_of_a_radiance_picture_are_divided_by() {
    let header = "COLORCORR=2 0.5 4\nEXPOSURE=2\nCOLORCORR=1 1 0.25\n";
    near(light(read(&hdr(header, [128, 64, 32, 129]), "hdr")), [0.25, 0.5, 0.125]);
}

/// Lines that begin with a blank are about the pictures that this one was made from. [Radiance, file formats]
#[test]
fn headers_of_inputs_of_a_radiance_picture_do_not_count() {
    let header = "EXPOSURE=2\na.hdr:\n\tEXPOSURE=4\n\tFORMAT=none\nEXPOSURE= 2.0\n";
    near(light(read(&hdr(header, [128, 64, 32, 129]), "hdr")), [0.25, 0.125, 0.0625]);
}

/// Two pixels, (64, 32, 0) of alpha 128 and (10, 20, 30) of alpha 200, with a kind of alpha. [TGA 2.0, field 24]
fn tga(kind: u8) -> Picture {
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 32, 0x28];
    bytes.extend([0, 32, 64, 128, 30, 20, 10, 200]);
    let start = bytes.len() as u32;
    let mut area = vec![0; 495];
    area[..2].copy_from_slice(&495u16.to_le_bytes());
    area[494] = kind;
    bytes.extend(area);
    bytes.extend(start.to_le_bytes());
    bytes.extend(b"\0\0\0\0TRUEVISION-XFILE.\0");
    read(&bytes, "tga")
}

#[test]
fn a_targa_says_what_its_alpha_is() {
    let pixel = |picture: &Picture, x: usize| {
        let colour = picture.rgb(x, 0).to_array();
        [colour[0], colour[1], colour[2], picture.alpha_at(x, 0)].map(|c| (c * 255.0).round() as u8)
    };
    for (kind, first, second) in [
        (0, [64, 32, 0, 255], [10, 20, 30, 255]),
        (1, [64, 32, 0, 255], [10, 20, 30, 255]),
        (3, [64, 32, 0, 128], [10, 20, 30, 200]),
        // 64 · 255 / 128 = 127.5, and 10 · 255 / 200 = 12.75.
        (4, [128, 64, 0, 128], [13, 26, 38, 200]),
    ] {
        let picture = tga(kind);
        assert_eq!([pixel(&picture, 0), pixel(&picture, 1)], [first, second], "{kind}");
    }
}

/// Adobe's segment says that the samples are red, green and blue; but a file of JFIF has luma and chroma, as libjpeg and browsers
/// read it.
#[test]
fn a_jpeg_of_jfif_has_luma_and_chroma_whatever_adobe_says() {
    let picture = Picture::from_rgb(8, 8, vec![Rgb::new(0.6, 0.02, 0.05); 64]).unwrap();
    let plain = write_bytes("jpeg", &picture, &WriteOptions::default()).unwrap();
    let wanted = read(&plain, "jpeg").rgb(4, 4);
    let is_jfif = plain.windows(5).any(|name| name == b"JFIF\0");
    let adobe = |transform: u8| [b"\xff\xee\0\x0eAdobe\0\x64\0\0\0\0".as_slice(), &[transform]].concat();
    let frame = plain.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    let with = |transform: u8| [&plain[..frame], &adobe(transform), &plain[frame..]].concat();
    assert!(is_jfif);
    for transform in [0, 1] {
        assert_eq!(read(&with(transform), "jpeg").rgb(4, 4), wanted, "{transform}");
    }
}

/// Eight pixels of one bit, of which only the last of the byte is white, in an order of bits. [TIFF 6.0]
fn tiff(order: u8) -> Vec<u8> {
    // Width, height, bits, compression, black is zero, order of bits, where the pixels are, samples, rows, bytes.
    let tags = [(0, 8), (1, 1), (2, 1), (3, 1), (6, 1), (10, order), (17, 134), (21, 1), (22, 1), (23, 1)];
    let entries = tags.into_iter().flat_map(|(tag, value)| [tag, 1, 3, 0, 1, 0, 0, 0, value, 0, 0, 0]);
    let head = [b'I', b'I', 42, 0, 8, 0, 0, 0, tags.len() as u8, 0];
    let mut bytes: Vec<u8> = head.into_iter().chain(entries).collect();
    bytes.extend([0; 4]);
    bytes.push(1);
    bytes
}

#[test]
fn a_tiff_whose_bytes_begin_with_the_lowest_bit_is_refused() {
    let row = |picture: &Picture| (0..8).map(|x| picture.rgb(x, 0).r).collect::<Vec<_>>();
    assert_eq!(row(&read(&tiff(1), "tiff")), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let error = read_bytes(&tiff(2), None, &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("FillOrder 2"), "{error}");
}

/// A KTX2 file of 2 × 2 bytes RGBA in sRGB, with keys. [KTX 2.0, 3 and 5]
#[cfg(feature = "ktx2")]
fn ktx2(keys: &[(&str, &str)], flags: u8) -> Vec<u8> {
    let mut descriptor = vec![0u8; 92];
    descriptor[0] = 92;
    (descriptor[12], descriptor[13], descriptor[14], descriptor[15]) = (1, 1, 2, flags);
    let mut pairs = Vec::new();
    for (key, value) in keys {
        pairs.extend((key.len() as u32 + value.len() as u32 + 2).to_le_bytes());
        pairs.extend(format!("{key}\0{value}\0").bytes());
        pairs.resize(pairs.len().next_multiple_of(4), 0);
    }
    let pixels = [[200, 10, 0, 255], [0, 150, 20, 255], [30, 0, 100, 128], [64, 32, 0, 128]].concat();
    let (first, second) = (104u32, 104 + descriptor.len() as u32);
    let third = second + pairs.len() as u32;
    let mut bytes = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    let of_pairs = if pairs.is_empty() { 0 } else { second };
    for number in [43, 1, 2, 2, 0, 0, 1, 1, 0, first, descriptor.len() as u32, of_pairs, pairs.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend([0; 16]);
    for number in [u64::from(third), 16, 16] {
        bytes.extend(number.to_le_bytes());
    }
    [bytes, descriptor, pairs, pixels].concat()
}

#[cfg(feature = "ktx2")]
#[test]
fn a_ktx_says_which_way_up_it_is_and_which_channels_it_has() {
    let texels =
        |keys: &[(&str, &str)]| read_rgba8(&ktx2(keys, 0), None, &Limits::default()).unwrap().unwrap().texels;
    let [a, b, c, d] = [[200, 10, 0, 255], [0, 150, 20, 255], [30, 0, 100, 128], [64, 32, 0, 128]];
    assert_eq!(texels(&[]), [a, b, c, d]);
    assert_eq!(texels(&[("KTXorientation", "rd")]), [a, b, c, d]);
    assert_eq!(texels(&[("KTXwriter", "x"), ("KTXorientation", "ru")]), [c, d, a, b]);
    assert_eq!(texels(&[("KTXorientation", "ld")]), [b, a, d, c]);
    assert_eq!(
        texels(&[("KTXorientation", "lu"), ("KTXswizzle", "bg01")]),
        [[0, 32, 0, 255], [100, 0, 0, 255], [20, 150, 0, 255], [0, 10, 0, 255]]
    );
    // Multiplied by alpha: bit 0 of the flags.
    let bytes = ktx2(&[], 1);
    assert_eq!(read_rgba8(&bytes, None, &Limits::default()).unwrap(), None);
    let picture = read(&bytes, "ktx2");
    assert_eq!((picture.alpha, read(&ktx2(&[], 0), "ktx2").alpha), (Alpha::Premultiplied, Alpha::Straight));
}
