//! `PointInstancer` of USD: what the copies wear. [OpenUSD, UsdGeomPointInstancer, "Primvars on PointInstancer"]

use crate::{read_text, warnings};
use bilux_scene::{Object, SceneBuilder};
use std::sync::Arc;

/// Four copies of `p`, the last but one hidden, with something said of all of them.
fn copies(said: &str, prototype: &str) -> SceneBuilder {
    let text = format!(
        "#usda 1.0\ndef PointInstancer \"i\" {{ int[] protoIndices = [0, 0, 0, 0]\n int64[] invisibleIds = [2]\n \
         point3f[] positions = [(1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)]\n rel prototypes = </i/s/p>\n {said}\n \
         def Scope \"s\" {{ {prototype} }} }}"
    );
    read_text("usda", text).unwrap()
}

/// Place of each object along x, with the colour and the opacity of its material.
fn worn(scene: &SceneBuilder) -> Vec<(f32, [f32; 3], f32)> {
    let one = |object: &Object| {
        let material = &scene.materials[object.material];
        let vertices = object.mesh.vertex_kd.first().map(|rgb| rgb.to_array());
        let colour = vertices.unwrap_or_else(|| material.colour("kd").unwrap().to_array());
        let opacity = material.number("opacity").unwrap_or(1.0);
        (object.motion.at(0.0).point(object.mesh.bounds().centre()).x, colour, opacity)
    };
    let mut all: Vec<_> = scene.objects.iter().map(one).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];
const EACH: &str = "color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = \"vertex\")\n \
                    int[] primvars:displayColor:indices = [0, 1, 1, 0]\n \
                    float[] primvars:displayOpacity = [1, 1, 1, 0.5] (interpolation = \"varying\")";

#[test]
fn copies_have_their_own_colours_and_share_their_mesh() {
    let scene = copies(EACH, "def Cube \"p\" {}");
    assert_eq!(worn(&scene), [(1.0, RED, 1.0), (2.0, GREEN, 1.0), (4.0, RED, 0.5)]);
    assert!(scene.objects.iter().all(|object| Arc::ptr_eq(&object.mesh, &scene.objects[0].mesh)));
    assert_eq!((scene.materials.len(), warnings(&scene)), (3, String::new()));
    // A constant value is for all, and so is a uniform one; a prototype that says more has what it says.
    for interpolation in ["constant", "uniform"] {
        let all = EACH.replace("vertex", interpolation).replace("[0, 1, 1, 0]", "[1]");
        let scene = copies(&all, "def Cube \"p\" {}");
        assert!(worn(&scene).iter().all(|(_, colour, _)| *colour == GREEN), "{interpolation}");
    }
    let own = copies(EACH, "def Cube \"p\" { color3f[] primvars:displayColor = [(0, 0, 1)] }");
    assert!(worn(&own).iter().all(|(_, colour, _)| *colour == [0.0, 0.0, 1.0]));
}

#[test]
fn materials_and_instancers_below_read_the_colours_of_copies() {
    let material = "def Material \"m\" { token outputs:surface.connect = </i/s/m/s.outputs:surface>\n \
        def Shader \"s\" { uniform token info:id = \"UsdPreviewSurface\"\n token outputs:surface\n \
        color3f inputs:diffuseColor.connect = </i/s/m/c.outputs:result> }\n \
        def Shader \"c\" { uniform token info:id = \"UsdPrimvarReader_float3\"\n token inputs:varname = \"displayColor\"\n \
        color3f outputs:result } }";
    // What is bound above a prototype is bound to it.
    let bound = format!("rel material:binding = </i/s/m>\n {material}\n def Cube \"p\" {{}}");
    let scene = copies(EACH, &bound);
    assert_eq!(worn(&scene).iter().map(|(_, colour, _)| *colour).collect::<Vec<_>>(), [RED, GREEN, RED]);
    assert!(scene.objects.iter().all(|object| scene.materials[object.material].name == "m"));
    let inner = "def PointInstancer \"p\" { int[] protoIndices = [0]\n point3f[] positions = [(0.5, 0, 0)]\n \
                 rel prototypes = </i/s/p/q>\n def Cube \"q\" {} }";
    assert_eq!(worn(&copies(EACH, inner)), [(1.5, RED, 1.0), (2.5, GREEN, 1.0), (4.5, RED, 0.5)]);
}

#[test]
fn what_copies_do_not_show_is_said() {
    let scene = copies(EACH, "def Xform \"p\" { def SphereLight \"l\" {}\n def Cube \"c\" {} }");
    assert_eq!((scene.lights.len(), scene.objects.len()), (0, 3));
    assert!(warnings(&scene).contains("lights and cameras below a prototype"), "{}", warnings(&scene));
}

/// Prototypes need no prims above them that are defined, and copies are made inactive by lists that change weaker ones. The crate
/// file was written by OpenUSD 26.11, whose mask of its copies is the same.
#[test]
fn copies_are_inactive_and_prototypes_hidden_as_openusd_has_it() {
    let places = |scene: &SceneBuilder| {
        let middle = |object: &Object| object.motion.at(0.0).point(object.mesh.bounds().centre()).x;
        let mut all: Vec<f32> = scene.objects.iter().map(middle).collect();
        all.sort_by(f32::total_cmp);
        all
    };
    let instancer = |inactive: &str, name: &str, more: &str| {
        format!(
            "def PointInstancer \"{name}\" ({inactive}) {{ int[] protoIndices = [0, 0, 0, 0]\n rel prototypes = </o/p>\n \
             point3f[] positions = [(1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)]\n {more} }}\n"
        )
    };
    let over = "over \"o\" { def Cube \"p\" {} }\n";
    let read = |text: String| read_text("usda", format!("#usda 1.0\n{over}{text}")).unwrap();
    assert_eq!(places(&read(instancer("", "i", ""))), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(places(&read(instancer("inactiveIds = [1, 3]", "i", ""))), [1.0, 3.0]);
    assert_eq!(
        places(&read(instancer("inactiveIds = [7]", "i", "int64[] ids = [9, 8, 7, 6]"))),
        [1.0, 2.0, 4.0]
    );
    let weaker = instancer("prepend inactiveIds = [0, 1]", "c", "").replace("def", "class");
    let stronger = "def \"i\" (inherits = </c> append inactiveIds = [3] delete inactiveIds = [0]) {}";
    assert_eq!(places(&read(weaker + stronger)), [1.0, 3.0]);
    let crate_file = include_bytes!("../../../../fuzz/corpus/scene_usdc/instancer.usdc");
    assert_eq!(places(&read_text("usdc", crate_file).unwrap()), [1.0, 3.0]);
    // What is only overridden is not shown itself.
    assert!(read(String::new()).objects.is_empty());
}
