//! Instances of two meshes each: every format places both, at every place.

use crate::read_text;
use bilux_math::Vec3;
use bilux_scene::SceneBuilder;

/// The left ends of all objects in the order of their places; the meshes are 1 and 3 long.
fn lefts_and_lengths(scene: &SceneBuilder) -> Vec<(f32, f32)> {
    let mut all: Vec<(f32, f32)> = scene
        .objects
        .iter()
        .map(|object| object.motion.at(0.0).bounds(&object.mesh.bounds()))
        .map(|bounds| ((bounds.min.x * 1e3).round() / 1e3, (bounds.extent().x * 1e3).round() / 1e3))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    all
}

/// A triangle from x = 0.
fn triangle(length: f32) -> [Vec3; 3] {
    [Vec3::ZERO, Vec3::X * length, Vec3::Y]
}

fn numbers(corners: [Vec3; 3], between: &str, around: [&str; 2]) -> String {
    let one = |p: Vec3| format!("{}{}{between}{}{between}{}{}", around[0], p.x, p.y, p.z, around[1]);
    corners.map(one).join(if around[0].is_empty() { " " } else { ", " })
}

#[test]
fn the_second_mesh_of_an_instance_is_placed_too() {
    let [one, three] = [1.0, 3.0].map(triangle);
    let pbrt_shape = |c| {
        format!(
            "Shape \"trianglemesh\" \"point3 P\" [{}] \"integer indices\" [0 1 2]\n",
            numbers(c, " ", ["", ""])
        )
    };
    let pbrt = format!(
        "WorldBegin\nObjectBegin \"o\"\n{}{}ObjectEnd\nAttributeBegin\nTranslate 10 0 0\nObjectInstance \"o\"\nAttributeEnd\n\
         AttributeBegin\nTranslate 25 0 0\nObjectInstance \"o\"\nAttributeEnd\n",
        pbrt_shape(one),
        pbrt_shape(three)
    );
    // Rectangles from -1 to 1, moved so that they begin at 0.
    let rectangle = |length: f32| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><translate x='1'/><scale x='{}'/></transform></shape>",
            length / 2.0
        )
    };
    let placed = |x: f32| {
        format!(
            "<shape type='instance'><ref id='g'/><transform name='to_world'><translate x='{x}'/></transform></shape>"
        )
    };
    let mitsuba = format!(
        "<scene version='3.0.0'><shape type='shapegroup' id='g'>{}{}</shape>{}{}</scene>",
        rectangle(1.0),
        rectangle(3.0),
        placed(10.0),
        placed(25.0)
    );
    let mesh = |name: &str, c| {
        format!(
            "def Mesh \"{name}\" {{\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n point3f[] points = [{}]\n}}\n",
            numbers(c, ", ", ["(", ")"])
        )
    };
    let usd = format!(
        "#usda 1.0\ndef PointInstancer \"i\" {{\n rel prototypes = </i/p>\n int[] protoIndices = [0, 0]\n \
         point3f[] positions = [(10, 0, 0), (25, 0, 0)]\n def Xform \"p\" {{\n{}{}}}\n}}\n",
        mesh("a", one),
        mesh("b", three)
    );
    let native = format!(
        "#usda 1.0\nclass \"c\" {{\n{}{}}}\ndef Xform \"x\" (instanceable = true inherits = </c>) {{\n double3 xformOp:translate = (10, 0, 0)\n \
         uniform token[] xformOpOrder = [\"xformOp:translate\"]\n}}\ndef Xform \"y\" (instanceable = true inherits = </c>) {{\n \
         double3 xformOp:translate = (25, 0, 0)\n uniform token[] xformOpOrder = [\"xformOp:translate\"]\n}}\n",
        mesh("a", one),
        mesh("b", three)
    );
    let wanted = [(10.0, 1.0), (10.0, 3.0), (25.0, 1.0), (25.0, 3.0)];
    for (format, text) in [("pbrt", &pbrt), ("mitsuba", &mitsuba), ("usda", &usd), ("usda", &native)] {
        let scene = read_text(format, text).unwrap_or_else(|error| panic!("{format}: {error}"));
        assert_eq!(lefts_and_lengths(&scene), wanted, "{format}");
    }
    assert_eq!(lefts_and_lengths(&gltf([one, three])), wanted, "glTF");
}

/// A node with a mesh of two primitives, at two places. [glTF: EXT_mesh_gpu_instancing]
fn gltf(meshes: [[Vec3; 3]; 2]) -> SceneBuilder {
    use base64::Engine;
    let places = [Vec3::X * 10.0, Vec3::X * 25.0];
    let all = meshes.as_flattened().iter().chain(&places);
    let bytes: Vec<u8> = all.flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    let bytes = base64::engine::general_purpose::STANDARD.encode(bytes);
    let accessor = |view: usize, count: usize, most: &str| {
        format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[{most},1,0]}}"#
        )
    };
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["EXT_mesh_gpu_instancing"],"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":2}}}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}},{{"attributes":{{"POSITION":1}}}}]}}],
        "accessors":[{},{},{{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":36}},{{"buffer":0,"byteOffset":72,"byteLength":24}}],
        "buffers":[{{"byteLength":96,"uri":"data:application/octet-stream;base64,{bytes}"}}]}}"#,
        accessor(0, 3, "1"),
        accessor(1, 3, "3"),
    );
    read_text("gltf", text).unwrap()
}
