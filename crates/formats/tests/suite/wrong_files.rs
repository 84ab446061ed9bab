//! Wrong files with all of their messages: `wrong_files.txt` holds the text for every row of the table. Each
//! message must state what is wrong, where, and what to do about it, and must read well aloud.
//!
//! After an intended change, `BILUX_WRITE_MESSAGES=1 cargo test -p bilux-formats wrong_files` rewrites the texts;
//! read the differences before you commit them.

use bilux_formats::{ReadOptions, read};
use bilux_pictures::PICTURE_FORMATS;
use std::fmt::Write;
use std::path::Path;

/// A wrong file.
struct Case {
    /// The fault, in a few words.
    name: &'static str,
    files: &'static [(&'static str, &'static [u8])],
    /// The file to read: as a picture, if its name is that of one.
    read: &'static str,
}

const CASES: &[Case] = &[
    // OBJ and MTL.
    Case { name: "a number of an OBJ file with a letter in it", files: &[("a.obj", b"v 0 0 0\nv 1.O 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 4\nf 1 2 4\n")], read: "a.obj" },
    Case { name: "a face of an OBJ file that names a vertex which does not exist", files: &[("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")], read: "a.obj" },
    Case { name: "a material that is in no library", files: &[("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl gold\nf 1 2 3\n")], read: "a.obj" },
    Case { name: "a library of materials that is not there", files: &[("a.obj", b"mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")], read: "a.obj" },
    Case { name: "a library of materials with a word for a number", files: &[("a.mtl", b"newmtl gold\nNs shiny\n"), ("a.obj", b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl gold\nf 1 2 3\n")], read: "a.obj" },
    Case { name: "a texture that is not there", files: &[("a.mtl", b"newmtl gold\nmap_Kd brick.png\n"), ("a.obj", b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl gold\nf 1 2 3\n")], read: "a.obj" },
    // TOML.
    Case { name: "a material's parameter by its name in glTF", files: &[("a.toml", b"[[material]]\nname = \"a\"\nkind = \"principled\"\ntransmission = 1\n")], read: "a.toml" },
    Case { name: "a material's parameter out of its range", files: &[("a.toml", b"[[material]]\nname = \"a\"\nkind = \"diffuse\"\nreflectance = 2\n")], read: "a.toml" },
    Case { name: "a material that is not in the scene", files: &[("a.toml", b"[[model]]\nshape = \"sphere\"\nmaterial = \"gold\"\n")], read: "a.toml" },
    Case { name: "a kind of light that is misspelt", files: &[("a.toml", b"[[light]]\nkind = \"pont\"\n")], read: "a.toml" },
    Case { name: "a quote that is not closed", files: &[("a.toml", b"[[model]]\nshape = \"sphere\n")], read: "a.toml" },
    Case { name: "a key that is there twice", files: &[("a.toml", b"[camera]\nfov = 40\nfov = 50\n")], read: "a.toml" },
    Case { name: "a model that is not there", files: &[("a.toml", b"[[model]]\nfile = \"pot.obj\"\n")], read: "a.toml" },
    Case { name: "a model outside of the scene's folder", files: &[("a/a.toml", b"[[model]]\nfile = \"../triangle.obj\"\n")], read: "a/a.toml" },
    Case { name: "scenes that include each other", files: &[("a.toml", b"include = [\"b.toml\"]\n"), ("b.toml", b"include = [\"a.toml\"]\n")], read: "a.toml" },
    // glTF.
    Case { name: "a glTF file that is cut off", files: &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [")], read: "a.gltf" },
    Case { name: "a glTF file of version 1", files: &[("a.gltf", b"{\"asset\": {\"version\": \"1.0\"}}")], read: "a.gltf" },
    Case { name: "a comma too many in a glTF file", files: &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\",}}")], read: "a.gltf" },
    Case { name: "a buffer of a glTF file that is not there", files: &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 4, \"uri\": \"a.bin\"}]}")], read: "a.gltf" },
    Case { name: "a buffer of a glTF file on a network", files: &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 4, \"uri\": \"https://example.com/a.bin\"}]}")], read: "a.gltf" },
    Case { name: "a broken data URI", files: &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 4, \"uri\": \"data:application/octet-stream;base64,AA!AA\"}]}")], read: "a.gltf" },
    Case { name: "an extension that is required and not supported", files: &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}, \"extensionsRequired\": [\"KHR_texture_bassu\"]}")], read: "a.gltf" },
    Case { name: "a GLB file that is cut off", files: &[("a.glb", b"glTF\x02\0\0\0\x40\0\0\0\x10\0\0\0JSON{}")], read: "a.glb" },
    // Other models.
    Case { name: "a PLY file with a format that does not exist", files: &[("a.ply", b"ply\nformat text 1.0\nend_header\n")], read: "a.ply" },
    Case { name: "a PLY file whose data are cut off", files: &[("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0\n")], read: "a.ply" },
    Case { name: "an STL file that is cut off", files: &[("a.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 zero\n")], read: "a.stl" },
    Case { name: "an OFF file that names a vertex which does not exist", files: &[("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")], read: "a.off" },
    Case { name: "a word among the numbers of a scene in the course's format", files: &[("a.asc", b"triangle\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 0 zero\n")], read: "a.asc" },
    Case { name: "a pbrt scene that includes a file which is not there", files: &[("a.pbrt", b"WorldBegin\nInclude \"none.pbrt\"\n")], read: "a.pbrt" },
    Case { name: "a directive of a pbrt scene that is misspelt", files: &[("a.pbrt", b"WorldBegin\nShpae \"sphere\"\n")], read: "a.pbrt" },
    // Pictures.
    Case { name: "a picture in place of a scene", files: &[("a.png", b"\x89PNG\r\n\x1a\n")], read: "a.png" },
    Case { name: "a picture of surroundings that is cut off", files: &[("sky.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n")], read: "sky.hdr" },
    Case { name: "a PNG that was copied as text", files: &[("sky.png", b"\x89PNG\n\x1a\n\0\0\0\rIHDR")], read: "sky.png" },
    Case { name: "a PNG with a wrong checksum", files: &[("a.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\0\0\0\0")], read: "a.png" },
    Case { name: "a PFM whose width is a word", files: &[("a.pfm", b"PF\nwide 4\n-1\n")], read: "a.pfm" },
    Case { name: "a file that is no picture", files: &[("a.gif", b"GIF89a")], read: "a.gif" },
]
;

impl Case {
    /// All messages about it, one per line, without the folder's name.
    fn run(&self) -> String {
        let folder = tempfile::tempdir().unwrap();
        let outer = folder.path().canonicalize().unwrap();
        for (name, bytes) in self.files {
            let path = outer.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
        let path = outer.join(self.read);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        let is_picture =
            extension == "gif" || PICTURE_FORMATS.iter().any(|row| row.extensions.contains(&extension));
        let is_scene = self.name.contains("in place of a scene");
        let said = if is_picture && !is_scene {
            format!("error: {}", bilux_pictures::read(&path).unwrap_err())
        } else {
            match read(&path, &ReadOptions { validate: true, ..ReadOptions::default() }) {
                Ok(scene) => scene.warnings.iter().map(|w| format!("warning: {w}\n")).collect(),
                Err(error) => format!("error: {error}"),
            }
        };
        let inner = format!("{}{}", outer.display(), std::path::MAIN_SEPARATOR);
        said.replace(&inner, "").replace(&outer.display().to_string(), "FOLDER").trim_end().to_owned()
    }
}

#[test]
fn wrong_files_give_the_recorded_messages() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/wrong_files.txt");
    let mut now = String::new();
    for case in CASES {
        let said = case.run();
        assert!(!said.is_empty(), "{}: nothing is said", case.name);
        writeln!(now, "## {}\n{said}\n", case.name).unwrap();
    }
    if std::env::var_os("BILUX_WRITE_MESSAGES").is_some() {
        std::fs::write(&path, &now).unwrap();
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    for (kept, now) in kept.split("## ").zip(now.split("## ")) {
        assert_eq!(kept, now, "wrong_files.txt says otherwise");
    }
    assert_eq!(kept.len(), now.len());
}
