//! Axes and units from every reader to every writer: a tetrahedron of known size and direction through all pairs, and what else
//! has a place, from a file in centimetres with z up.

use crate::read_text;
use crate::threemf::package;
use bilux_formats::{ReadOptions, SCENE_FORMATS, WriteOptions, read, read_bytes, write};
use bilux_math::{DVec3, Vec3};
use bilux_scene::{Axis, SceneBuilder, UpHint};

/// The corners of the tetrahedron in metres with y up: 3 to the right, 1 up, 2 to the back.
const SIZE: DVec3 = DVec3::new(3.0, 1.0, 2.0);

/// Corners of the tetrahedron in units of a file, where the legs along x, up, and to the back are these vectors.
fn corners(unit: f64, legs: [DVec3; 3]) -> [DVec3; 4] {
    let [x, up, back] = [0, 1, 2].map(|i| legs[i] * SIZE.to_array()[i] / unit);
    [DVec3::ZERO, x, up, back]
}

const Y_UP: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::NEG_Z];
const Z_UP: [DVec3; 3] = [DVec3::X, DVec3::Z, DVec3::Y];

fn numbers(corners: &[DVec3], between: &str, around: [&str; 2]) -> String {
    let one = |p: &DVec3| format!("{}{}{between}{}{between}{}{}", around[0], p.x, p.y, p.z, around[1]);
    corners.iter().map(one).collect::<Vec<_>>().join(if around[0].is_empty() { between } else { "," })
}

const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];

fn faces(text: impl Fn([usize; 3]) -> String) -> String {
    FACES.map(text).concat()
}

/// A file of each format that has lengths, and whether it states its unit or its axis.
fn sources() -> Vec<(&'static str, Vec<u8>, bool)> {
    let metres = corners(1.0, Y_UP);
    let lines = |before: &str, c: &[DVec3]| -> String {
        c.iter().map(|p| format!("{before}{} {} {}\n", p.x, p.y, p.z)).collect()
    };
    let obj = format!(
        "{}{}",
        lines("v ", &metres),
        faces(|f| format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1))
    );
    let list = faces(|[a, b, c]| format!("3 {a} {b} {c}\n"));
    let columns = "property float x\nproperty float y\nproperty float z\n";
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\n{columns}element face 4\nproperty list uchar int vertex_indices\n\
         end_header\n{}{list}",
        lines("", &metres)
    );
    let printed = corners(0.001, Z_UP);
    let stl = faces(|f| {
        let corner = |i: usize| lines("vertex ", &printed[i..=i]);
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", f.map(corner).concat())
    });
    let centimetres = corners(0.01, Z_UP);
    let indices = faces(|[a, b, c]| format!("{a} {b} {c} "));
    let usd = usd(&centimetres);
    vec![
        ("obj", obj.clone().into_bytes(), false),
        ("ply", ply.into_bytes(), false),
        ("off", format!("OFF\n4 4 0\n{}{list}", lines("", &metres)).into_bytes(), false),
        ("xyz", lines("", &corners(1.0, Z_UP)).into_bytes(), false),
        ("asc", asc(&metres).into_bytes(), true),
        ("stl", format!("solid a\n{stl}endsolid\n").into_bytes(), true),
        ("step", step(&corners(0.0254, Z_UP)).into_bytes(), true),
        ("3mf", printable(&printed), true),
        ("usd", usd.clone().into_bytes(), true),
        ("usdz", package(&[("a.usda", usd.as_bytes())]), true),
        ("collada", collada(&centimetres, &indices).into_bytes(), true),
        ("fbx", fbx(&corners(0.0254, Z_UP)).into_bytes(), true),
        ("gltf", gltf(&metres).into_bytes(), true),
        ("pbrt", pbrt(&metres, &indices).into_bytes(), true),
        ("mitsuba", mitsuba().into_bytes(), true),
        ("radiance", radiance(&corners(1.0, Z_UP)).into_bytes(), true),
        ("archive", package(&[("a.obj", obj.as_bytes())]), false),
        ("toml", b"[[model]]\nshape = \"box\"\nmatrix = [[3, 0, 0, 1.5], [0, 1, 0, 0.5], [0, 0, 2, -1], [0, 0, 0, 1]]\n".to_vec(), true),
    ]
}

fn asc(metres: &[DVec3]) -> String {
    let corner = |i: usize| format!("{} {} {} 0 0 1 0 0\n", metres[i].x, metres[i].y, metres[i].z);
    faces(|f| format!("triangle\n{}", f.map(corner).concat()))
}

fn usd(points: &[DVec3]) -> String {
    let points = numbers(points, ",", ["(", ")"]);
    let indices = faces(|[a, b, c]| format!("{a}, {b}, {c}, "));
    format!(
        "#usda 1.0\n(\n    metersPerUnit = 0.01\n    upAxis = \"Z\"\n)\ndef Mesh \"a\"\n{{\n    int[] faceVertexCounts = [3, 3, 3, 3]\n    \
         int[] faceVertexIndices = [{indices}]\n    point3f[] points = [{points}]\n    uniform token subdivisionScheme = \"none\"\n}}\n"
    )
}

fn collada(points: &[DVec3], indices: &str) -> String {
    let points = numbers(points, " ", ["", ""]);
    format!(
        "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><unit meter=\"0.01\"/>\
         <up_axis>Z_UP</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"s\"><float_array id=\"f\" \
         count=\"12\">{points}</float_array><technique_common><accessor source=\"#f\" count=\"4\" stride=\"3\"><param name=\"X\" \
         type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#s\"/></vertices><triangles count=\"4\"><input semantic=\"VERTEX\" \
         source=\"#v\" offset=\"0\"/><p>{indices}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>\
         <visual_scene id=\"w\"><node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene>\
         <instance_visual_scene url=\"#w\"/></scene></COLLADA>"
    )
}

/// In inches, with z up.
fn fbx(points: &[DVec3]) -> String {
    let points = numbers(points, ",", ["", ""]);
    let polygons = faces(|[a, b, c]| format!("{a},{b},{},", -(c as i64) - 1));
    let polygons = polygons.trim_end_matches(',');
    let setting = |name: &str, value: &str| format!("P: \"{name}\", \"\", \"\", \"A\", {value}\n");
    let axes = [
        ("UpAxis", "2"),
        ("UpAxisSign", "1"),
        ("FrontAxis", "1"),
        ("FrontAxisSign", "-1"),
        ("CoordAxis", "0"),
    ];
    let settings: String = axes.iter().map(|(name, value)| setting(name, value)).collect();
    format!(
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {{\nFBXVersion: 7400\n}}\nGlobalSettings: {{\nProperties70: {{\n{settings}{}{}}}\n}}\n\
         Objects: {{\nGeometry: 1, \"Geometry::a\", \"Mesh\" {{\nVertices: *12 {{\na: {points}\n}}\nPolygonVertexIndex: *12 {{\n\
         a: {polygons}\n}}\n}}\nModel: 2, \"Model::a\", \"Mesh\" {{\n}}\n}}\nConnections: {{\nC: \"OO\", 1, 2\nC: \"OO\", 2, 0\n}}\n",
        setting("CoordAxisSign", "1"),
        setting("UnitScaleFactor", "2.54"),
    )
}

fn gltf(metres: &[DVec3]) -> String {
    use base64::Engine;
    let mut bytes: Vec<u8> =
        metres.iter().flat_map(|p| p.as_vec3().to_array()).flat_map(f32::to_le_bytes).collect();
    bytes.extend(FACES.as_flattened().iter().map(|i| *i as u8));
    let bytes = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{
        "attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",
        "min":[0,0,-2],"max":[3,1,0]}},{{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}}],"bufferViews":[
        {{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],"buffers":[{{"byteLength":60,
        "uri":"data:application/octet-stream;base64,{bytes}"}}]}}"#
    )
}

fn pbrt(metres: &[DVec3], indices: &str) -> String {
    let points = numbers(metres, " ", ["", ""]);
    format!("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [{points}] \"integer indices\" [{indices}]\n")
}

/// A cube, from -1 to 1 before it is placed.
fn mitsuba() -> String {
    "<scene version=\"3.0.0\"><shape type=\"cube\"><transform name=\"to_world\"><scale x=\"1.5\" y=\"0.5\" z=\"1\"/>\
     <translate x=\"1.5\" y=\"0.5\" z=\"-1\"/></transform></shape></scene>"
        .to_owned()
}

fn radiance(metres: &[DVec3]) -> String {
    let corner = |i: usize| format!(" {} {} {}", metres[i].x, metres[i].y, metres[i].z);
    let polygon = |f: [usize; 3]| format!("m polygon p 0 0 9{}\n", f.map(corner).concat());
    format!("void plastic m 0 0 5 .5 .5 .5 0 0\n{}", faces(polygon))
}

fn printable(points: &[DVec3]) -> Vec<u8> {
    let vertices: String =
        points.iter().map(|p| format!("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", p.x, p.y, p.z)).collect();
    let triangles = faces(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"));
    crate::threemf::printed(&format!(
        "<object id=\"1\"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>"
    ))
}

/// In inches, with z up.
fn step(points: &[DVec3]) -> String {
    let points = numbers(points, ",", ["(", ")"]);
    let list = faces(|[a, b, c]| format!("({},{},{}),", a + 1, b + 1, c + 1));
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('a','2026-01-01T00:00:00',(''),(''),'','Bilux tests','');\n\
         FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF'));\nENDSEC;\nDATA;\n\
         #22=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n#23=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#22);\n\
         #24=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n#1=(CONVERSION_BASED_UNIT('INCH',#23)LENGTH_UNIT()NAMED_UNIT(#24));\n\
         #2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n#3=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n\
         #4=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#2,#3))REPRESENTATION_CONTEXT('','3D'));\n\
         #5=APPLICATION_CONTEXT('design');\n#6=PRODUCT_CONTEXT('',#5,'mechanical');\n\
         #7=PRODUCT_DEFINITION_CONTEXT('part definition',#5,'design');\n#8=COORDINATES_LIST('',4,({points}));\n\
         #9=TRIANGULATED_FACE('',#8,4,(),$,(),({}));\n#11=TESSELLATED_SOLID('',(#9),$);\n#12=PRODUCT('a','a','',(#6));\n\
         #13=PRODUCT_DEFINITION_FORMATION('','',#12);\n#14=PRODUCT_DEFINITION('design','',#13,#7);\n\
         #15=PRODUCT_DEFINITION_SHAPE('','',#14);\n#16=CARTESIAN_POINT('',(0.,0.,0.));\n#17=DIRECTION('',(0.,0.,1.));\n\
         #18=DIRECTION('',(1.,0.,0.));\n#19=AXIS2_PLACEMENT_3D('',#16,#17,#18);\n\
         #20=TESSELLATED_SHAPE_REPRESENTATION('',(#19,#11),#4);\n#21=SHAPE_DEFINITION_REPRESENTATION(#15,#20);\nENDSEC;\n\
         END-ISO-10303-21;\n",
        list.trim_end_matches(',')
    )
}

/// The corners of the box around everything, in metres with y up, by what the scene says of itself.
fn extent(scene: &SceneBuilder) -> [DVec3; 2] {
    let bounds = scene.bounds(0.0);
    let unit = if scene.unit > 0.0 { scene.unit } else { 1.0 };
    let turned = |p: Vec3| match scene.up {
        UpHint::Is(Axis::Z) | UpHint::Usually(Axis::Z) => {
            DVec3::new(p.x.into(), p.z.into(), -f64::from(p.y)) * unit
        }
        _ => p.as_dvec3() * unit,
    };
    let [a, b] = [turned(bounds.min), turned(bounds.max)];
    [a.min(b), a.max(b)]
}

/// Points become small triangles where a format has only those.
fn is_tetrahedron(scene: &SceneBuilder, tolerance: f64) -> bool {
    let [low, high] = extent(scene);
    let off = (low - DVec3::new(0.0, 0.0, -SIZE.z)).abs() + (high - DVec3::new(SIZE.x, SIZE.y, 0.0)).abs();
    off.max_element() < tolerance
}

#[test]
fn a_shape_of_known_size_and_direction_passes_through_all_pairs() {
    let sources = sources();
    // Point clouds that are made by other programs, and grids of numbers, have tests of their own.
    for row in SCENE_FORMATS
        .iter()
        .filter(|row| row.reads() && !["las", "e57", "usdc", "vdb"].contains(&row.entry.name))
    {
        assert!(
            sources.iter().any(|(format, ..)| *format == row.entry.name),
            "no file of {}",
            row.entry.name
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for (format, bytes, says) in &sources {
        let scene = read_bytes(bytes, format, None, "a", &ReadOptions::default())
            .unwrap_or_else(|e| panic!("{format}: {e}"));
        assert!(is_tetrahedron(&scene, 1e-6), "{format} itself: {:?}", extent(&scene));
        let extensions = SCENE_FORMATS.iter().filter(|row| row.writes()).flat_map(|row| row.extensions);
        for extension in extensions {
            let path = folder.path().join(format!("{format}.{extension}"));
            write(&path, &scene, &WriteOptions::default()).unwrap();
            let back = read(&path, &ReadOptions::default()).unwrap();
            // What says nothing is taken as slicers take it.
            let is_kept = !says && ["stl", "3mf"].contains(extension);
            let same = if is_kept {
                (scene.bounds(0.0).extent() - back.bounds(0.0).extent()).length() < 0.05
            } else {
                is_tetrahedron(&back, if *format == "xyz" { 0.05 } else { 1e-5 })
            };
            if !same {
                wrong.push(format!("{format} to {extension}: {:?}", extent(&back)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// In centimetres with z up: a camera 400 away looks along y, past a point lamp that is 300 above the origin.
const STAGE: &str = "#usda 1.0\n(\n    metersPerUnit = 0.01\n    upAxis = \"Z\"\n)\n
def Mesh \"a\"\n{\n    int[] faceVertexCounts = [3]\n    int[] faceVertexIndices = [0, 1, 2]\n    point3f[] points = [(0, 0, 0), (300, 0, 0), (0, 0, 100)]\n}\n
def Camera \"eye\"\n{\n    float focalLength = 24\n    float horizontalAperture = 36\n    float verticalAperture = 24\n    float fStop = 2\n    float focusDistance = 150
    matrix4d xformOp:transform = ((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (100, -400, 50, 1))\n    uniform token[] xformOpOrder = [\"xformOp:transform\"]\n}\n
def SphereLight \"point\"\n{\n    bool treatAsPoint = 1\n    float inputs:intensity = 7\n    float inputs:radius = 20\n    double3 xformOp:translate = (0, 30, 300)\n    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n}\n
def SphereLight \"ball\"\n{\n    float inputs:intensity = 5\n    float inputs:radius = 20\n    double3 xformOp:translate = (0, 60, 200)\n    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n}\n
def DistantLight \"sun\"\n{\n    float inputs:intensity = 3\n    float inputs:angle = 0\n}\n";

/// Meaning of a camera and lamps in metres with y up, whatever a spec leaves to its defaults.
#[test]
fn cameras_and_lamps_keep_their_places_and_their_light() {
    let scene = read_text("usda", STAGE).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for extension in ["toml", "glb", "pbrt", "xml"] {
        let path = folder.path().join(format!("a.{extension}"));
        write(&path, &scene, &WriteOptions::default()).unwrap();
        let back = read(&path, &ReadOptions::default()).unwrap();
        let near = |what: &str, found: Vec3, wanted: Vec3| {
            assert!(
                (found - wanted).length() < 1e-4 * wanted.length().max(1.0),
                "{what} in {extension}: {found}, not {wanted}"
            );
        };
        let camera = &back.cameras[0].spec;
        let [eye, at] = ["position", "look_at"].map(|key| camera.vector(key).unwrap());
        near("the eye", eye, Vec3::new(1.0, 0.5, 4.0));
        near("the view", (at - eye).normalize(), Vec3::NEG_Z);
        near("up", camera.vector("up").unwrap_or(Vec3::Y).normalize(), Vec3::Y);
        if extension == "toml" {
            // A lens of 24 mm at f/2 has a radius of 6 mm.
            near("the lens", Vec3::splat(camera.number("aperture").unwrap()), Vec3::splat(0.006));
            near("the focus", Vec3::splat(camera.number("focus").unwrap()), Vec3::splat(1.5));
        }
        let lamp = |kind: &str| back.lights.iter().find(|light| light.kind == kind);
        let point = lamp("point").unwrap();
        near("the lamp", point.vector("position").unwrap(), Vec3::new(0.0, 3.0, -0.3));
        // Radiance over a disc with a radius of 0.2 m.
        let intensity = 7.0 * std::f32::consts::PI * 0.04;
        near(
            "its intensity",
            Vec3::from(point.colour("intensity").unwrap().to_array()),
            Vec3::splat(intensity),
        );
        let sun = lamp("directional").unwrap();
        near("the sun", Vec3::from(sun.colour("irradiance").unwrap().to_array()), Vec3::splat(3.0));
        near("its light", sun.vector("direction").unwrap().normalize(), Vec3::NEG_Y);
        if extension != "glb" {
            let centre = ball(&back);
            near("the ball", centre, Vec3::new(0.0, 2.0, -0.6));
        }
    }
}

/// The centre of the lamp that is a ball: a light, or a mesh that shines.
fn ball(scene: &SceneBuilder) -> Vec3 {
    if let Some(light) = scene.lights.iter().find(|light| light.kind == "sphere") {
        assert!((light.number("radius").unwrap() - 0.2).abs() < 1e-5);
        return light.vector("position").unwrap();
    }
    let shines = |material: usize| scene.materials[material].parameters.find("emission").is_some();
    let ball = scene.objects.iter().find(|object| shines(object.material)).unwrap();
    let bounds = ball.motion.at(0.0).bounds(&ball.mesh.bounds());
    (bounds.min + bounds.max) * 0.5
}
