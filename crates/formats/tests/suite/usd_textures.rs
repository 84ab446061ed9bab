//! Pictures of UsdPreviewSurface: what their samples are, what is beyond their edges, and what stands in for primvars that are
//! not there.

use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_math::{Rgb, Vec2};
use bilux_pictures::{BitDepth, ColourSpace, Picture, WriteOptions, write_bytes};
use bilux_scene::texture::UvPair;
use bilux_scene::{SceneBuilder, Texture, Value};

/// Properties of a picture of the tests.
#[derive(Clone, Copy)]
struct Of<'a> {
    channels: &'a [&'a str],
    depth: BitDepth,
    /// Whether the file says that it is sRGB.
    says: bool,
    /// Whether it states a power.
    has_gamma: bool,
}

const PLAIN: Of = Of { channels: &["R", "G", "B"], depth: BitDepth::Eight, says: false, has_gamma: false };

/// A PNG of two texels: a half of what there can be, and a quarter, in each channel but alpha.
fn png(of: Of) -> Vec<u8> {
    let mut picture = Picture::new(2, 1).unwrap();
    picture.colour_space = ColourSpace::Srgb;
    for name in of.channels {
        // Opaque, so that colours are not divided by it.
        let samples = if *name == "A" { vec![1.0; 2] } else { vec![0.5, 0.25] };
        picture.push_channel(*name, samples).unwrap();
    }
    let options = WriteOptions { bit_depth: of.depth, ..WriteOptions::default() };
    let bytes = write_bytes("png", &picture, &options).unwrap();
    let srgb = bytes.windows(4).position(|name| name == b"sRGB").unwrap() - 4;
    // 1 / 2.2, as PNG writes it, and its checksum.
    let gamma = b"\0\0\0\x04gAMA\0\0\xb1\x8f\x0b\xfc\x61\x05";
    let stated = if of.has_gamma { &gamma[..] } else { &[] };
    if of.says { bytes } else { [&bytes[..srgb], stated, &bytes[srgb + 13..]].concat() }
}

/// A cube with a texture as an input of its surface.
fn cube(input: &str, node: &str, more: &str, picture: &[u8]) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.png"), picture).unwrap();
    let kind = if input.ends_with("Color") { "color3f" } else { "float" };
    let output = if input.ends_with("Color") { "rgb" } else { "r" };
    let text = format!(
        "#usda 1.0\ndef Material \"m\" {{ token outputs:surface.connect = </m/s.outputs:surface>\n def Shader \"s\" {{ uniform \
         token info:id = \"UsdPreviewSurface\"\n {kind} inputs:{input}.connect = </m/t.outputs:{output}>\n {more}\n token \
         outputs:surface }}\n def Shader \"t\" {{ uniform token info:id = \"UsdUVTexture\"\n asset inputs:file = @./p.png@\n \
         {node}\n }} }}\ndef Cube \"c\" {{ rel material:binding = </m> }}"
    );
    let path = folder.path().join("a.usda");
    std::fs::write(&path, text).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(warnings(&scene), "");
    scene
}

fn texture<'s>(scene: &'s SceneBuilder, key: &str) -> &'s Texture {
    match scene.materials[scene.objects[0].material].parameters.find(key) {
        Some((Value::Texture(index), _)) => &scene.textures[*index],
        other => panic!("{key} is {other:?}"),
    }
}

/// [UsdPreviewSurface, `sourceColorSpace`: by `auto`, which is also what counts if nothing is said, pictures of 8 bits and three or
/// four channels are sRGB, and those that say so.]
#[test]
fn pictures_of_16_bits_or_of_one_channel_are_numbers_unless_they_are_said_to_be_colours() {
    let deep = BitDepth::Sixteen;
    let (srgb, raw) = (bilux_math::colour::srgb_decode(0.5), 0.5);
    for (of, space, wanted) in [
        (PLAIN, "", srgb),
        (PLAIN, "auto", srgb),
        (PLAIN, "raw", raw),
        (Of { channels: &["R", "G", "B", "A"], ..PLAIN }, "auto", srgb),
        (Of { channels: &["Y"], ..PLAIN }, "auto", raw),
        (Of { channels: &["Y"], ..PLAIN }, "", raw),
        (Of { channels: &["Y"], ..PLAIN }, "sRGB", srgb),
        (Of { channels: &["Y"], says: true, ..PLAIN }, "auto", srgb),
        (Of { depth: deep, ..PLAIN }, "auto", raw),
        (Of { depth: deep, ..PLAIN }, "sRGB", srgb),
        (Of { depth: deep, says: true, ..PLAIN }, "auto", srgb),
        (Of { depth: deep, has_gamma: true, ..PLAIN }, "auto", srgb),
        (Of { channels: &["Y"], has_gamma: true, ..PLAIN }, "", srgb),
    ] {
        let node = match space {
            "" => String::new(),
            space => format!("token inputs:sourceColorSpace = \"{space}\""),
        };
        let scene = cube("diffuseColor", &node, "", &png(of));
        let found = texture(&scene, "base_color").texel(0, 0).g;
        assert!((found - wanted).abs() < 3e-3, "{:?} {space:?}: {found}, not {wanted}", of.channels);
        // What is no colour is raw, however many channels it has.
        let scene = cube("roughness", "", "", &png(of));
        let found = texture(&scene, "specular_roughness").texel(0, 0).r;
        assert!((found - raw).abs() < 3e-3, "{found}");
    }
}

/// [UsdPreviewSurface, `wrapS`: `black` is black outside of 0 to 1.] The other axis goes on as it says.
#[test]
fn beyond_its_edges_a_picture_can_be_black() {
    let texels = |x: usize, y: usize| Rgb::new(0.2 + 0.2 * x as f32, 0.9 - 0.3 * y as f32, 0.4);
    let pixels = (0..6).map(|i| texels(i % 3, i / 3)).collect();
    let picture = Picture::from_rgb(3, 2, pixels).unwrap();
    let bytes = write_bytes("png", &picture, &WriteOptions::default()).unwrap();
    let node = |s: &str, t: &str| format!("token inputs:wrapS = \"{s}\"\n token inputs:wrapT = \"{t}\"");
    let at = |scene: &SceneBuilder, u: f32, v: f32| {
        texture(scene, "base_color").at(UvPair([Vec2::new(u, v); 2])).to_array()
    };
    let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
    // In the middles of texels, with v upwards.
    let middle = |x: usize, y: usize| [(x as f32 + 0.5) / 3.0, 1.0 - (y as f32 + 0.5) / 2.0];
    for (s, t) in [("black", "black"), ("black", "repeat"), ("mirror", "black")] {
        let scene = cube("diffuseColor", &node(s, t), "", &bytes);
        for (x, y) in (0..3).flat_map(|x| (0..2).map(move |y| (x, y))) {
            let [u, v] = middle(x, y);
            let (found, wanted) = (at(&scene, u, v), texels(x, y).to_array());
            assert!(near(found, wanted), "{s} {t} at {x}, {y}: {found:?}, not {wanted:?}");
        }
        let [u, v] = middle(2, 0);
        for (across, down, is_black) in [
            (1.0, 0.0, s == "black"),
            (-5.0, 0.0, s == "black"),
            (0.0, 2.0, t == "black"),
            (0.0, -7.0, t == "black"),
        ] {
            let found = at(&scene, u + across, v + down);
            assert_eq!(found == [0.0; 3], is_black, "{s} {t} beyond by {across}, {down}: {found:?}");
        }
    }
    // Where a transform places it, it is as large and as far as the transform says, on both axes.
    let moved = |wrap: &str| {
        let transform = "def Shader \"x\" { uniform token info:id = \"UsdTransform2d\"\n float2 inputs:scale = (2, 4)\n \
                         float2 inputs:translation = (0.3, 0.1)\n float2 inputs:in = (0, 0)\n float2 outputs:result }";
        let reads = "float2 inputs:st.connect = </m/t.outputs:result>";
        let node = format!("{}\n {reads} }}\n {transform} def Scope \"n\" {{", node(wrap, "black"));
        cube("diffuseColor", &node.replace("/m/t.outputs:result", "/m/x.outputs:result"), "", &bytes)
    };
    for wrap in ["black", "repeat"] {
        let scene = moved(wrap);
        for (x, y) in (0..3).flat_map(|x| (0..2).map(move |y| (x, y))) {
            let [u, v] = middle(x, y);
            let found = at(&scene, (u - 0.3) / 2.0, (v - 0.1) / 4.0);
            let wanted = texels(x, y).to_array();
            assert!(near(found, wanted), "{wrap} at {x}, {y}: {found:?}, not {wanted:?}");
        }
        assert_eq!(at(&scene, (0.5 - 0.3) / 2.0, (1.6 - 0.1) / 4.0), [0.0; 3], "{wrap}");
    }
    let scene = cube("diffuseColor", &node("repeat", "repeat"), "", &bytes);
    assert!(near(at(&scene, middle(1, 1)[0] + 4.0, middle(1, 1)[1] - 3.0), texels(1, 1).to_array()));
}

/// The reflectance at normal incidence is the texel, by the index of the brightest one: what a constant of the same colour has.
#[test]
fn specular_colours_of_a_picture_are_those_of_constants() {
    let workflow = "int inputs:useSpecularWorkflow = 1";
    let pixels = vec![Rgb::new(0.16, 0.09, 0.04), Rgb::new(0.04, 0.02, 0.01)];
    let picture = Picture::from_rgb(2, 1, pixels.clone()).unwrap();
    let deep = WriteOptions { bit_depth: BitDepth::Sixteen, ..WriteOptions::default() };
    let bytes = write_bytes("png", &picture, &deep).unwrap();
    let scene = cube("specularColor", "token inputs:sourceColorSpace = \"sRGB\"", workflow, &bytes);
    let ior = scene.materials[scene.objects[0].material].number("specular_ior").unwrap();
    let root = (ior - 1.0) / (ior + 1.0);
    let at_normal = root * root;
    for (x, wanted) in pixels.into_iter().enumerate() {
        let found = texture(&scene, "specular_color").texel(x, 0) * at_normal;
        let off = (0..3).map(|c| (found[c] - wanted[c]).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{found:?}, not {wanted:?}");
    }
}

/// [UsdPreviewSurface, `UsdPrimvarReader`: the fallback is used where the primvar is not there.] A mesh that has colours keeps them,
/// whichever of the two comes first.
#[test]
fn meshes_without_the_primvar_have_the_colour_that_stands_in_for_it() {
    let looks = "def Material \"m\" { token outputs:surface.connect = </m/s.outputs:surface>\n def Shader \"s\" { uniform token \
                 info:id = \"UsdPreviewSurface\"\n color3f inputs:diffuseColor.connect = </m/r.outputs:result>\n float \
                 inputs:roughness = 0.25\n token outputs:surface }\n def Shader \"r\" { uniform token info:id = \
                 \"UsdPrimvarReader_float3\"\n string inputs:varname = \"displayColor\"\n float3 inputs:fallback = (0.25, 0.5, 0.75) \
                 } }\n";
    let mesh = |name: &str, more: &str| {
        format!(
            "def Mesh \"{name}\" {{ rel material:binding = </m>\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n \
             point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n {more} }}\n"
        )
    };
    let coloured = mesh("with", "color3f[] primvars:displayColor = [(1, 0.5, 0)]");
    for order in [[&*mesh("without", ""), &*coloured], [&*coloured, &*mesh("without", "")]] {
        let text = format!("#usda 1.0\n{looks}{}", order.concat());
        let scene = crate::read_text("usda", text).unwrap();
        for object in &scene.objects {
            let material = &scene.materials[object.material];
            let base = material
                .colour("base_color")
                .map(Rgb::to_array)
                .or_else(|| material.number("base_color").map(|grey| [grey; 3]));
            assert_eq!(material.number("specular_roughness"), Some(0.25));
            if object.name == "with" {
                assert_eq!((object.mesh.vertex_kd[0], base), (Rgb::new(1.0, 0.5, 0.0), Some([1.0; 3])));
            } else {
                assert!(object.mesh.vertex_kd.is_empty());
                assert_eq!(base, Some([0.25, 0.5, 0.75]));
            }
        }
        assert_eq!(scene.objects.len(), 2);
    }
}
