//! Round trips: what is written is read back, to the bit where the format can hold it, and the same bytes are written
//! every time.

use bilux_math::Rgb;
use bilux_pictures::{
    Alpha, BitDepth, ColourSpace, Crop, Limits, PICTURE_FORMATS, Picture, PictureError, Source, WriteOptions,
    read, read_bytes, read_crop_bytes, read_interleaved_bytes, write, write_bytes, write_source_bytes,
};

/// Values that a careless writer loses: signed zero, subnormal, huge, infinite, NaN.
const NASTY: [f32; 8] = [0.0, -0.0, 1e-40, f32::MAX, f32::MIN_POSITIVE, f32::INFINITY, f32::NAN, -3.25];

fn hash(seed: u32) -> u32 {
    let mut h = seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
    h = (h ^ (h >> 15)).wrapping_mul(0x85eb_ca6b);
    h ^ (h >> 13)
}

fn unit(seed: u32) -> f32 {
    (hash(seed) >> 8) as f32 / (1 << 24) as f32
}

fn noise(width: usize, height: usize, names: &[&str]) -> Picture {
    let mut picture = Picture::new(width, height).unwrap();
    for (channel, name) in names.iter().enumerate() {
        let plane = (0..width * height).map(|i| unit((i * 7 + channel) as u32)).collect();
        picture.push_channel(*name, plane).unwrap();
    }
    picture
}

fn bits(samples: &[f32]) -> Vec<u32> {
    samples.iter().map(|s| s.to_bits()).collect()
}

fn round_trip(format: &str, picture: &Picture, options: &WriteOptions) -> Picture {
    let bytes = write_bytes(format, picture, options).unwrap();
    assert_eq!(bytes, write_bytes(format, picture, options).unwrap(), "{format} is not deterministic");
    read_bytes(&bytes, None, &Limits::default()).unwrap()
}

#[test]
fn exr_keeps_floats_integers_layers_and_texts_to_the_bit() {
    for (width, height) in [(1, 1), (7, 5), (33, 17), (100, 64)] {
        let names =
            ["R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "depth.Z", "normal.X", "normal.Y"];
        let mut picture = noise(width, height, &names);
        for name in ["R", "depth.Z"] {
            let plane = picture.channel_mut(name).unwrap();
            plane.iter_mut().zip(NASTY.iter().cycle()).for_each(|(sample, nasty)| *sample = *nasty);
        }
        let limbs = |seed| (0..width * height).map(|i| hash(seed + i as u32)).collect::<Vec<u32>>();
        picture.push_integer_plane("sum.R.0", limbs(1)).unwrap();
        picture.push_integer_plane("sum.R.1", limbs(2)).unwrap();
        picture.push_integer_plane("a_very_long_name_that_needs_the_long_name_flag", limbs(3)).unwrap();
        for key in ["bilux.scale", "comments", "owner", "software", "zebra", "Ünïcode"] {
            picture.metadata.insert(key.to_owned(), format!("text of {key}: 東京"));
        }
        let back = round_trip("exr", &picture, &WriteOptions::default());
        assert_eq!(back.channels().len(), picture.channels().len());
        for channel in picture.channels() {
            let same = bits(back.channel(&channel.name).unwrap()) == bits(&channel.samples);
            assert!(same, "{} at {width} x {height}", channel.name);
        }
        for plane in picture.integer_planes() {
            assert_eq!(back.integer_plane(&plane.name), Some(&plane.samples[..]));
        }
        assert_eq!(back.metadata, picture.metadata);
        assert_eq!(back.layers(), ["albedo", "depth", "normal", "sum.R"]);
    }
}

#[test]
fn exr_keeps_the_place_of_a_crop() {
    let names = ["R", "G", "B", "A", "depth.Z"];
    // Wider and higher than a block of rows, at places that are no multiple of one.
    let mut picture = noise(21, 37, &names);
    picture.push_integer_plane("id.object", (1..=21 * 37).collect()).unwrap();
    picture.crop = Some(Crop { x: 5, y: 23, whole: [40, 64] });
    let bytes = write_bytes("exr", &picture, &WriteOptions::default()).unwrap();
    let limits = Limits::default();
    let back = read_crop_bytes(&bytes, None, &limits).unwrap();
    assert_eq!((back.width(), back.height(), back.crop), (21, 37, picture.crop));
    let whole = read_bytes(&bytes, None, &limits).unwrap();
    assert_eq!((whole.width(), whole.height(), whole.crop), (40, 64, None));
    for name in names {
        let (part, all) = (picture.channel(name).unwrap(), whole.channel(name).unwrap());
        assert_eq!(bits(back.channel(name).unwrap()), bits(part), "{name}");
        for (i, &sample) in all.iter().enumerate() {
            let (x, y) = (i % 40, i / 40);
            let is_within = (5..26).contains(&x) && (23..60).contains(&y);
            let expected = if is_within { part[(y - 23) * 21 + x - 5] } else { 0.0 };
            assert_eq!(sample.to_bits(), expected.to_bits(), "{name} at {x},{y}");
        }
    }
    assert_eq!(back.integer_plane("id.object"), picture.integer_plane("id.object"));
    // A place that is not within the larger picture is refused, not written.
    for crop in [Crop { x: 20, y: 23, whole: [40, 64] }, Crop { x: 0, y: 0, whole: [usize::MAX, 64] }] {
        picture.crop = Some(crop);
        let error = write_bytes("exr", &picture, &WriteOptions::default()).unwrap_err().to_string();
        assert!(error.contains("not within a picture"), "{error}");
    }
}

#[test]
fn exr_keeps_matrices_as_numbers() {
    let mut picture = noise(2, 2, &["R", "G", "B"]);
    let numbers = (0..16).map(|i| (i as f32 / 3.0 - 2.0).to_string()).collect::<Vec<_>>().join(" ");
    picture.metadata.insert("worldToCamera".to_owned(), numbers);
    picture.metadata.insert("Software".to_owned(), "bilux".to_owned());
    let back = round_trip("exr", &picture, &WriteOptions::default());
    assert_eq!(back.metadata["worldToCamera"], picture.metadata["worldToCamera"]);
    assert_eq!(back.metadata["software"], "bilux", "as the format calls it");
    assert_eq!(back.to_rgb(), picture.to_rgb(), "the primaries are our own");
    let again = round_trip("png", &back, &WriteOptions::default());
    assert_eq!(again.metadata.into_iter().collect::<Vec<_>>(), [("Software".to_owned(), "bilux".to_owned())]);
    picture.metadata.insert("worldToNDC".to_owned(), "no matrix".to_owned());
    let error = write_bytes("exr", &picture, &WriteOptions::default()).unwrap_err().to_string();
    assert!(error.contains("'worldToNDC'"), "{error}");
}

/// Names of more than 31 bytes are allowed where the version of the file says so. [OpenEXR File Layout, version field: bit 10]
#[test]
fn exr_says_that_names_are_long() {
    let flags = |key: &str, channel: &str| {
        let mut picture = noise(2, 2, &["R", "G", "B"]);
        picture.push_channel(channel, vec![0.25; 4]).unwrap();
        picture.metadata.insert(key.to_owned(), "x".to_owned());
        let bytes = write_bytes("exr", &picture, &WriteOptions::default()).unwrap();
        assert_eq!(read_bytes(&bytes, None, &Limits::default()).unwrap().metadata[key], "x");
        bytes[5] & 4
    };
    let (long, just) = ("k".repeat(32), "k".repeat(31));
    assert_eq!([flags("short", "Z"), flags(&just, &just)], [0, 0]);
    assert_eq!([flags(&long, "Z"), flags("short", &long)], [4, 4]);
}

/// Files of several strips have each row once, whatever their format.
#[test]
fn large_pictures_for_displays_have_all_of_their_rows() {
    let (width, height) = (1031, 1100);
    let mut picture = Picture::new(width, height).unwrap();
    for (name, turn) in [("R", 1), ("G", 3), ("B", 7)] {
        let row = |y: usize| (((y * turn / 4) % 500) as f32 - 250.0).abs() / 250.0;
        picture.push_channel(name, (0..width * height).map(|i| row(i / width)).collect()).unwrap();
    }
    picture.colour_space = ColourSpace::Srgb;
    for (format, off) in [("png", 3e-3), ("jpeg", 0.1), ("webp", 3e-3), ("ppm", 3e-3)] {
        let options = WriteOptions { quality: 95, ..WriteOptions::default() };
        let Ok(bytes) = write_bytes(format, &picture, &options) else { panic!("{format} is not written") };
        let back = read_bytes(&bytes, Some(format), &Limits::default()).unwrap();
        assert_eq!((back.width(), back.height()), (width, height), "{format}");
        for y in (0..height).step_by(37) {
            let (found, wanted) = (back.rgb(500, y), picture.rgb(500, y));
            let is_near = (0..3).all(|c| (found[c] - wanted[c]).abs() < off);
            assert!(is_near, "{format}, row {y}: {found:?}, not {wanted:?}");
        }
    }
}

/// Pictures of cameras whose pixels are no squares: programs that heed the attribute show them undistorted.
#[test]
fn exr_keeps_the_shape_of_pixels_and_says_it() {
    let mut picture = noise(3, 2, &["R", "G", "B"]);
    assert!(round_trip("exr", &picture, &WriteOptions::default()).warnings.is_empty());
    picture.metadata.insert("pixelAspectRatio".to_owned(), "1.5".to_owned());
    let bytes = write_bytes("exr", &picture, &WriteOptions::default()).unwrap();
    let name = b"pixelAspectRatio\0float\0\x04\0\0\0";
    let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
    assert_eq!(bytes[at..at + 4], 1.5f32.to_le_bytes());
    let back = read_bytes(&bytes, None, &Limits::default()).unwrap();
    assert_eq!((&*back.metadata["pixelAspectRatio"], back.to_rgb()), ("1.5", picture.to_rgb()));
    assert!(back.warnings[0].contains("1.5 times as wide as high"), "{:?}", back.warnings);
}

#[test]
fn pfm_keeps_floats_to_the_bit() {
    for names in [&["R", "G", "B"][..], &["Y"]] {
        let mut picture = noise(13, 9, names);
        let plane = picture.channel_mut(names[0]).unwrap();
        plane.iter_mut().zip(NASTY.iter().cycle()).for_each(|(sample, nasty)| *sample = *nasty);
        let back = round_trip("pfm", &picture, &WriteOptions::default());
        for name in names {
            assert_eq!(bits(back.channel(name).unwrap()), bits(picture.channel(name).unwrap()));
        }
    }
}

#[test]
fn png_and_ppm_keep_every_step() {
    for (depth, steps) in [(BitDepth::Eight, 255u32), (BitDepth::Sixteen, 65535)] {
        for (format, names) in [
            ("png", &["R", "G", "B"][..]),
            ("png", &["R", "G", "B", "A"]),
            ("png", &["Y"]),
            ("png", &["Y", "A"]),
            ("ppm", &["R", "G", "B"]),
            ("ppm", &["Y"]),
        ] {
            let mut picture = noise(256, 257, names);
            picture.colour_space = ColourSpace::Srgb;
            picture.alpha = if format == "png" { Alpha::Straight } else { Alpha::Premultiplied };
            for name in names {
                let plane = picture.channel_mut(name).unwrap();
                plane
                    .iter_mut()
                    .enumerate()
                    .for_each(|(i, s)| *s = (i as u32 % (steps + 1)) as f32 / steps as f32);
            }
            let options = WriteOptions { bit_depth: depth, ..WriteOptions::default() };
            assert_eq!(round_trip(format, &picture, &options), picture, "{format} {names:?} {steps}");
        }
    }
}

#[test]
fn png_keeps_texts() {
    let mut picture = noise(3, 2, &["R", "G", "B"]);
    picture.metadata.insert("Software".to_owned(), "Bilux".to_owned());
    picture.metadata.insert("Title".to_owned(), "Teekanne, Größe 5, 東京".to_owned());
    assert_eq!(round_trip("png", &picture, &WriteOptions::default()).metadata, picture.metadata);
}

#[test]
fn hdr_is_within_half_a_step_and_then_exact() {
    for (width, height) in [(1, 1), (7, 3), (8, 3), (300, 20)] {
        let mut picture = noise(width, height, &["R", "G", "B"]);
        for name in ["R", "G", "B"] {
            let plane = picture.channel_mut(name).unwrap();
            // Flat stretches, so that there are runs; and many powers of two.
            plane.iter_mut().enumerate().for_each(|(i, s)| {
                let exponent = (i / 11 % 60) as i32 - 30;
                *s =
                    if i / 50 % 2 == 0 { 0.75 } else { *s } * f32::from_bits(((127 + exponent) as u32) << 23);
            });
        }
        let once = round_trip("hdr", &picture, &WriteOptions::default());
        for y in 0..height {
            for x in 0..width {
                let (a, b) = (picture.rgb(x, y), once.rgb(x, y));
                let step = a.max_channel() / 128.0;
                assert!((0..3).all(|c| (a[c] - b[c]).abs() <= 0.5001 * step), "{a:?} became {b:?}");
            }
        }
        assert_eq!(round_trip("hdr", &once, &WriteOptions::default()), once);
    }
}

#[test]
fn hdr_holds_whole_numbers_and_limits() {
    let colours = [Rgb::grey(1.0), Rgb::new(255.0, 3.0, 0.0), Rgb::grey(f32::INFINITY), Rgb::grey(f32::NAN)];
    let picture = Picture::from_rgb(4, 1, colours.to_vec()).unwrap();
    let back = round_trip("hdr", &picture, &WriteOptions::default());
    assert_eq!((back.rgb(0, 0), back.rgb(1, 0)), (colours[0], colours[1]));
    assert!(back.rgb(2, 0).r > 1e38 && back.rgb(2, 0).is_finite());
    assert_eq!(back.rgb(3, 0), Rgb::BLACK);
}

/// Bytes by hand, from the formats' own specifications: an error that writer and reader share would survive a round
/// trip.
#[test]
fn bytes_mean_what_their_formats_say() {
    let read = |bytes: &[u8]| read_bytes(bytes, None, &Limits::default()).unwrap();
    // Radiance: a mantissa is in units of 1/256, and the exponent is biased by 128. One pixel of 1, 1/2 and 1/4; one
    // of 64, 0 and 0.
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    let hdr = read(&[&header[..], &[128, 64, 32, 129], &[128, 0, 0, 135]].concat());
    assert_eq!(hdr.to_rgb().unwrap(), [Rgb::new(1.0, 0.5, 0.25), Rgb::new(64.0, 0.0, 0.0)]);
    // PFM: bottom row first; the sign of the scale is the byte order.
    for (scale, bytes) in [("1.0", 2.0f32.to_be_bytes()), ("-1.0", 2.0f32.to_le_bytes())] {
        let pfm = read(&[format!("Pf\n1 2\n{scale}\n").as_bytes(), &bytes, &[0; 4]].concat());
        assert_eq!(pfm.channel("Y").unwrap(), [0.0, 2.0], "{scale}");
    }
    // PPM of 16 bits: most significant byte first, by the sRGB curve.
    let ppm = read(&[&b"P6\n1 1\n65535\n"[..], &[0x80, 0x00, 0xff, 0xff, 0x00, 0x00]].concat());
    let light = ppm.into_linear().to_rgb().unwrap()[0];
    assert!((light - Rgb::new(0.214_05, 1.0, 0.0)).map(f32::abs).max_channel() < 2e-5, "{light:?}");
    // The reverse: written.
    let picture = Picture::from_rgb(1, 2, vec![Rgb::grey(1.0), Rgb::grey(0.502_886)]).unwrap();
    let written = |format: &str| write_bytes(format, &picture, &WriteOptions::default()).unwrap();
    assert!(written("ppm").ends_with(&[255, 255, 255, 188, 188, 188]));
    assert!(written("hdr").ends_with(&[128, 128, 128, 129, 129, 129, 129, 128]));
    assert!(written("pfm").ends_with(&[1.0f32.to_le_bytes(); 3].concat()));
}

#[test]
fn display_formats_encode_light() {
    let picture = Picture::from_rgb(3, 1, vec![Rgb::grey(0.5), Rgb::grey(7.0), Rgb::grey(-1.0)]).unwrap();
    for format in ["png", "ppm"] {
        let back = round_trip(format, &picture, &WriteOptions::default());
        let bytes: Vec<u32> = (0..3).map(|x| (back.rgb(x, 0).r * 255.0).round() as u32).collect();
        assert_eq!(bytes, [188, 255, 0]);
        assert_eq!(back.colour_space, ColourSpace::Srgb);
    }
    let brighter = WriteOptions { exposure: 1.0, ..WriteOptions::default() };
    assert_eq!(round_trip("png", &picture, &brighter).rgb(0, 0), Rgb::WHITE);
}

#[test]
fn alpha_is_multiplied_and_divided_where_the_formats_want_it() {
    let mut picture = Picture::from_rgb(2, 1, vec![Rgb::grey(0.25), Rgb::BLACK]).unwrap();
    picture.push_channel("A", vec![0.5, 0.0]).unwrap();
    let options = WriteOptions { bit_depth: BitDepth::Sixteen, ..WriteOptions::default() };
    let png = round_trip("png", &picture, &options);
    assert_eq!(png.alpha, Alpha::Straight);
    assert!((png.clone().into_linear().rgb(0, 0).r - 0.25).abs() < 1e-4);
    assert!((ColourSpace::Srgb.decode(png.rgb(0, 0).r) - 0.5).abs() < 1e-4);
    let exr = round_trip("exr", &png, &WriteOptions::default());
    assert!((exr.rgb(0, 0).r - 0.25).abs() < 1e-4 && exr.alpha == Alpha::Premultiplied);
}

#[test]
fn files_are_written_in_one_step_by_extension() {
    let folder = tempfile::tempdir().unwrap();
    let picture = noise(9, 4, &["R", "G", "B"]);
    for row in PICTURE_FORMATS.iter().filter(|row| row.write.is_some()) {
        for extension in row.extensions {
            let path = folder.path().join(format!("picture.{extension}"));
            std::fs::write(&path, "the old one").unwrap();
            write(&path, &picture, &WriteOptions::default()).unwrap();
            assert_eq!(read(&path).unwrap().width(), 9);
        }
    }
    let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| name.to_string_lossy().starts_with("picture.")), "{left:?}");
}

#[test]
fn errors_name_the_file_and_the_nearest_format() {
    let picture = noise(2, 2, &["R", "G", "B"]);
    let message = |path: &str| write(path, &picture, &WriteOptions::default()).unwrap_err().to_string();
    let misspelt = message("out.pgn");
    assert!(misspelt.contains("out.pgn") && misspelt.contains("did you mean 'png'"), "{misspelt}");
    assert!(message("out.tga").contains("written"));
    assert!(message("out").contains("png"));
    assert!(message("no/such/folder/out.png").contains("no/such/folder/out.png"));
    let missing = read("no/such/file.png").unwrap_err().to_string();
    assert!(missing.contains("no/such/file.png"), "{missing}");
    let depth = noise(2, 2, &["depth.Z"]);
    let error = write_bytes("png", &depth, &WriteOptions::default()).unwrap_err();
    assert!(
        matches!(&error, PictureError::Unwritable { .. }) && error.to_string().contains("depth.Z"),
        "{error}"
    );
    let mut reserved = noise(2, 2, &["Y"]);
    reserved.metadata.insert("dataWindow".to_owned(), "?".to_owned());
    assert!(write_bytes("exr", &reserved, &WriteOptions::default()).is_err());
}

#[test]
fn planes_have_to_fit() {
    let mut picture = noise(3, 2, &["R"]);
    assert!(picture.push_channel("R", vec![0.0; 6]).is_err());
    assert!(picture.push_integer_plane("R", vec![0; 6]).is_err());
    assert!(picture.push_channel("G", vec![0.0; 5]).is_err());
    assert!(picture.push_channel("", vec![0.0; 6]).is_err());
    assert!(Picture::new(0, 4).is_err() && Picture::new(usize::MAX, usize::MAX).is_err());
    assert!(Picture::from_rgb(2, 2, vec![Rgb::BLACK; 3]).is_err());
}

#[test]
fn bytes_for_a_display_are_encoded_and_have_alpha() {
    let mut picture = Picture::from_rgb(2, 1, vec![Rgb::new(0.5, 0.0, 7.0), Rgb::grey(0.25)]).unwrap();
    assert_eq!(picture.to_rgba8().unwrap(), [188, 0, 255, 255, 137, 137, 137, 255]);
    // Half transparent, with premultiplied light.
    picture.push_channel("A", vec![1.0, 0.5]).unwrap();
    assert_eq!(picture.to_rgba8().unwrap(), [188, 0, 255, 255, 188, 188, 188, 128]);
    assert_eq!(Picture::new(2, 1).unwrap().to_rgba8(), None);
}

/// A short name is a whole word of the long one: `direct` is not the end of `indirect`.
#[test]
fn a_layer_is_not_taken_for_one_whose_name_ends_alike() {
    let mut picture = Picture::from_rgb(1, 1, vec![Rgb::BLACK]).unwrap();
    picture.push_rgb("View.direct", &[Rgb::grey(1.0)]).unwrap();
    picture.push_rgb("View.indirect", &[Rgb::grey(2.0)]).unwrap();
    assert_eq!(picture.clone().with_main(Some("direct")).unwrap().rgb(0, 0), Rgb::grey(1.0));
    assert_eq!(picture.clone().with_main(Some("Indirect")).unwrap().rgb(0, 0), Rgb::grey(2.0));
    assert!(picture.with_main(Some("rect")).is_err());
}

/// Files from the bytes of another file are those from its numbers, with alpha and texts, in every format and over any
/// background. The last picture has more rows than are converted at a time.
#[test]
fn files_from_bytes_are_those_from_numbers() {
    for (names, [width, height], is_opaque) in [
        (&["Y"][..], [31, 40], true),
        (&["Y", "A"], [40, 31], false),
        (&["R", "G", "B"], [33, 17], true),
        (&["R", "G", "B", "A"], [17, 33], true),
        (&["R", "G", "B", "A"], [1 << 12, 257], false),
    ] {
        let mut picture = noise(width, height, names);
        if let (true, Some(alpha)) = (is_opaque, picture.channel_mut("A")) {
            alpha.fill(1.0);
        }
        (picture.colour_space, picture.alpha) = (ColourSpace::Srgb, Alpha::Straight);
        picture.metadata.insert("Software".to_owned(), "a camera".to_owned());
        let file = write_bytes("png", &picture, &WriteOptions::default()).unwrap();
        let numbers = read_bytes(&file, None, &Limits::default()).unwrap();
        let stored = read_interleaved_bytes(&file, None, &Limits::default()).unwrap().unwrap();
        assert_eq!(stored.is_transparent(), !is_opaque, "{names:?}");
        let plain = WriteOptions::default();
        let deep = WriteOptions { bit_depth: BitDepth::Sixteen, ..plain };
        let over = WriteOptions { behind: Some(Rgb::new(0.1, 0.5, 0.9)), exposure: -1.5, ..plain };
        for row in PICTURE_FORMATS.iter().filter(|row| row.write.is_some()) {
            // Strips are put together in one way, whatever the options.
            let is_large = width * height > 1 << 20;
            for (number, options) in [plain, deep, over].iter().take(if is_large { 1 } else { 3 }).enumerate()
            {
                let from_numbers = write_bytes(row.entry.name, &numbers, options).unwrap();
                let from_bytes = write_source_bytes(row.entry.name, Source::Bytes(&stored), options).unwrap();
                assert!(from_bytes == from_numbers, "{} {number} {names:?}", row.entry.name);
            }
        }
    }
}

/// A limit of memory is one of what is needed: bytes in files of bytes take no more than themselves.
#[test]
fn bytes_need_no_more_memory_than_themselves() {
    let picture = noise(64, 64, &["R", "G", "B"]);
    let file = write_bytes("png", &picture, &WriteOptions::default()).unwrap();
    let limits = Limits::new(64 * 64 * 3 + 4096);
    assert!(read_bytes(&file, None, &limits).is_err());
    assert!(read_interleaved_bytes(&file, None, &limits).unwrap().is_some());
    let deep = WriteOptions { bit_depth: BitDepth::Sixteen, ..WriteOptions::default() };
    let file = write_bytes("png", &picture, &deep).unwrap();
    assert_eq!(read_interleaved_bytes(&file, None, &Limits::default()).unwrap(), None);
}
