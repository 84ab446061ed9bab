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
