//! Scenes of Mitsuba 3 and of older versions.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read, read_bytes};
use bilux_math::transcendental::{atan, tan};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::bsdf::{Albedo, Ggx};
use bilux_scene::{SceneBuilder, Spec, Value};
use std::fs;
use std::io::Write;
use std::path::Path;

fn scene(inside: &str) -> SceneBuilder {
    let text = format!("<scene version=\"3.0.0\">{inside}</scene>");
    read_text("mitsuba", text).unwrap_or_else(|error| panic!("{inside}: {error}"))
}

/// A sphere with this material.
fn material(bsdf: &str) -> Spec {
    scene(&format!("<shape type=\"sphere\">{bsdf}</shape>")).materials.last().unwrap().clone()
}

fn close(found: Rgb, wanted: [f32; 3], by: f32) -> bool {
    (0..3).all(|i| (found[i] - wanted[i]).abs() <= by)
}

/// Cosine-weighted means of what Mitsuba 3.9.1 (`scalar_rgb`) reflects, by `bsdf.sample`; Bilux's materials reflect as much.
#[test]
fn principled_is_as_bright_as_in_mitsuba() {
    let given = "<rgb name=\"base_color\" value=\"0.5, 0.1, 0.8\"/>";
    for (roughness, wanted) in [(0.5f32, [0.565, 0.1597, 0.869]), (0.2, [0.576, 0.1846, 0.8696])] {
        let spec = material(&format!(
            "<bsdf type=\"principled\">{given}<float name=\"roughness\" value=\"{roughness}\"/></bsdf>"
        ));
        let boundary = Albedo::new(&Ggx::new(roughness * roughness), spec.number("specular_ior").unwrap());
        let reflected =
            spec.colour("base_color").unwrap() * (1.0 - boundary.mean()) + Rgb::grey(boundary.mean());
        assert!(close(reflected, wanted, 0.01), "{reflected:?}, not {wanted:?}");
    }
    let inside = format!("{given}<float name=\"spec_trans\" value=\"1\"/>");
    let glass = material(&format!("<bsdf type=\"principled\">{inside}</bsdf>"));
    assert!(close(glass.colour("transmission_color").unwrap(), [0.5f32.sqrt(), 0.3162, 0.8944], 1e-3));
    let thin = material(&format!("<bsdf type=\"principledthin\">{inside}</bsdf>"));
    assert!(close(thin.colour("transmission_color").unwrap(), [0.5, 0.1, 0.8], 1e-6));
    // At normal incidence a pane reflects (1.5 - 1)² / (1.5 + 1)², and only clear parts have a boundary.
    let each = thin.number("specular_ior").map(|index| (index - 1.0) / (index + 1.0)).map(|a| a * a).unwrap();
    assert!((2.0 * each / (1.0 + each) - 0.04).abs() < 1e-5 && thin.number("specular_weight") == Some(0.0));
    let metal =
        material(&format!("<bsdf type=\"principled\">{given}<float name=\"metallic\" value=\"1\"/></bsdf>"));
    assert!(
        close(metal.colour("base_color").unwrap(), [0.5, 0.1, 0.8], 1e-6),
        "metals have the colour given"
    );
}

/// A ramp of heights is as steep as the shape is small: 45 degrees where one unit of u is one unit long, on a square two wide.
#[test]
fn bumps_are_lengths_on_the_shape() {
    let folder = tempfile::tempdir().unwrap();
    // White on the right, of four columns.
    let row = [0u8, 85, 170, 255].repeat(4);
    fs::write(folder.path().join("ramp.pgm"), [b"P5 4 4 255\n".as_slice(), &row].concat()).unwrap();
    let slope = |size: f64| {
        let bump = "<bsdf type=\"bumpmap\"><texture type=\"bitmap\"><string name=\"filename\" value=\"ramp.pgm\"/>\
            <boolean name=\"raw\" value=\"true\"/></texture><bsdf type=\"diffuse\"/></bsdf>";
        let place = format!("<transform name=\"to_world\"><scale value=\"{size}\"/></transform>");
        let text =
            format!("<scene version=\"3.0.0\"><shape type=\"rectangle\">{place}{bump}</shape></scene>");
        fs::write(folder.path().join("scene.xml"), text).unwrap();
        let scene = read(&folder.path().join("scene.xml"), &ReadOptions::default()).unwrap();
        let Some((Value::Texture(index), _)) = scene.materials.last().unwrap().parameters.find("normal")
        else {
            panic!("no normal map");
        };
        let n = scene.textures[*index].texel(1, 1) * 2.0 - Rgb::WHITE;
        -n.r / n.b
    };
    // A third of the height in a quarter of the width: 4/3 per unit of u.
    assert!((slope(0.5) - 4.0 / 3.0).abs() < 0.02, "{}", slope(0.5));
    assert!((slope(2.0) - 1.0 / 3.0).abs() < 0.02, "{}", slope(2.0));
}

#[test]
fn attributes_of_meshes_are_linear_colours() {
    let folder = tempfile::tempdir().unwrap();
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float heat_0\nproperty float heat_1\nproperty float heat_2\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n";
    let rows = "0 0 0 0.25 0 1\n1 0 0 0.25 0 1\n0 1 0 0.25 0 1\n3 0 1 2\n";
    fs::write(folder.path().join("a.ply"), format!("{header}{rows}")).unwrap();
    let text = "<scene version=\"3.0.0\"><shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>\
        <bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"mesh_attribute\">\
        <string name=\"name\" value=\"vertex_heat\"/></texture></bsdf></shape></scene>";
    fs::write(folder.path().join("scene.xml"), text).unwrap();
    let scene = read(&folder.path().join("scene.xml"), &ReadOptions::default()).unwrap();
    assert!(close(scene.objects[0].mesh.vertex_kd[0], [0.25, 0.0, 1.0], 1e-4));
    assert_eq!(scene.materials[0].colour("reflectance"), Some(Rgb::WHITE));
    assert_eq!(warnings(&scene), "");
}

/// Filters let half of unpolarised light through, and bend none.
#[test]
fn polarisers_are_grey_filters() {
    let spec = material("<bsdf type=\"polarizer\"><float name=\"theta\" value=\"45\"/></bsdf>");
    assert_eq!((spec.kind.as_str(), spec.number("eta")), ("dielectric", Some(1.0)));
    assert_eq!(spec.colour("tint"), Some(Rgb::grey(0.5)));
}

#[test]
fn a_whole_scene_is_read() {
    let bytes =
        fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/scene_mitsuba/all.xml"));
    let bytes = bytes.unwrap();
    let given = [("spp".to_owned(), "8".to_owned())];
    let options = ReadOptions { definitions: given.to_vec(), ..ReadOptions::default() };
    let scene = read_bytes(&bytes, "", None, "all.xml", &options).unwrap();
    assert_eq!((scene.objects.len(), scene.lights.len(), scene.cameras.len()), (6, 2, 1));
    let setting = |key| scene.settings.find(key).map(|(value, _)| value.clone());
    assert_eq!(setting("spp"), Some(Value::Integer(8)), "the command line overrides the default");
    assert_eq!(setting("max_depth"), Some(Value::Integer(5)), "edges count one more than events");
    assert_eq!(setting("size"), Some(Value::Text("64x48".to_owned())));
    assert_eq!(warnings(&scene), "");
    let unknown = ReadOptions { definitions: vec![("sp".into(), "8".into())], ..ReadOptions::default() };
    let error = read_bytes(&bytes, "", None, "all.xml", &unknown).unwrap_err().to_string();
    assert!(error.contains("did you mean 'spp'"), "{error}");
    let other = read_bytes(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "off", None, "x", &unknown)
        .unwrap_err()
        .to_string();
    assert!(other.contains("has no variable 'sp'"), "{other}");
}

/// The numbers are those of Mitsuba 3.9 (`scalar_rgb`), for the same elements.
#[test]
fn conventions_are_those_of_mitsuba() {
    let camera = |inside: &str| {
        let film = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/><integer name=\"height\" value=\"100\"/></film>";
        scene(&format!("<sensor type=\"perspective\">{film}{inside}</sensor>")).cameras[0].spec.clone()
    };
    // The horizontal field of view: half its tangent is the vertical one here.
    let vertical = |x: f32| 2.0 * atan(0.5 * tan(x.to_radians() * 0.5)).to_degrees();
    for (inside, x) in [
        ("<float name=\"fov\" value=\"40\"/>", 40.0),
        ("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"y\"/>", 72.104_774),
        ("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"diagonal\"/>", 36.064_79),
        ("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"smaller\"/>", 72.104_774),
        ("<string name=\"focal_length\" value=\"50mm\"/>", 42.311_714),
    ] {
        let fov = camera(inside).number("fov").unwrap();
        assert!((fov - vertical(x)).abs() < 1e-3, "{inside}: {fov}");
    }
    let shifted =
        camera("<float name=\"fov\" value=\"60\"/><float name=\"principal_point_offset_x\" value=\"0.2\"/>");
    assert_eq!(shifted.number("principal_x"), Some(0.3));
    assert!(camera("").parameters.find("mirrored").is_none(), "cameras are right-handed");

    let light = |inside: &str| {
        scene(&format!("<emitter type=\"constant\">{inside}</emitter>")).lights[0].colour("radiance").unwrap()
    };
    for (inside, wanted) in [
        ("<spectrum name=\"radiance\" value=\"2\"/>", [2.4096, 1.8966, 1.8178]),
        ("<spectrum name=\"radiance\" value=\"400:1, 500:2, 600:3,700:1\"/>", [3.2733, 2.3709, 1.2525]),
        (
            "<spectrum name=\"radiance\" type=\"uniform\"><float name=\"value\" value=\"2\"/></spectrum>",
            [2.0; 3],
        ),
        ("<rgb name=\"radiance\" value=\"0.5\"/>", [0.5; 3]),
        ("<spectrum name=\"radiance\" type=\"d65\"><float name=\"scale\" value=\"3\"/></spectrum>", [3.0; 3]),
    ] {
        assert!(close(light(inside), wanted, 0.01), "{inside}: {:?}", light(inside));
    }
    let surface = material(
        "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:.1, 500:.2, 600:.8,700:.1\"/></bsdf>",
    );
    assert!(close(surface.colour("reflectance").unwrap(), [0.7909, 0.459, 0.1075], 0.005));
    let glass = material("<bsdf type=\"dielectric\"/>");
    assert!((glass.number("eta").unwrap() - 1.504_183_3).abs() < 1e-5);
    let gold = material("<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>");
    assert!(close(gold.colour("k").unwrap(), [3.983, 2.386, 1.603], 1e-3));
    let rough = material("<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.25\"/></bsdf>");
    assert_eq!(rough.number("roughness"), Some(0.5), "the square root of alpha");
    // Beckmann's microfacets, unless the file says otherwise.
    assert_eq!(rough.parameters.find("distribution").unwrap().0, &Value::from("beckmann"));
    let chosen = "<string name=\"distribution\" value=\"ggx\"/>";
    for kind in ["roughconductor", "roughdielectric"] {
        let ggx = material(&format!("<bsdf type=\"{kind}\">{chosen}</bsdf>"));
        assert_eq!(ggx.parameters.find("distribution"), None);
    }
}

#[test]
fn texture_coordinates_count_downwards() {
    let quad = &scene("<shape type=\"rectangle\"/>").objects[0].mesh;
    let at =
        |mesh: &bilux_scene::Mesh, p: Vec3| mesh.uvs[mesh.positions.iter().position(|q| *q == p).unwrap()];
    assert_eq!(at(quad, Vec3::new(-1.0, -1.0, 0.0)), Vec2::new(0.0, 1.0), "the top left of a picture");
    let cube = &scene("<shape type=\"cube\"/>").objects[0].mesh;
    assert!(cube.triangles.iter().all(|t| {
        let [a, b, c] = t.map(|i| cube.positions[i as usize]);
        (b - a).cross(c - a).dot(a + b + c) > 0.0
    }));
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nusemtl x\nf 1/1 2/1 3/1\n";
    fs::write(folder.path().join("a.obj"), obj).unwrap();
    let file = folder.path().join("a.xml");
    fs::write(&file, "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape></scene>").unwrap();
    let read = read(&file, &ReadOptions::default()).unwrap();
    assert_eq!((read.objects[0].mesh.uvs[0].y, warnings(&read)), (0.25, String::new()));
    // The lower left square of the file is the upper left one of the texture, which has the first colour.
    let checker = scene(
        "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"/></bsdf></shape>",
    );
    let texture = &checker.textures[0];
    assert!((texture.at(Vec2::new(0.1, 0.9)).r - 0.4).abs() < 1e-6);
    assert!((texture.at(Vec2::new(0.1, 0.1)).r - 0.2).abs() < 1e-6);
}

#[test]
fn older_names_are_those_of_version_3() {
    let new = "<scene version=\"3.0.0\"><sensor type=\"perspective\"><string name=\"fov_axis\" value=\"y\"/><float name=\"fov\" value=\"30\"/>\
        <transform name=\"to_world\"><lookat origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>\
        <shape type=\"sphere\"><bsdf type=\"roughdielectric\"><float name=\"int_ior\" value=\"1.3\"/><float name=\"alpha_u\" value=\"0.2\"/></bsdf></shape></scene>";
    let old = new.replace("3.0.0", "0.6.0").replace("fov_axis", "fovAxis").replace("to_world", "toWorld");
    let old = old.replace("lookat", "lookAt").replace("int_ior", "intIOR").replace("alpha_u", "alphaU");
    let (new, old) = (read_text("mitsuba", new).unwrap(), read_text("mitsuba", old).unwrap());
    let plain = |spec: &Spec| {
        spec.parameters.0.iter().map(|(key, value, _)| (key.clone(), value.clone())).collect::<Vec<_>>()
    };
    assert_eq!(plain(&new.materials[0]), plain(&old.materials[0]));
    assert_eq!(plain(&new.cameras[0].spec), plain(&old.cameras[0].spec));
    let light = "<scene version=\"0.5.0\"><shape type=\"sphere\"><bsdf type=\"diffuse\"><srgb name=\"reflectance\" value=\"#808080\"/></bsdf></shape></scene>";
    let grey = read_text("mitsuba", light).unwrap().materials[0].colour("reflectance").unwrap();
    assert!(close(grey, [0.2159; 3], 1e-3), "sRGB");
}

/// A file with a mesh in it, a triangle whose corners have texture coordinates.
fn serialized(version: u16, vertices: u64, corner: u32) -> Vec<u8> {
    let mut inside = 0x1002u32.to_le_bytes().to_vec();
    if version == 4 {
        inside.extend(b"name\0");
    }
    inside.extend([vertices.to_le_bytes(), 1u64.to_le_bytes()].concat());
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    inside.extend(positions.iter().chain(&[0.0, 0.25, 1.0, 0.0, 0.0, 1.0]).flat_map(|x| x.to_le_bytes()));
    inside.extend([0, 1, corner].iter().flat_map(|i: &u32| i.to_le_bytes()));
    let mut bytes = [0x041cu16.to_le_bytes(), version.to_le_bytes()].concat();
    let mut encoder = flate2::write::ZlibEncoder::new(&mut bytes, flate2::Compression::fast());
    encoder.write_all(&inside).unwrap();
    encoder.finish().unwrap();
    let start: &[u8] = if version == 4 { &[0; 8] } else { &[0; 4] };
    [&bytes, start, &1u32.to_le_bytes()].concat()
}

#[test]
fn serialized_meshes_are_read_and_their_counts_are_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.xml");
    fs::write(&file, "<scene version=\"3.0.0\"><shape type=\"serialized\"><string name=\"filename\" value=\"a.serialized\"/></shape></scene>").unwrap();
    let read = |bytes: &[u8]| {
        fs::write(folder.path().join("a.serialized"), bytes).unwrap();
        read(&file, &ReadOptions::default())
    };
    for version in [3, 4] {
        let scene = read(&serialized(version, 3, 2)).unwrap();
        let mesh = &scene.objects[0].mesh;
        assert_eq!(
            (mesh.triangles.as_slice(), mesh.positions[1], mesh.uvs[0]),
            (&[[0, 1, 2]][..], Vec3::X, Vec2::new(0.0, 0.75))
        );
        assert_eq!(mesh.normals[0], Vec3::Z);
    }
    for (bytes, part) in [
        (serialized(4, u64::MAX / 7, 2), "ends in the middle of a mesh"),
        (serialized(4, 3, 3), "refers to vertices that it does not have"),
        (serialized(5, 3, 2), "has version 5"),
        (b"\x1c\x04\x04\0".to_vec(), "is not a file of meshes"),
        (b"ply".to_vec(), "is not a file of meshes"),
    ] {
        let error = read(&bytes).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn what_cannot_be_read_says_where_and_why() {
    let broken = |inside: &str| refusal("mitsuba", format!("<scene version=\"3.0.0\">\n{inside}</scene>"));
    for (inside, part) in [
        (
            "<shape type=\"spher\"/>",
            "scene.mitsuba:2:1: there is no type 'spher' of shape; did you mean 'sphere'?",
        ),
        ("<shape type=\"sphere\"><ref id=\"x\"/></shape>", "2:22: there is no id 'x'"),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"big\"/></shape>",
            "'radius' must be a number, not 'big'",
        ),
        ("<shape type=\"sphere\"/><bsdf type=\"diffuse\"", "2:43: this is not well-formed XML"),
        ("<shape type=\"obj\"/>", "filename"),
        (
            "<bsdf id=\"a\" type=\"twosided\"><ref id=\"a\"/></bsdf><shape type=\"sphere\"><ref id=\"a\"/></shape>",
            "contains itself",
        ),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>", "variable 'r'"),
    ] {
        let message = broken(inside);
        assert!(message.contains(part), "{inside}: {message}");
    }
    let odd =
        scene("<shape type=\"sphere\"><float name=\"radios\" value=\"1\"/></shape><shape type=\"sdfgrid\"/>");
    let said = warnings(&odd);
    assert!(said.contains("'radios' of the shape 'sphere' is not used; did you mean 'radius'?"), "{said}");
    assert!(said.contains("more than the picture shows: the shape 'sdfgrid'"), "{said}");
    let grey =
        scene("<shape type=\"sphere\"><bsdf type=\"difuse\"><float name=\"x\" value=\"1\"/></bsdf></shape>");
    assert_eq!(grey.materials[grey.objects[0].material].number("reflectance"), Some(0.5));
    let what = "a material is grey: there is no type 'difuse' of bsdf; did you mean 'diffuse'?";
    assert!(warnings(&grey).contains(what), "{}", warnings(&grey));
}

/// Two voxels along x, of one channel or of three.
fn voxels(channels: i32, numbers: &[f32]) -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    [1, 2, 1, 1, channels].iter().for_each(|x| out.extend(x.to_le_bytes()));
    [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().chain(numbers).for_each(|x| out.extend(x.to_le_bytes()));
    out
}

/// A medium has one colour: that of an extinction in colour is the mean of each channel, that of an albedo the mean where it is dense.
#[test]
fn volumes_in_colour_keep_their_means() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("e.vol"), voxels(3, &[1.0, 2.0, 3.0, 3.0, 2.0, 7.0])).unwrap();
    fs::write(folder.path().join("a.vol"), voxels(1, &[0.2, 0.8])).unwrap();
    let text = r#"<scene version="3.0.0"><shape type="cube"><bsdf type="null"/><medium type="heterogeneous" name="interior">
        <volume type="gridvolume" name="sigma_t"><string name="filename" value="e.vol"/></volume>
        <volume type="gridvolume" name="albedo"><string name="filename" value="a.vol"/></volume>
        <float name="scale" value="10"/></medium></shape></scene>"#;
    let path = folder.path().join("a.xml");
    fs::write(&path, text).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let spec = scene.materials.last().unwrap();
    // The density is 2 and 4, and 3 in the mean; so an albedo of 0.2 and 0.8 is 0.6 there.
    let (absorption, scattering) = (spec.colour("absorption").unwrap(), spec.colour("scattering").unwrap());
    assert!(close(scattering, [4.0, 4.0, 10.0], 0.01), "{scattering:?}");
    assert!(close(absorption, [8.0 / 3.0, 8.0 / 3.0, 20.0 / 3.0], 0.01), "{absorption:?}");
    let said = warnings(&scene);
    for part in
        ["has a colour for each voxel, whose mean is taken", "an albedo that varies is replaced by its mean"]
    {
        assert!(said.contains(part), "{said}");
    }
}

/// The numbers are those of `ScalarTransform4f().rotate([0, 1, 1], 15)` of Mitsuba 3.9.1; version 0.5 has a quarter turn about the diagonal.
#[test]
fn axes_of_rotations_are_not_normalised_since_version_2() {
    let along_x = |version: &str, angle: f32| {
        let text = format!(
            "<scene version=\"{version}\"><shape type=\"cube\"><transform name=\"to_world\"><rotate y=\"1\" z=\"1\" angle=\"{angle}\"/></transform></shape></scene>"
        );
        let text = if version == "0.5.0" { text.replace("to_world", "toWorld") } else { text };
        let scene = read_bytes(text.as_bytes(), "", None, "a.xml", &ReadOptions::default()).unwrap();
        scene.objects[0].motion.at(0.0).vector(Vec3::X)
    };
    let near = |a: Vec3, b: [f32; 3]| assert!((a - Vec3::from(b)).length() < 1e-6, "{a}");
    near(along_x("3.0.0", 15.0), [0.965_925_8, 0.258_819_04, -0.258_819_04]);
    near(along_x("0.5.0", 90.0), [0.0, 0.5f32.sqrt(), -0.5f32.sqrt()]);
}

#[test]
fn hostile_files_end_soon() {
    let nested =
        |count: usize| format!("{}{}", "<bsdf type=\"twosided\">".repeat(count), "</bsdf>".repeat(count));
    let message = refusal("mitsuba", format!("<scene version=\"3.0.0\">{}</scene>", nested(100_000)));
    assert!(message.contains("more than"), "{message}");
    let bomb = "<!DOCTYPE s [<!ENTITY a \"aaaaaaaaaa\">]><scene version=\"3.0.0\"><string name=\"a\" value=\"&a;\"/></scene>";
    assert!(refusal("mitsuba", bomb).contains("document type"));
    let attributes: String = (0..5000).map(|i| format!(" a{i}=\"\"")).collect();
    assert!(
        refusal("mitsuba", format!("<scene version=\"3\"><x{attributes}/></scene>"))
            .contains("5000 attributes")
    );
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("a.xml", "<scene version=\"3.0.0\"><include filename=\"b.xml\"/></scene>");
    write("b.xml", "<scene version=\"3.0.0\"><include filename=\"a.xml\"/></scene>");
    let error = read(&folder.path().join("a.xml"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("b.xml:1:24: there is no file 'a.xml'") || error.contains("includes itself"),
        "{error}"
    );
    write("c.xml", "<scene version=\"3.0.0\"><include filename=\"../../etc/passwd\"/></scene>");
    assert!(read(&folder.path().join("c.xml"), &ReadOptions::default()).is_err());
}

/// Booleans of any case, as Mitsuba has them: Python writes them with a capital.
#[test]
fn booleans_are_of_any_case() {
    for (word, turned) in [("True", true), ("TRUE", true), ("true", true), ("False", false), ("fAlse", false)]
    {
        let shape = format!("<shape type='rectangle'><boolean name='flip_normals' value='{word}'/></shape>");
        let scene = scene(&shape);
        assert_eq!(scene.objects[0].mesh.normals[0].z < 0.0, turned, "{word}");
    }
    let wrong = read_text(
        "mitsuba",
        "<scene version='3.0.0'><shape type='cube'><boolean name='flip_normals' value='yes'/></shape></scene>",
    );
    assert!(wrong.unwrap_err().to_string().contains("'yes'"));
}

/// Before version 2 a shape with a medium and no material is an invisible boundary. [Mitsuba 0.6, 8.1] Since then it is grey.
#[test]
fn media_without_a_material_have_no_surface_before_version_2() {
    let kinds = |version: &str, [a, s]: [&str; 2], names: &str| {
        let medium = format!(
            "<medium type='homogeneous' id='fog'><rgb name='{a}' value='2,1,.5'/><rgb name='{s}' value='1,1,3'/></medium>"
        );
        let own = "<shape type='sphere'><medium type='homogeneous' name='interior'/></shape>";
        let by_id = "<shape type='cube'><ref name='interior' id='fog'/></shape>";
        let with = "<bsdf type='dielectric' id='glass'/><shape type='sphere'><ref id='glass'/><ref name='interior' id='fog'/></shape>";
        let text = format!("<scene version='{version}'>{medium}{own}{by_id}{with}{names}</scene>");
        let scene = read_text("mitsuba", text).unwrap();
        scene.objects.iter().map(|o| scene.materials[o.material].kind.clone()).collect::<Vec<_>>()
    };
    let old = ["sigmaA", "sigmaS"];
    for version in ["0.5.0", "0.6.0"] {
        assert_eq!(kinds(version, old, ""), ["interface", "interface", "dielectric"], "{version}");
    }
    assert_eq!(kinds("3.0.0", ["sigma_a", "sigma_s"], "")[..2], ["diffuse", "diffuse"]);
}

/// The lobes of [Burley 2012] as types of their own, and includes that name files beside themselves.
#[test]
fn scenes_for_teaching_are_read() {
    let with = |kind: &str| {
        let bsdf = format!(
            "<bsdf type='{kind}'><rgb name='baseColor' value='.5,.25,.125'/><float name='roughness' value='.3'/>\
             <float name='specularTransmission' value='.75'/></bsdf>"
        );
        let text = format!("<scene version='0.5.0'><shape type='sphere'>{bsdf}</shape></scene>");
        let scene = read_text("mitsuba", text).unwrap();
        scene.materials[scene.objects[0].material].clone()
    };
    let number = |kind: &str, key: &str| with(kind).number(key);
    assert_eq!(number("disneybsdf", "transmission_weight"), Some(0.75));
    assert_eq!(number("disneymetal", "base_metalness"), Some(1.0));
    assert_eq!(number("disneyglass", "transmission_weight"), Some(1.0));
    assert_eq!(number("disneydiffuse", "specular_ior"), Some(1.0));
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    let scene = |inside: &str| format!("<scene version='0.5.0'>{inside}</scene>");
    for (name, text) in [
        (
            "main.xml",
            scene("<include filename='parts/all.xml'/><shape type='sphere'><ref id='red'/></shape>"),
        ),
        (
            "parts/all.xml",
            scene(
                "<include filename='red.xml'/><shape type='obj'><string name='filename' value='a.obj'/></shape>",
            ),
        ),
        (
            "parts/red.xml",
            "<bsdf type='diffuse' id='red'><rgb name='reflectance' value='1,0,0'/></bsdf>".to_owned(),
        ),
        ("parts/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_owned()),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let read = bilux_formats::read(&folder.path().join("main.xml"), &Default::default()).unwrap();
    assert_eq!(read.objects.len(), 2);
}

/// A projector's angle is that of the width of its picture, whose height follows from its shape. [Mitsuba 3, projector]
#[test]
fn projectors_throw_pictures_of_their_shape() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.xml");
    // Tangents of half the width and half the height, for a picture that is wide and one that is high.
    for (size, half) in [([4, 2], [1.0, 0.5]), ([2, 4], [1.0, 2.0])] {
        let [width, height] = size;
        let texels = "255 ".repeat(3 * width * height);
        fs::write(folder.path().join("a.ppm"), format!("P3 {width} {height} 255 {texels}")).unwrap();
        let picture = "<texture type=\"bitmap\" name=\"irradiance\"><string name=\"filename\" value=\"a.ppm\"/></texture>";
        let emitter =
            format!("<emitter type=\"projector\"><float name=\"fov\" value=\"90\"/>{picture}</emitter>");
        fs::write(&file, format!("<scene version=\"3.0.0\">{emitter}</scene>")).unwrap();
        let scene = read(&file, &ReadOptions::default()).unwrap();
        let light = &scene.lights[0];
        let Some((Value::Distribution(rays), _)) = light.parameters.find("distribution") else {
            panic!("{light:?}")
        };
        for (azimuth, half) in [(0.0, half[0]), (90.0, half[1]), (180.0, half[0]), (270.0, half[1])] {
            let lit = |tangent: f32| rays.at(f64::from(atan(tangent).to_degrees()), azimuth) > 0.0;
            assert!(lit(0.95 * half) && !lit(1.05 * half), "{size:?} at {azimuth}");
        }
    }
}

/// Before version 1, pictures could go on in another way along each axis. [Mitsuba 0.6, 8.3.1]
#[test]
fn pictures_go_on_beyond_each_edge_as_older_files_say() {
    use bilux_scene::texture::Wrap;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.ppm"), "P3 2 1 255 255 0 0 0 255 0").unwrap();
    let file = folder.path().join("a.xml");
    for (modes, wanted) in [
        (&[][..], [Wrap::Repeat; 2]),
        (&[("wrapMode", "clamp")], [Wrap::Clamp; 2]),
        (&[("wrapModeU", "mirror")], [Wrap::Mirror, Wrap::Repeat]),
        (&[("wrapModeV", "clamp")], [Wrap::Repeat, Wrap::Clamp]),
        (&[("wrapMode", "clamp"), ("wrapModeV", "mirror")], [Wrap::Clamp, Wrap::Mirror]),
    ] {
        let modes: String =
            modes.iter().map(|(key, value)| format!("<string name=\"{key}\" value=\"{value}\"/>")).collect();
        let texture = format!(
            "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"a.ppm\"/>{modes}</texture>"
        );
        let shape = format!("<shape type=\"rectangle\"><bsdf type=\"diffuse\">{texture}</bsdf></shape>");
        fs::write(&file, format!("<scene version=\"0.6.0\">{shape}</scene>")).unwrap();
        let scene = read(&file, &ReadOptions::default()).unwrap();
        assert_eq!((scene.textures[0].wrap, warnings(&scene)), (wanted, String::new()), "{modes}");
    }
}
