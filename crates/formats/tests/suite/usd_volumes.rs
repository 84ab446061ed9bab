//! Volumes of USD: where their fields are, what fills them, and what is wrong with some. A field is a ball whose middle is at 1.

use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_math::Vec3;
use bilux_scene::media::Grid;
use bilux_scene::{SceneBuilder, Spec, Value};
use std::path::Path;
use std::sync::Arc;

/// The middle of the ball in its file.
const MIDDLE: Vec3 = Vec3::new(7.0 / 8.0, 6.0 / 8.0, 9.0 / 8.0);
const FIELD: &str = "token fieldName = \"density\"\nasset filePath = @ball.vdb@";

fn read_at(time: f32, text: &str) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/scene_vdb");
    for (from, to) in
        [("blosc.vdb", "ball.vdb"), ("halves_two_grids.vdb", "fire.vdb"), ("level_set.vdb", "set.vdb")]
    {
        std::fs::copy(corpus.join(from), folder.path().join(to)).unwrap();
    }
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2), }           \n";
    let mut kelvins = b"\x93NUMPY\x01\0".to_vec();
    kelvins.extend((header.len() as u16).to_le_bytes());
    kelvins.extend(header.as_bytes());
    kelvins.extend([1500.0f32, 750.0].iter().flat_map(|x| x.to_le_bytes()));
    std::fs::write(folder.path().join("kelvins.npy"), kelvins).unwrap();
    let path = folder.path().join("a.usda");
    std::fs::write(&path, format!("#usda 1.0\n{text}")).unwrap();
    read(&path, &ReadOptions { time, ..ReadOptions::default() }).unwrap()
}

fn scene(text: &str) -> SceneBuilder {
    read_at(0.0, text)
}

/// A volume with one field below it.
fn volume(volume: &str, field: &str) -> String {
    format!(
        "def Volume \"smoke\" {{\n{volume}\nrel field:density = </smoke/d>\ndef OpenVDBAsset \"d\" {{\n{field}\n}} }}\n"
    )
}

fn filling(scene: &SceneBuilder, object: usize) -> &Spec {
    &scene.materials[scene.objects[object].material]
}

fn grid<'s>(spec: &'s Spec, key: &str) -> &'s Arc<Grid> {
    match spec.parameters.find(key) {
        Some((Value::Grid(grid), _)) => grid,
        other => panic!("{other:?}"),
    }
}

/// The density of an object at a point of the world.
fn at(scene: &SceneBuilder, object: usize, world: Vec3) -> f32 {
    let local = scene.objects[object].motion.at(0.0).inverted().point(world);
    assert!(scene.objects[object].mesh.bounds().contains(local), "within the box of the object");
    grid(filling(scene, object), "density").value(local)
}

#[track_caller]
fn close(found: f32, wanted: f32) {
    assert!((found - wanted).abs() <= 1e-3 * wanted.abs().max(1.0), "{found} for {wanted}");
}

#[test]
fn fields_are_where_their_prims_or_their_volumes_are() {
    let moved = "double3 xformOp:translate = (0, 10, 0)\ndouble xformOp:rotateX = -90\n\
                 uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateX\"]";
    let turned = Vec3::new(MIDDLE.x, 10.0 + MIDDLE.z, -MIDDLE.y);
    let below = scene(&volume(moved, FIELD));
    close(at(&below, 0, turned), 1.0);
    let own = format!(
        "{FIELD}\ndouble3 xformOp:scale = (2, 2, 2)\nuniform token[] xformOpOrder = [\"xformOp:scale\"]"
    );
    let scaled = scene(&volume(moved, &own));
    close(at(&scaled, 0, Vec3::new(2.0 * MIDDLE.x, 10.0 + 2.0 * MIDDLE.z, -2.0 * MIDDLE.y)), 1.0);
    // As OpenUSD's own pictures of `testUsdImagingGLVdbVolume` show a field that volumes share.
    let shared = scene(&format!(
        "def OpenVDBAsset \"d\" {{ {FIELD} }}\ndef Volume \"a\" {{ rel field:density = </d> }}\n\
         def Volume \"b\" {{ rel field:fog = </d>\n{moved} }}"
    ));
    close(at(&shared, 0, MIDDLE), 1.0);
    close(at(&shared, 1, turned), 1.0);
    assert!(Arc::ptr_eq(grid(filling(&shared, 0), "density"), grid(filling(&shared, 1), "density")));
    assert_eq!(warnings(&shared), "");
}

/// Without a material, the density is the extinction, and .18 of it scatter: what OpenUSD's fallback for volumes does.
#[test]
fn what_fills_a_volume_is_what_its_material_says() {
    let both = |scene: &SceneBuilder| -> [[f32; 3]; 2] {
        ["absorption", "scattering"].map(|key| filling(scene, 0).colour(key).unwrap().to_array())
    };
    let plain = scene(&volume("", FIELD));
    assert_eq!((filling(&plain, 0).kind.as_str(), warnings(&plain)), ("interface", String::new()));
    let [absorption, scattering] = both(&plain);
    close(absorption[0], 0.82);
    close(scattering[1], 0.18);
    let white = scene(&volume("color3f[] primvars:displayColor = [(0.9, 1, 0.5)]", FIELD));
    close(both(&white)[1][2], 0.5);
    let material = |shader: &str, output: &str| {
        let text = format!(
            "{}def Material \"m\" {{\ntoken outputs:{output}.connect = </m/v.outputs:out>\n{shader} }}",
            volume("rel material:binding = </m>", FIELD)
        );
        scene(&text)
    };
    let materialx = material(
        "def Shader \"v\" { uniform token info:id = \"ND_volume\"\nvectordf inputs:vdf.connect = </m/a.outputs:out> }\n\
         def Shader \"a\" { uniform token info:id = \"ND_anisotropic_vdf\"\nvector3f inputs:absorption = (1, 2, 3)\n\
         vector3f inputs:scattering = (4, 5, 6)\nfloat inputs:anisotropy = 0.25 }",
        "mtlx:volume",
    );
    assert_eq!(both(&materialx), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    close(filling(&materialx, 0).number("scattering_anisotropy").unwrap(), 0.25);
    // Of light, exp(-1) passes a unit of length at a density of 1; here half of it passes two units at a density of 1/3.
    let arnold = material(
        "def Shader \"v\" { uniform token info:id = \"arnold:standard_volume\"\nfloat inputs:density = 3\n\
         color3f inputs:transparent = (0.5, 0.5, 0.5)\nfloat inputs:transparent_depth = 2\n\
         color3f inputs:scatter_color = (0.75, 0.5, 0.25)\ntoken inputs:emission_mode = \"none\" }",
        "arnold:volume",
    );
    let [absorption, scattering] = both(&arnold);
    (0..3).for_each(|i| close(absorption[i] + scattering[i], 3.0 * std::f32::consts::LN_2 / 2.0));
    close(scattering[0] / absorption[0], 3.0);
    assert_eq!(warnings(&arnold), "");
    let other = material("def Shader \"v\" { uniform token info:id = \"Fog\" }", "volume");
    close(both(&other)[1][0], 0.18);
    assert!(warnings(&other).contains("the shader 'Fog' of the inside of volumes"), "{}", warnings(&other));
}

#[test]
fn temperatures_in_kelvins_glow() {
    let fire = |file: &str| {
        scene(&format!(
            "def Volume \"fire\" {{ rel field:density = </fire/d>\nrel field:temperature = </fire/t>\n\
             def OpenVDBAsset \"d\" {{ {FIELD} }}\ndef OpenVDBAsset \"t\" {{ token fieldName = \"temperature\"\n\
             asset filePath = @{file}@ }} }}"
        ))
    };
    let hot = fire("kelvins.npy");
    close(grid(filling(&hot, 0), "temperature").maximum(), 1500.0);
    let norm = filling(&hot, 0).parameters.find("temperature_norm").unwrap().0;
    assert_eq!(norm, &Value::Text("peak".to_owned()));
    // The spectrum has a maximum of 1: at 1500 K, little of it can be seen.
    let light = filling(&hot, 0).colour("medium_emission").unwrap().g;
    assert!(light > 0.0 && light < 1.0, "{light}");
    assert_eq!(warnings(&hot), "");
    hot.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    let cold = fire("fire.vdb");
    assert!(filling(&cold, 0).parameters.find("temperature").is_none());
    assert!(warnings(&cold).contains("the field 'temperature' of volumes"), "{}", warnings(&cold));
}

#[test]
fn files_of_fields_change_with_time() {
    let head = "(timeCodesPerSecond = 1 startTimeCode = 1 endTimeCode = 3)\n";
    let text = volume("", "asset filePath.timeSamples = { 1: @gone.vdb@, 2: @ball.vdb@ }");
    let text = format!("{head}{text}");
    assert_eq!(read_at(1.5, &text).objects.len(), 1);
    let before = read_at(0.5, &text);
    assert_eq!(before.objects.len(), 0);
    assert!(warnings(&before).contains("gone.vdb"), "{}", warnings(&before));
}

#[test]
fn what_is_wrong_with_volumes_is_said() {
    for (field, wanted) in [
        ("asset filePath = @gone.vdb@", "gone.vdb"),
        ("asset filePath = @set.vdb@", "is a level set"),
        ("asset filePath = @a.usda@", "this is no file of grids"),
        (
            "asset filePath = @fire.vdb@\ntoken fieldName = \"flame\"",
            "has no grid 'flame', but density, temperature",
        ),
        ("", "the field 'density' of a volume names no file"),
    ] {
        let scene = scene(&volume("", field));
        assert_eq!(scene.objects.len(), 0, "{field}");
        let warnings = warnings(&scene);
        assert!(
            warnings.contains(wanted) && warnings.contains("a volume has no density"),
            "{field}: {warnings}"
        );
    }
    let text = "def Volume \"v\" { rel field:density = </v/f>\nrel field:heat = </v/h>\ndef Field3DAsset \"f\" { } }";
    let warnings = warnings(&scene(text));
    assert!(warnings.contains("fields of volumes of type Field3DAsset"), "{warnings}");
    assert!(
        warnings.contains("the field 'heat' of a volume is /v/h, and there is no such prim"),
        "{warnings}"
    );
}
