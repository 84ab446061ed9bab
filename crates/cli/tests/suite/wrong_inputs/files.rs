//! Wrong files.

use super::Case;

/// Each case with its files.
pub(crate) const CASES: &[Case] = &[
    Case::file("an empty file", 1, &[("empty.obj", b"")], "render empty.obj -o out.png"),
    Case::file(
        "a file that is cut off",
        1,
        &[("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1")],
        "render cut.obj -o out.png",
    ),
    Case::file(
        "a key of a TOML scene that is misspelt",
        1,
        &[("a.toml", b"[camera]\npositon = [0, 0, 5]\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a key of a TOML scene that is given twice",
        1,
        &[("a.toml", b"[render]\nsize = \"8x8\"\nsize = \"9x9\"\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a TOML scene with an open bracket",
        1,
        &[("a.toml", b"[[model]\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a TOML scene with a text in place of a number",
        1,
        &[("a.toml", b"[render]\nseed = \"many\"\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a TOML scene with an unknown material",
        1,
        &[("a.toml", b"[[model]]\nshape = \"sphere\"\nmaterial = \"gold\"\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a TOML scene whose model is missing",
        1,
        &[("a.toml", b"[[model]]\nfile = \"pot.obj\"\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a TOML scene with a file outside its folder",
        1,
        &[("in/a.toml", b"[[model]]\nfile = \"../triangle.obj\"\n")],
        "render in/a.toml -o out.png",
    ),
    Case::file(
        "a TOML scene without a model",
        1,
        &[("a.toml", b"[render]\nspp = 4\n")],
        "render a.toml -o out.png",
    ),
    Case::file(
        "a word in place of a number of a material",
        1,
        &[
            ("a.obj", b"mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            ("a.mtl", b"newmtl a\nNs shiny\n"),
        ],
        "render a.obj -o out.png --strict",
    ),
    Case::file(
        "a face with a vertex that the file does not have",
        1,
        &[("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")],
        "render a.obj -o out.png",
    ),
    Case::file("JSON that is not glTF", 1, &[("a.gltf", b"[1, 2]")], "render a.gltf -o out.png"),
    Case::file(
        "a glTF file that is cut off",
        1,
        &[("a.gltf", b"{\"asset\": {\"version\": \"2.0\"")],
        "render a.gltf -o out.png",
    ),
    Case::file(
        "a GLB file that is cut off",
        1,
        &[("a.glb", b"glTF\x02\0\0\0\x40\0\0\0")],
        "render a.glb -o out.png",
    ),
    Case::file(
        "a pbrt scene without a world",
        1,
        &[("a.pbrt", b"Camera \"perspective\"\n")],
        "render a.pbrt -o out.png",
    ),
    Case::file(
        "a pbrt scene with a number in place of a name",
        1,
        &[("a.pbrt", b"WorldBegin\nShape 3\n")],
        "render a.pbrt -o out.png",
    ),
    Case::file(
        "a page of HTML in place of a model",
        1,
        &[("a.obj", b"<!DOCTYPE html>\n<html>\n")],
        "render a.obj -o out.png",
    ),
];
