//! 3MF files as slicers and modelling programs write them.

use crate::warnings;
use bilux_formats::{FormatError, ReadOptions, read_bytes};
use bilux_math::colour::srgb_decode;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Value};
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const TYPES: &str = r#"<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;
const RELATIONSHIPS: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/a.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
/// A tetrahedron whose corners are the origin and a unit along each axis.
const MESH: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh>"#;

pub(crate) fn package(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// A model with all extensions declared.
fn model(resources: &str, build: &str) -> String {
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
 xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
 xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">
<metadata name="Application">Hand 1.0 &amp; more</metadata>
<resources>
{resources}
</resources>
<build>{build}</build></model>"#
    )
}

/// A file with further members.
fn file_with(model: &str, more: &[(&str, &[u8])]) -> Result<SceneBuilder, FormatError> {
    let own: [(&str, &[u8]); 3] = [
        ("[Content_Types].xml", TYPES.as_bytes()),
        ("_rels/.rels", RELATIONSHIPS.as_bytes()),
        ("3D/a.model", model.as_bytes()),
    ];
    read_bytes(&package(&[&own, more].concat()), "3mf", None, "x.3mf", &ReadOptions::default())
}

/// A package in millimetres that prints its first object.
pub(crate) fn printed(resources: &str) -> Vec<u8> {
    let model = model(resources, &items(&[1]));
    package(&[
        ("[Content_Types].xml", TYPES.as_bytes()),
        ("_rels/.rels", RELATIONSHIPS.as_bytes()),
        ("3D/a.model", model.as_bytes()),
    ])
}

fn file(resources: &str, build: &str) -> Result<SceneBuilder, FormatError> {
    file_with(&model(resources, build), &[])
}

fn object(id: u32, attributes: &str) -> String {
    format!(r#"<object id="{id}" {attributes}>{MESH}</object>"#)
}

/// An item for each object.
fn items(ids: &[u32]) -> String {
    ids.iter().map(|id| format!(r#"<item objectid="{id}"/>"#)).collect()
}

fn base_colour(scene: &SceneBuilder, object: usize) -> Rgb {
    let parameters = &scene.materials[scene.objects[object].material].parameters;
    match parameters.find("base_color") {
        Some((Value::List(colour), _)) => match colour[..] {
            [Value::Number(r), Value::Number(g), Value::Number(b)] => Rgb::new(r as f32, g as f32, b as f32),
            _ => panic!("{colour:?}"),
        },
        other => panic!("{other:?}"),
    }
}

#[test]
fn objects_components_and_items_are_placed_and_share_their_mesh() {
    let resources = format!(
        r#"{}<object id="2"><components><component objectid="1"/><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 5 0 0"/></components></object>"#,
        object(1, r#"name="a &lt; b""#)
    );
    let build = r#"<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 7"/><item objectid="1"/>"#;
    let scene = file(&resources, build).unwrap();
    assert_eq!((scene.objects.len(), scene.unit, warnings(&scene)), (3, 0.001, String::new()));
    assert!(scene.objects.iter().all(|object| std::sync::Arc::ptr_eq(&object.mesh, &scene.objects[0].mesh)));
    assert_eq!(scene.objects[0].name, "a < b");
    assert_eq!(scene.objects[0].mesh.triangles[0], [0, 2, 1]);
    let at = |object: usize, p: Vec3| scene.objects[object].motion.at(0.0).point(p);
    // Row vectors: x goes to (0, 1, 0), y to (-1, 0, 0); then all is moved by 5, doubled and moved by 7.
    assert_eq!(at(1, Vec3::X), Vec3::new(10.0, 2.0, 7.0));
    assert_eq!(at(1, Vec3::Y), Vec3::new(8.0, 0.0, 7.0));
    assert_eq!(at(2, Vec3::Z), Vec3::Z);
    assert_eq!(scene.written_by, "Hand 1.0 & more");
}

#[test]
fn units_are_those_of_the_specification() {
    for (unit, metres) in
        [("micron", 1e-6), ("centimeter", 0.01), ("inch", 0.0254), ("foot", 0.3048), ("meter", 1.0)]
    {
        let text = model(&object(1, ""), &items(&[1])).replace("millimeter", unit);
        assert_eq!(file_with(&text, &[]).unwrap().unit, metres);
    }
}

#[test]
fn base_materials_and_colours_are_srgb_and_triangles_have_their_own() {
    let group = r##"<basematerials id="5"><base name="PLA" displaycolor="#FF8000"/><base name="clear" displaycolor="#0000FF80"/></basematerials>"##;
    let with = object(1, r#"pid="5" pindex="0""#)
        .replace(r#"v1="1" v2="2" v3="3""#, r#"v1="1" v2="2" v3="3" p1="1""#);
    let scene = file(&format!("{group}{with}"), &items(&[1])).unwrap();
    assert_eq!(scene.objects.len(), 2);
    assert_eq!(scene.objects.iter().map(|o| o.mesh.triangles.len()).collect::<Vec<_>>(), [3, 1]);
    assert_eq!(base_colour(&scene, 0), Rgb::new(1.0, srgb_decode(128.0 / 255.0), 0.0));
    let clear = &scene.materials[scene.objects[1].material];
    assert_eq!(
        (&*clear.name, clear.parameters.find("opacity").map(|(value, _)| value.clone())),
        ("clear", Some(Value::Number(f64::from(128.0_f32 / 255.0))))
    );
    // Colours at corners, of which vertices at two colours become two.
    let group = r##"<m:colorgroup id="5"><m:color color="#FF0000"/><m:color color="#00FF00"/><m:color color="#0000FF"/></m:colorgroup>"##;
    let with = object(1, r#"pid="5" pindex="2""#)
        .replace(r#"v1="1" v2="2" v3="3""#, r#"v1="1" v2="2" v3="3" pid="5" p1="0" p2="1" p3="2""#);
    let scene = file(&format!("{group}{with}"), &items(&[1])).unwrap();
    let mesh = &scene.objects[0].mesh;
    let colour = |triangle: usize| mesh.triangles[triangle].map(|i| mesh.vertex_kd[i as usize].to_array());
    assert_eq!(colour(2), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(colour(0), [[0.0, 0.0, 1.0]; 3]);
    let place = |triangle: usize| mesh.triangles[triangle].map(|i| mesh.positions[i as usize]);
    assert_eq!(place(2), [Vec3::X, Vec3::Y, Vec3::Z]);
}

#[test]
fn mixtures_layers_and_display_properties_follow_their_formulas() {
    let bases = r##"<basematerials id="5" displaypropertiesid="8"><base name="a" displaycolor="#FF0000"/><base name="b" displaycolor="#0000FF"/></basematerials>"##;
    let display = r#"<m:pbmetallicdisplayproperties id="8"><m:pbmetallic name="x" metallicness="1" roughness="0.25"/><m:pbmetallic name="y" metallicness="0" roughness="0.5"/></m:pbmetallicdisplayproperties>"#;
    let scene =
        file(&format!("{bases}{}{display}", object(1, r#"pid="5" pindex="1""#)), &items(&[1])).unwrap();
    let material = &scene.materials[scene.objects[0].material];
    let number = |key: &str| material.parameters.find(key).map(|(value, _)| value.clone());
    assert_eq!(number("base_metalness"), Some(Value::Number(0.0)));
    assert_eq!(number("specular_roughness"), Some(Value::Number(0.5)));
    let plain = bases.replace(r#" displaypropertiesid="8""#, "");
    // Values are parts of their sum; missing ones are 0.
    let mixed = r#"<m:compositematerials id="6" matid="5" matindices="0 1"><m:composite values="1 3"/><m:composite values="0"/></m:compositematerials>"#;
    let scene = file(&format!("{plain}{mixed}{}", object(1, r#"pid="6" pindex="0""#)), &items(&[1])).unwrap();
    assert_eq!(scene.objects[0].mesh.vertex_kd[0], Rgb::new(0.25, 0.0, 0.75));
    // A colour with an alpha of 0.4 above red, in linear light.
    let colours = r##"<m:colorgroup id="6"><m:color color="#00FF0066"/></m:colorgroup>"##;
    for (method, wanted) in
        [("", Rgb::new(0.6, 0.4, 0.0)), (r#"blendmethods="multiply""#, Rgb::new(0.0, 1.0, 0.0))]
    {
        let layers = format!(
            r#"<m:multiproperties id="7" pids="5 6" {method}><m:multi pindices="0 0"/></m:multiproperties>"#
        );
        let scene =
            file(&format!("{plain}{colours}{layers}{}", object(1, r#"pid="7" pindex="0""#)), &items(&[1]))
                .unwrap();
        let kd = scene.objects[0].mesh.vertex_kd[0];
        assert!((kd.r - wanted.r).abs() + (kd.g - wanted.g).abs() < 1e-6, "{method} {kd:?}");
    }
}

/// A second layer that multiplies hides a material, whose colour nobody knows; a third one does not. [3MF Materials 1.2, 5]
#[test]
fn layers_above_the_second_multiply_what_is_below() {
    let shade = Rgb::new(0.5, 0.25, 1.0);
    let picture = bilux_pictures::Picture::from_rgb(2, 2, vec![shade; 4]).unwrap();
    let png = bilux_pictures::write_bytes("png", &picture, &Default::default()).unwrap();
    let base = r##"<basematerials id="5"><base name="a" displaycolor="#FF0000"/></basematerials>"##;
    // Green with an alpha of 0.4 above red.
    let green = r##"<m:colorgroup id="6"><m:color color="#00FF0066"/></m:colorgroup>"##;
    let texture = r#"<m:texture2d id="3" path="/3D/t.png" contenttype="image/png"/><m:texture2dgroup id="4" texid="3"><m:tex2coord u="0" v="0"/></m:texture2dgroup>"#;
    for (methods, wanted) in [
        ("mix multiply", Rgb::new(0.6, 0.4, 0.0) * shade),
        ("multiply multiply", Rgb::new(0.0, 1.0, 0.0) * shade),
        ("mix mix", shade),
    ] {
        let layers = format!(
            r#"<m:multiproperties id="7" pids="5 6 4" blendmethods="{methods}"><m:multi pindices="0 0 0"/></m:multiproperties>"#
        );
        let whole = format!("{base}{green}{texture}{layers}{}", object(1, r#"pid="7" pindex="0""#));
        let scene = file_with(&model(&whole, &items(&[1])), &[("3D/t.png", &png)]).unwrap();
        let material = &scene.materials[scene.objects[0].material];
        let Some((Value::Texture(index), _)) = material.parameters.find("base_color") else {
            panic!("{methods}: {material:?}")
        };
        let found = scene.textures[*index].at_one(Vec2::new(0.3, 0.6));
        assert!((found - wanted).map(f32::abs).max_channel() < 4e-3, "{methods}: {found:?}, not {wanted:?}");
    }
}

#[test]
fn textures_lie_with_v_upwards() {
    let picture = bilux_pictures::Picture::from_rgb(1, 2, vec![Rgb::WHITE, Rgb::BLACK]).unwrap();
    let png = bilux_pictures::write_bytes("png", &picture, &Default::default()).unwrap();
    let resources = format!(
        r#"<m:texture2d id="3" path="/3D/t.png" contenttype="image/png" tilestyleu="mirror" tilestylev="clamp"/><m:texture2dgroup id="4" texid="3"><m:tex2coord u="0" v="0"/><m:tex2coord u="1" v="0.9"/></m:texture2dgroup>{}"#,
        object(1, r#"pid="4" pindex="1""#)
    );
    let scene = file_with(&model(&resources, &items(&[1])), &[("3D/t.png", &png)]).unwrap();
    assert_eq!((scene.objects[0].mesh.uvs[0], warnings(&scene)), (Vec2::new(1.0, 0.9), String::new()));
    let texture = &scene.textures[0];
    use bilux_scene::texture::Wrap;
    assert_eq!(texture.wrap, [Wrap::Mirror, Wrap::Clamp]);
    assert_eq!(texture.at_one(Vec2::new(0.5, 1.0)), Rgb::WHITE, "the upper row of the picture");
    let scene = file_with(&model(&resources, &items(&[1])), &[]).unwrap();
    assert!(warnings(&scene).contains("does not contain the picture '/3D/t.png'"), "{}", warnings(&scene));
}

#[test]
fn beams_are_tubes_with_balls_at_their_ends() {
    let lattice = r#"<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="0" y="0" z="4"/></vertices><triangles/><b:beamlattice radius="0.5" minlength="0.1"><b:beams><b:beam v1="0" v2="1" r1="0.5" r2="0.25"/></b:beams></b:beamlattice></mesh></object>"#;
    let scene = file(lattice, &items(&[1])).unwrap();
    let tubes = &scene.objects[0].mesh;
    let radius = |p: &Vec3| p.truncate().length();
    let [first, second] = tubes.points[..] else { panic!("{:?}", tubes.points) };
    let wall = &tubes.positions[..first as usize];
    assert!(wall.iter().all(|p| (radius(p) - if p.z == 0.0 { 0.5 } else { 0.25 }).abs() < 1e-6));
    let ball = |i: u32| (tubes.positions[i as usize], tubes.point_widths[i as usize]);
    assert_eq!([ball(first), ball(second)], [(Vec3::ZERO, 1.0), (Vec3::Z * 4.0, 0.5)]);
    let [a, b, c] = tubes.triangles[0].map(|i| tubes.positions[i as usize]);
    assert!((b - a).cross(c - a).dot(tubes.normals[0]) > 0.0, "outwards");
    // Across the lines from end to end, of which each vertex at one has its neighbour at the other.
    for (ends, normal) in wall.chunks_exact(2).zip(tubes.normals.chunks_exact(2)) {
        assert!((ends[1] - ends[0]).dot(normal[0]).abs() < 1e-6 && normal[0] == normal[1], "{normal:?}");
    }
}

#[test]
fn other_parts_are_read_where_they_are_named() {
    let other = model(&object(1, ""), "");
    let build = r#"<item objectid="1" p:path="/3D/Objects/b.model"/><item objectid="1" p:path="/3D/Objects/b.model"/>"#;
    let scene = file_with(&model("", build), &[("3D/Objects/b.model", other.as_bytes())]).unwrap();
    assert_eq!(scene.objects.len(), 2);
    let message = file_with(&model("", build), &[]).unwrap_err().to_string();
    assert!(message.contains("the part '3D/Objects/b.model', which the file does not contain"), "{message}");
    let back = other.replace("<build></build>", "<build/>").replace(
        "</resources>",
        r#"<object id="2"><components><component objectid="1" p:path="/3D/a.model"/></components></object></resources>"#,
    );
    let message =
        file_with(&model("", build), &[("3D/Objects/b.model", back.as_bytes())]).unwrap_err().to_string();
    assert!(
        message.contains("only the main part of a file can refer to objects of other parts"),
        "{message}"
    );
}

#[test]
fn what_is_not_printed_is_named_and_left_out() {
    let resources = [object(1, ""), object(2, r#"type="support""#)].concat();
    let scene =
        file(&resources, r#"<item objectid="1"/><item objectid="2"/><item objectid="1" printable="0"/>"#)
            .unwrap();
    assert_eq!(scene.objects.len(), 1);
    assert!(
        warnings(&scene).contains("supports, objects that are not to be printed"),
        "{}",
        warnings(&scene)
    );
}

/// The colours of all triangles, by object.
fn colours(scene: &SceneBuilder) -> Vec<(usize, Rgb)> {
    (0..scene.objects.len()).map(|i| (scene.objects[i].mesh.triangles.len(), base_colour(scene, i))).collect()
}

#[test]
fn projects_of_slicers_say_which_filament_prints_what() {
    const RED: Rgb = Rgb::new(1.0, 0.0, 0.0);
    const GREEN: Rgb = Rgb::new(0.0, 1.0, 0.0);
    // PrusaSlicer: ranges of triangles, and triangles that are painted in parts.
    let config = r#"<config><object id="1"><metadata type="object" key="extruder" value="2"/><volume firstid="0" lastid="1"><metadata type="volume" key="extruder" value="1"/></volume><volume firstid="2" lastid="2"><metadata type="volume" key="volume_type" value="ParameterModifier"/></volume></object></config>"#;
    let settings = "; a = 1\n; extruder_colour = \"\";#00FF00\n; filament_colour = #FF0000;#0000FF\n";
    let members: [(&str, &[u8]); 2] = [
        ("Metadata/Slic3r_PE_model.config", config.as_bytes()),
        ("Metadata/Slic3r_PE.config", settings.as_bytes()),
    ];
    let scene = file_with(&model(&object(1, ""), &items(&[1])), &members).unwrap();
    assert_eq!(colours(&scene), [(2, RED), (1, GREEN)]);
    assert!(warnings(&scene).contains("modifiers"), "{}", warnings(&scene));
    let painted =
        object(1, "").replace(r#"v1="0" v2="2" v3="1""#, r#"v1="0" v2="2" v3="1" mmu_segmentation="00043""#);
    let scene = file_with(&model(&painted, &items(&[1])), &members[1..]).unwrap();
    assert_eq!(colours(&scene).iter().map(|(count, _)| count).sum::<usize>(), 7, "one in four parts");
    // Bambu Studio: components, and colours as JSON.
    let resources = format!(
        r#"{}{}<object id="3"><components><component objectid="1"/><component objectid="2"/></components></object>"#,
        object(1, ""),
        object(2, "")
    );
    let config = r#"<config><object id="3"><metadata key="extruder" value="2"/><part id="1" subtype="normal_part"/><part id="2" subtype="negative_part"/></object></config>"#;
    let members: [(&str, &[u8]); 2] = [
        ("Metadata/model_settings.config", config.as_bytes()),
        ("Metadata/project_settings.config", br##"{"filament_colour": ["#FF0000", "#00FF00"]}"##),
    ];
    let scene = file_with(&model(&resources, &items(&[3])), &members).unwrap();
    assert_eq!(colours(&scene), [(4, GREEN)]);
    assert!(warnings(&scene).contains("negative parts"), "{}", warnings(&scene));
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let whole = model(&object(1, ""), &items(&[1]));
    let cases = [
        (whole.replace(r#"v3="1"/>"#, r#"v3="4"/>"#), "x.3mf/3D/a.model:8:", "refers to vertex 4, but its mesh has 4"),
        (whole.replace(r#"y="0" z="0"/>"#, r#"z="0"/>"#), "a.model:8:", "a vertex needs x, y and z"),
        (whole.replace(r#"x="1""#, r#"x="one""#), "a.model:8:", "'vertex' has x='one', but needs a number"),
        (whole.replace(r#"objectid="1""#, r#"objectid="9""#), "a.model:10:", "object 9 is to be built, but no object"),
        (whole.replace(r#"<object id="1""#, r#"<object id="1" pindex="0""#), "a.model:8:1:", "needs a pid"),
        (whole.replace(r#"<object id="1""#, r#"<object id="1" type="x""#), "a.model:8:1:", "needs model, support"),
        (whole.replace(r#"<object id="1""#, r#"<object id="1" pid="3""#), "a.model:8:1:", "no group of properties"),
        (whole.replace("millimeter", "mile"), "a.model:2:", "'model' has unit='mile', but needs micron"),
        (whole.replace("<build>", "<b>").replace("</build>", "</b>"), "a.model:2:", "has no element 'build'"),
        (whole.replace("core/2015/02", "core/2099/01"), "a.model:2:", "this is no 3MF model"),
        (whole.replace("unit=", r#"requiredextensions="q" unit="#), "a.model:2:", "does not declare this prefix"),
        (whole.replace("unit=", r#"requiredextensions="q" xmlns:q="http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01" unit="#), "a.model:2:", "requires the extension for volumetric data"),
        (whole.replace("<model ", "<!DOCTYPE model [<!ENTITY a 'aaaa'>]><model "), "a.model:2:", "declares its own grammar"),
        (whole.replace("</mesh>", ""), "a.model:8:", "this XML cannot be read"),
        (whole[..800].to_owned(), "a.model:", "this XML cannot be read: "),
        (whole.replace("<resources>", "<resources><q:x/>"), "a.model:7:", "prefix of 'x' is not declared"),
        (whole.replace("</model>", "</model><model/>"), "a.model:10:", "a second root element"),
        (whole.replace(r#"objectid="1""#, r#"objectid="1" transform="1 2 3""#), "a.model:10:", "needs twelve numbers"),
        (whole.replace("UTF-8", "ISO-8859-1"), "a.model:1:", "its encoding is neither"),
        (model(&[object(1, ""), object(1, "")].concat(), &items(&[1])), "a.model:8:", "two resources have the id 1"),
        (model(r#"<object id="1"><components><component objectid="1"/></components></object>"#, &items(&[1])), "a.model:8:", "no object with this id comes before"),
    ];
    for (text, place, part) in cases {
        let message = file_with(&text, &[]).expect_err(part).to_string();
        assert!(message.contains(place) && message.contains(part), "{part}: {message}");
    }
    let read = |files: &[(&str, &[u8])]| {
        read_bytes(&package(files), "3mf", None, "x.3mf", &ReadOptions::default()).unwrap_err().to_string()
    };
    let types = ("[Content_Types].xml", TYPES.as_bytes());
    let message = read(&[("a.txt", b"a")]);
    assert!(message.contains("a zip archive"), "{message}");
    assert!(read(&[types]).contains("no relationship names the part with the 3D model"));
    assert!(
        read(&[types, ("_rels/.rels", RELATIONSHIPS.as_bytes())])
            .contains("the part '3D/a.model', which the file does not contain")
    );
    let text = RELATIONSHIPS.replace("2013/01/3dmodel", "x").replace(
        "http://schemas.microsoft.com/3dmanufacturing/x",
        "http://schemas.openxmlformats.org/package/2006/relationships/encryptedfile",
    );
    assert!(
        read(&[types, ("_rels/.rels", text.as_bytes())])
            .contains("is encrypted (the secure content extension)")
    );
}

#[test]
fn diagnostics_that_can_be_drawn_give_a_warning() {
    let whole = model(&object(1, ""), &items(&[1]));
    let cases = [
        (
            whole.replace(r#"v1="0" v2="2" v3="1""#, r#"v1="0" v2="2" v3="2""#),
            "x.3mf/3D/a.model:8:",
            "it has no area",
        ),
        (
            whole.replace("<resources>", r#"<metadata name="Application">b</metadata><resources>"#),
            "a.model:7:",
            "two metadata have the same name",
        ),
        (
            whole.replace(
                r#"<item objectid="1"/>"#,
                r#"<item objectid="1"/><item objectid="1" transform="0 0 0 0 0 0 0 0 0 0 0 0"/>"#,
            ),
            "a.model:10:",
            "flattens an object",
        ),
    ];
    for (text, place, part) in cases {
        let reported = warnings(&file_with(&text, &[]).unwrap());
        assert!(reported.contains(place) && reported.contains(part), "{part}: {reported}");
    }
}

#[test]
fn hostile_files_end_soon() {
    // 2^40 instances of nothing, or of something.
    for mesh in [MESH, "<mesh><vertices/><triangles/></mesh>"] {
        let mut resources = format!(r#"<object id="1">{mesh}</object>"#);
        for id in 2..42 {
            let child = format!(r#"<component objectid="{}"/>"#, id - 1);
            resources += &format!(r#"<object id="{id}"><components>{child}{child}</components></object>"#);
        }
        let text = model(&resources, &items(&[41]));
        let bytes = package(&[
            ("[Content_Types].xml", TYPES.as_bytes()),
            ("_rels/.rels", RELATIONSHIPS.as_bytes()),
            ("3D/a.model", text.as_bytes()),
        ]);
        let options = ReadOptions { max_memory: 16 << 20, ..ReadOptions::default() };
        let error = read_bytes(&bytes, "3mf", None, "x.3mf", &options).unwrap_err();
        assert!(matches!(error, FormatError::TooLarge { .. }), "{error}");
    }
    let mut deep = object(1, "");
    for id in 2..200 {
        deep += &format!(
            r#"<object id="{id}"><components><component objectid="{}"/></components></object>"#,
            id - 1
        );
    }
    let message = file(&deep, &items(&[199])).unwrap_err().to_string();
    assert!(message.contains("nested more than 64 levels deep"), "{message}");
    let nested = ["<a>".repeat(1_000_000), "</a>".repeat(1_000_000)].concat();
    let message = file(&nested, &items(&[1])).unwrap_err().to_string();
    assert!(message.contains("nested more than 256 levels deep"), "{message}");
    let message = file(&format!("<!--{}-->", "a".repeat(40 << 20)), "").unwrap_err().to_string();
    assert!(message.contains("longer than 16777216 bytes"), "{message}");
}

#[test]
fn a_file_in_utf_16_is_read() {
    let text = model(&object(1, ""), &items(&[1])).replace("UTF-8", "UTF-16");
    let wide: Vec<u8> =
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let files: [(&str, &[u8]); 3] = [
        ("[Content_Types].xml", TYPES.as_bytes()),
        ("_rels/.rels", RELATIONSHIPS.as_bytes()),
        ("3D/a.model", &wide),
    ];
    let scene = read_bytes(&package(&files), "", None, "upload", &ReadOptions::default()).unwrap();
    assert_eq!(scene.objects.len(), 1, "recognised by its first bytes, too");
}

/// Faults that the specification forbids but slicers read: drawn, and said. A tetrahedron of unit legs each time.
#[test]
fn what_slicers_read_is_drawn_with_a_warning() {
    let whole = model(&object(1, ""), &items(&[1]));
    let types = ("[Content_Types].xml", TYPES.as_bytes());
    let relations = ("_rels/.rels", RELATIONSHIPS.as_bytes());
    let read = |files: &[(&str, &[u8])]| {
        let scene = read_bytes(&package(files), "3mf", None, "x.3mf", &ReadOptions::default()).unwrap();
        assert_eq!(scene.bounds(0.0).max, Vec3::ONE);
        (scene.objects.len(), warnings(&scene))
    };
    let (count, said) = read(&[relations, ("3D/a.model", whole.as_bytes())]);
    assert!(count == 1 && said.contains("has no '[Content_Types].xml'"), "{said}");
    let (count, said) = read(&[types, ("3D/3dmodel.model", whole.as_bytes())]);
    assert!(count == 1 && said.contains("no relationship names the part"), "{said}");
    let zero = model(&object(0, ""), &items(&[0]));
    let (count, said) = read(&[types, relations, ("3D/a.model", zero.as_bytes())]);
    assert!(count == 1 && said.contains("an id is 0"), "{said}");
    let draft = whole.replace("core/2015/02", "2013/01");
    let (count, said) = read(&[types, relations, ("3D/a.model", draft.as_bytes())]);
    assert!(count == 1 && said.contains("the draft of 2013"), "{said}");
    // Two parts beside the main one, without a build of their own. [3MF Production 1.1]
    let build = r#"<item objectid="1" p:path="/3D/b.model"/><item objectid="1" p:path="/3D/c.model"/>"#;
    let main = model("", build);
    let part = whole.replace("<build><item objectid=\"1\"/></build>", "");
    let parts = [("3D/b.model", part.as_bytes()), ("3D/c.model", part.as_bytes())];
    let (count, said) = read(&[types, relations, ("3D/a.model", main.as_bytes()), parts[0], parts[1]]);
    assert!(count == 2 && said.contains("has no element 'build'"), "{said}");
}
