//! Archives with a model and its files, as people upload them: read in place, and nothing outside of them.

use crate::warnings;
use bilux_formats::{FormatError, ReadOptions, read, read_bytes};
use bilux_scene::SceneBuilder;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

type Files<'a> = &'a [(&'a str, &'a [u8])];

const OBJ: &[u8] =
    b"mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
const MTL: &[u8] = b"newmtl m\nmap_Kd t.png\n";
const STL: &[u8] = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";

fn picture() -> Vec<u8> {
    let red = bilux_pictures::Picture::from_rgb(1, 1, vec![bilux_math::Rgb::new(1.0, 0.0, 0.0)]).unwrap();
    bilux_pictures::write_bytes("png", &red, &Default::default()).unwrap()
}

fn zip_of(files: Files, packing: CompressionMethod) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default().compression_method(packing)).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn tar_of(files: Files) -> Vec<u8> {
    let mut tar = tar::Builder::new(Vec::new());
    for (name, bytes) in files {
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        header.as_gnu_mut().unwrap().name[..name.len()].copy_from_slice(name.as_bytes());
        header.set_cksum();
        tar.append(&header, *bytes).unwrap();
    }
    tar.into_inner().unwrap()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
    gzip.write_all(bytes).unwrap();
    gzip.finish().unwrap()
}

fn from_bytes(bytes: &[u8]) -> Result<SceneBuilder, FormatError> {
    read_bytes(bytes, "", None, "upload", &ReadOptions::default())
}

fn refused(bytes: &[u8]) -> String {
    read_bytes(bytes, "archive", None, "upload", &ReadOptions::default()).expect_err("refused").to_string()
}

#[test]
fn a_model_and_its_textures_are_read_from_every_kind_of_archive() {
    let png = picture();
    let beside: Files = &[("l.mtl", MTL), ("m.obj", OBJ), ("t.png", &png)];
    // As Sketchfab packs them: the textures in another folder than the model that names them.
    let apart: Files = &[("textures/T.PNG", &png), ("source/l.mtl", MTL), ("source/m.obj", OBJ)];
    let from_windows: Files =
        &[("a\\l.mtl", MTL), ("a\\m.obj", OBJ), ("a\\t.png", &png), ("__MACOSX/a/._m.obj", b"?")];
    for files in [beside, apart, from_windows] {
        let tar = tar_of(files);
        let kinds = [
            ("zip", zip_of(files, CompressionMethod::Stored)),
            ("zip", zip_of(files, CompressionMethod::Deflated)),
            ("tgz", gzip(&tar)),
            ("tar", tar),
        ];
        for (kind, bytes) in kinds {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(format!("model.{kind}"));
            std::fs::write(&path, &bytes).unwrap();
            let scenes = [read(&path, &ReadOptions::default()), from_bytes(&bytes)];
            for scene in scenes.map(Result::unwrap) {
                assert_eq!((warnings(&scene).as_str(), scene.objects.len()), ("", 1), "{kind}");
                assert_eq!(scene.textures.len(), 1, "{kind}: {:?}", scene.notes);
            }
            assert!(
                std::fs::read_dir(folder.path()).unwrap().count() == 1,
                "nothing is unpacked to the disk"
            );
        }
    }
}

/// A file of one model, packed alone.
#[test]
fn files_compressed_by_gzip_are_read_by_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    // What stands beside a packed model may be packed too.
    put("l.mtl", &gzip(MTL));
    put("t.png", &gzip(&picture()));
    for name in ["m.obj.gz", "m.OBJ.GZ", "m.gz", "m.obj", "m"] {
        let scene = read(&put(name, &gzip(OBJ)), &ReadOptions::default()).unwrap();
        assert_eq!((warnings(&scene).as_str(), scene.textures.len()), ("", 1), "{name}");
        assert_eq!(scene.objects[0].mesh.triangles.len(), 1, "{name}");
    }
    assert_eq!(from_bytes(&gzip(STL)).unwrap().objects.len(), 1);
    let in_zip = put("parts.zip", &zip_of(&[("m.stl.gz", &gzip(STL))], CompressionMethod::Stored));
    assert_eq!(read(&in_zip, &ReadOptions::default()).unwrap().objects.len(), 1);

    let refused = |name: &str, bytes: &[u8]| {
        let options = ReadOptions { max_memory: 1 << 20, ..ReadOptions::default() };
        read(&put(name, bytes), &options).map(|_| ()).unwrap_err().to_string()
    };
    let packed = gzip(OBJ);
    let cut = refused("cut.obj.gz", &packed[..packed.len() - 9]);
    assert!(cut.contains("cut.obj.gz: ") && cut.contains("it cannot be decompressed"), "{cut}");
    assert!(cut.contains("compress it again"), "{cut}");
    let bomb = refused("bomb.stl.gz", &gzip(&vec![0; 40 << 20]));
    assert!(bomb.contains("bomb.stl.gz") && bomb.contains("takes more than the"), "{bomb}");
    let picture = refused("t.gz", &gzip(&picture()));
    assert!(picture.contains("picture"), "{picture}");
}

#[test]
fn of_several_scenes_one_is_shown_and_any_can_be_named() {
    let files: Files = &[("a/small.stl", STL), ("big.stl", &[STL, STL].concat()), ("read me.txt", b"hello")];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parts.zip");
    std::fs::write(&path, zip_of(files, CompressionMethod::Deflated)).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let said = warnings(&scene);
    assert!(
        said.contains("shown is 'big.stl', not a/small.stl") && said.contains("parts.zip/a/small.stl'"),
        "{said}"
    );
    let named = read(&path.join("a/small.stl"), &ReadOptions::default()).unwrap();
    assert_eq!((warnings(&named).as_str(), named.objects[0].mesh.triangles.len()), ("", 1));
    assert!(named.files.iter().any(|file| file.ends_with("parts.zip")), "{:?}", named.files);
    let absent = read(&path.join("a/none.stl"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(absent.contains("parts.zip/a/none.stl: cannot open it: no file in the archive"), "{absent}");
    std::fs::write(folder.path().join("plain.stl"), STL).unwrap();
    let message =
        read(&folder.path().join("plain.stl/x.stl"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("plain.stl/x.stl: cannot open it") && !message.contains("archive"), "{message}");
}

#[test]
fn an_archive_in_an_archive_is_read_too() {
    let inner = zip_of(&[("m.stl", STL)], CompressionMethod::Stored);
    let outer = zip_of(&[("inner.zip", &inner)], CompressionMethod::Deflated);
    assert_eq!(from_bytes(&outer).unwrap().objects.len(), 1);
    // Sixteen levels are too many.
    let deep = (0..20).fold(inner, |inner, _| zip_of(&[("inner.zip", &inner)], CompressionMethod::Stored));
    assert!(refused(&deep).contains("nested"), "{}", refused(&deep));
}

#[test]
fn nothing_outside_an_archive_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("l.mtl"), MTL).unwrap();
    std::fs::write(folder.path().join("t.png"), picture()).unwrap();
    let path = folder.path().join("model.zip");
    let absolute = format!("mtllib {}/l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", folder.path().display());
    for obj in [OBJ.to_vec(), absolute.into_bytes(), [b"mtllib ../l.mtl\n", OBJ].concat()] {
        std::fs::write(&path, zip_of(&[("m.obj", &obj)], CompressionMethod::Stored)).unwrap();
        let scene = read(&path, &ReadOptions { allow_outside: true, ..ReadOptions::default() }).unwrap();
        assert!(warnings(&scene).contains("l.mtl") && scene.textures.is_empty(), "{}", warnings(&scene));
    }
    for name in ["../m.stl", "/etc/m.stl", "a/../../m.stl", "C:\\m.stl", "..\\m.stl"] {
        let message = refused(&zip_of(&[(name, STL)], CompressionMethod::Stored));
        assert!(message.contains("outside the archive"), "{name}: {message}");
        let message = refused(&tar_of(&[(name, STL)]));
        assert!(message.contains("outside the archive"), "{name}: {message}");
    }
}

#[test]
fn bombs_and_damaged_archives_are_refused() {
    let zeros = vec![b' '; 64 << 20];
    let bomb = zip_of(&[("m.obj", &zeros)], CompressionMethod::Deflated);
    let tar = gzip(&tar_of(&[("m.obj", &zeros)]));
    assert!(bomb.len() < 200_000 && tar.len() < 200_000);
    for bytes in [&bomb, &tar] {
        let options = ReadOptions { max_memory: 32 << 20, ..ReadOptions::default() };
        let message = read_bytes(bytes, "", None, "upload", &options).unwrap_err().to_string();
        assert!(
            message.contains("more than the 3") && message.contains("raise the memory limit"),
            "{message}"
        );
    }
    // What a member states: one byte more, one less, and another checksum.
    let zip = zip_of(&[("m.stl", STL)], CompressionMethod::Stored);
    let directory = zip.windows(4).position(|word| word == b"PK\x01\x02").unwrap();
    for (at, change, wanted) in [(24, 1, "shorter"), (24, 255, "longer"), (16, 1, "checksum")] {
        let mut zip = zip.clone();
        zip[directory + at] = zip[directory + at].wrapping_add(change);
        let message = refused(&zip);
        assert!(message.contains(wanted) && message.contains("m.stl"), "{message}");
    }
    for length in [4, 100, zip.len() - 1] {
        assert!(refused(&zip[..length]).contains("this archive cannot be read"), "{length}");
    }
}

#[test]
fn an_archive_without_a_scene_says_what_it_has() {
    let message =
        refused(&zip_of(&[("model.blend", b"BLENDER"), ("a.png", b"?")], CompressionMethod::Stored));
    assert!(
        message.contains("no file in this archive is a scene") && message.contains("model.blend"),
        "{message}"
    );
    assert!(refused(&zip_of(&[], CompressionMethod::Stored)).contains("empty"));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.obj"), zip_of(&[("m.stl", STL)], CompressionMethod::Stored))
        .unwrap();
    let message = read(&folder.path().join("m.obj"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("zip archive") && message.contains("ends in .zip"), "{message}");
}
