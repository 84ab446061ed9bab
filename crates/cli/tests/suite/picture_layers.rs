//! Pictures that commands read: layers of an EXR, pictures that are turned or cut short, pictures given as scenes.

use bilux::math::Rgb;
use bilux::pictures::{BitDepth, Picture, WriteOptions, read, write};
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The exit status, and what is printed to standard error.
fn run(folder: &Path, command: &str) -> (i32, String) {
    let mut bilux = Command::new(env!("CARGO_BIN_EXE_bilux"));
    let output = bilux.current_dir(folder).args(command.split_whitespace()).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[track_caller]
fn done(folder: &Path, command: &str) -> String {
    let (code, said) = run(folder, command);
    assert_eq!(code, 0, "{command}: {said}");
    said
}

/// `two.exr` has two layers and no main picture, `one.exr` a single layer, red.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut two = Picture::new(16, 8).unwrap();
    two.push_rgb("ViewLayer.Combined", &[Rgb::new(0.5, 0.0, 0.0); 128]).unwrap();
    two.push_rgb("ViewLayer.Glow", &[Rgb::new(0.0, 0.5, 0.0); 128]).unwrap();
    two.push_channel("ViewLayer.Depth.Z", vec![3.0; 128]).unwrap();
    write(folder.path().join("two.exr"), &two, &Default::default()).unwrap();
    let mut one = Picture::new(16, 8).unwrap();
    one.push_rgb("beauty", &[Rgb::new(0.5, 0.0, 0.0); 128]).unwrap();
    write(folder.path().join("one.exr"), &one, &Default::default()).unwrap();
    fs::write(folder.path().join("a.obj"), "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    folder
}

fn colour(folder: &Path, name: &str) -> Rgb {
    read(folder.join(name)).unwrap().into_linear().rgb(3, 3)
}

#[test]
fn a_layer_of_an_exr_is_converted_compared_and_denoised() {
    let folder = folder();
    let path = folder.path();
    for name in ["ViewLayer.Glow", "Glow", "glow"] {
        done(path, &format!("convert two.exr -o out.exr --layer {name}"));
        let picture = read(path.join("out.exr")).unwrap();
        assert_eq!((picture.rgb(3, 3), picture.layers().len()), (Rgb::new(0.0, 0.5, 0.0), 0));
    }
    done(path, "convert two.exr -o glow.png --layer Glow");
    assert!((colour(path, "glow.png").g - 0.5).abs() < 0.01);
    // Without a layer all of them stay, in a format that has them.
    done(path, "convert two.exr -o all.exr");
    assert_eq!(read(path.join("all.exr")).unwrap().layers().len(), 3);
    let (code, said) = run(path, "compare two.exr two.exr --layer Combined --max-rmse 0");
    assert_eq!(code, 0, "{said}");
    done(path, "denoise two.exr -o smooth.exr --layer Combined --by builtin");
    assert!((colour(path, "smooth.exr").r - 0.5).abs() < 0.01);
}

#[test]
fn without_a_main_picture_the_error_lists_the_layers() {
    let folder = folder();
    let path = folder.path();
    for command in [
        "convert two.exr -o out.png",
        "convert two.exr -o out.png --layer nothing",
        "denoise two.exr -o b.exr",
    ] {
        let (code, said) = run(path, command);
        assert_eq!(code, 1, "{command}: {said}");
        assert!(
            said.contains("two.exr") && said.contains("ViewLayer.Combined, ViewLayer.Glow"),
            "{command}: {said}"
        );
    }
    let (code, said) = run(path, "compare two.exr one.exr");
    assert!(code == 2 && said.contains("ViewLayer.Combined"), "{said}");
    let (code, said) = run(path, "render a.obj --env two.exr -o out.png --size 8x8 --spp 1");
    assert!(code == 1 && said.contains("ViewLayer.Combined") && said.contains("--env"), "{said}");
    // Nor has a picture of bytes the layer that is asked for.
    let mut plain = Picture::new(16, 8).unwrap();
    for name in ["R", "G", "B"] {
        plain.push_channel(name, vec![0.5; 128]).unwrap();
    }
    write(path.join("plain.png"), &plain, &Default::default()).unwrap();
    let (code, said) = run(path, "convert plain.png -o plain.jpg --layer Glow");
    assert!(code == 1 && said.contains("Glow") && !path.join("plain.jpg").exists(), "{code}: {said}");
    // With a single layer there is no doubt.
    let said = done(path, "convert one.exr -o out.png");
    assert!(said.contains("its only layer with colours, 'beauty', is used"), "{said}");
    assert!((colour(path, "out.png").r - 0.5).abs() < 0.01);
    let (code, said) = run(path, "render a.obj --layer Glow -o out.png");
    assert!(code == 2 && said.contains("--layer"), "{said}");
}

#[test]
fn surroundings_come_from_the_layer_that_is_named() {
    let folder = folder();
    let path = folder.path();
    let base = "render a.obj --size 8x8 --spp 4 --ground none --exposure 0 -q";
    done(path, &format!("{base} --env two.exr --layer Glow -o glow.exr"));
    done(path, &format!("{base} --env two.exr --layer Combined -o combined.exr"));
    done(path, &format!("{base} --env one.exr -o one.exr.exr"));
    let corner = |name: &str| read(path.join(name)).unwrap().rgb(0, 0);
    assert!(corner("glow.exr").g > 0.4 && corner("glow.exr").r < 0.01, "{:?}", corner("glow.exr"));
    assert!(corner("combined.exr").r > 0.4 && corner("combined.exr").g < 0.01);
    assert_eq!(corner("combined.exr"), corner("one.exr.exr"));
    // A scene file says the same.
    let toml = "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n\n[[light]]\nkind = \"environment\"\nradiance = { texture = \"two.exr\", layer = \"Glow\" }\n";
    fs::write(path.join("scene.toml"), toml).unwrap();
    done(path, "render scene.toml --size 8x8 --spp 4 -q -o sky.exr");
    assert!(corner("sky.exr").g > 0.4 && corner("sky.exr").r < 0.01, "{:?}", corner("sky.exr"));
}

#[test]
fn a_jpeg_without_an_end_is_converted_with_a_warning() {
    let folder = folder();
    let path = folder.path();
    done(path, "convert one.exr -o whole.jpg");
    let bytes = fs::read(path.join("whole.jpg")).unwrap();
    fs::write(path.join("cut.jpg"), &bytes[..bytes.len() - 2]).unwrap();
    let said = done(path, "convert cut.jpg -o out.png");
    assert!(said.contains("cut.jpg") && said.contains("no end marker"), "{said}");
    let (code, said) = run(path, "convert cut.jpg -o out.png --strict");
    assert!(code == 1 && said.contains("no end marker"), "{said}");
    assert!(done(path, "convert cut.jpg -o out.png -q").is_empty());
    let said = done(path, "render a.obj --env cut.jpg --size 8x8 --spp 1 -o out.png");
    assert!(said.contains("cut.jpg") && said.contains("no end marker"), "{said}");
}

#[test]
fn pictures_that_are_not_read_are_named() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("a.gif"), b"GIF89a\x01\0\x01\0").unwrap();
    fs::write(path.join("b.heic"), b"\0\0\0\x18ftypheic\0\0\0\0").unwrap();
    fs::write(path.join("c.blend"), b"BLENDER-v400").unwrap();
    for (command, part) in [
        ("render a.gif -o out.png", "a.gif: this is a GIF picture, not a scene"),
        ("info b.heic", "b.heic: this is a HEIC picture"),
        ("render c.blend -o out.png", "c.blend: this is a Blender file"),
        ("convert a.gif -o out.png", "a.gif: this is a GIF picture: convert it"),
        ("convert c.blend -o out.glb", "c.blend: this is a Blender file"),
        ("denoise a.gif -o out.png", "a.gif: this is a GIF picture: convert it"),
        ("render a.obj --env a.gif -o out.png", "a.gif: this is a GIF picture: convert it"),
    ] {
        let (code, said) = run(path, command);
        assert!(code == 1 && said.contains(part), "{command}: {code} {said}");
    }
}

/// Bytes are converted as bytes, and not as the numbers that they stand for, which take eight times as much. What does not fit is
/// said, with what to do.
#[test]
fn a_picture_of_bytes_is_converted_in_the_memory_of_its_bytes() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (width, height) = (1024usize, 768usize);
    let mut picture = Picture::new(width, height).unwrap();
    picture.colour_space = bilux::pictures::ColourSpace::Srgb;
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let sample = |i: usize| ((i % width) * (channel + 1) / 5 + i / width) as f32 % 256.0 / 255.0;
        picture.push_channel(name, (0..width * height).map(sample).collect()).unwrap();
    }
    let options = WriteOptions::default();
    write(path("bytes.png"), &picture, &options).unwrap();
    write(path("deep.png"), &picture, &WriteOptions { bit_depth: BitDepth::Sixteen, ..options }).unwrap();
    // Three bytes a pixel, and not one more.
    let limit = (width * height * 3).to_string();
    for format in ["png", "ppm", "webp", "jpg", "exr"] {
        let output = format!("out.{format}");
        done(folder.path(), &format!("convert bytes.png -o {output} --max-memory {limit}"));
        let (before, after) = (picture.clone().into_linear(), read(path(&output)).unwrap().into_linear());
        let off = |x: usize, y: usize| {
            (0..3).map(|c| (before.rgb(x, y)[c] - after.rgb(x, y)[c]).abs()).fold(0.0, f32::max)
        };
        let worst = [(0, 0), (1000, 700), (517, 300)].map(|(x, y)| off(x, y)).into_iter().fold(0.0, f32::max);
        assert!(worst < if format == "jpg" { 0.1 } else { 1e-5 }, "{format}: {worst}");
    }
    let (status, said) = run(folder.path(), &format!("convert deep.png -o out.png --max-memory {limit}"));
    assert_eq!(status, 1, "{said}");
    assert!(said.contains("1024 x 768 pixels need") && said.contains("--max-memory"), "{said}");
}
