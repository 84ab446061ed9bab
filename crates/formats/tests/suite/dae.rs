//! Collada files as programs write them.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read, read_bytes};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Spec, Texture, Value};
use std::sync::Arc;

/// Positions of a square of two by two, for a mesh with an id.
fn geometry(id: &str, positions: &str, polygons: &str) -> String {
    let count = positions.split_whitespace().count();
    format!(
        "<geometry id='{id}'><mesh><source id='{id}-p'><float_array id='{id}-a' count='{count}'>{positions}</float_array>\
         <technique_common><accessor source='#{id}-a' count='{}' stride='3'/></technique_common></source>\
         <vertices id='{id}-v'><input semantic='POSITION' source='#{id}-p'/></vertices>{polygons}</mesh></geometry>",
        count / 3
    )
}

const SQUARE: &str = "0 0 0 2 0 0 2 2 0 0 2 0";

fn polylist(id: &str) -> String {
    format!(
        "<polylist material='m' count='1'><input semantic='VERTEX' source='#{id}-v' offset='0'/><vcount>4</vcount>\
         <p>0 1 2 3</p></polylist>"
    )
}

/// A file with an asset, libraries and the nodes of its scene.
fn file(asset: &str, libraries: &str, nodes: &str) -> String {
    format!(
        "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>\
         <asset>{asset}</asset>{libraries}<library_visual_scenes><visual_scene id='s'>{nodes}</visual_scene>\
         </library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>"
    )
}

/// A file with the square at a node.
fn placed(asset: &str, more: &str, transforms: &str) -> String {
    let square =
        format!("<library_geometries>{}</library_geometries>{more}", geometry("g", SQUARE, &polylist("g")));
    file(asset, &square, &format!("<node id='n'>{transforms}{INSTANCE}</node>"))
}

const INSTANCE: &str = "<instance_geometry url='#g'><bind_material><technique_common><instance_material symbol='m' \
                        target='#mat'/></technique_common></bind_material></instance_geometry>";

fn scene(text: &str) -> SceneBuilder {
    read_text("dae", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Corners of the first object, in world space.
fn corners(scene: &SceneBuilder) -> Vec<Vec3> {
    let object = &scene.objects[0];
    object.mesh.positions.iter().map(|p| object.motion.at(0.0).point(*p)).collect()
}

fn near(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).length() < 1e-5
}

#[test]
fn scenes_are_in_metres_with_y_up() {
    let third = |asset: &str| corners(&scene(&placed(asset, "", "<translate>0 0 1</translate>")))[2];
    let inch = "<unit name='inch' meter='0.0254'/>";
    assert!(near(third(""), [2.0, 2.0, 1.0]));
    assert!(near(third(inch), [0.0508, 0.0508, 0.0254]));
    assert!(near(third("<up_axis>Z_UP</up_axis>"), [2.0, 1.0, -2.0]));
    assert!(near(third("<up_axis>X_UP</up_axis>"), [-2.0, 2.0, 1.0]));
    let tool = "<contributor><authoring_tool>SketchUp 26.0</authoring_tool></contributor>";
    let read = read_text("", placed(tool, "", "")).unwrap();
    assert_eq!(read.written_by, "SketchUp 26.0", "by its first bytes");
    let odd = scene(&placed("<unit meter='0'/>", "", ""));
    assert!(warnings(&odd).contains("it is read as a metre"), "{}", warnings(&odd));
}

#[test]
fn transforms_apply_in_the_order_of_the_file() {
    let third = |transforms: &str| corners(&scene(&placed("", "", transforms)))[2];
    for (transforms, expected) in [
        ("<translate>1 0 0</translate><scale>2 2 2</scale>", [5.0, 4.0, 0.0]),
        ("<scale>2 2 2</scale><translate>1 0 0</translate>", [6.0, 4.0, 0.0]),
        ("<rotate>0 0 1 90</rotate>", [-2.0, 2.0, 0.0]),
        ("<matrix>1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1</matrix>", [7.0, 8.0, 7.0]),
        // The further along y, the more to the right, as the pictures of the conformance suite show it.
        ("<skew>45 1 0 0 0 1 0</skew>", [4.0, 2.0, 0.0]),
        // Looks from x = 5 to the origin: what is ahead (-z) is towards -x.
        ("<lookat>5 0 0 0 0 0 0 1 0</lookat>", [5.0, 2.0, -2.0]),
    ] {
        let found = third(transforms);
        assert!(near(found, expected), "{transforms}: {found}");
    }
}

#[test]
fn every_form_of_polygons_is_that_square() {
    let input = "<input semantic='VERTEX' source='#g-v' offset='0'/>";
    // Of a fan the first vertex is shared, of a strip each pair.
    for polygons in [
        format!("<triangles count='2'>{input}<p>0 1 2 0 2 3</p></triangles>"),
        format!("<polylist count='2'>{input}<vcount>3 3</vcount><p>0 1 2 0 2 3</p></polylist>"),
        format!("<polygons count='1'>{input}<p>0 1 2 3</p></polygons>"),
        format!("<trifans count='1'>{input}<p>0 1 2 3</p></trifans>"),
        format!("<tristrips count='1'>{input}<p>0 1 3 2</p></tristrips>"),
        // The vertices come second among the indices, and what comes first does not exist.
        "<triangles><input semantic='NORMAL' source='#no' offset='0'/><input semantic='VERTEX' source='#g-v' offset='1'/>\
         <p>9 0 9 1 9 2 9 0 9 2 9 3</p></triangles>"
            .to_owned(),
    ] {
        let libraries = format!("<library_geometries>{}</library_geometries>", geometry("g", SQUARE, &polygons));
        let scene = scene(&file("", &libraries, "<node><instance_geometry url='#g'/></node>"));
        let mesh = &scene.objects[0].mesh;
        let doubled = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a)
        };
        assert_eq!(mesh.triangles.len(), 2, "{polygons}");
        assert!(mesh.triangles.iter().all(|t| doubled(t) == Vec3::new(0.0, 0.0, 4.0)), "{polygons}");
        assert_eq!(warnings(&scene), "");
    }
    let hole = "<polygons><input semantic='VERTEX' source='#g-v' offset='0'/><ph><p>0 1 2 3</p><h>4 5 6 7</h></ph></polygons>";
    let positions = format!("{SQUARE} .5 .5 0 1 .5 0 1 1 0 .5 1 0");
    let libraries = format!("<library_geometries>{}</library_geometries>", geometry("g", &positions, hole));
    let scene = scene(&file("", &libraries, "<node><instance_geometry url='#g'/></node>"));
    let mesh = &scene.objects[0].mesh;
    let area: f32 = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.positions[i as usize]))
        .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
        .sum();
    assert!((area - 3.75).abs() < 1e-6, "{area}");
}

/// A file whose square has a material with these values of a model.
fn with_material(asset: &str, shader: &str, more: &str) -> String {
    let libraries = format!(
        "<library_materials><material id='mat' name='paint'><instance_effect url='#e'/></material></library_materials>\
         <library_effects><effect id='e'><profile_COMMON>{more}<technique sid='c'>{shader}</technique></profile_COMMON></effect></library_effects>"
    );
    placed(asset, &libraries, "")
}

/// Opacities by the four modes of the specification, and what programs write in spite of them.
#[test]
fn transparency_is_what_its_mode_says_and_never_all() {
    let opacity = |tool: &str, inner: &str| {
        let asset = format!("<contributor><authoring_tool>{tool}</authoring_tool></contributor>");
        let scene = scene(&with_material(&asset, &format!("<phong>{inner}</phong>"), ""));
        (scene.materials[0].number("opacity").unwrap_or(1.0), warnings(&scene).contains("wholly transparent"))
    };
    let inner = |mode: &str, colour: &str, factor: &str| {
        format!(
            "<transparent{mode}><color>{colour}</color></transparent><transparency><float>{factor}</float></transparency>"
        )
    };
    for (mode, colour, factor, expected) in [
        ("", "1 1 1 1", "0.25", 0.25),
        (" opaque='A_ONE'", "0 0 0 0.5", "0.5", 0.25),
        (" opaque='RGB_ZERO'", "0.4 0.4 0.4 1", "0.5", 0.8),
        (" opaque='A_ZERO'", "0 0 0 0.25", "1", 0.75),
        (" opaque='RGB_ONE'", "0.5 0.5 0.5 1", "0.5", 0.25),
        (" opaque='RGB_ZERO'", "0 0 0 1", "1", 1.0),
    ] {
        let (found, is_noted) = opacity("x", &inner(mode, colour, factor));
        assert!((found - expected).abs() < 1e-6 && !is_noted, "{mode} {colour} {factor}: {found}");
    }
    // White in RGB_ZERO, of 3ds Max and Maya, and no opacity at all, of old SketchUp: both are meant to be opaque.
    assert_eq!(opacity("x", &inner(" opaque='RGB_ZERO'", "1 1 1 1", "1")), (1.0, true));
    assert_eq!(opacity("x", &inner("", "1 1 1 1", "0")), (1.0, true));
    assert_eq!(opacity("Google SketchUp 6.4.112", &inner("", "1 1 1 1", "0.25")).0, 0.75);
    assert_eq!(opacity("Google SketchUp 7.1.4871", &inner("", "1 1 1 1", "0.25")).0, 0.25);
    let alone = opacity("x", "<transparency><float>0.5</float></transparency>");
    assert_eq!(alone.0, 0.5);
}

#[test]
fn phong_becomes_principled() {
    let shader = "<blinn><emission><color>0 0 0 1</color></emission><diffuse><param ref='tint'/></diffuse>\
                  <specular><color>0.5 0.25 0 1</color></specular><shininess><float>30</float></shininess></blinn>";
    let tint = "<newparam sid='tint'><float3>1 0 0.5</float3></newparam>";
    let material = scene(&with_material("", shader, tint)).materials.remove(0);
    assert_eq!(material.name, "paint");
    let srgb = bilux_math::colour::srgb_decode(0.5);
    assert_eq!(material.colour("base_color"), Some(Rgb::new(1.0, 0.0, srgb)));
    // The square root of the square root of 2 / (30 + 2).
    assert!((material.number("specular_roughness").unwrap() - 0.5).abs() < 1e-6);
    assert!((material.number("specular_weight").unwrap() - srgb).abs() < 1e-6);
    let blender = "<contributor><authoring_tool>Blender 2.79.0</authoring_tool></contributor>";
    let material = scene(&with_material(blender, shader, tint)).materials.remove(0);
    assert_eq!(material.colour("base_color"), Some(Rgb::new(1.0, 0.0, 0.5)), "linear");
}

#[test]
fn textures_are_found_by_every_chain_of_names() {
    let folder = std::env::temp_dir().join(format!("bilux dae {}", std::process::id()));
    std::fs::create_dir_all(folder.join("textures")).unwrap();
    std::fs::write(folder.join("textures/a b.ppm"), "P3 1 1 255 255 0 0").unwrap();
    let shader = |name: &str| {
        format!("<lambert><diffuse><texture texture='{name}' texcoord='UV'/></diffuse></lambert>")
    };
    let image = |inner: &str| {
        format!("<library_images><image id='img'><init_from>{inner}</init_from></image></library_images>")
    };
    let surface = "<newparam sid='su'><surface type='2D'><init_from>img</init_from></surface></newparam>\
                   <newparam sid='sa'><sampler2D><source>su</source><wrap_s>CLAMP</wrap_s></sampler2D></newparam>";
    let new = "<newparam sid='sa'><sampler2D><instance_image url='#img'/></sampler2D></newparam>";
    for (name, params, from) in [
        ("sa", surface, "textures/a%20b.ppm"),
        ("su", surface, "file:///C:/models/textures/a%20b.ppm"),
        ("sa", new, "<ref>.\\textures\\a b.ppm</ref>"),
        ("img", "", "/srv/me/a b.ppm"),
    ] {
        let text = with_material("", &shader(name), params)
            .replace("<library_materials>", &(image(from) + "<library_materials>"));
        let path = folder.join("scene.dae");
        std::fs::write(&path, text).unwrap();
        let scene = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(warnings(&scene), "", "{from}");
        assert!(matches!(scene.materials[0].parameters.find("base_color"), Some((Value::Texture(0), _))));
        assert_eq!(scene.textures[0].texel(0, 0), Rgb::new(1.0, 0.0, 0.0), "{from}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Maya turns a picture about its middle, wherever that is after it has been repeated, and moves it then.
#[test]
fn pictures_are_turned_about_their_middle() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.ppm"), "P3 1 1 255 255 0 0").unwrap();
    for degrees in [0.0f32, 30.0, 90.0, 200.0] {
        let shader = format!(
            "<lambert><diffuse><texture texture='img' texcoord='UV'><extra><technique profile='MAYA'><repeatU>2</repeatU>\
             <repeatV>4</repeatV><offsetU>0.1</offsetU><offsetV>0.3</offsetV><rotateUV>{degrees}</rotateUV></technique></extra></texture>\
             </diffuse></lambert>"
        );
        let image = "<library_images><image id='img'><init_from>a.ppm</init_from></image></library_images>";
        let text = with_material("", &shader, "")
            .replace("<library_materials>", &format!("{image}<library_materials>"));
        let path = folder.path().join("scene.dae");
        std::fs::write(&path, text).unwrap();
        let scene = read(&path, &ReadOptions::default()).unwrap();
        let transform = scene.textures[0].transform.unwrap();
        // v is upwards in the file, and downwards in a picture.
        let at = |u: f32, v: f32| {
            let found = transform.apply(Vec2::new(u, 1.0 - v));
            Vec2::new(found.x, 1.0 - found.y)
        };
        let middle = at(0.25, 0.125);
        assert!(middle.distance(Vec2::new(0.6, 0.8)) < 1e-5, "{degrees}: {middle}");
        let [u, v] = [at(0.75, 0.125) - middle, at(0.25, 0.375) - middle];
        assert!((u.length() - 1.0).abs() < 1e-5 && v.distance(Vec2::new(-u.y, u.x)) < 1e-5, "{u} {v}");
        assert!((u.x - bilux_math::transcendental::cos(degrees.to_radians())).abs() < 1e-5, "{degrees}: {u}");
    }
}

fn source(id: &str, kind: &str, list: &str, stride: usize) -> String {
    let count = list.split_whitespace().count();
    format!(
        "<source id='{id}'><{kind} id='{id}-array' count='{count}'>{list}</{kind}><technique_common><accessor \
         source='#{id}-array' count='{}' stride='{stride}'/></technique_common></source>",
        count / stride
    )
}

const IDENTITY: &str = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ";

#[test]
fn skins_follow_their_joints_by_sid_and_by_id() {
    // 3ds Max writes names with spaces in them; only the number of the names tells that they are not more.
    let plain = ["one", "two"];
    for (kind, [one, two]) in
        [("Name_array", plain), ("IDREF_array", plain), ("Name_array", ["Bip01 L", "Bip01 L Calf"])]
    {
        let skin = format!(
            "<library_controllers><controller id='c'><skin source='#g'><bind_shape_matrix>1 0 0 10 0 1 0 0 0 0 1 0 0 0 0 1\
             </bind_shape_matrix>{}{}{}<joints><input semantic='JOINT' source='#j'/><input semantic='INV_BIND_MATRIX' source='#b'/>\
             </joints><vertex_weights count='4'><input semantic='JOINT' source='#j' offset='0'/><input semantic='WEIGHT' source='#w' \
             offset='1'/><vcount>1 2 1 0</vcount><v>0 0 0 1 1 1 -1 0</v></vertex_weights></skin></controller></library_controllers>",
            format_args!("<source id='j'><{kind} id='ja' count='2'>{one} {two}</{kind}></source>"),
            source("b", "float_array", &IDENTITY.repeat(2), 16),
            source("w", "float_array", "1 0.5", 1),
        );
        let libraries = format!(
            "<library_geometries>{}</library_geometries>{skin}",
            geometry("g", SQUARE, &polylist("g"))
        );
        let joint = |name: &str, by: &str| {
            let key = if kind == "Name_array" {
                format!("id='x{name}' sid='{name}'")
            } else {
                format!("id='{name}'")
            };
            format!("<node {key} type='JOINT'><translate>{by}</translate></node>")
        };
        let nodes = format!(
            "<node id='root'>{}{}</node><node><translate>0 0 5</translate><instance_controller url='#c'>\
             <skeleton>#root</skeleton></instance_controller></node>",
            joint(one, "0 100 0"),
            joint(two, "0 200 0")
        );
        let found = corners(&scene(&file("", &libraries, &nodes)));
        // The first follows one joint, the second two; the third is as it was bound, and the last has no joints.
        for (found, expected) in
            found.iter().zip([[10., 100., 0.], [12., 150., 0.], [12., 2., 5.], [10., 2., 5.]])
        {
            assert!(near(*found, expected), "{kind}: {found} {expected:?}");
        }
        // The shapes of a morph are not where the bones have moved the mesh.
        let morph = format!(
            "</controller><controller id='m'><morph source='#c'>{}{}<targets><input semantic='MORPH_TARGET' source='#t'/><input \
             semantic='MORPH_WEIGHT' source='#mw'/></targets></morph></controller></library_controllers>",
            source("t", "IDREF_array", "g", 1),
            source("mw", "float_array", "0.5", 1),
        );
        let libraries = libraries.replace("</controller></library_controllers>", &morph);
        let scene = scene(&file("", &libraries, &nodes.replace("url='#c'", "url='#m'")));
        assert!(warnings(&scene).contains("morphs of meshes that bones have moved"), "{}", warnings(&scene));
        assert!(near(corners(&scene)[0], [10., 100., 0.]));
    }
}

#[test]
fn morphs_are_normalized_or_relative_and_their_weights_move() {
    let morph = |method: &str| {
        let library = format!(
            "<library_controllers><controller id='c'><morph source='#g' method='{method}'>{}{}<targets><input \
             semantic='MORPH_TARGET' source='#t'/><input semantic='MORPH_WEIGHT' source='#w'/></targets></morph></controller>\
             </library_controllers><library_animations><animation>{}{}<sampler id='sm'><input semantic='INPUT' source='#i'/>\
             <input semantic='OUTPUT' source='#o'/></sampler><channel source='#sm' target='w(0)'/></animation></library_animations>",
            source("t", "IDREF_array", "h", 1),
            source("w", "float_array", "0.5", 1),
            source("i", "float_array", "0 2", 1),
            source("o", "float_array", "0.5 1", 1),
        );
        // A shape needs no polygons of its own.
        let polygons = polylist("h");
        let high = geometry(
            "h",
            "0 0 4 2 0 4 2 2 4 0 2 4",
            if method == "RELATIVE" { "" } else { polygons.as_str() },
        );
        let square = geometry("g", SQUARE, &polylist("g"));
        let libraries = format!("<library_geometries>{square}{high}</library_geometries>{library}");
        file("", &libraries, "<node><instance_controller url='#c'/></node>")
    };
    let third = |method: &str, time: f32| {
        let options = ReadOptions { time, ..ReadOptions::default() };
        corners(&read_bytes(morph(method).as_bytes(), "dae", None, "x", &options).unwrap())[2]
    };
    assert!(near(third("NORMALIZED", 0.0), [2.0, 2.0, 2.0]));
    assert!(near(third("RELATIVE", 0.0), [3.0, 3.0, 2.0]));
    assert!(near(third("NORMALIZED", 1.0), [2.0, 2.0, 3.0]));
}

/// An animation of a target, from time 0 to 2.
fn animated(kind: &str, target: &str, output: (&str, usize), tangents: &str) -> String {
    let (list, stride) = output;
    format!(
        "<library_animations><animation id='an'>{}{}{}{tangents}<sampler id='sm'><input semantic='INPUT' source='#i'/><input \
         semantic='OUTPUT' source='#o'/><input semantic='INTERPOLATION' source='#k'/><input semantic='OUT_TANGENT' source='#ot'/>\
         <input semantic='IN_TANGENT' source='#it'/></sampler><channel source='#sm' target='{target}'/></animation></library_animations>",
        source("i", "float_array", "0 2", 1),
        source("o", "float_array", list, stride),
        source("k", "Name_array", &format!("{kind} {kind}"), 1),
    )
}

#[test]
fn animations_set_the_numbers_of_their_targets() {
    let transforms = "<translate sid='t'>0 0 0</translate><rotate sid='r'>0 0 1 0</rotate><matrix sid='m'>1 0 0 0 0 1 0 0 0 0 1 \
                      0 0 0 0 1</matrix>";
    let at = |library: &str, time: f32, animation: Option<&str>| {
        let options = ReadOptions {
            time,
            animation: animation.map(str::to_owned),
            whole_movement: true,
            ..ReadOptions::default()
        };
        let text = placed("", library, transforms);
        let scene = read_bytes(text.as_bytes(), "dae", None, "x", &options).unwrap();
        assert_eq!(scene.movement.as_ref().unwrap().objects.len(), 9);
        corners(&scene)[2]
    };
    let turned = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0 -1 0 4 1 0 0 0 0 0 1 0 0 0 0 1";
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // The first half of a Bézier curve from 0 to 8 that starts and ends level is as high as its middle, 4.
    let level =
        source("ot", "float_array", "0.7 0 2.7 8", 2) + &source("it", "float_array", "-0.7 0 1.3 8", 2);
    for (kind, target, output, tangents, expected) in [
        ("LINEAR", "n/t.X", ("0 8", 1), "", [6.0, 2.0, 0.0]),
        ("STEP", "n/t.X", ("1 8", 1), "", [3.0, 2.0, 0.0]),
        ("LINEAR", "n/t", ("0 0 0 8 6 4", 3), "", [6.0, 5.0, 2.0]),
        ("LINEAR", "n/r.ANGLE", ("0 180", 1), "", [-2.0, 2.0, 0.0]),
        ("LINEAR", "n/m(3)(1)", ("0 8", 1), "", [2.0, 6.0, 0.0]),
        ("LINEAR", "n/m", (turned, 16), "", [2.0, 4.0 * half, 0.0]),
        ("BEZIER", "n/t.Y", ("0 8", 1), &level, [2.0, 6.0, 0.0]),
    ] {
        let found = at(&animated(kind, target, output, tangents), 1.0, None);
        assert!(near(found, expected), "{kind} {target}: {found}");
    }
    let clips = animated("LINEAR", "n/t.X", ("0 8", 1), "")
        + "<library_animation_clips><animation_clip id='all' end='2'><instance_animation url='#an'/></animation_clip>\
           <animation_clip name='late' start='1' end='2'><instance_animation url='#an'/></animation_clip></library_animation_clips>";
    assert!(near(at(&clips, 0.0, None), [2.0, 2.0, 0.0]));
    assert!(near(at(&clips, 0.5, Some("late")), [8.0, 2.0, 0.0]));
}

#[test]
fn cameras_and_lights_are_those_of_the_file() {
    let libraries = "<library_cameras><camera id='p'><optics><technique_common><perspective><xfov>90</xfov><aspect_ratio>2\
                     </aspect_ratio></perspective></technique_common></optics></camera><camera id='o'><optics><technique_common>\
                     <orthographic><ymag>3</ymag></orthographic></technique_common></optics></camera></library_cameras>\
                     <library_lights><light id='d'><technique_common><directional><color>1 1 1</color></directional></technique_common>\
                     </light><light id='q'><technique_common><point><color>1 1 1</color><constant_attenuation>0</constant_attenuation>\
                     <quadratic_attenuation>0.25</quadratic_attenuation></point></technique_common></light><light id='s'>\
                     <technique_common><spot><color>1 1 1</color><falloff_angle>60</falloff_angle></spot></technique_common></light>\
                     <light id='a'><technique_common><ambient><color>0.5 0.5 0.5</color></ambient></technique_common></light></library_lights>";
    let nodes = "<instance_camera url='#p'/><instance_camera url='#o'/><instance_light url='#d'/><instance_light url='#q'/>\
                 <instance_light url='#s'/><instance_light url='#a'/>";
    let read = scene(&placed("<unit meter='0.5'/>", libraries, nodes));
    let fov = read.cameras[0].spec.number("fov").unwrap();
    // Half as high as wide: twice the arc tangent of one half.
    assert!((fov - 53.130_1).abs() < 1e-3, "{fov}");
    assert_eq!(read.cameras[1].spec.number("height"), Some(3.0), "six units of half a metre");
    let pi = std::f32::consts::PI;
    let kinds: Vec<&str> = read.lights.iter().map(|light| &*light.kind).collect();
    assert_eq!(kinds, ["directional", "point", "spot", "environment", "environment"]);
    let behind: Vec<bool> = read.lights.iter().map(bilux_scene::Spec::is_backdrop).collect();
    assert_eq!(behind, [false, false, false, false, true]);
    assert!((read.lights[0].colour("irradiance").unwrap().r - pi).abs() < 1e-5);
    // At 2 units, or 1 metre, a white surface is white: 1 / (0.25 · 2²) of an irradiance of π.
    assert!((read.lights[1].colour("intensity").unwrap().r - pi).abs() < 1e-5);
    assert_eq!(read.lights[2].number("angle"), Some(30.0), "half of the whole cone");
    let blender = "<contributor><authoring_tool>Blender 2.93.0</authoring_tool></contributor>";
    let watts = libraries.replace("<color>1 1 1</color><constant", "<color>1000 1000 1000</color><constant");
    let read = scene(&placed(blender, &watts, nodes));
    assert!((read.lights[1].colour("intensity").unwrap().r - 1000.0 / (4.0 * pi)).abs() < 1e-3);
}

#[test]
fn what_is_wrong_is_refused_or_said_with_its_place() {
    let node = |inner: &str| file("", "", inner);
    let cycle = file(
        "",
        "<library_nodes><node id='a'><instance_node url='#b'/></node><node id='b'><instance_node url='#a'/></node></library_nodes>",
        "<node><instance_node url='#a'/></node>",
    );
    let deep = node(&("<node>".repeat(3000) + &"</node>".repeat(3000)));
    for (text, part) in [
        (cycle, "its own ancestor"),
        (deep, "nested more than 2000 levels"),
        (node("<node><translate>1 2</translate></node>"), "<translate> has 3 numbers, not 2"),
        (node("<node><scale>1 x 1</scale></node>"), "'x' where a number has to be"),
        ("<COLLADA/>".to_owned(), "no <visual_scene>"),
        ("<!DOCTYPE COLLADA [<!ENTITY a 'b'>]><COLLADA/>".to_owned(), "document type"),
        ("<COLLADA><asset>".to_owned(), "not well-formed"),
    ] {
        let error = refusal("dae", &text);
        assert!(error.contains(part) && error.starts_with("scene.dae:1:"), "{error}");
    }
    let missing = placed("", "", "").replace("#g'>", "other.dae#g'>");
    assert!(warnings(&scene(&missing)).contains("is in another file, which is not read"));
    let out_of_range = placed("", "", "").replace("0 1 2 3", "0 1 2 9");
    assert!(warnings(&scene(&out_of_range)).contains("a vertex that the mesh does not have"));
}

/// A picture's alpha counts times `<transparency>` [Collada 1.4.1, transparent]: in each mode, by two different numbers.
#[test]
fn a_picture_of_opacity_counts_times_transparency() {
    use bilux_scene::texture::Channel;
    let folder = tempfile::tempdir().unwrap();
    let picture = bilux_pictures::Picture::from_rgb(2, 1, vec![Rgb::grey(1.0), Rgb::grey(0.25)]).unwrap();
    bilux_pictures::write(folder.path().join("mask.png"), &picture, &Default::default()).unwrap();
    let opacities = |mode: &str, factor: f32| {
        let (spec, textures) = with_mask(folder.path(), mode, factor);
        let Some((Value::Texture(index), _)) = spec.parameters.find("opacity") else { panic!("{spec:?}") };
        let texture = &textures[*index];
        assert_ne!(texture.channel, Some(Channel::A), "this picture has no alpha");
        [texture.texel(0, 0).g, texture.texel(1, 0).g]
    };
    // The bytes of the picture are 255 and 137, read as numbers.
    let grey = 137.0 / 255.0;
    for (mode, factor, wanted) in [
        ("RGB_ONE", 1.0, [1.0, grey]),
        ("RGB_ONE", 0.5, [0.5, 0.5 * grey]),
        ("RGB_ZERO", 0.5, [0.5, 1.0 - 0.5 * grey]),
        ("RGB_ZERO", 0.25, [0.75, 1.0 - 0.25 * grey]),
    ] {
        let found = opacities(mode, factor);
        let off = (found[0] - wanted[0]).abs().max((found[1] - wanted[1]).abs());
        assert!(off < 0.01, "{mode} {factor}: {found:?}, not {wanted:?}");
    }
    // In the modes of alpha, that of a picture without any is 1.
    for (mode, wanted) in [("A_ONE", 0.25), ("A_ZERO", 0.75)] {
        assert_eq!(with_mask(folder.path(), mode, 0.25).0.number("opacity"), Some(wanted), "{mode}");
    }
}

/// A material whose `<transparent>` is a picture in two greys, with the textures of its scene.
fn with_mask(folder: &std::path::Path, mode: &str, factor: f32) -> (Spec, Vec<Arc<Texture>>) {
    let shader = format!(
        "<phong><diffuse><color>1 1 1 1</color></diffuse><transparent opaque='{mode}'><texture texture='mask' texcoord='u'/>\
         </transparent><transparency><float>{factor}</float></transparency></phong>"
    );
    let images = "<image id='mask'><init_from>mask.png</init_from></image>";
    let path = folder.join("a.dae");
    std::fs::write(&path, with_material("", &shader, images)).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    (scene.materials[scene.objects[0].material].clone(), scene.textures)
}

/// Files in which 0 is opaque have all of their materials so: what some exporters for 3ds Max write.
#[test]
fn inverted_transparency_is_of_whole_files() {
    let opacities = |numbers: &[&str]| -> Vec<f32> {
        let effects: String = numbers
            .iter()
            .enumerate()
            .map(|(i, number)| {
                format!(
                    "<effect id='e{i}'><profile_COMMON><technique sid='c'><phong><transparent><color>1 1 1 1</color></transparent>\
                     <transparency><float>{number}</float></transparency></phong></technique></profile_COMMON></effect>"
                )
            })
            .collect();
        let list = |kind: &dyn Fn(usize) -> String| (0..numbers.len()).map(kind).collect::<String>();
        let materials = list(&|i| format!("<material id='m{i}'><instance_effect url='#e{i}'/></material>"));
        let nodes = list(&|i| {
            let bound = INSTANCE.replace("#mat", &format!("#m{i}"));
            format!("<node id='n{i}'>{bound}</node>")
        });
        let libraries = format!(
            "<library_effects>{effects}</library_effects><library_materials>{materials}</library_materials>\
             <library_geometries>{}</library_geometries>",
            geometry("g", SQUARE, &polylist("g"))
        );
        let scene = scene(&file("", &libraries, &nodes));
        scene.objects.iter().map(|o| scene.materials[o.material].number("opacity").unwrap_or(1.0)).collect()
    };
    let near = |found: &[f32], wanted: &[f32]| {
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}, not {wanted:?}");
    };
    near(&opacities(&["0", "0.2", "0.75"]), &[1.0, 0.8, 0.25]);
    near(&opacities(&["1", "0.2", "0.75"]), &[1.0, 0.2, 0.75]);
    near(&opacities(&["0", "0.2", "1"]), &[1.0, 0.2, 1.0]);
}

/// An asset is of the element that it is in [Collada 1.4.1, asset], within others that have their own.
#[test]
fn axes_and_units_are_of_the_element_that_states_them() {
    let square =
        format!("<library_geometries>{}</library_geometries>", geometry("g", SQUARE, &polylist("g")));
    let asset = |inside: &str| format!("<asset>{inside}</asset>");
    let inner = format!(
        "<node id='b'>{}<translate>0 0 3</translate>{INSTANCE}</node>",
        asset("<unit meter='0.01'/>")
    );
    let nodes = format!(
        "<node id='a'>{}<translate>1 2 5</translate>{INSTANCE}{inner}</node><node id='c'><translate>0 7 0</translate>{INSTANCE}</node>",
        asset("<up_axis>Z_UP</up_axis>")
    );
    let scene = scene(&file("<unit meter='0.5'/>", &square, &nodes));
    let corner = |i: usize| scene.objects[i].motion.at(0.0).point(Vec3::new(2.0, 2.0, 0.0));
    // The corner at (2, 2, 0): in halves of a metre with z up after (1, 2, 5); 3 cm above that, in centimetres; and with y up.
    assert!(near(corner(0), [1.5, 2.5, -2.0]), "{}", corner(0));
    assert!(near(corner(1), [0.52, 2.53, -1.02]), "{}", corner(1));
    assert!(near(corner(2), [1.0, 4.5, 0.0]), "{}", corner(2));
}

/// Lines are shown where a geometry has nothing else: pairs, and rows.
#[test]
fn lines_alone_are_shown() {
    let lines = "<lines material='m' count='2'><input semantic='VERTEX' source='#g-v' offset='0'/><p>0 1 2 3</p></lines>\
                 <linestrips count='1'><input semantic='VERTEX' source='#g-v' offset='0'/><p>1 2 3 0</p></linestrips>";
    let library =
        |more: &str| format!("<library_geometries>{}</library_geometries>", geometry("g", SQUARE, more));
    let with = |more: &str| scene(&file("", &library(more), &format!("<node id='n'>{INSTANCE}</node>")));
    let mesh = with(lines).objects[0].mesh.clone();
    assert_eq!(mesh.lines, [[0, 1], [2, 3], [1, 2], [2, 3], [3, 0]]);
    assert_eq!(mesh.bounds().max, Vec3::new(2.0, 2.0, 0.0));
    let both = with(&format!("{lines}{}", polylist("g")));
    assert!(both.objects[0].mesh.lines.is_empty() && warnings(&both).contains("lines"));
}

/// Colours of vertices are morphed as positions are, by two shapes of different weights.
#[test]
fn morphs_blend_the_colours_of_vertices() {
    let coloured = |id: &str, colours: &str| {
        let list = source(&format!("{id}-c"), "float_array", colours, 3);
        let polygons = format!(
            "<polylist material='m' count='1'><input semantic='VERTEX' source='#{id}-v' offset='0'/>\
             <input semantic='COLOR' source='#{id}-c' offset='1'/><vcount>4</vcount><p>0 0 1 1 2 2 3 3</p></polylist>"
        );
        geometry(id, SQUARE, &polygons).replace("<vertices", &format!("{list}<vertices"))
    };
    let geometries = coloured("g", "1 0 0 1 0 0 1 0 0 1 0 0")
        + &coloured("a", "0 1 0 0 1 0 0 1 0 0 1 0")
        + &coloured("b", "0 0 1 0 0 1 0 0 1 0 0 1");
    let morph = |method: &str| {
        format!(
            "<library_controllers><controller id='k'><morph source='#g' method='{method}'>{}{}<targets>\
         <input semantic='MORPH_TARGET' source='#t'/><input semantic='MORPH_WEIGHT' source='#w'/></targets></morph></controller>\
         </library_controllers>",
            source("t", "IDREF_array", "a b", 1),
            source("w", "float_array", "0.5 0.125", 1)
        )
    };
    let node = "<node id='n'><instance_controller url='#k'/></node>";
    // Blended in linear light: red and green and blue of full strength are the same in both spaces.
    for (method, wanted) in
        [("NORMALIZED", Rgb::new(0.375, 0.5, 0.125)), ("RELATIVE", Rgb::new(1.0, 0.5, 0.125))]
    {
        let libraries = format!("<library_geometries>{geometries}</library_geometries>{}", morph(method));
        let colour = scene(&file("", &libraries, node)).objects[0].mesh.vertex_kd[2];
        assert!((colour - wanted).map(f32::abs).max_channel() < 1e-6, "{method}: {colour:?}");
    }
}

/// The manifest of a `.zae` names its scene [Collada 1.5, zip archive], whatever else is there.
#[test]
fn manifests_name_the_scene() {
    let wide = placed("", "", "<scale>3 1 1</scale>");
    let manifest = "<?xml version='1.0'?><dae_root xmlns=''>./deep/scene.dae#s</dae_root>";
    let files = |manifest: &str| {
        let first = placed("", "", "");
        let all: [(&str, &[u8]); 3] = [
            ("a.dae", first.as_bytes()),
            ("deep/scene.dae", wide.as_bytes()),
            ("manifest.xml", manifest.as_bytes()),
        ];
        read_bytes(&crate::threemf::package(&all), "zae", None, "x.zae", &ReadOptions::default()).unwrap()
    };
    assert_eq!(files(manifest).bounds(0.0).max.x, 6.0);
    let lost = files("<dae_root>gone.dae</dae_root>");
    assert_eq!(lost.bounds(0.0).max.x, 2.0);
    assert!(warnings(&lost).contains("'gone.dae'"), "{}", warnings(&lost));
}

/// Each column of a curve has tangents of its own [Barnes 2008, sampler]: with times at thirds, the number at a time is that of
/// Bernstein's polynomials of its four control points.
#[test]
fn columns_of_bezier_curves_have_their_own_tangents() {
    // From 0 to 2 seconds; control points of each column at 2/3 and 4/3.
    let points = [[0.0, 3.0, -6.0, 8.0], [1.0, -2.0, 5.0, 4.0], [2.0, 9.0, 0.5, -1.0]];
    let column = |i: usize, end: usize| points[i][end];
    let list =
        |time: f64, end: usize| -> String { (0..3).map(|i| format!("{time} {} ", column(i, end))).collect() };
    let tangents = source("ot", "float_array", &(list(2.0 / 3.0, 1) + &list(8.0 / 3.0, 3)), 6)
        + &source("it", "float_array", &(list(-2.0 / 3.0, 0) + &list(4.0 / 3.0, 2)), 6);
    let ends: Vec<String> =
        [0, 3].iter().flat_map(|end| (0..3).map(|i| column(i, *end).to_string())).collect();
    let library = animated("BEZIER", "n/t", (&ends.join(" "), 3), &tangents);
    for time in [0.5f32, 1.0, 1.5] {
        let text = placed("", &library, "<translate sid='t'>0 0 0</translate>");
        let options = ReadOptions { time, ..ReadOptions::default() };
        let scene = read_bytes(text.as_bytes(), "dae", None, "x", &options).unwrap();
        let t = f64::from(time) / 2.0;
        let weights = [
            (1.0 - t) * (1.0 - t) * (1.0 - t),
            3.0 * t * (1.0 - t) * (1.0 - t),
            3.0 * t * t * (1.0 - t),
            t * t * t,
        ];
        let wanted = points.map(|p| p.iter().zip(weights).map(|(p, w)| p * w).sum::<f64>() as f32);
        let found = corners(&scene)[0];
        assert!((found - Vec3::from(wanted)).length() < 1e-3, "{time}: {found}, not {wanted:?}");
    }
}

/// A lamp without a place lights what there is; nobody sees it behind that, since the format has no sky.
#[test]
fn light_from_all_around_is_no_background() {
    let lamp = |id: &str, colour: &str| {
        format!(
            "<light id='{id}'><technique_common><ambient><color>{colour}</color></ambient></technique_common></light>"
        )
    };
    let libraries =
        format!("<library_lights>{}{}</library_lights>", lamp("a", "0.2 0.4 1"), lamp("b", "1 0.5 0.25"));
    let read = scene(&placed("", &libraries, "<instance_light url='#a'/><instance_light url='#b'/>"));
    let lit: Vec<Rgb> =
        read.lights.iter().filter(|l| !l.is_backdrop()).map(|l| l.colour("radiance").unwrap()).collect();
    let linear = |c: f32| bilux_math::colour::srgb_decode(c);
    assert!((lit[0].r - linear(0.2)).abs() < 1e-5 && (lit[1].b - linear(0.25)).abs() < 1e-5, "{lit:?}");
    let behind: Vec<_> = read.lights.iter().filter(|light| light.is_backdrop()).collect();
    assert_eq!((lit.len(), behind.len()), (2, 1));
    assert_eq!(behind[0].colour("radiance"), Some(Rgb::BLACK));
}

/// Meshes have two sets of texture coordinates: who asks for a third one is told.
#[test]
fn a_third_set_of_texture_coordinates_is_named() {
    let effect = |set: &str| {
        format!(
            "<library_effects><effect id='e'><profile_COMMON><technique sid='t'><lambert><diffuse><texture texture='i' \
             texcoord='{set}'/></diffuse></lambert></technique></profile_COMMON></effect></library_effects>\
             <library_materials><material id='mat'><instance_effect url='#e'/></material></library_materials>\
             <library_images><image id='i'><init_from>none.png</init_from></image></library_images>"
        )
    };
    let source = "<source id='uv'><float_array id='uva' count='2'>0.25 0.75</float_array><technique_common><accessor \
                  source='#uva' count='1' stride='2'><param name='S' type='float'/><param name='T' type='float'/>\
                  </accessor></technique_common></source>";
    let inputs: String = [3, 7, 9]
        .iter()
        .enumerate()
        .map(|(i, set)| format!("<input semantic='TEXCOORD' source='#uv' offset='{}' set='{set}'/>", i + 1))
        .collect();
    let corners = (0..3).map(|vertex| format!("{vertex} 0 0 0")).collect::<Vec<_>>().join(" ");
    let triangle = format!(
        "<library_geometries><geometry id='g'><mesh><source id='p'><float_array id='pa' count='9'>0 0 0 1 0 0 0 1 0\
         </float_array><technique_common><accessor source='#pa' count='3' stride='3'><param name='X' type='float'/>\
         <param name='Y' type='float'/><param name='Z' type='float'/></accessor></technique_common></source>{source}\
         <vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles count='1' material='m'>\
         <input semantic='VERTEX' source='#v' offset='0'/>{inputs}<p>{corners}</p></triangles></mesh></geometry>\
         </library_geometries>"
    );
    let bound: String = [("FIRST", 3), ("SECOND", 7), ("THIRD", 9)]
        .iter()
        .map(|(name, set)| {
            format!("<bind_vertex_input semantic='{name}' input_semantic='TEXCOORD' input_set='{set}'/>")
        })
        .collect();
    let node = format!(
        "<node><instance_geometry url='#g'><bind_material><technique_common><instance_material symbol='m' \
         target='#mat'>{bound}</instance_material></technique_common></bind_material></instance_geometry></node>"
    );
    for (set, is_said) in [("FIRST", false), ("SECOND", false), ("THIRD", true)] {
        // The picture is there, so that it is looked at.
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("none.png"), b"P3 1 1 255 9 99 199\n").unwrap();
        let path = folder.path().join("sets.dae");
        std::fs::write(&path, file("", &(effect(set) + &triangle), &node)).unwrap();
        let read = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(warnings(&read).contains("third set"), is_said, "{set}: {}", warnings(&read));
    }
}
