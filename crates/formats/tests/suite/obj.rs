//! OBJ and MTL as programs write them.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Spec, Value};
use std::path::Path;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Reads a library by way of a file that names its first material.
fn materials(library: &str) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a b.mtl"), library).unwrap();
    let path = folder.path().join("scene.obj");
    std::fs::write(&path, format!("mtllib a b.mtl\n{SQUARE}usemtl m\nf 1 2 3\n")).unwrap();
    read(&path, &ReadOptions::default()).unwrap()
}

fn value<'s>(spec: &'s Spec, key: &str) -> Option<&'s Value> {
    spec.parameters.find(key).map(|(value, _)| value)
}

#[test]
fn indices_forward_backward_and_with_every_part() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt 1 0\nvn 0 0 1\nf -4 -3 -2\nf 1/1 3/2 4/2\nf 1//1 2//1 3//-1\nf 1/1/1 2/2/1 5/2/1\nv 9 9 9\n"
    );
    let scene = read_text("obj", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.triangles.len(), 4);
    let last = mesh.triangles[3][2] as usize;
    assert_eq!((mesh.positions[last], mesh.uvs[last]), (Vec3::splat(9.0), Vec2::X));
    assert!(warnings(&scene).contains("no texture coordinates"));
}

#[test]
fn corners_alike_share_a_vertex_and_others_do_not() {
    let scene = read_text(
        "obj",
        format!("{SQUARE}vt 0 0\nvt 1 1\ns off\nf 1/1 2/1 3/1\nf 1/1 3/1 4/2\nf 1/2 2/1 3/1\n"),
    )
    .unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 1, 2]]);
}

#[test]
fn hollow_polygons_are_cut() {
    let text = "v 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4 5 6\n";
    let mesh = read_text("obj", text).unwrap().objects[0].mesh.clone();
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).z * 0.5
    };
    assert!(mesh.triangles.iter().all(|t| area(t) > 0.0));
    assert!((mesh.triangles.iter().map(area).sum::<f32>() - 3.0).abs() < 1e-6);
}

#[test]
fn names_groups_and_materials_make_objects() {
    let text = format!(
        "{SQUARE}f 1 2 3\no first  one\nf 1 2 4\nusemtl red paint\nf 1 2 3\ng second\nf 1 2 4\nusemtl red paint\nf 2 3 4\n"
    );
    let scene = read_text("obj", text).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| &*o.name).collect();
    assert_eq!(names, ["scene", "first  one", "first  one", "second"]);
    let used: Vec<&str> = scene.objects.iter().map(|o| &*scene.materials[o.material].name).collect();
    assert_eq!(used, ["default", "default", "red paint", "red paint"]);
    assert_eq!(scene.objects[3].mesh.triangles.len(), 2);
    assert!(
        warnings(&scene).starts_with("scene.obj:8:1: a material is in no library"),
        "{}",
        warnings(&scene)
    );
}

#[test]
fn vertex_colours_and_weights() {
    let scene =
        read_text("obj", "v 0 0 0 1 .5 .25\nv 1 0 0\nv 0 1 0 2\nv 5 5 5 1 .1 .2 .3\nf 1 2 3\n").unwrap();
    assert_eq!(scene.objects[0].mesh.vertex_kd, [Rgb::new(1.0, 0.5, 0.25), Rgb::WHITE, Rgb::WHITE]);
}

#[test]
fn smoothing_follows_groups_or_else_the_angle() {
    // Two squares at a right angle.
    let fold = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 0 1 1\n";
    let faces = "f 1 2 3 4\nf 1 4 6 5\n";
    let normals = |head: &str| {
        read_text("obj", format!("{fold}{head}{faces}")).unwrap().objects[0].mesh.normals.clone()
    };
    assert!(normals("").is_empty() && normals("s off\n").is_empty());
    let smooth = normals("s 1\n");
    assert_eq!(smooth.len(), 6);
    assert!((smooth[0] - Vec3::new(1.0, 0.0, 1.0).normalize()).length() < 1e-6);
}

#[test]
fn materials_map_to_ours() {
    let scene = materials(
        "newmtl m\nKd .8 .4 .2\nKs .1 .1 .1\nNs 20\nKe 1 2 3\nillum 2\nKa 1 1 1\n\nnewmtl glass\nNi 1.33\nTf .9 1 1\nillum 7\nnewmtl mirror\nKd 0 0 0\nKs .9 .9 .9\nillum 3\nnewmtl shiny\nKd .5 0 0\nKs .4 .4 .4\nillum 3\nnewmtl veil\nKd .5 .5 .5\nTr .25\n",
    );
    let [m, glass, mirror, shiny, veil] = &scene.materials[..] else { panic!("{:?}", scene.materials) };
    assert_eq!((&*m.name, &*m.kind), ("m", "phong"));
    assert_eq!(value(m, "kd"), Some(&Value::triple([0.8, 0.4, 0.2])));
    assert_eq!(value(m, "exponent"), Some(&Value::from(20.0)));
    assert_eq!(value(m, "reflectivity"), Some(&Value::from(0.0)));
    assert_eq!(value(m, "emission"), Some(&Value::triple([1.0, 2.0, 3.0])));
    assert_eq!((&*glass.kind, value(glass, "eta")), ("dielectric", Some(&Value::from(1.33))));
    assert_eq!(value(glass, "tint"), Some(&Value::triple([0.9, 1.0, 1.0])));
    assert_eq!((&*mirror.kind, value(mirror, "reflectance")), ("mirror", Some(&Value::triple([0.9; 3]))));
    assert_eq!((&*shiny.kind, value(shiny, "reflectivity")), ("phong", Some(&Value::from(1.0))));
    assert_eq!(value(veil, "kt"), Some(&Value::triple([0.25; 3])));
    assert_eq!(value(veil, "kd"), Some(&Value::triple([0.375; 3])));
    assert_eq!(warnings(&scene), "");
    assert!(scene.build(&Default::default(), [0.0, 0.0], 1.0).is_ok());
}

fn write_picture(path: &Path, texel: Rgb) {
    let picture = bilux_pictures::Picture::from_rgb(2, 1, vec![texel, Rgb::WHITE]).unwrap();
    bilux_pictures::write(path, &picture, &Default::default()).unwrap();
}

#[test]
fn textures_are_found_tinted_and_kept_within_the_folder() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("inner");
    std::fs::create_dir(&folder).unwrap();
    write_picture(&folder.join("two words.png"), Rgb::BLACK);
    write_picture(&outer.path().join("secret.png"), Rgb::BLACK);
    let library = "newmtl m\nKd .5 1 1\nmap_Kd -blendu on -o .1 .2 -s 1 1 1 C:\\somewhere\\two words.png\nnewmtl n\nKd .3 .3 .3\nmap_Kd ../secret.png\nnewmtl o\nmap_Kd no.png\n";
    std::fs::write(folder.join("l.mtl"), library).unwrap();
    let path = folder.join("scene.obj");
    std::fs::write(&path, format!("mtllib l.mtl\n{SQUARE}usemtl m\nf 1 2 3\n")).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(value(&scene.materials[0], "kd"), Some(&Value::Texture(0)));
    assert!(scene.textures[0].texels().eq([Rgb::BLACK, Rgb::new(0.5, 1.0, 1.0)]));
    assert_eq!(value(&scene.materials[1], "kd"), Some(&Value::triple([0.3; 3])));
    let all = warnings(&scene);
    assert!(all.contains("l.mtl:6:1") && all.contains("outside the scene's folder"), "{all}");
    assert!(all.contains("l.mtl:8:1") && all.contains("no file 'no.png'"), "{all}");
    let open = ReadOptions { allow_outside: true, ..ReadOptions::default() };
    assert_eq!(value(&read(&path, &open).unwrap().materials[1], "kd"), Some(&Value::Texture(1)));
}

/// One row of two texels: a colour, then white.
fn old_picture(extension: &str, [r, g, b]: [u8; 3]) -> Vec<u8> {
    let row = [b, g, r, 255, 255, 255];
    match extension {
        "tga" => [&[0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0][..], &row].concat(),
        "bmp" => {
            let core = [12, 0, 0, 0, 2, 0, 1, 0, 1, 0, 24, 0];
            [b"BM\x22\0\0\0\0\0\0\0\x1a\0\0\0".as_slice(), &core, &row, &[0, 0]].concat()
        }
        _ => {
            // Width, height, bits, no packing, RGB, offset, channels, rows and bytes of the one strip.
            let tags: [[u16; 2]; 9] =
                [[256, 2], [257, 1], [258, 8], [259, 1], [262, 2], [273, 8], [277, 3], [278, 1], [279, 6]];
            let mut bytes = b"II*\0\x0e\0\0\0".to_vec();
            bytes.extend([r, g, b, 255, 255, 255, 9, 0]);
            for [tag, value] in tags {
                bytes.extend([tag, 3, 1, 0, value, 0].map(u16::to_le_bytes).as_flattened());
            }
            bytes.extend([0; 4]);
            bytes
        }
    }
}

#[test]
fn textures_of_older_formats_are_shown() {
    for extension in ["tga", "bmp", "tif"] {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
        write(&format!("t.{extension}"), &old_picture(extension, [255, 0, 51]));
        write("l.mtl", format!("newmtl m\nKd 1 1 1\nmap_Kd t.{extension}\n").as_bytes());
        write("s.obj", format!("mtllib l.mtl\n{SQUARE}usemtl m\nf 1 2 3\n").as_bytes());
        let toml = "[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = { texture = \"t.EXT\" }\n\
                    [[light]]\nkind = \"environment\"\nradiance = { texture = \"t.EXT\" }\n";
        write("s.toml", toml.replace("EXT", extension).as_bytes());
        let pbrt = "WorldBegin\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.EXT\"\n\
                    Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"disk\"\n";
        write("s.pbrt", pbrt.replace("EXT", extension).as_bytes());
        for scene in ["s.obj", "s.toml", "s.pbrt"] {
            let scene = read(&folder.path().join(scene), &ReadOptions::default()).unwrap();
            assert_eq!(warnings(&scene), "", "{extension}");
            let texture = &scene.textures[0];
            assert_eq!((texture.width(), texture.height()), (2, 1), "{extension}");
            let linear = bilux_math::colour::srgb_decode(0.2);
            assert_eq!(texture.texel(0, 0), Rgb::new(1.0, 0.0, linear), "{extension}");
            assert_eq!(texture.texel(1, 0), Rgb::WHITE);
            // In bytes, as it came.
            assert!(texture.image.is_bytes(), "{extension}");
        }
    }
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let cases = [
        ("v 0 0\n", "scene.obj:1:6: there are 2 numbers on this line, where 3"),
        ("v 0 0 zero\n", "scene.obj:1:7: 'zero' is no number"),
        ("v 0 0 0\nf 1 1 2\n", "scene.obj:2:1: this face names vertex 2, but the file has only 1"),
        ("v 0 0 0\nf 0 1 1\n", "scene.obj:2:3: '0' is no corner"),
        ("v 0 0 0\nf -2 1 1\n", "'-2' is no corner"),
        ("v 0 0 0\nf 1/ 1 1/1/1/1\n", "'1/1/1/1' is no corner"),
        ("v 0 0 0\nf 99999999999999999999 1 1\n", "is no corner"),
        ("v 0 0 0\ns maybe\n", "scene.obj:2:1: 'maybe' is no smoothing group"),
        ("v 0 0 0\n\u{1}\u{2}\u{3}\n", "is no statement"),
        ("# nothing\n", "there is no face in it: is this an OBJ file?"),
    ];
    for (text, part) in cases {
        let message = refusal("obj", text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
}

#[test]
fn a_face_can_do_without_the_uv_and_the_normal_that_it_names() {
    let scene = read_text("obj", format!("{SQUARE}f 1/1/1 2/2/1 3/3/1\n")).unwrap();
    assert!(scene.objects[0].mesh.uvs.is_empty());
    let all = warnings(&scene);
    assert!(
        all.starts_with("scene.obj:5:1: a face names texture coordinates or a normal")
            && all.contains("6 times")
    );
}

#[test]
fn memory_is_bounded() {
    let text = format!("{SQUARE}{}", "f 1 2 3\n".repeat(10_000));
    let little = ReadOptions { max_memory: 300_000, ..ReadOptions::default() };
    let error = bilux_formats::read_bytes(text.as_bytes(), "obj", None, "big.obj", &little).unwrap_err();
    assert!(error.to_string().starts_with("big.obj: reading it takes more than the 300000 bytes"), "{error}");
}
