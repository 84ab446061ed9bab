//! OBJ and MTL files as exporters write them.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read};
use bilux_math::colour::srgb_decode;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::texture::Wrap;
use bilux_scene::{SceneBuilder, Spec, Value};
use std::path::Path;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Reads a library through a file that uses its first material.
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
fn texture_coordinates_may_be_negative_and_are_counted_backwards_too() {
    // The indices of the second face count back from its own line, past the lines in between.
    let text = format!(
        "{SQUARE}vt -0.25 0.5\nvt 1.5 -2\nvt .1 -.2\nvn 0 0 1\nvn 0 1 0\nf 1/-3/-2 2/-2/-2 3/-1/-2\nvt 7 7\nvn 1 0 0\n\
         f -4/-4/-2 -3/-3/-2 -2/-2/-2\nf 1/-1/-1 2/4/3 3/-4/1\n"
    );
    let mesh = read_text("obj", text).unwrap().objects[0].mesh.clone();
    let uvs = |face: usize| mesh.triangles[face].map(|i| mesh.uvs[i as usize]);
    let normals = |face: usize| mesh.triangles[face].map(|i| mesh.normals[i as usize]);
    let [a, b, c] = [Vec2::new(-0.25, 0.5), Vec2::new(1.5, -2.0), Vec2::new(0.1, -0.2)];
    assert_eq!((uvs(0), normals(0)), ([a, b, c], [Vec3::Z; 3]));
    assert_eq!((uvs(1), normals(1)), ([a, b, c], [Vec3::Y; 3]));
    assert_eq!((uvs(2), normals(2)), ([Vec2::splat(7.0), Vec2::splat(7.0), a], [Vec3::X, Vec3::X, Vec3::Z]));
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
fn concave_polygons_are_triangulated() {
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
        warnings(&scene)
            .starts_with("scene.obj:8:1: the material 'red paint' is not in any material library"),
        "{}",
        warnings(&scene)
    );
}

#[test]
fn vertex_colours_and_weights() {
    let scene =
        read_text("obj", "v 0 0 0 1 .5 .25\nv 1 0 0\nv 0 1 0 2\nv 5 5 5 1 .1 .2 .3\nf 1 2 3\n").unwrap();
    let shown = |r, g, b| Rgb::new(r, g, b).map(srgb_decode);
    assert_eq!(scene.objects[0].mesh.vertex_kd, [shown(1.0, 0.5, 0.25), Rgb::WHITE, Rgb::WHITE]);
    // After a weight, the colour is one column further.
    let scene = read_text("obj", "v 0 0 0\nv 1 0 0\nv 5 5 5 1 .1 .2 .3\nf 1 2 3\n").unwrap();
    assert_eq!(scene.objects[0].mesh.vertex_kd[2], shown(0.1, 0.2, 0.3));
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
    assert_eq!(value(veil, "opacity"), Some(&Value::from(0.75)));
    assert_eq!(value(veil, "kd"), Some(&Value::triple([0.5; 3])));
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
    // Half of the image to the right, with v upwards; a missing image becomes a checker.
    let texture = &scene.textures[0];
    let moved = texture.transform.unwrap().apply(Vec2::new(0.2, 0.6));
    assert!(moved.distance(Vec2::new(0.1 + 0.2, 0.4)) < 1e-6, "{moved}");
    assert_eq!(value(&scene.materials[1], "kd"), Some(&Value::Texture(1)));
    assert_eq!(scene.textures[1].texel(0, 0), Rgb::new(1.0, 0.0, 1.0));
    let all = warnings(&scene);
    assert!(all.contains("l.mtl:6:1") && all.contains("outside the scene's folder"), "{all}");
    assert!(all.contains("l.mtl:8:1") && all.contains("no file 'no.png'"), "{all}");
    let open = ReadOptions { allow_outside: true, ..ReadOptions::default() };
    assert_eq!(value(&read(&path, &open).unwrap().materials[1], "kd"), Some(&Value::Texture(1)));
}

/// A scene with one material, next to the images that the closure writes.
fn of_material(library: &str, pictures: impl FnOnce(&Path)) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    pictures(folder.path());
    std::fs::write(folder.path().join("l.mtl"), library).unwrap();
    let path = folder.path().join("scene.obj");
    std::fs::write(&path, format!("mtllib l.mtl\n{SQUARE}usemtl m\nf 1 2 3\n")).unwrap();
    read(&path, &ReadOptions::default()).unwrap()
}

#[test]
fn words_of_metal_and_roughness_make_a_principled_surface() {
    let library = "newmtl m\nKd .8 .4 .2\nNi 1.45\nPr .25\nPm 1\nPs .1\nPc .5\nPcr .05\naniso .7\nanisor .25\nKe 0 0 2\nd .5\n";
    let scene = of_material(library, |_| {});
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    let spec = &scene.materials[0];
    assert_eq!(spec.kind, "principled");
    for (key, wanted) in [
        ("base_metalness", 1.0),
        ("specular_roughness", 0.25),
        ("specular_ior", 1.45),
        ("fuzz_weight", 0.1),
        ("coat_weight", 0.5),
        ("coat_roughness", 0.05),
        ("specular_roughness_anisotropy", 0.7),
        ("anisotropy_rotation", 0.25),
        ("opacity", 0.5),
    ] {
        assert_eq!(value(spec, key), Some(&Value::from(wanted as f32)), "{key}");
    }
    assert_eq!(value(spec, "base_color"), Some(&Value::triple([0.8, 0.4, 0.2])));
    assert_eq!(value(spec, "emission"), Some(&Value::triple([0.0, 0.0, 2.0])));
    // Without a roughness, the exponent determines it; glass is smooth.
    let glass = of_material("newmtl m\nillum 7\nNs 6\nPm 0\nTf .9 1 1\n", |_| {});
    let said = |key| value(&glass.materials[0], key);
    assert_eq!(said("specular_roughness"), Some(&Value::from(0.5f32.sqrt())));
    assert_eq!(said("transmission_weight"), Some(&Value::from(1.0f32)));
    assert_eq!(said("transmission_color"), Some(&Value::triple([0.9, 1.0, 1.0])));
    assert!(glass.build(&Default::default(), [0.0, 0.0], 1.0).is_ok());
}

#[test]
fn a_principled_surface_comes_back() {
    use bilux_scene::{Texture, texture::UvTransform};
    use std::sync::Arc;
    let mut scene = materials("newmtl m\nPr 0\n");
    let mut picture = Texture::new("", 2, 1, vec![Rgb::grey(0.2), Rgb::WHITE], true);
    picture.transform = Some(UvTransform::new([0.25, -2.0], 0.0, [2.0, 3.0]));
    scene.textures.push(Arc::new(picture));
    let spec = Spec::new("m", "principled")
        .with("base_color", Rgb::new(0.5, 0.25, 1.0))
        .with("specular_roughness", Value::Texture(0))
        .with("coat_weight", 0.5f32)
        .with("coat_roughness", 0.25f32)
        .with("transmission_weight", 1.0f32)
        .with("transmission_color", Rgb::new(1.0, 0.5, 0.5))
        .with("normal", Value::Texture(0))
        .with("normal_scale", 0.5f32);
    scene.materials[scene.objects[0].material] = spec.clone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.obj");
    let lost = bilux_formats::write(&path, &scene, &Default::default()).unwrap();
    assert!(lost.is_empty(), "{lost:?}");
    let back = read(&path, &ReadOptions::default()).unwrap();
    let found = &back.materials[back.objects[0].material];
    assert_eq!(found.kind, "principled");
    for (key, wanted, _) in &spec.parameters.0 {
        match (value(found, key), wanted) {
            (Some(Value::Texture(index)), Value::Texture(_)) => {
                let texture = &back.textures[*index];
                for uv in [Vec2::new(0.1, 0.3), Vec2::new(0.7, 0.9)] {
                    let (a, b) = (texture.at(uv).r, scene.textures[0].at(uv).r);
                    assert!((a - b).abs() < 0.004, "{key}: {a} {b}");
                }
            }
            (found, wanted) => assert_eq!(found, Some(wanted), "{key}"),
        }
    }
}

#[test]
fn options_may_follow_the_file_name() {
    let picture = |name: &str, options: [&str; 2]| {
        let library = format!("newmtl m\nKd .5 .5 .5\nmap_Kd {}{name}{}\n", options[0], options[1]);
        let scene = of_material(&library, |folder| write_picture(&folder.join("a -b.png"), Rgb::BLACK));
        assert_eq!(warnings(&scene), "", "{library}");
        scene.textures[0].clone()
    };
    let options = " -s 2 3 1 -clamp on -o .1 .2";
    let [before, after] =
        [["-s 2 3 1 -clamp on -o .1 .2 ", ""], ["", options]].map(|o| picture("a -b.png", o));
    assert_eq!((before.transform, before.wrap), (after.transform, after.wrap));
    assert_eq!(picture("a -b.png", ["-clamp on ", " -s 2 3 1 -o .1 .2 "]).transform, before.transform);
    // What is followed by more than options belongs to the name.
    let scene = of_material("newmtl m\nmap_Kd a -s 1.png\nmap_bump b.jpg -bm 1.5\n", |_| {});
    let said = warnings(&scene);
    assert!(said.contains("no file 'a -s 1.png'") && said.contains("no file 'b.jpg'"), "{said}");
}

#[test]
fn a_missing_texture_does_not_take_the_tint() {
    for tint in ["0 0 0", ".1 .1 .1"] {
        let scene = of_material(&format!("newmtl m\nKd {tint}\nmap_Kd no.png\n"), |_| {});
        assert_eq!(scene.textures[0].texel(0, 0), Rgb::new(1.0, 0.0, 1.0), "{tint}");
    }
}

#[test]
fn pictures_of_numbers_holes_light_and_bumps_are_read() {
    use bilux_pictures::{Picture, write as write_picture};
    let library = "newmtl m\nKe 3 3 3\nmap_Ke glow.png\nmap_Pr -clamp on rough.png\nmap_d -imfchan g holes.png\nbump -bm 0.5 up.png\n";
    let scene = of_material(library, |folder| {
        let grey =
            |pixels: &[f32]| Picture::from_rgb(4, 1, pixels.iter().map(|x| Rgb::grey(*x)).collect()).unwrap();
        for (name, picture) in [
            ("glow.png", grey(&[1.0, 0.0, 1.0, 0.0])),
            ("rough.png", grey(&[0.25; 4])),
            ("holes.png", Picture::from_rgb(1, 1, vec![Rgb::new(1.0, 0.0, 1.0)]).unwrap()),
            // A ramp that rises along u.
            ("up.png", grey(&[0.0, 0.05, 0.2, 0.6])),
        ] {
            write_picture(folder.join(name), &picture, &Default::default()).unwrap();
        }
    });
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    let spec = &scene.materials[0];
    let texture = |key: &str| match value(spec, key) {
        Some(Value::Texture(index)) => &*scene.textures[*index],
        other => panic!("{key}: {other:?}"),
    };
    assert_eq!(texture("emission").texel(0, 0), Rgb::WHITE);
    assert_eq!(value(spec, "emission_scale"), Some(&Value::triple([3.0; 3])));
    let rough = texture("specular_roughness");
    assert!(rough.is_data && rough.wrap == [Wrap::Clamp; 2]);
    assert!((rough.number(Vec2::splat(0.5)) - 0.537).abs() < 0.01, "as the file has it, not as light");
    assert_eq!(texture("opacity").number(Vec2::splat(0.5)), 0.0);
    // Where the height rises along u, the normal tilts the other way; at the end it falls.
    let normals = texture("normal");
    let lean = |x: usize| normals.texel(x, 0).r - 0.5;
    assert!(lean(1) < -0.03 && lean(2) < -0.05 && lean(3) > 0.05, "{} {} {}", lean(1), lean(2), lean(3));
    assert!((normals.texel(1, 0).g - 0.5).abs() < 0.01);
    assert!(scene.build(&Default::default(), [0.0, 0.0], 1.0).is_ok());
}

#[test]
fn bump_maps_of_normals_become_normal_maps_and_alpha_becomes_opacity() {
    use bilux_pictures::{Picture, write as write_picture};
    let scene = of_material("newmtl m\nKd 1 1 1\nmap_Bump -bm 2 n.png\nmap_d leaf.png\n", |folder| {
        let blue = Picture::from_rgb(1, 1, vec![Rgb::new(0.25, 0.2, 1.0)]).unwrap();
        write_picture(folder.join("n.png"), &blue, &Default::default()).unwrap();
        let mut leaf = Picture::from_rgb(1, 1, vec![Rgb::WHITE]).unwrap();
        leaf.push_channel("A", vec![0.25]).unwrap();
        write_picture(folder.join("leaf.png"), &leaf, &Default::default()).unwrap();
    });
    let spec = &scene.materials[0];
    assert_eq!(value(spec, "normal_scale"), Some(&Value::from(2.0f32)));
    let Some(Value::Texture(index)) = value(spec, "opacity") else { panic!("no holes") };
    let opacity = scene.textures[*index].number(Vec2::splat(0.5));
    assert!((opacity - 0.25).abs() < 0.01, "{opacity}");
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
            // Width, height, bits, no compression, RGB, offset, channels, rows and bytes of the single strip.
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
            // As 8-bit texels, unchanged.
            assert!(texture.image.is_bytes(), "{extension}");
        }
    }
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let cases = [
        ("v 0 0\n", "scene.obj:1:6: this line has 2 numbers, but needs 3"),
        ("v 0 0 zero\n", "scene.obj:1:7: 'zero' is not a number"),
        ("v 0 0 0\nf 1 1 2\n", "scene.obj:2:1: this face refers to vertex 2, but the file has only 1"),
        ("v 0 0 0\nf 0 1 1\n", "scene.obj:2:3: '0' is not a corner"),
        ("v 0 0 0\nf -2 1 1\n", "'-2' is not a corner"),
        ("v 0 0 0\nf 1/ 1 1/1/1/1\n", "'1/1/1/1' is not a corner"),
        ("v 0 0 0\nf 99999999999999999999 1 1\n", "is not a corner"),
        ("v 0 0 0\ns maybe\n", "scene.obj:2:1: 'maybe' is not a smoothing group"),
        ("v 0 0 0\n\u{1}\u{2}\u{3}\n", "is not a statement"),
        ("# nothing\n", "the file has no faces and no vertices: is this an OBJ file?"),
    ];
    for (text, part) in cases {
        let message = refusal("obj", text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
}

#[test]
fn one_bad_number_costs_its_element_and_not_the_file() {
    let text = format!(
        "{SQUARE}v 1.O 0 0\nvn 0 0 up\nf 1 2 3\nf 1 2 5\nf 1/x 2 3\nf 1 2 77\nf 1 2 -99\nf 4/ 1/1/1/1 2\ns maybe\nf 2 3 4\n"
    );
    let scene = read_text("obj", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    let is_seen = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).length() > 0.0
    };
    assert_eq!(mesh.triangles.iter().filter(is_seen).count(), 2);
    assert_eq!(
        warnings(&scene).lines().collect::<Vec<_>>(),
        [
            "scene.obj:5:3: '1.O' is not a number: this vertex is left out, together with the faces that use it",
            "scene.obj:6:8: 'up' is not a number: this normal or texture coordinate is set to 0",
            "scene.obj:9:3: '1/x' is not a corner of a face, which is written vertex, vertex/uv, vertex//normal or \
             vertex/uv/normal, each counted from 1, or backwards from -1: this face is left out (3 times; this is the first)",
            "scene.obj:11:7: '-99' is not a corner of a face, which is written vertex, vertex/uv, vertex//normal or \
             vertex/uv/normal, each counted from 1, or backwards from -1: this face counts back to a missing vertex, and is left out",
            "scene.obj:13:1: 'maybe' is not a smoothing group: write a number or 'off': this line is left out",
        ]
    );
}

#[test]
fn a_face_can_do_without_the_uv_and_the_normal_that_it_names() {
    let scene = read_text("obj", format!("{SQUARE}f 1/1/1 2/2/1 3/3/1\n")).unwrap();
    assert!(scene.objects[0].mesh.uvs.is_empty());
    let all = warnings(&scene);
    assert!(
        all.starts_with("scene.obj:5:1: a face refers to texture coordinates or a normal")
            && all.contains("6 times")
    );
}

#[test]
fn memory_is_bounded() {
    let text = format!("{SQUARE}{}", "f 1 2 3\n".repeat(10_000));
    let little = ReadOptions { max_memory: 300_000, ..ReadOptions::default() };
    let error = bilux_formats::read_bytes(text.as_bytes(), "obj", None, "big.obj", &little).unwrap_err();
    assert!(
        error.to_string().starts_with("big.obj: reading this takes more than the 300000 bytes"),
        "{error}"
    );
}

/// Blender writes a specular level and a roughness, and says who it is: `Ks` 0.5 reflects 4% [Burley 2012], and `Ns` is 1000 or 900 times
/// (1 - r)². Two materials, of which one is a metal; the same lines of other programs stay Phong's.
#[test]
fn specular_levels_of_blender_are_no_mirrors() {
    let lines = "newmtl plain\nNs 250\nKa 1 1 1\nKd .2 .1 .05\nKs .5 .5 .5\nNi 1.45\nd 1\nillum 2\n\
                 newmtl metal\nNs 40\nKa .75 .75 .75\nKd .8 .4 .2\nKs .25 .25 .25\nNi 1.45\nd .5\nillum 3\n\
                 newmtl veiled\nNs 40\nKa .5 .5 .5\nKd .8 .4 .2\nKs .25 .25 .25\nNi 1.45\nd .5\nillum 6\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let face =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl plain\nf 1 2 3\nusemtl metal\nf 1 3 2\nusemtl veiled\nf 2 1 3\n";
    std::fs::write(&path, format!("mtllib a.mtl\n{face}")).unwrap();
    let materials = |first: &str| {
        std::fs::write(folder.path().join("a.mtl"), format!("{first}\n{lines}")).unwrap();
        read(&path, &ReadOptions::default()).unwrap().materials
    };
    for (first, smooth) in
        [("# Blender 4.1.0 MTL File: 'a.blend'", 1000.0f32), ("# Blender MTL File: 'a.blend'", 900.0)]
    {
        let [plain, metal, veiled] = &materials(first)[..3] else { panic!() };
        let near = |spec: &Spec, key: &str, wanted: f32| {
            let found = spec.number(key).unwrap();
            assert!((found - wanted).abs() < 1e-5, "{first}, {key}: {found}, not {wanted}");
        };
        assert_eq!(
            (&*plain.kind, plain.colour("base_color")),
            ("principled", Some(Rgb::new(0.2, 0.1, 0.05)))
        );
        // 4% is an index of 1.5, and 2% one of 1.3294.
        near(plain, "specular_ior", 1.5);
        near(plain, "specular_roughness", 1.0 - (250.0 / smooth).sqrt());
        assert_eq!(plain.number("base_metalness"), None);
        near(metal, "specular_ior", 1.329_431_3);
        near(metal, "specular_roughness", 1.0 - (40.0 / smooth).sqrt());
        near(metal, "base_metalness", 0.75);
        near(veiled, "base_metalness", 0.5);
        near(metal, "opacity", 0.5);
    }
    for first in ["# Exported by another program", "", "# not Blender"] {
        assert_eq!(materials(first)[0].kind, "phong", "{first}");
    }
}
