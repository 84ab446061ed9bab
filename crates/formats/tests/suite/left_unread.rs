//! Unusual statements of files: columns without a name, deleted points, indices of 0, lamps that are meshes or mirrored.

use crate::{read_text, warnings};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Spec};
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr};
use std::io::Cursor;

/// A triangle whose places and texture coordinates are columns of one array of rows.
fn collada(array: &str, places: &str, uvs: &str) -> SceneBuilder {
    let text = format!(
        "<COLLADA version='1.4.1'><asset><unit meter='1'/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id='g'>\
         <mesh><source id='p'><float_array id='a' count='15'>{array}</float_array><technique_common>\
         <accessor source='#a' count='3' {places}</accessor></technique_common></source>\
         <source id='t'><technique_common><accessor source='#a' count='3' {uvs}</accessor></technique_common></source>\
         <vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles count='1'>\
         <input semantic='VERTEX' source='#v' offset='0'/><input semantic='TEXCOORD' source='#t' offset='0' set='0'/>\
         <p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='s'>\
         <node><instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>\
         <scene><instance_visual_scene url='#s'/></scene></COLLADA>"
    );
    read_text("dae", text).unwrap()
}

fn params(names: &[&str]) -> String {
    let param = |name: &&str| match *name {
        "" => "<param type='float'/>".to_owned(),
        name => format!("<param name='{name}' type='float'/>"),
    };
    names.iter().map(param).collect()
}

/// A parameter without a name is a column that is no part of what the accessor gives. [Collada 1.4.1, accessor]
#[test]
fn columns_of_collada_without_a_name_are_left_out() {
    let after = "0 0 0 .1 .2  2 0 0 .3 .4  0 3 0 .5 .6";
    let five = |names: &[&str]| format!("stride='5'>{}", params(names));
    let apart = "0 9 0 0 .1  2 9 0 0 .3  0 9 3 0 .5";
    for (array, places, uvs) in [
        (after, five(&["X", "Y", "Z"]), five(&["", "", "", "S", "T"])),
        (after, five(&["X", "Y", "Z"]), format!("offset='3' {}", five(&["S", "T"]))),
        (after, five(&["X", "Y", "Z", "", ""]), format!("offset='3' {}", five(&[]))),
        (apart, five(&["X", "", "Y", "Z"]), format!("offset='4' {}", five(&["S"]))),
    ] {
        let scene = collada(array, &places, &uvs);
        let mesh = &scene.objects[0].mesh;
        let corner = |i: usize| mesh.triangles[0][i] as usize;
        let found = [0, 1, 2].map(|i| mesh.positions[corner(i)]);
        assert_eq!(found, [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 3.0], "{places}");
        if array == after {
            let found = [0, 1, 2].map(|i| mesh.uvs[corner(i)]);
            // Nothing of the last row is beyond the array but what has no name.
            let third = if uvs.contains("<param") { Vec2::new(0.5, 0.6) } else { found[2] };
            assert_eq!(found, [Vec2::new(0.1, 0.2), Vec2::new(0.3, 0.4), third], "{uvs}");
        }
    }
}

/// Three points of a point format, of which those that are named are withheld. [LAS 1.4 R15, tables 8 and 16]
fn las(format: u8, withheld: &[usize]) -> Vec<u8> {
    let record = [20u16, 28, 26, 34, 57, 63, 30, 36][usize::from(format)];
    let mut file = vec![0u8; 375];
    file[..4].copy_from_slice(b"LASF");
    (file[24], file[25], file[104]) = (1, 4, format);
    file[96..100].copy_from_slice(&375u32.to_le_bytes());
    file[105..107].copy_from_slice(&record.to_le_bytes());
    file[247..255].copy_from_slice(&3u64.to_le_bytes());
    for axis in 0..3 {
        file[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&1.0f64.to_le_bytes());
    }
    for (i, place) in [[1i32, 2, 3], [5000, 9000, 0], [2, 4, 6]].into_iter().enumerate() {
        let mut bytes = vec![0; usize::from(record)];
        for (axis, x) in place.into_iter().enumerate() {
            bytes[4 * axis..4 * axis + 4].copy_from_slice(&x.to_le_bytes());
        }
        // Other flags and the class do not hide a point.
        bytes[15] = match (format < 6, withheld.contains(&i)) {
            (true, is_withheld) => 0x60 | if is_withheld { 0x80 } else { 2 },
            (false, is_withheld) => 0x0b & !4 | if is_withheld { 4 } else { 0 },
        };
        file.extend(bytes);
    }
    file
}

/// A LAS file as `las` makes it, with compressed points: a record that says how, and the points after it. [LAS 1.4 R15, 2.5]
fn laz(format: u8, withheld: &[usize]) -> Vec<u8> {
    let plain = las(format, withheld);
    let (mut file, points) = (plain[..375].to_vec(), &plain[375..]);
    let items = LazItemRecordBuilder::default_for_point_format_id(format, 0).unwrap();
    let vlr = LazVlr::from_laz_items(items);
    let mut content = Vec::new();
    vlr.write_to(&mut content).unwrap();
    let mut head = [0u8; 54];
    head[2..16].copy_from_slice(b"laszip encoded");
    head[18..20].copy_from_slice(&22204u16.to_le_bytes());
    head[20..22].copy_from_slice(&(content.len() as u16).to_le_bytes());
    file.extend(head);
    file.extend(content);
    let (header, start) = (375u16, file.len() as u32);
    file[94..96].copy_from_slice(&header.to_le_bytes());
    file[96..100].copy_from_slice(&start.to_le_bytes());
    file[100..104].copy_from_slice(&1u32.to_le_bytes());
    file[104] |= 0x80;
    let mut to = Cursor::new(file);
    to.set_position(u64::from(start));
    let mut compressor = LasZipCompressor::new(to, vlr).unwrap();
    for point in points.chunks_exact(points.len() / 3) {
        compressor.compress_one(point).unwrap();
    }
    compressor.done().unwrap();
    compressor.into_inner().into_inner()
}

#[test]
fn withheld_points_of_las_are_left_out() {
    let size = |scene: &SceneBuilder| scene.objects[0].mesh.positions.len();
    for format in [0, 2, 6, 7] {
        let all = read_text("las", las(format, &[])).unwrap();
        let some = read_text("las", las(format, &[1])).unwrap();
        assert_eq!(size(&some) * 3, size(&all) * 2, "{format}");
        let extent = some.bounds(0.0).extent();
        assert!(extent.max_element() < 10.0, "{format}: {extent}");
        let said = some.notes.iter().map(|note| &*note.message).collect::<Vec<_>>().join("\n");
        assert!(said.contains("1 points are withheld"), "{format}: {said}");
        let packed = read_text("las", laz(format, &[1])).unwrap();
        assert_eq!(packed.objects[0].mesh.positions, some.objects[0].mesh.positions, "{format}");
        let none = read_text("las", las(format, &[0, 1, 2])).unwrap();
        assert_eq!(size(&none), size(&all), "{format}");
    }
}

fn gltf(extensions: &str, base: &str) -> Spec {
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"material":0,"attributes":{{"POSITION":0}}}}]}}],
        "buffers":[{{"byteLength":36,"uri":"data:,%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3F%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3F%00%00%00%00"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":{base},"metallicFactor":0}},"extensions":{{{extensions}}}}}]}}"#
    );
    let scene = read_text("gltf", &text).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert_eq!(warnings(&scene), "");
    scene.materials[0].clone()
}

/// Reflectance of a surface at normal incidence: of a metal its colour, of a dielectric by its index. [OpenPBR 1.1]
fn reflected(spec: &Spec) -> [f32; 3] {
    let number = |key: &str, unsaid: f32| spec.number(key).unwrap_or(unsaid);
    let metal = number("base_metalness", 0.0);
    let root = (number("specular_ior", 1.5) - 1.0) / (number("specular_ior", 1.5) + 1.0);
    let tint = spec.colour("specular_color").unwrap_or(Rgb::WHITE);
    let base = spec.colour("base_color").unwrap_or(Rgb::WHITE);
    (tint * (root * root * (1.0 - metal)) + base * metal).to_array()
}

/// Converters of the extension for specular colours state an index of 0 or 1000, so that F0 is the colour alone. [KHR_materials_ior;
/// KHR_materials_specular, conversions]
#[test]
fn an_index_of_0_or_1000_leaves_the_reflection_to_the_colour() {
    let specular = |colour: &str| format!(r#""KHR_materials_specular":{{"specularColorFactor":{colour}}}"#);
    let index = |ior: &str| format!(r#""KHR_materials_ior":{{"ior":{ior}}}"#);
    let near = |extensions: &str, base: &str, wanted: [f32; 3], off: f32| {
        let found = reflected(&gltf(extensions, base));
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < off), "{extensions}: {found:?}");
    };
    for ior in ["0", "1000"] {
        near(&format!("{},{}", index(ior), specular("[0.04,0.04,0.04]")), "[0.5,0.5,0.5,1]", [0.04; 3], 1e-3);
        near(&format!("{},{}", index(ior), specular("[0.3,0.2,0.1]")), "[0,0,0,1]", [0.3, 0.2, 0.1], 2e-3);
        near(&format!("{},{}", index(ior), specular("[0.9,0.8,0.7]")), "[0,0,0,1]", [0.9, 0.8, 0.7], 1e-2);
    }
    near(&index("0"), "[0,0,0,1]", [1.0; 3], 1e-3);
    // Others are what they were: ((1.8 - 1) / 2.8)².
    near(&index("1.8"), "[0,0,0,1]", [0.08163; 3], 1e-4);
    near(
        &format!("{},{}", index("1.8"), specular("[0.5,1,0.25]")),
        "[0,0,0,1]",
        [0.0408, 0.0816, 0.0204],
        1e-4,
    );
}

fn usd(prims: &str) -> SceneBuilder {
    let floor = "def Mesh \"floor\" {\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n\
                 point3f[] points = [(-9, 0, -9), (0, 0, 9), (9, 0, -9)]\nuniform token subdivisionScheme = \"none\"\n}\n";
    read_text("usda", format!("#usda 1.0\n(upAxis = \"Y\"\nmetersPerUnit = 1)\n{floor}{prims}")).unwrap()
}

/// Lamps that are meshes here are lamps: no studio is added. [UsdLux]
#[test]
fn lamps_that_are_meshes_are_lamps_and_mirrored_ones_shine_the_same_way() {
    for kind in ["DiskLight", "CylinderLight", "RectLight", "SphereLight", "DistantLight"] {
        assert!(!usd(&format!("def {kind} \"a\" {{ }}\n")).environment_unspecified, "{kind}");
    }
    assert!(usd("").environment_unspecified);
    let turned = |scale: &str| {
        format!(
            "float3 xformOp:rotateXYZ = (-90, 0, 0)\nfloat3 xformOp:scale = {scale}\n\
             double3 xformOp:translate = (0, 2, 0)\n\
             uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateXYZ\", \"xformOp:scale\"]\n"
        )
    };
    for scale in ["(1, 1, 1)", "(-1, 1, 1)", "(1, -2, 1)", "(-1, 2, 1)"] {
        // Along its -z, which is down.
        let scene = usd(&format!("def RectLight \"a\" {{\n{}}}\n", turned(scale)));
        let edge = |key: &str| scene.lights[0].vector(key).unwrap();
        let front = edge("edge_u").cross(edge("edge_v")).normalize();
        assert!(front.distance(Vec3::NEG_Y) < 1e-5, "{scale}: {front}");
        let scene = usd(&format!("def DiskLight \"a\" {{\n{}}}\n", turned(scale)));
        let mesh = &scene.objects.last().unwrap().mesh;
        let [a, b, c] = mesh.triangles[5].map(|i| mesh.positions[i as usize]);
        let front = (b - a).cross(c - a).normalize();
        assert!(front.distance(Vec3::NEG_Y) < 1e-3, "{scale}: {front}");
    }
}

fn preview(inputs: &str) -> Spec {
    let scene = usd(&format!(
        "def Mesh \"m\" (prepend apiSchemas = [\"MaterialBindingAPI\"]) {{\nint[] faceVertexCounts = [3]\n\
         int[] faceVertexIndices = [0, 1, 2]\npoint3f[] points = [(0, 1, 0), (1, 1, 0), (0, 2, 0)]\n\
         uniform token subdivisionScheme = \"none\"\nrel material:binding = </M>\n}}\n\
         def Material \"M\" {{\ntoken outputs:surface.connect = </M/S.outputs:surface>\n\
         def Shader \"S\" {{\nuniform token info:id = \"UsdPreviewSurface\"\n{inputs}\ntoken outputs:surface\n}}\n}}\n"
    ));
    let material = scene.objects.iter().find(|object| object.name == "m").unwrap().material;
    scene.materials[material].clone()
}

/// The specular colour is F0, whatever it is; the coat has the index of all specular parts. [UsdPreviewSurface]
#[test]
fn specular_colours_and_coats_of_usd_reflect_what_they_say() {
    for (colour, wanted) in [("(0.3, 0.2, 0.1)", [0.3, 0.2, 0.1]), ("(0.9, 0.85, 0.8)", [0.9, 0.85, 0.8])] {
        let spec = preview(&format!(
            "color3f inputs:diffuseColor = (0, 0, 0)\nint inputs:useSpecularWorkflow = 1\n\
             color3f inputs:specularColor = {colour}"
        ));
        let found = reflected(&spec);
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-2), "{colour}: {found:?}");
    }
    let spec = preview("float inputs:clearcoat = 1\nfloat inputs:ior = 2.4");
    assert!((spec.number("coat_ior").unwrap() - 2.4).abs() < 1e-6);
}
