//! Materials of MaterialX: in files of their own, and networks that come down to a texture or a constant.

use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_scene::{SceneBuilder, Texture, Value};

/// A cube with the material `M` of a document.
fn cube(document: &str) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    file(
        "m.mtlx",
        &format!(
            "<?xml version=\"1.0\"?>\n<materialx version=\"1.38\" colorspace=\"lin_rec709\">{document}</materialx>"
        ),
    );
    file("p.ppm", "P3 2 1 255 255 0 128 0 255 64");
    file(
        "a.usda",
        "#usda 1.0\ndef \"looks\" (references = @m.mtlx@</MaterialX>) {}\n\
         def Cube \"c\" { rel material:binding = </looks/Materials/M> }",
    );
    read(&folder.path().join("a.usda"), &ReadOptions::default()).unwrap()
}

/// A surface, given inputs and what comes before it.
fn surface(kind: &str, inputs: &str, before: &str) -> SceneBuilder {
    cube(&format!(
        "{before}<{kind} name=\"S\" type=\"surfaceshader\">{inputs}</{kind}>\
         <surfacematerial name=\"M\" type=\"material\"><input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"S\"/></surfacematerial>"
    ))
}

fn parameter<'s>(scene: &'s SceneBuilder, key: &str) -> Option<&'s Value> {
    let material = &scene.materials[scene.objects[0].material];
    material.parameters.0.iter().find(|(name, ..)| name == key).map(|(_, value, _)| value)
}

fn number(scene: &SceneBuilder, key: &str) -> f32 {
    scene.materials[scene.objects[0].material].number(key).unwrap()
}

fn colour(scene: &SceneBuilder, key: &str) -> [f32; 3] {
    scene.materials[scene.objects[0].material].colour(key).unwrap().to_array()
}

fn texture<'s>(scene: &'s SceneBuilder, key: &str) -> &'s Texture {
    match parameter(scene, key) {
        Some(Value::Texture(index)) => &scene.textures[*index],
        other => panic!("{key} is {other:?}: {}", warnings(scene)),
    }
}

#[test]
fn surfaces_in_documents_become_principled() {
    let inputs = "<input name=\"base\" type=\"float\" value=\"0.5\"/><input name=\"base_color\" type=\"color3\" value=\"0.2, 0.4, 0.8\"/>\
                  <input name=\"metalness\" type=\"float\" value=\"1\"/>";
    let scene = surface("standard_surface", inputs, "");
    assert_eq!((colour(&scene, "base_color"), number(&scene, "base_metalness")), ([0.1, 0.2, 0.4], 1.0));
    assert_eq!(warnings(&scene), "");
    let scene =
        surface("open_pbr_surface", "<input name=\"coat_weight\" type=\"float\" value=\"0.75\"/>", "");
    assert_eq!((number(&scene, "coat_weight"), number(&scene, "coat_ior")), (0.75, 1.6));
    let scene = surface("UsdPreviewSurface", "<input name=\"roughness\" type=\"float\" value=\"0.25\"/>", "");
    assert_eq!(number(&scene, "specular_roughness"), 0.25);
}

#[test]
fn graphs_come_down_to_textures_and_constants() {
    let graph = "<nodegraph name=\"G\"><input name=\"tint\" type=\"color3\" value=\"0.5, 1, 0.25\"/>\
        <image name=\"i\" type=\"color3\"><input name=\"file\" type=\"filename\" value=\"p.ppm\"/>\
        <input name=\"texcoord\" type=\"vector2\" nodename=\"place\"/></image>\
        <place2d name=\"place\" type=\"vector2\"><input name=\"texcoord\" type=\"vector2\" nodename=\"uv\"/>\
        <input name=\"scale\" type=\"vector2\" value=\"0.5, 0.25\"/><input name=\"offset\" type=\"vector2\" value=\"0.125, 0\"/></place2d>\
        <texcoord name=\"uv\" type=\"vector2\"/>\
        <multiply name=\"m\" type=\"color3\"><input name=\"in1\" type=\"color3\" nodename=\"i\"/><input name=\"in2\" type=\"color3\" interfacename=\"tint\"/></multiply>\
        <mix name=\"half\" type=\"float\"><input name=\"fg\" type=\"float\" value=\"1\"/><input name=\"bg\" type=\"float\" value=\"0.5\"/><input name=\"mix\" type=\"float\" nodename=\"c\"/></mix>\
        <constant name=\"c\" type=\"float\"><input name=\"value\" type=\"float\" value=\"0.5\"/></constant>\
        <extract name=\"g\" type=\"float\"><input name=\"in\" type=\"color3\" nodename=\"i\"/><input name=\"index\" type=\"integer\" value=\"1\"/></extract>\
        <invert name=\"rough\" type=\"float\"><input name=\"in\" type=\"float\" nodename=\"g\"/></invert>\
        <output name=\"colour\" type=\"color3\" nodename=\"m\"/><output name=\"metal\" type=\"float\" nodename=\"half\"/>\
        <output name=\"rough\" type=\"float\" nodename=\"rough\"/></nodegraph>";
    let inputs = "<input name=\"base\" type=\"float\" value=\"1\"/><input name=\"base_color\" type=\"color3\" nodegraph=\"G\" output=\"colour\"/>\
        <input name=\"metalness\" type=\"float\" nodegraph=\"G\" output=\"metal\"/>\
        <input name=\"specular_roughness\" type=\"float\" nodegraph=\"G\" output=\"rough\"/>";
    let scene = surface("standard_surface", inputs, graph);
    assert_eq!(texture(&scene, "base_color").factor.to_array(), [0.5, 1.0, 0.25]);
    assert_eq!(number(&scene, "base_metalness"), 0.75);
    // The coordinates (1, 1) are divided by the scale and moved back: (1.875, 4), whose v downwards is -3. [MaterialX: place2d]
    let transform = texture(&scene, "base_color").transform.unwrap().to_array();
    assert_eq!(transform, [2.0, 0.0, 0.0, 4.0, -0.125, -3.0]);
    let rough = texture(&scene, "specular_roughness");
    let texels: Vec<f32> = rough.texels().map(|t| t.r).collect();
    assert!((texels[0] - 1.0).abs() < 1e-6 && texels[1].abs() < 1e-6, "one minus green: {texels:?}");
    assert_eq!(warnings(&scene), "");
}

#[test]
fn documents_that_make_no_sense_are_left_out_or_end() {
    // Nodes in a circle, and a material without a surface.
    let circle = "<multiply name=\"a\" type=\"color3\"><input name=\"in1\" type=\"color3\" nodename=\"b\"/></multiply>\
                  <multiply name=\"b\" type=\"color3\"><input name=\"in1\" type=\"color3\" nodename=\"a\"/></multiply>";
    let inputs = "<input name=\"base_color\" type=\"color3\" nodename=\"a\"/>";
    let scene = surface("standard_surface", inputs, circle);
    assert!(warnings(&scene).contains("very many nodes"), "{}", warnings(&scene));
    assert!(warnings(&cube("<surfacematerial name=\"M\" type=\"material\"/>")).contains("without a surface"));
    assert!(warnings(&cube("<broken")).contains("a layer is left out"));
    let entity = cube("<!DOCTYPE x [<!ENTITY a \"b\">]>");
    assert!(warnings(&entity).contains("a layer is left out"), "{}", warnings(&entity));
}

/// Arnold's shaders as its exporters write them into USD: the same graph by its own names, two unequal inputs each.
#[test]
fn graphs_of_arnold_come_down_to_the_same() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.ppm"), "P3 2 1 255 255 0 128 0 255 64").unwrap();
    let shader = |name: &str, id: &str, inputs: &str| {
        format!(
            "    def Shader \"{name}\"\n    {{\n        uniform token info:id = \"arnold:{id}\"\n{inputs}        token outputs:out\n    }}\n"
        )
    };
    let shaders = [
        shader(
            "surface",
            "standard_surface",
            "        float inputs:base = 0.5\n        color3f inputs:base_color.connect = </M/tint.outputs:out>\n        \
             float inputs:metalness.connect = </M/blend.outputs:out>\n        float inputs:specular_roughness = 0.375\n",
        ),
        shader(
            "tint",
            "multiply",
            "        color3f inputs:input1.connect = </M/picture.outputs:out>\n        color3f inputs:input2 = (0.5, 1, 0.25)\n",
        ),
        shader(
            "picture",
            "image",
            "        string inputs:filename = \"p.ppm\"\n        string inputs:swrap = \"clamp\"\n",
        ),
        shader(
            "blend",
            "mix_rgba",
            "        color3f inputs:input1 = (0.25, 0.25, 0.25)\n        color3f inputs:input2.connect = </M/flat.outputs:out>\n        float inputs:mix = 0.75\n",
        ),
        shader("flat", "flat", "        color3f inputs:color = (0.5, 0.5, 0.5)\n"),
    ];
    let text = format!(
        "#usda 1.0\ndef Material \"M\"\n{{\n    token outputs:arnold:surface.connect = </M/surface.outputs:out>\n{}}}\n\
         def Cube \"c\" {{ rel material:binding = </M> }}\n",
        shaders.concat()
    );
    let path = folder.path().join("a.usda");
    std::fs::write(&path, &text).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(warnings(&scene), "");
    let picture = texture(&scene, "base_color");
    assert_eq!(picture.factor.to_array(), [0.25, 0.5, 0.125]);
    assert_eq!(picture.wrap, [bilux_scene::texture::Wrap::Clamp, bilux_scene::texture::Wrap::Repeat]);
    assert_eq!((number(&scene, "base_metalness"), number(&scene, "specular_roughness")), (0.4375, 0.375));
    // What is not read is named.
    std::fs::write(&path, text.replace("arnold:multiply", "arnold:cell_noise")).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert!(warnings(&scene).contains("cell_noise"), "{}", warnings(&scene));
}
