//! Pictures as cameras and interrupted downloads leave them: turned by Exif, cut short, of 12 bits.

use bilux_math::Rgb;
use bilux_pictures::{BitDepth, Limits, Picture, WriteOptions, read_bytes, read_rgba8, write_bytes};

/// Red and green above blue and white, each of 16 × 8 pixels.
fn quarters() -> Picture {
    let colour = |x: usize, y: usize| match (x < 16, y < 8) {
        (true, true) => Rgb::new(1.0, 0.0, 0.0),
        (false, true) => Rgb::new(0.0, 1.0, 0.0),
        (true, false) => Rgb::new(0.0, 0.0, 1.0),
        (false, false) => Rgb::WHITE,
    };
    let pixels = (0..16).flat_map(|y| (0..32).map(move |x| colour(x, y))).collect();
    Picture::from_rgb(32, 16, pixels).unwrap()
}

fn jpeg() -> Vec<u8> {
    write_bytes("jpeg", &quarters(), &WriteOptions::default()).unwrap()
}

/// Exif data that state an orientation: one entry, tag 0x0112. [Exif]
fn exif(orientation: u8) -> Vec<u8> {
    [&b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"[..], &[orientation, 0, 0, 0, 0, 0, 0]].concat()
}

fn in_jpeg(orientation: u8) -> Vec<u8> {
    let body = [&b"Exif\0\0"[..], &exif(orientation)].concat();
    let [high, low] = (body.len() as u16 + 2).to_be_bytes();
    let plain = jpeg();
    [&plain[..2], &[0xff, 0xe1, high, low], &body, &plain[2..]].concat()
}

/// A chunk `eXIf` before the pixels. [PNG, 11.3.4.5]
fn in_png(orientation: u8, options: &WriteOptions) -> Vec<u8> {
    with_exif(&write_bytes("png", &quarters(), options).unwrap(), orientation)
}

fn with_exif(plain: &[u8], orientation: u8) -> Vec<u8> {
    let body = [&b"eXIf"[..], &exif(orientation)].concat();
    let crc = body.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    });
    let length = (body.len() as u32 - 4).to_be_bytes();
    [&plain[..33], &length, &body, &(!crc).to_be_bytes(), &plain[33..]].concat()
}

/// The colours in the corners: top left, top right, bottom left, bottom right.
fn corners(picture: &Picture) -> String {
    let (right, bottom) = (picture.width() - 3, picture.height() - 3);
    let letter = |(x, y): (usize, usize)| match picture.rgb(x, y).to_array().map(|c| c > 0.5) {
        [true, false, false] => 'r',
        [false, true, false] => 'g',
        [false, false, true] => 'b',
        [true, true, true] => 'w',
        other => panic!("{other:?} at {x}, {y}"),
    };
    [(2, 2), (right, 2), (2, bottom), (right, bottom)].map(letter).iter().collect()
}

/// Places of the corners follow from the standard's table, which says where row 0 and column 0 are.
#[test]
fn all_eight_orientations_are_applied() {
    let sixteen = WriteOptions { bit_depth: bilux_pictures::BitDepth::Sixteen, ..WriteOptions::default() };
    for (orientation, wanted, size) in [
        (1, "rgbw", (32, 16)),
        (2, "grwb", (32, 16)),
        (3, "wbgr", (32, 16)),
        (4, "bwrg", (32, 16)),
        (5, "rbgw", (16, 32)),
        (6, "brwg", (16, 32)),
        (7, "wgbr", (16, 32)),
        (8, "gwrb", (16, 32)),
        (0, "rgbw", (32, 16)),
        (9, "rgbw", (32, 16)),
    ] {
        for file in [
            in_jpeg(orientation),
            in_png(orientation, &WriteOptions::default()),
            in_png(orientation, &sixteen),
        ] {
            let picture = read_bytes(&file, None, &Limits::default()).unwrap();
            assert_eq!((picture.width(), picture.height()), size, "{orientation}");
            assert_eq!(corners(&picture), wanted, "{orientation}");
            let Some(texels) = read_rgba8(&file, None, &Limits::default()).unwrap() else { continue };
            assert_eq!((texels.width, texels.height), size, "{orientation}");
            for (i, texel) in texels.texels.iter().enumerate() {
                let red = picture.rgb(i % size.0, i / size.0).r;
                assert!((f32::from(texel[0]) / 255.0 - red).abs() < 1e-6, "{orientation}");
            }
        }
    }
}

#[test]
fn a_jpeg_without_its_end_marker_is_whole() {
    let whole = read_bytes(&jpeg(), None, &Limits::default()).unwrap();
    assert!(whole.warnings.is_empty());
    let bytes = jpeg();
    let picture = read_bytes(&bytes[..bytes.len() - 2], None, &Limits::default()).unwrap();
    assert_eq!(picture.channels(), whole.channels());
    assert!(picture.warnings[0].contains("no end marker, but all of its pixels"), "{:?}", picture.warnings);
    let texels = read_rgba8(&bytes[..bytes.len() - 2], None, &Limits::default()).unwrap().unwrap();
    assert_eq!(texels.warnings, picture.warnings);
}

/// A picture of noise, whose bytes are spread evenly over its rows.
#[test]
fn of_a_jpeg_that_was_cut_short_the_rows_that_are_there_are_shown() {
    let noise = |i: usize| ((i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f32 / (1 << 24) as f32;
    let pixels = (0..64 * 128).map(|i| Rgb::new(noise(i), noise(i + 99_991), noise(i + 777))).collect();
    let picture = Picture::from_rgb(64, 128, pixels).unwrap();
    let bytes = write_bytes("jpeg", &picture, &WriteOptions::default()).unwrap();
    let whole = read_bytes(&bytes, None, &Limits::default()).unwrap();
    let cut = read_bytes(&bytes[..bytes.len() * 3 / 4], None, &Limits::default()).unwrap();
    assert!(cut.warnings[0].contains("was cut short"), "{:?}", cut.warnings);
    let said: usize = cut.warnings[0].split(' ').find_map(|word| word.parse().ok()).unwrap();
    let (first, all) = (whole.channel("R").unwrap(), cut.channel("R").unwrap());
    let right = first.chunks(64).zip(all.chunks(64)).take_while(|(a, b)| a == b).count();
    // Header and tables are a part of the bytes too.
    assert!((50..128).contains(&right), "{right} rows");
    assert!(
        right >= 128 - said && 128 - said + 16 > right,
        "{right} rows are right, and {said} are called wrong"
    );
    // Within the header there is nothing to show.
    for length in [2, 20, 300] {
        let error = read_bytes(&bytes[..length], Some("jpeg"), &Limits::default()).unwrap_err().to_string();
        assert!(error.contains("cut short") || error.contains("damaged"), "{length}: {error}");
    }
}

/// An extended sequential frame of 12 bits per sample. [JPEG, B.2.2]
#[test]
fn a_jpeg_of_12_bits_is_refused_with_the_program_that_converts_it() {
    let mut bytes = jpeg();
    let frame = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    bytes[frame + 1] = 0xc1;
    bytes[frame + 4] = 12;
    let error = read_bytes(&bytes, None, &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("12 bits per sample") && error.contains("djpeg"), "{error}");
}

/// Inks as Photoshop stores them, inverted: plain (Adobe transform 0) and as YCCK (transform 2). Of each ink, and of black, light
/// keeps what is left: red = (1 − cyan)(1 − black).
#[test]
fn jpegs_of_four_inks_have_the_colours_of_their_inks() {
    use jpeg_encoder::{ColorType, Encoder};
    for (inks, rgb) in [
        ([255, 0, 0, 0], [0.0, 1.0, 1.0]),
        ([0, 255, 0, 0], [1.0, 0.0, 1.0]),
        ([0, 0, 255, 0], [1.0, 1.0, 0.0]),
        ([0, 0, 0, 255], [0.0, 0.0, 0.0]),
        ([0, 0, 0, 0], [1.0, 1.0, 1.0]),
        ([51, 102, 0, 102], [0.48, 0.36, 0.6]),
    ] {
        for kind in [ColorType::Cmyk, ColorType::CmykAsYcck] {
            let mut bytes = Vec::new();
            Encoder::new(&mut bytes, 100).encode(&inks.repeat(256), 16, 16, kind).unwrap();
            let picture = read_bytes(&bytes, None, &Limits::default()).unwrap();
            let found = picture.rgb(8, 8).to_array();
            let is_near = found.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 0.02);
            assert!(is_near, "{inks:?} as {kind:?}: {found:?}, not {rgb:?}");
        }
    }
}

/// The definition of the format: RY = (R − Y) / Y, BY = (B − Y) / Y.
#[test]
fn an_exr_of_luminance_and_chroma_has_its_colours() {
    let [r, g, b] = [0.5, 0.25, 2.0f32];
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let mut picture = Picture::new(4, 4).unwrap();
    for (name, value) in [("Y", y), ("RY", (r - y) / y), ("BY", (b - y) / y), ("A", 1.0)] {
        picture.push_channel(name, vec![value; 16]).unwrap();
    }
    let bytes = write_bytes("exr", &picture, &WriteOptions::default()).unwrap();
    let read = read_bytes(&bytes, None, &Limits::default()).unwrap();
    let found = read.rgb(1, 1).to_array();
    assert!(found.iter().zip([r, g, b]).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
    assert!(read.channel("RY").is_none() && read.channel("A").is_some());
}

/// A colour that stands for nothing: `tRNS` of a picture without a palette, in 8 and 16 bits. [PNG, 11.3.1.1]
#[test]
fn the_transparent_colour_of_a_png_is_transparent() {
    let chunk = |kind: &[u8], data: &[u8]| {
        let body = [kind, data].concat();
        let crc = body.iter().fold(!0u32, |crc, &byte| {
            (0..8)
                .fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
        });
        [&(data.len() as u32).to_be_bytes()[..], &body, &(!crc).to_be_bytes()].concat()
    };
    for (bits, key, row) in [
        (8u8, vec![0, 255, 0, 0, 0, 0], vec![0, 255, 0, 0, 0, 255, 0]),
        (16, vec![1, 2, 3, 4, 5, 6], vec![0, 1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 7]),
    ] {
        let header = [&[0, 0, 0, 2, 0, 0, 0, 1][..], &[bits, 2, 0, 0, 0]].concat();
        // A deflate stream of one stored block, with the header and the checksum of zlib.
        let (a, b) = row.iter().fold((1u32, 0u32), |(a, b), &byte| {
            let a = (a + u32::from(byte)) % 65521;
            (a, (b + a) % 65521)
        });
        let length = row.len() as u16;
        let stored = [
            &[0x78, 1, 1][..],
            &length.to_le_bytes(),
            &(!length).to_le_bytes(),
            &row,
            &(b << 16 | a).to_be_bytes(),
        ];
        let file = [
            b"\x89PNG\r\n\x1a\n".to_vec(),
            chunk(b"IHDR", &header),
            chunk(b"tRNS", &key),
            chunk(b"IDAT", &stored.concat()),
            chunk(b"IEND", &[]),
        ];
        let picture = read_bytes(&file.concat(), None, &Limits::default()).unwrap();
        assert_eq!([picture.alpha_at(0, 0), picture.alpha_at(1, 0)], [0.0, 1.0], "{bits} bits");
    }
}

/// Bit 4 of the descriptor: the first pixel is the rightmost; bit 5: the first row is the uppermost. [TGA 2.0, field 5.6]
#[test]
fn targas_are_turned_as_their_descriptors_say() {
    // Blue, green, red of four pixels: A B / C D in the order of the file.
    let pixels = [[0, 0, 255], [0, 255, 0], [255, 0, 0], [255, 255, 255]];
    for (descriptor, wanted) in [(0u8, "bwrg"), (0x10, "wbgr"), (0x20, "rgbw"), (0x30, "grwb")] {
        for is_packed in [false, true] {
            let kind = if is_packed { 10 } else { 2 };
            let mut file = vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, descriptor];
            for pixel in pixels {
                // A packet of one pixel.
                file.extend(is_packed.then_some(0));
                file.extend(pixel);
            }
            let picture = read_bytes(&file, Some("tga"), &Limits::default()).unwrap();
            let letter = |(x, y): (usize, usize)| match picture.rgb(x, y).to_array().map(|c| c > 0.5) {
                [true, false, false] => 'r',
                [false, true, false] => 'g',
                [false, false, true] => 'b',
                _ => 'w',
            };
            let found: String = [(0, 0), (1, 0), (0, 1), (1, 1)].map(letter).iter().collect();
            assert_eq!(found, wanted, "descriptor {descriptor:#x}, packed: {is_packed}");
        }
    }
}

/// The eight resolution strings: the first axis is that of the scanlines, and its sign says where they begin. [Ward 1991]
#[test]
fn hdr_pictures_are_turned_as_their_resolution_strings_say() {
    // A pixel of mantissa 255 and exponent 128 is nearly 1. Three pixels along a scanline, two scanlines: A B C / D E F.
    for (resolution, rows) in [
        ("-Y 2 +X 3", ["ABC", "DEF"].as_slice()),
        ("-Y 2 -X 3", &["CBA", "FED"]),
        ("+Y 2 +X 3", &["DEF", "ABC"]),
        ("+Y 2 -X 3", &["FED", "CBA"]),
        ("+X 2 -Y 3", &["AD", "BE", "CF"]),
        ("-X 2 -Y 3", &["DA", "EB", "FC"]),
        ("+X 2 +Y 3", &["CF", "BE", "AD"]),
        ("-X 2 +Y 3", &["FC", "EB", "DA"]),
    ] {
        let mut file = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{resolution}\n").into_bytes();
        for letter in b"ABCDEF" {
            file.extend([letter * 2, 200, 200, 128]);
        }
        let picture = read_bytes(&file, None, &Limits::default()).unwrap();
        assert_eq!((picture.width(), picture.height()), (rows[0].len(), rows.len()), "{resolution}");
        for (y, row) in rows.iter().enumerate() {
            for (x, letter) in row.bytes().enumerate() {
                // (m + 0.5) / 256 · 2^(e − 128), or without the half.
                let wanted = f32::from(letter * 2) / 256.0;
                let found = picture.rgb(x, y).r;
                assert!((found - wanted).abs() < 0.003, "{resolution} at {x}, {y}: {found}, not {wanted}");
            }
        }
    }
}

/// The file states the primaries of Rec. 2020, whose luminance has other weights (ITU-R BT.2020: 0.2627,
/// 0.6780, 0.0593), and a grey stays grey.
#[test]
fn an_exr_of_luminance_and_chroma_has_the_colours_of_its_primaries() {
    let [r, g, b] = [0.5, 0.25, 2.0f32];
    let y = 0.2627 * r + 0.6780 * g + 0.0593 * b;
    let of = |channels: &[(&str, f32)]| {
        let mut picture = Picture::new(2, 2).unwrap();
        for (name, value) in channels {
            picture.push_channel(*name, vec![*value; 4]).unwrap();
        }
        let mut bytes = write_bytes("exr", &picture, &WriteOptions::default()).unwrap();
        let key = b"chromaticities\0chromaticities\0";
        let at = bytes.windows(key.len()).position(|part| part == key).unwrap() + key.len() + 4;
        let primaries = [0.708f32, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290];
        bytes[at..at + 32].copy_from_slice(&primaries.map(f32::to_le_bytes).concat());
        read_bytes(&bytes, None, &Limits::default()).unwrap().rgb(1, 1).to_array()
    };
    let chroma = of(&[("Y", y), ("RY", (r - y) / y), ("BY", (b - y) / y)]);
    let plain = of(&[("R", r), ("G", g), ("B", b)]);
    assert!(chroma.iter().zip(plain).all(|(a, b)| (a - b).abs() < 2e-3), "{chroma:?}, not {plain:?}");
    assert!((plain[2] - b).abs() > 0.1, "the primaries count: {plain:?}");
}

/// A PNG of 16 bits has straight alpha, turned or not, and its light is multiplied by it.
#[test]
fn a_turned_picture_with_alpha_keeps_its_light() {
    let mut stored = Picture::from_rgb(2, 1, vec![Rgb::new(0.25, 0.125, 0.5); 2]).unwrap();
    stored.push_channel("A", vec![0.5; 2]).unwrap();
    let options = WriteOptions { bit_depth: BitDepth::Sixteen, ..WriteOptions::default() };
    for orientation in [1, 3, 6] {
        let bytes = with_exif(&write_bytes("png", &stored, &options).unwrap(), orientation);
        let picture = read_bytes(&bytes, None, &Limits::default()).unwrap().into_linear();
        let found = [picture.rgb(0, 0).to_array().as_slice(), &[picture.alpha_at(0, 0)]].concat();
        let is_near = found.iter().zip([0.25, 0.125, 0.5, 0.5]).all(|(a, b)| (a - b).abs() < 1e-4);
        assert!(is_near, "orientation {orientation}: {found:?}");
    }
}
