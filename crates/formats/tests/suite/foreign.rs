//! Files in formats of other programs: by their bytes they are called what they are, whatever their names say.

use crate::warnings;
use bilux_formats::{ReadOptions, read, read_bytes};

/// The first bytes of a format, from its specification, and what it is called.
const FILES: &[(&[u8], &str, bool)] = &[
    (b"GIF89a\x01\0\x01\0", "GIF", true),
    (b"\0\0\0\x20ftypavif\0\0\0\0", "AVIF", true),
    (b"\0\0\0\x18ftypheic\0\0\0\0", "HEIC", true),
    (b"DDS \x7c\0\0\0\x07\x10\0\0", "DDS", true),
    (b"8BPS\0\x01\0\0\0\0\0\0", "Photoshop", true),
    (b"\xabKTX 11\xbb\r\n\x1a\n\x01\x02\x03\x04", "KTX 1", true),
    (b"\xff\x0a\x7f\x10", "JPEG XL", true),
    (b"\0\0\0\x0cjP  \r\n\x87\n", "JPEG 2000", true),
    (b"qoif\0\0\0\x01", "QOI", true),
    (b"<?xml version=\"1.0\"?>\n<svg xmlns=\"a\">", "SVG", true),
    (b"%PDF-1.7\n", "PDF", true),
    (b"BLENDER-v400", "Blender", false),
    (b"MM\x40\0\0\0\x02\0\x0a\0\0\0", "3D Studio", false),
    (b"#VRML V2.0 utf8\n", "VRML", false),
    (b"Ogawa\xff\0\x01", "Alembic", false),
    (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "Git LFS", false),
    (b"<!DOCTYPE html>\n<html><head>", "web page", false),
    (b"\x28\xb5\x2f\xfd\x04", "zstd", false),
];

#[test]
fn a_file_of_another_program_is_called_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for (bytes, called, is_picture) in FILES {
        // Without an extension, with one that nobody knows, and with that of a format that is read.
        for name in ["file", "file.dat", "file.obj", "file.glb", "file.stl"] {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            let error = read(&path, &ReadOptions::default()).unwrap_err().to_string();
            assert!(error.contains(called) && error.contains("not a scene"), "{called} as {name}: {error}");
            assert_eq!(error.contains("--env"), *is_picture, "{called} as {name}: {error}");
        }
        let piped = read_bytes(bytes, "", None, "standard input", &ReadOptions::default()).unwrap_err();
        assert!(piped.to_string().contains(called), "{called}: {piped}");
        let as_picture =
            bilux_pictures::read_bytes(bytes, Some("png"), &Default::default()).unwrap_err().to_string();
        assert!(as_picture.contains(called), "{called}: {as_picture}");
        assert_eq!(as_picture.contains("not a picture"), !is_picture, "{called}: {as_picture}");
        // As a texture.
        std::fs::write(folder.path().join("t.png"), bytes).unwrap();
        std::fs::write(folder.path().join("l.mtl"), "newmtl m\nmap_Kd t.png\n").unwrap();
        let path = folder.path().join("s.obj");
        std::fs::write(&path, "mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n").unwrap();
        let all = warnings(&read(&path, &ReadOptions::default()).unwrap());
        assert!(all.contains("l.mtl:2:1") && all.contains(called), "{called}: {all}");
    }
}

#[test]
fn a_picture_is_no_scene_whatever_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![bilux_math::Rgb::WHITE]).unwrap();
    for extension in ["png", "jpg", "webp", "exr", "hdr", "tga"] {
        if bilux_pictures::format_named(extension).is_none_or(|row| row.write.is_none()) {
            continue;
        }
        let bytes = bilux_pictures::write_bytes(extension, &picture, &Default::default()).unwrap();
        for name in [format!("a.{extension}"), "a.obj".to_owned(), "a.ply".to_owned()] {
            let path = folder.path().join(&name);
            std::fs::write(&path, &bytes).unwrap();
            let error = read(&path, &ReadOptions::default()).unwrap_err().to_string();
            assert!(error.contains("this is a picture"), "{extension} as {name}: {error}");
        }
    }
    // A scene under the name of another format.
    let path = folder.path().join("a.obj");
    std::fs::write(&path, b"glTF\x02\0\0\0\x0c\0\0\0").unwrap();
    let error = read(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains(".glb"), "{error}");
}
