//! TIFF, BMP and TGA as other programs write them. All files show the same picture, in all available encodings.

use bilux_math::colour::srgb_decode;
use bilux_pictures::{Alpha, ColourSpace, Limits, Picture, Rgba8, read_bytes, read_rgba8};
use std::path::Path;

fn seed(format: &str, name: &str) -> Vec<u8> {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(format!("picture_{format}"));
    std::fs::read(folder.join(name)).unwrap()
}

fn picture(format: &str, name: &str) -> Picture {
    read_bytes(&seed(format, name), Some(format), &Limits::default())
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The original picture, in bytes.
fn colour(x: usize, y: usize) -> [u8; 4] {
    let blue = if (x + y) % 2 == 1 { 255 } else { 10 };
    [x as u8 * 40, y as u8 * 60, blue, if x < 4 { 255 } else { 80 }]
}

fn grey(x: usize, y: usize) -> u8 {
    (x * 30 + y * 7) as u8
}

/// Compares each pixel of 7 x 5 with the original, to within a fraction of white.
fn check(picture: &Picture, name: &str, off: f32, truth: impl Fn(usize, usize) -> [f32; 3]) {
    assert_eq!((picture.width(), picture.height()), (7, 5), "{name}");
    for (y, x) in (0..5).flat_map(|y| (0..7).map(move |x| (y, x))) {
        let (got, truth) = (picture.rgb(x, y).to_array(), truth(x, y));
        let is_near = got.iter().zip(truth).all(|(got, truth)| (got - truth).abs() <= off);
        assert!(is_near, "{name} at {x}, {y}: {got:?} and not {truth:?}");
    }
}

fn check_alpha(picture: &Picture, name: &str, off: f32) {
    assert_eq!(picture.alpha, Alpha::Straight, "{name}");
    for (y, x) in (0..5).flat_map(|y| (0..7).map(move |x| (y, x))) {
        let truth = f32::from(colour(x, y)[3]) / 255.0;
        assert!((picture.alpha_at(x, y) - truth).abs() <= off, "{name} at {x}, {y}");
    }
}

fn in_srgb(x: usize, y: usize) -> [f32; 3] {
    let [r, g, b, _] = colour(x, y);
    [r, g, b].map(|byte| f32::from(byte) / 255.0)
}

#[test]
fn colours_are_in_their_places() {
    let of = |format: &'static str, names: &[&'static str]| {
        names.iter().map(|name| (format, *name)).collect::<Vec<_>>()
    };
    let tiff = of(
        "tiff",
        &[
            "rgb_raw.tif",
            "rgb_lzw.tif",
            "rgb_deflate.tif",
            "rgb_packbits.tif",
            "rgb_planes.tif",
            "rgb_tiles.tif",
            "rgb_tiles_deflate.tif",
            "rgb_strips.tif",
            "rgb_bigtiff.tif",
            "rgb_from_below.tif",
            "rgb_on_its_side.tif",
            "rgba_lzw.tif",
            "rgb16.tif",
            "rgb16_big_predicted.tif",
            "rgb32.tif",
            "rgba16.tif",
        ],
    );
    let bmp = of(
        "bmp",
        &[
            "rgb24.bmp",
            "rgb_top.bmp",
            "rgb_os2.bmp",
            "rgb32.bmp",
            "palette8.bmp",
            "runs8.bmp",
            "rgba.bmp",
            "rgba_v5.bmp",
            "rgba_alphamasks.bmp",
        ],
    );
    let tga = of(
        "tga",
        &[
            "rgb.tga",
            "rgb_top.tga",
            "rgb_runs.tga",
            "rgba.tga",
            "rgba_runs.tga",
            "palette.tga",
            "palette_runs.tga",
        ],
    );
    for (format, name) in [tiff, bmp, tga].concat() {
        let picture = picture(format, name);
        assert_eq!(picture.colour_space, ColourSpace::Srgb, "{name}");
        check(&picture, name, 1e-7, in_srgb);
        // A BMP of 32 bits without masks has no alpha, whatever its fourth byte holds.
        if name.starts_with("rgba") && name != "rgba.bmp" {
            check_alpha(&picture, name, 1e-7);
        } else {
            assert!(picture.channel("A").is_none(), "{name}");
        }
    }
    for (format, name) in [("bmp", "rgb555.bmp"), ("bmp", "rgb565_masks.bmp"), ("tga", "rgb555.tga")] {
        check(&picture(format, name), name, 0.5 / 31.0 + 0.5 / 255.0, in_srgb);
    }
    // Premultiplied colours of eight bits are recovered as well as their precision allows.
    let multiplied = picture("tiff", "rgba_multiplied.tif");
    check(&multiplied, "rgba_multiplied.tif", 0.5 / 80.0 + 0.001, in_srgb);
    check_alpha(&multiplied, "rgba_multiplied.tif", 1e-7);
}

#[test]
fn floats_are_light() {
    let linear = |x: usize, y: usize| in_srgb(x, y).map(srgb_decode);
    let files = [
        ("rgb_f32.tif", 1e-6),
        ("rgb_f32_predicted.tif", 1e-6),
        ("rgb_f64.tif", 1e-6),
        ("rgb_f16.tif", 5e-4),
    ];
    for (name, off) in files {
        let picture = picture("tiff", name);
        assert_eq!(picture.colour_space, ColourSpace::LinearRec709, "{name}");
        check(&picture, name, off, linear);
    }
}

#[test]
fn greys_and_two_colours() {
    let of_grey = |x, y| [f32::from(grey(x, y)) / 255.0; 3];
    let files = [("bmp", "grey8.bmp"), ("tga", "grey.tga"), ("tga", "grey_alpha.tga"), ("tiff", "grey.tif")];
    for (format, name) in
        [&files[..], &[("tiff", "grey_alpha.tif"), ("tiff", "grey_white_is_nought.tif")]].concat()
    {
        let picture = picture(format, name);
        check(&picture, name, 1e-7, of_grey);
        if name.contains("alpha") {
            check_alpha(&picture, name, 1e-7);
        }
    }
    let of_two = |x, y| [if (x + 2 * y) % 3 == 0 { 1.0 } else { 0.0 }; 3];
    check(&picture("bmp", "two1.bmp"), "two1.bmp", 0.0, of_two);
    check(&picture("tiff", "two.tif"), "two.tif", 0.0, of_two);
    let four = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for name in ["palette4.bmp", "runs4.bmp"] {
        check(&picture("bmp", name), name, 0.0, |x, y| four[(x / 2 + y) % 4]);
    }
}

#[test]
fn textures_in_bytes_are_the_same_picture() {
    for (format, names) in [
        (
            "tiff",
            &[
                "rgb_raw.tif",
                "rgb_planes.tif",
                "rgba_lzw.tif",
                "grey_alpha.tif",
                "two.tif",
                "rgb_on_its_side.tif",
            ],
        ),
        ("bmp", &["rgb24.bmp", "rgb_top.bmp", "palette8.bmp", "runs8.bmp", "rgba_v5.bmp", "two1.bmp"]),
        ("tga", &["rgb.tga", "rgb_top.tga", "rgba_runs.tga", "palette.tga", "grey_alpha.tga", "grey.tga"]),
    ] {
        for name in names {
            let bytes = seed(format, name);
            let Rgba8 { width, height, texels, .. } =
                read_rgba8(&bytes, Some(format), &Limits::default()).unwrap().unwrap();
            let by_planes = picture(format, name);
            assert_eq!((width, height), (by_planes.width(), by_planes.height()));
            for (i, [r, g, b, a]) in texels.into_iter().enumerate() {
                let rgb = by_planes.rgb(i % width, i / width).to_array().map(|c| (c * 255.0).round() as u8);
                let alpha = (by_planes.alpha_at(i % width, i / width) * 255.0).round() as u8;
                assert_eq!((rgb, alpha), ([r, g, b], a), "{name}: {i}");
            }
        }
    }
    for name in ["rgb16.tif", "rgb_f32.tif", "rgba_multiplied.tif"] {
        assert!(read_rgba8(&seed("tiff", name), None, &Limits::default()).unwrap().is_none(), "{name}");
    }
}

/// A kilobyte that claims to be a picture of gigabytes.
#[test]
fn pixels_beyond_the_end_of_a_file_take_no_memory() {
    for (format, name) in [
        ("tiff", "broken_absurd_size.tif"),
        ("tiff", "broken_text_of_a_gigabyte.tif"),
        ("bmp", "broken_absurd_size.bmp"),
        ("bmp", "broken_absurd_runs.bmp"),
        ("tga", "broken_absurd_size.tga"),
    ] {
        let error = read_bytes(&seed(format, name), Some(format), &Limits::new(u64::MAX)).unwrap_err();
        assert!(error.to_string().contains("cut short"), "{name}: {error}");
    }
}
