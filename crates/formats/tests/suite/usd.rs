//! OpenUSD: text, crate files and packages, and how layers are composed.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read};
use bilux_math::Vec3;
use bilux_scene::{Axis, SceneBuilder, UpHint};
use std::path::Path;

/// A file of the fuzzers' corpus.
fn seed(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(format!("../../fuzz/corpus/scene_{}", if name.ends_with("usdc") { "usdc" } else { "usd" }))
        .join(name);
    std::fs::read(path).unwrap()
}

/// Reads the first of some files in a folder.
fn read_files(files: &[(&str, &str)], options: &ReadOptions) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, format!("#usda 1.0\n{text}")).unwrap();
    }
    read(&folder.path().join(files[0].0), options).unwrap()
}

fn composed(files: &[(&str, &str)]) -> SceneBuilder {
    read_files(files, &ReadOptions::default())
}

fn text(text: &str) -> SceneBuilder {
    read_text("usda", format!("#usda 1.0\n{text}")).unwrap()
}

/// The x extent of each object, by name.
fn widths(scene: &SceneBuilder) -> Vec<(&str, f32)> {
    let width = |o: &bilux_scene::Object| o.motion.at(0.0).bounds(&o.mesh.bounds()).extent().x;
    scene.objects.iter().map(|o| (o.name.as_str(), (width(o) * 1000.0).round() / 1000.0)).collect()
}

#[test]
fn a_mesh_has_the_attributes_that_its_corners_have() {
    let scene = text(
        "(upAxis = \"Z\" metersPerUnit = 0.5)\ndef Mesh \"m\" {\n\
         int[] faceVertexCounts = [3, 4, 3]\nint[] faceVertexIndices = [0, 1, 4, 0, 1, 2, 3, 1, 2, 4]\n\
         point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)]\n\
         int[] holeIndices = [2]\nuniform token orientation = \"leftHanded\"\nuniform token subdivisionScheme = \"none\"\n\
         texCoord2f[] primvars:st = [(0, 0), (0.5, 1)] (interpolation = \"faceVarying\")\n\
         int[] primvars:st:indices = [0, 0, 1, 0, 0, 1, 1, 0, 0, 0]\n\
         color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0), (0, 0, 1)] (interpolation = \"uniform\") }",
    );
    let mesh = &scene.objects[0].mesh;
    assert_eq!((scene.up, scene.unit), (UpHint::Is(Axis::Z), 0.5));
    assert_eq!(mesh.triangles.len(), 3, "without the hole");
    // Clockwise in the file, so the front is below.
    let [a, b, c] = mesh.triangles[1].map(|i| mesh.positions[i as usize]);
    assert!((b - a).cross(c - a).z < 0.0);
    // Vertices 0 and 1 have another colour on the other face.
    assert_eq!((mesh.positions.len(), mesh.vertex_kd[0].to_array()), (7, [1.0, 0.0, 0.0]));
    assert!(
        mesh.uvs.iter().all(|uv| *uv == bilux_math::Vec2::ZERO || *uv == bilux_math::Vec2::new(0.5, 1.0))
    );
    assert_eq!(warnings(&scene), "");
}

/// A variant, an inherited class and a reference say different things; the order of strength is local, inherited, variant,
/// referenced. [OpenUSD]
#[test]
fn stronger_opinions_win() {
    let whole = "class \"c\" { double a:inherit = 1\n def Cube \"x\" { double size = 3 } }\n\
                 def Xform \"p\" (inherits = </c> references = @r.usda@</q> variants = { string v = \"one\" } \
                 prepend variantSets = \"v\") {\n over \"w\" { double size = 7 }\n variantSet \"v\" = { \"one\" { over \"x\" { \
                 double size = 4 }\n over \"y\" { double size = 5 } }\n \"two\" { over \"y\" { double size = 6 } } } }";
    let other = "def \"q\" { def Cube \"x\" { double size = 9 }\n def Cube \"y\" { double size = 9 }\n \
                 def Cube \"w\" { double size = 9 }\n def Cube \"z\" { double size = 9 } }";
    let files = [("a.usda", whole), ("r.usda", other)];
    let sizes = |variant: Option<&str>| {
        let options = ReadOptions { variant: variant.map(str::to_owned), ..ReadOptions::default() };
        let scene = read_files(&files, &options);
        assert_eq!(scene.inventory.variants, ["v=one", "v=two"]);
        let mut all: Vec<_> = widths(&scene).into_iter().map(|(name, w)| (name.to_owned(), w)).collect();
        all.sort_by(|a, b| a.0.cmp(&b.0));
        all.into_iter().map(|(_, width)| width).collect::<Vec<_>>()
    };
    assert_eq!(sizes(None), [7.0, 3.0, 5.0, 9.0], "w, x, y, z");
    assert_eq!(sizes(Some("v=two")), [7.0, 3.0, 6.0, 9.0]);
    assert_eq!(sizes(Some("two")), [7.0, 3.0, 6.0, 9.0]);
}

#[test]
fn sublayers_and_references_shift_and_stretch_time() {
    let ball = "def Sphere \"s\" { double radius.timeSamples = { 0: 0, 100: 100 } }";
    let radius = |files: &[(&str, &str)]| widths(&composed(files))[0].1 / 2.0;
    assert_eq!(radius(&[("a.usda", &format!("(startTimeCode = 10)\n{ball}"))]), 10.0);
    // 10 = 2 t + 4
    let top = "(startTimeCode = 10 subLayers = [@b.usda@ (offset = 4; scale = 2)])";
    assert_eq!(radius(&[("a.usda", top), ("b.usda", ball)]), 3.0);
    let top = "(startTimeCode = 10)\ndef \"r\" (references = @b.usda@</s> (offset = 4; scale = 2)) {}";
    assert_eq!(radius(&[("a.usda", top), ("b.usda", ball)]), 3.0);
    // 24 time codes in a second here, 48 there.
    let fast = format!("(timeCodesPerSecond = 48)\n{ball}");
    let top = "(startTimeCode = 10)\ndef \"r\" (payload = @b.usda@</s>) {}";
    assert_eq!(radius(&[("a.usda", top), ("b.usda", &fast)]), 20.0);
    // Names with @, in the three ways in which they are written.
    for (name, stated) in
        [("b@.usda", "@@@b@.usda@@@"), ("b@@@.usda", "@@@b\\@@@.usda@@@"), ("b.usda@@", "@@@b.usda@@@@@")]
    {
        let top = format!("(startTimeCode = 10 subLayers = [{stated}])");
        assert_eq!(radius(&[("a.usda", &top), (name, ball)]), 10.0, "{name}");
    }
    // Without time codes in a second, all times are the first. [OpenUSD 25]
    let stopped = format!("#usda 1.0\n(timeCodesPerSecond = 0 startTimeCode = 10 endTimeCode = 20)\n{ball}");
    let options = ReadOptions { time: 0.25, ..ReadOptions::default() };
    let scene = bilux_formats::read_bytes(stopped.as_bytes(), "usda", None, "a.usda", &options).unwrap();
    assert_eq!(widths(&scene)[0].1 / 2.0, 10.0);
    assert!(warnings(&scene).contains("timeCodesPerSecond is 0") && !scene.inventory.moves());
}

#[test]
fn classes_of_a_referenced_file_can_be_overridden_where_it_is_used() {
    let asset = "(defaultPrim = \"m\")\nclass \"_c\" { }\ndef Xform \"m\" (inherits = </_c>) { def Cube \"b\" { double size = 1 } }";
    let top = "class \"_c\" { over \"b\" { double size = 5 } }\ndef \"one\" (references = @b.usda@) {}";
    assert_eq!(widths(&composed(&[("a.usda", top), ("b.usda", asset)])), [("b", 5.0)]);
}

#[test]
fn instances_ignore_what_is_said_below_them() {
    let top = "def \"i\" (instanceable = true references = </p>) { over \"b\" { double size = 5 } }\n\
               class \"p\" { def Cube \"b\" { double size = 2 } }";
    assert_eq!(widths(&text(top)), [("b", 2.0)]);
    assert_eq!(widths(&text(&top.replace("instanceable = true", ""))), [("b", 5.0)]);
}

#[test]
fn copies_share_their_mesh_and_are_where_the_instancer_says() {
    let scene = text(
        "def PointInstancer \"i\" { int[] protoIndices = [0, 0, 0]\n point3f[] positions = [(1, 0, 0), (2, 0, 0), (3, 0, 0)]\n \
         quath[] orientations = [(1, 0, 0, 0), (0.7071, 0, 0, 0.7071), (1, 0, 0, 0)]\n int64[] invisibleIds = [2]\n \
         rel prototypes = </i/p>\n def Cylinder \"p\" { uniform token axis = \"X\" double height = 4 double radius = 0.5 } }",
    );
    assert_eq!(widths(&scene), [("p", 4.0), ("p", 1.0)], "the second is turned by 90 degrees about z");
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].mesh, &scene.objects[1].mesh));
    let middle = |i: usize| scene.objects[i].motion.at(0.0).point(Vec3::ZERO);
    assert_eq!([middle(0).x, middle(1).x], [1.0, 2.0]);
}

#[test]
fn prims_that_are_hidden_or_not_for_renders_are_not_shown() {
    let scene = text(
        "def Xform \"a\" { token visibility = \"invisible\"\n def Cube \"b\" {} }\ndef Cube \"c\" { uniform token purpose = \"proxy\" }\n\
         def Xform \"d\" { uniform token purpose = \"render\"\n def Cube \"e\" {} }\nover \"f\" { def Cube \"g\" {} }\n\
         def Cube \"h\" (active = false) {}",
    );
    assert_eq!(widths(&scene), [("e", 2.0)]);
}

/// Written by OpenUSD 26.11: compressed arrays, samples, an internal reference and a variant.
#[test]
fn crate_files_are_read() {
    let scene = read_text("usdc", seed("crate.usdc")).unwrap();
    let mesh = &scene.objects.iter().find(|o| o.name == "disc").unwrap().mesh;
    assert_eq!((mesh.triangles.len(), mesh.vertex_opacity[0]), (20, 0.25));
    assert!((mesh.positions[0] - Vec3::X).length() < 1e-6);
    let mut all = widths(&scene);
    all.sort_by(|a, b| a.0.cmp(b.0).then(a.1.total_cmp(&b.1)));
    assert_eq!(all, [("ball", 0.5), ("disc", 2.0), ("disc", 4.0)]);
    assert_eq!(
        scene.objects.iter().map(|o| o.motion.at(0.0).point(Vec3::ZERO)).find(|p| p.x == 1.5).unwrap(),
        Vec3::new(1.5, 2.0, 3.0)
    );
    assert_eq!(warnings(&scene), "");
}

#[test]
fn what_cannot_be_read_is_refused_with_a_reason() {
    let cases = [
        (
            "usda",
            b"#usda 1.0\ndef Mesh \"m\" {\n  int[] a = [1, 2".to_vec(),
            "scene.usda:3:18: a number is missing here: the file was cut off",
        ),
        (
            "usda",
            b"#usda 1.0\ndef Mesh \"m\" { point3f[] p = [(1, 2)] }".to_vec(),
            "2 numbers, which is not a multiple of 3",
        ),
        ("usda", seed("broken_deep.usda"), "nested more than 128 levels deep"),
        ("usdc", seed("broken_crate_cut.usdc"), "an offset leads out of it"),
        ("usdc", seed("broken_crate_section.usdc"), "its section TOKENS goes on beyond its end"),
        ("usdc", seed("broken_crate_tokens.usdc"), "more items than its compressed bytes can hold"),
        ("usdc", seed("broken_crate_paths.usdc"), "more paths than it has bytes for"),
        (
            "usdc",
            b"PXR-USDC\x00\x63\x00\x00\x00\x00\x00\x00\0\0\0\0\0\0\0\0".to_vec(),
            "version 0.99.0, but only 0.4 to",
        ),
        ("usdz", crate::threemf::package(&[("readme.txt", b"a")]), "no layer: put a .usdc file first in it"),
    ];
    for (format, bytes, part) in cases {
        let message = refusal(format, bytes);
        assert!(message.contains(part), "{message}");
    }
    let options = ReadOptions { variant: Some("v=three".to_owned()), ..ReadOptions::default() };
    let scene = bilux_formats::read_bytes(&seed("crate.usdc"), "usdc", None, "a.usdc", &options);
    assert!(
        scene
            .unwrap_err()
            .to_string()
            .contains("there is no variant 'v=three' in this file; there are: v=one")
    );
}

#[test]
fn circles_and_missing_layers_are_warned_of() {
    let scene = composed(&[("circle.usda", &String::from_utf8(seed("circle.usda")).unwrap()[10..])]);
    let told = warnings(&scene);
    for part in
        ["among its own sublayers", "no file 'missing.usda'", "composed with itself", "no file 'gone.usd'"]
    {
        assert!(told.contains(part), "{told}");
    }
    let outside = composed(&[
        ("in/a.usda", "def \"a\" (references = @../b.usda@</x>) {}"),
        ("b.usda", "def Cube \"x\" {}"),
    ]);
    assert!(warnings(&outside).contains("lies outside the scene's folder"), "{}", warnings(&outside));
    // Two references of two references of …: 2⁴⁰ places.
    let doubled: String = (0..40).map(|i| format!("def \"p{i}\" (references = [</p{0}/x>, </p{0}>]) {{ def \"x\" (references = </p{0}>) {{}} }}\n", i + 1)).collect();
    let begin = std::time::Instant::now();
    _ = read_text("usda", format!("#usda 1.0\n{doubled}"));
    assert!(begin.elapsed().as_secs() < 20);
}

/// A material of the first object, by parameter.
#[track_caller]
fn number(scene: &SceneBuilder, object: usize, key: &str) -> f32 {
    let material = &scene.materials[scene.objects[object].material];
    material.colour(key).map(|c| c.g).or(material.number(key)).unwrap_or_else(|| panic!("{key}"))
}

#[test]
fn preview_surfaces_become_principled_and_bindings_are_inherited() {
    let material = |inputs: &str, id: &str| {
        format!(
            "def Material \"m\" {{ token outputs:surface.connect = </m/s.outputs:surface>\n float inputs:r = 0.25\n \
                 def Shader \"s\" {{ uniform token info:id = \"{id}\"\n {inputs}\n token outputs:surface }} }}\n"
        )
    };
    let preview = material(
        "color3f inputs:diffuseColor = (1, 0.5, 0.25)\n float inputs:metallic = 1\n float inputs:roughness.connect = </m.inputs:r>\n \
         float inputs:opacity = 0.5\n color3f inputs:emissiveColor = (2, 3, 4)\n float inputs:clearcoat = 1",
        "UsdPreviewSurface",
    );
    let cube = "def Xform \"x\" { rel material:binding = </m>\n def Cube \"c\" {} }";
    let scene = text(&(preview + cube));
    for (key, value) in [
        ("base_color", 0.5),
        ("base_metalness", 1.0),
        ("specular_roughness", 0.25),
        ("opacity", 0.5),
        ("emission", 3.0),
        ("coat_weight", 1.0),
        ("coat_roughness", 0.01),
    ] {
        assert_eq!(number(&scene, 0, key), value, "{key}");
    }
    assert_eq!(warnings(&scene), "");
    // Half of the reflectance of a mirror at normal incidence, by an index of refraction of (1 + √.5) / (1 - √.5).
    let specular = material(
        "int inputs:useSpecularWorkflow = 1\n color3f inputs:specularColor = (0.5, 0.5, 0.5)",
        "UsdPreviewSurface",
    );
    assert!((number(&text(&(specular + cube)), 0, "specular_ior") - 5.828_43).abs() < 1e-3);
    let standard = material(
        "color3f inputs:base_color = (0.5, 0.5, 0.5)\n float inputs:base = 0.5\n float inputs:coat = 0.75",
        "ND_standard_surface_surfaceshader",
    );
    let scene = text(&(standard + cube));
    assert_eq!(
        [
            number(&scene, 0, "base_color"),
            number(&scene, 0, "coat_weight"),
            number(&scene, 0, "specular_roughness")
        ],
        [0.25, 0.75, 0.2]
    );
    let unknown = text(&(material("", "SomethingElse") + cube));
    assert!(
        warnings(&unknown).contains("materials with the surface 'SomethingElse'"),
        "{}",
        warnings(&unknown)
    );
}

#[test]
fn materials_read_the_colour_of_a_prim_or_of_one_above_it() {
    let reader = "def Material \"m\" { token outputs:surface.connect = </m/s.outputs:surface>\n\
         def Shader \"s\" { uniform token info:id = \"UsdPreviewSurface\"\n\
         color3f inputs:diffuseColor.connect = </m/r.outputs:result> }\n\
         def Shader \"r\" { uniform token info:id = \"UsdPrimvarReader_float3\"\nstring inputs:varname = \"displayColor\" } }\n";
    let colour = |c: &str| format!("rel material:binding = </m>\ncolor3f[] primvars:displayColor = [({c})]");
    let mesh = "def Mesh \"a\" { int[] faceVertexCounts = [3] int[] faceVertexIndices = [0, 1, 2]\n\
                point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\nuniform token subdivisionScheme = \"none\" }";
    let class = format!("class \"c\" {{ {mesh} def Sphere \"s\" {{}} }}");
    let scene = text(&format!(
        "{reader}{class}\ndef \"x\" (inherits = </c>) {{ {} }}\ndef \"y\" (inherits = </c>) {{ {} }}",
        colour("0.25, 0.5, 1"),
        colour("1, 0, 0.5")
    ));
    let colours: Vec<[f32; 3]> = scene.objects.iter().map(|o| o.mesh.vertex_kd[0].to_array()).collect();
    assert_eq!(colours, [[0.25, 0.5, 1.0], [0.25, 0.5, 1.0], [1.0, 0.0, 0.5], [1.0, 0.0, 0.5]]);
    assert!(scene.objects.iter().all(|o| o.mesh.vertex_kd.len() == o.mesh.positions.len()));
}

/// [UsdPreviewSurface, `UsdUVTexture`: the fallback is used where the texture cannot be read.]
#[test]
fn a_texture_that_is_missing_has_the_colour_that_the_file_states_for_it() {
    let file = |fallback: &str, output: &str| {
        format!(
            "def Material \"m\" {{ token outputs:surface.connect = </m/s.outputs:surface>\n def Shader \"s\" {{ uniform token info:id \
             = \"UsdPreviewSurface\"\n color3f inputs:diffuseColor.connect = </m/t.outputs:{output}>\n token outputs:surface }}\n def \
             Shader \"t\" {{ uniform token info:id = \"UsdUVTexture\"\n asset inputs:file = @./gone.png@\n {fallback}\n }} }}\n\
             def Cube \"c\" {{ rel material:binding = </m> }}"
        )
    };
    let stated = "float4 inputs:fallback = (0.25, 0.5, 0.75, 1)";
    for (output, colour) in [("rgb", [0.25, 0.5, 0.75]), ("b", [0.75; 3])] {
        let scene = text(&file(stated, output));
        let found = scene.materials[scene.objects[0].material].colour("base_color");
        assert_eq!(found.map(|found| found.to_array()), Some(colour), "{output}");
        assert!(warnings(&scene).contains("gone.png"), "{}", warnings(&scene));
    }
    let scene = text(&file("", "rgb"));
    assert_eq!(scene.textures.len(), 1, "without one it is the checker of what is missing");
}

#[test]
fn subsets_collections_and_stronger_bindings_choose_materials() {
    let material = |name: &str, green: f32| {
        format!(
            "def Material \"{name}\" {{ token outputs:surface.connect = </{name}/s.outputs:surface>\n def Shader \"s\" {{ \
         uniform token info:id = \"UsdPreviewSurface\"\n color3f inputs:diffuseColor = (0, {green}, 0)\n token outputs:surface }} }}\n"
        )
    };
    let all = material("a", 0.25) + &material("b", 0.5) + &material("c", 0.75);
    let mesh = "def Mesh \"q\" { int[] faceVertexCounts = [3, 3]\n int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]\n \
                point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n rel material:binding = </a>\n \
                def GeomSubset \"one\" { uniform token elementType = \"face\"\n int[] indices = [1]\n rel material:binding = </b> } }";
    let scene = text(&(all.clone() + mesh));
    assert_eq!(
        (scene.objects.len(), number(&scene, 0, "base_color"), number(&scene, 1, "base_color")),
        (2, 0.5, 0.25)
    );
    let group = |said: &str| {
        format!(
            "{all}def Xform \"g\" {{ {said}\n def Cube \"x\" {{ rel material:binding = </a> }}\n def Cube \"y\" {{}} }}"
        )
    };
    let colours = |said: &str| {
        let scene = text(&group(said));
        [number(&scene, 0, "base_color"), number(&scene, 1, "base_color")]
    };
    assert_eq!(colours("rel material:binding = </b>"), [0.25, 0.5]);
    assert_eq!(
        colours("rel material:binding = </b> ( bindMaterialAs = \"strongerThanDescendants\" )"),
        [0.5, 0.5]
    );
    let collection = "rel material:binding = </b>\n rel material:binding:collection:k = [</g.collection:k>, </c>]\n \
                      rel collection:k:includes = </g/y>";
    assert_eq!(colours(collection), [0.25, 0.75]);
}

/// Lamps in numbers worked out by hand from the schemas. [OpenUSD]
#[test]
fn lights_are_as_bright_as_the_schema_says() {
    let light = |text_of: &str| {
        let scene = text(text_of);
        assert_eq!((scene.lights.len(), scene.environment_unspecified), (1, false), "{}", warnings(&scene));
        scene.lights[0].clone()
    };
    let sun = light("def DistantLight \"l\" { float inputs:intensity = 1000\n float inputs:angle = 2 }");
    // π sin² 1° · 1000
    assert!((sun.colour("irradiance").unwrap().g - 0.956_89).abs() < 1e-4);
    let panel = light(
        "def RectLight \"l\" { float inputs:width = 2\n float inputs:height = 3\n bool inputs:normalize = 1\n \
                       float inputs:intensity = 12\n float inputs:exposure = 1\n color3f inputs:color = (1, 0.5, 0) }",
    );
    assert_eq!(panel.colour("radiance").unwrap().to_array(), [4.0, 2.0, 0.0]);
    let edges = ["edge_u", "edge_v"].map(|key| Vec3::from_array(panel.colour(key).unwrap().to_array()));
    assert_eq!(edges[0].cross(edges[1]), Vec3::Z * -6.0, "it shines along -z");
    let warm = light(
        "def SphereLight \"l\" { bool inputs:enableColorTemperature = 1\n float inputs:colorTemperature = 3000\n \
                      float inputs:radius = 2 }",
    );
    let radiance = warm.colour("radiance").unwrap();
    assert!(
        (radiance.luminance() - 1.0).abs() < 1e-3
            && radiance.r > radiance.b
            && warm.number("radius") == Some(2.0)
    );
    assert!(
        light("def DomeLight \"l\" { float inputs:intensity = 3 }")
            .colour("radiance")
            .is_some_and(|c| c.g == 3.0)
    );
    let linked = text(
        "def SphereLight \"l\" { rel light:filters = </f>\n rel collection:lightLink:includes = </x>\n float inputs:radius = 1 }",
    );
    let said = warnings(&linked);
    assert!(said.contains("filters of lights") && said.contains("light linking"), "{said}");
}

/// Cones, exponents and profiles make lights emit less in some directions, by the formulas of the schema; what is left is a light without
/// extent. A dome's map stands along y, or as its stage does.
#[test]
fn shaped_lights_emit_in_the_directions_that_the_schema_says() {
    let light = |more: &str| {
        let scene = text(&format!(
            "def SphereLight \"l\" {{ float inputs:radius = 2\n float inputs:intensity = 3\n {more} }}"
        ));
        assert_eq!((scene.lights.len(), &*scene.lights[0].kind), (1, "luminaire"), "{}", warnings(&scene));
        scene.lights[0].clone()
    };
    let intensity = |light: &bilux_scene::Spec, polar: f64| {
        let Some((_, bilux_scene::Value::Distribution(found), _)) =
            light.parameters.0.iter().find(|(key, ..)| key == "distribution")
        else {
            panic!("no distribution")
        };
        let per_candela =
            light.colour("flux").unwrap().g * light.colour("scale").unwrap().g / found.lumens() as f32;
        found.at(polar, 0.0) as f32 * per_candela
    };
    let near = |a: f32, b: f32| assert!((a - b).abs() < 2e-3 * b.abs().max(1.0), "{a} is not {b}");
    let whole = 3.0 * std::f32::consts::PI * 4.0;
    let hard = light("float inputs:shaping:cone:angle = 30");
    near(intensity(&hard, 29.9), whole);
    near(intensity(&hard, 30.1), 0.0);
    // Halfway between 15 and 30 degrees a smooth step is a half.
    let soft = light("float inputs:shaping:cone:angle = 30\n float inputs:shaping:cone:softness = 0.5");
    near(intensity(&soft, 14.9), whole);
    near(intensity(&soft, 22.5), whole / 2.0);
    let focused = light("float inputs:shaping:focus = 2");
    near(intensity(&focused, 60.0), whole / 4.0);
    near(intensity(&focused, 180.0), whole);
    assert_eq!(hard.colour("direction").unwrap().to_array(), [0.0, 0.0, -1.0]);
}

#[test]
fn cameras_have_the_field_of_view_of_their_film() {
    let scene = text(
        "def Camera \"c\" { float focalLength = 20\n float horizontalAperture = 40\n float verticalAperture = 40\n float fStop = 2\n \
         float focusDistance = 7\n float horizontalApertureOffset = 10\n double3 xformOp:translate = (0, 0, 5)\n \
         uniform token[] xformOpOrder = [\"xformOp:translate\"] }\ndef Cube \"x\" {}",
    );
    let camera = &scene.cameras[0].spec;
    let of = |key: &str| camera.number(key).unwrap();
    assert!((of("fov") - 90.0).abs() < 1e-4, "2 atan(20 / 20)");
    // A focal length of 2 units through half of a diameter of 1 unit, and a quarter of the film to the right.
    assert_eq!([of("aperture"), of("focus"), of("principal_x"), of("frame")], [0.5, 7.0, 0.25, 1.0]);
    // A film that is twice as wide as high, whose middle is 3 upwards and 2 to the right of the axis.
    let scene = text(
        "def Camera \"c\" { float horizontalAperture = 20\n float verticalAperture = 10\n float horizontalApertureOffset = 2\n \
         float verticalApertureOffset = 3 }\ndef Cube \"x\" {}",
    );
    let shifted = ["principal_x", "principal_y"].map(|key| scene.cameras[0].spec.number(key).unwrap());
    assert!((shifted[0] - 0.4).abs() < 1e-6 && (shifted[1] - 0.8).abs() < 1e-6, "{shifted:?}");
}

/// A dome's map is blended between the middles of its texels. The left edge is towards -z, as is the right one, between
/// which there is no edge on a sphere; a quarter from the left is +x, and the middle +z. [OpenUSD, UsdLuxDomeLight]
#[test]
fn the_map_of_a_dome_has_no_seam() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sky.ppm"), "P3 4 1 255 255 0 0 0 0 0 0 0 255 0 255 0").unwrap();
    let path = folder.path().join("a.usda");
    std::fs::write(&path, "#usda 1.0\ndef DomeLight \"l\" { asset inputs:texture:file = @sky.ppm@ }")
        .unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let map = &scene.textures[0];
    // Its middle is towards -z, with a quarter to each side of what lies between the middles of two texels there.
    let (width, row) = (map.width(), map.height() / 2);
    let quarter = width / 4;
    for column in width / 2 - quarter / 2..width / 2 + quarter / 2 {
        let right = (column as f32 + 0.5 - (width / 2 - quarter / 2) as f32) / quarter as f32;
        let found = map.texel(column, row);
        let off = [found.r - right, found.g - (1.0 - right), found.b].map(f32::abs);
        assert!(off.iter().all(|off| *off < 1e-4), "{column}: {found:?}");
    }
}

/// A cube that becomes round, with colours of faces, and coordinates of corners that are their places on each face.
#[test]
fn values_of_faces_and_corners_stay_with_their_faces_on_smooth_surfaces() {
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let list = |items: Vec<String>| items.join(", ");
    let points = list((0..8).map(|i| format!("({}, {}, {})", i & 1, i >> 1 & 1, i >> 2)).collect());
    let indices = list(faces.iter().flatten().map(|i| i.to_string()).collect());
    let colours = list((0..6).map(|i| format!("({}, 0, 1)", f64::from(i) / 8.0)).collect());
    let uvs = list((0..6).map(|_| "(0, 0), (1, 0), (1, 1), (0, 1)".to_owned()).collect());
    let text = |rule: &str| {
        format!(
            "#usda 1.0\ndef Mesh \"cube\" {{\nint[] faceVertexCounts = [4, 4, 4, 4, 4, 4]\nint[] faceVertexIndices = [{indices}]\n\
             point3f[] points = [{points}]\ncolor3f[] primvars:displayColor = [{colours}] (interpolation = \"uniform\")\n\
             texCoord2f[] primvars:st = [{uvs}] (interpolation = \"faceVarying\")\nuniform token faceVaryingLinearInterpolation = \
             \"{rule}\"\n}}\n"
        )
    };
    for (rule, least) in [("cornersPlus1", 0.0f32), ("none", 0.05)] {
        let scene = read_text("usd", text(rule)).unwrap();
        let mesh = &scene.objects[0].mesh;
        assert!(scene.notes.is_empty() && mesh.triangles.len() > 100, "{:?}", scene.notes);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.vertex_kd[i as usize].r);
            assert!(a == b && b == c && (a * 8.0).fract() == 0.0, "{a} {b} {c}");
        }
        let reach = mesh.uvs.iter().fold(1.0f32, |least, uv| least.min(uv.x + uv.y));
        assert!((reach - least).abs() < 1e-6 || rule == "none" && reach > least, "{rule}: {reach}");
    }
}

/// A material bound for previews alone is the only one there is; one for all purposes is better, one for full pictures best.
#[test]
fn a_binding_for_previews_is_better_than_none() {
    let material = |name: &str, red: f32| {
        format!(
            "def Material \"{name}\"\n{{\n    token outputs:surface.connect = </{name}/s.outputs:surface>\n    def Shader \"s\"\n    {{\n        \
             uniform token info:id = \"UsdPreviewSurface\"\n        color3f inputs:diffuseColor = ({red}, 0, 0)\n        token outputs:surface\n    }}\n}}\n"
        )
    };
    let bound = |bindings: &str| {
        let mesh = "int[] faceVertexCounts = [3]\n    int[] faceVertexIndices = [0, 1, 2]\n    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]";
        let scene = text(&format!(
            "{}{}{}def Mesh \"m\" (\n    prepend apiSchemas = [\"MaterialBindingAPI\"]\n)\n{{\n    {mesh}\n{bindings}}}\n",
            material("a", 0.25),
            material("b", 0.5),
            material("c", 0.75)
        ));
        let object = &scene.objects[0];
        scene.materials[object.material].colour("base_color").unwrap().r
    };
    let to = |purpose: &str, name: &str| format!("    rel material:binding{purpose} = </{name}>\n");
    assert_eq!(bound(&to(":preview", "a")), 0.25);
    assert_eq!(bound(&(to(":preview", "a") + &to("", "b"))), 0.5);
    assert_eq!(bound(&(to(":preview", "a") + &to("", "b") + &to(":full", "c"))), 0.75);
}

/// Sublayers with other time codes in a second than the layer above them, and than each other: each is scaled by its own, and a
/// sublayer of one by both. [OpenUSD, SdfLayerOffset]
#[test]
fn sublayers_keep_their_own_time_codes() {
    let ball = |name: &str| {
        format!("def Sphere \"{name}\" {{ double radius.timeSamples = {{ 0: 0, 1000: 1000 }} }}")
    };
    let layer =
        |rate: u32, name: &str, more: &str| format!("(timeCodesPerSecond = {rate}{more})\n{}", ball(name));
    let files = [
        ("a.usda", "(startTimeCode = 10 timeCodesPerSecond = 24 subLayers = [@b.usda@, @c.usda@ (offset = 4; scale = 2)])".to_owned()),
        ("b.usda", layer(48, "b", "")),
        ("c.usda", layer(12, "c", " subLayers = [@d.usda@]")),
        ("d.usda", layer(60, "d", "")),
    ];
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let scene = composed(&files);
    let mut radii: Vec<(&str, f32)> =
        widths(&scene).into_iter().map(|(name, width)| (name, width / 2.0)).collect();
    radii.sort_by_key(|(name, _)| *name);
    // At 10 of 24: 20 of 48; 10 = 2 (24/12) t + 4, so 1.5 of 12; and five times that of 60.
    assert_eq!(radii, [("b", 20.0), ("c", 1.5), ("d", 7.5)]);
}
