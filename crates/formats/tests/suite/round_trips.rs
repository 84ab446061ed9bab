//! Round trips: whatever a format can hold is preserved to the bit, except that colours are rounded where they are
//! written as sRGB.

use crate::shared_files::scenes;
use bilux_formats::{ReadOptions, SCENE_FORMATS, WriteOptions, read, write};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::path::Path;
use std::sync::Arc;

/// Every corner of every triangle, in order, as bits: everything that affects the image except colours.
pub(crate) fn corners(mesh: &Mesh) -> Vec<Vec<u32>> {
    let bits = |i: usize| {
        let mut all = mesh.positions[i].to_array().to_vec();
        all.extend(mesh.normals.get(i).into_iter().flat_map(|n| n.to_array()));
        all.extend(mesh.uvs.get(i).into_iter().flat_map(|uv| uv.to_array()));
        all.into_iter().map(f32::to_bits).collect()
    };
    mesh.triangles.iter().flatten().map(|&i| bits(i as usize)).collect()
}

/// Far below a 255th, which is what other programs keep.
const ROUNDED: f32 = 1e-6;

/// Asserts that the corners of all triangles have the same colours.
#[track_caller]
pub(crate) fn assert_same_colours(a: &Mesh, b: &Mesh) {
    let lists: [fn(&Mesh) -> Vec<Rgb>; 2] = [|mesh| mesh.vertex_kd.clone(), |mesh| mesh.vertex_ks.clone()];
    for of in lists {
        let at = |mesh: &Mesh, colours: &[Rgb]| -> Vec<Rgb> {
            let corners = mesh.triangles.iter().flatten();
            corners.filter_map(|&i| colours.get(i as usize).copied()).collect()
        };
        let (a, b) = (at(a, &of(a)), at(b, &of(b)));
        assert_eq!(a.len(), b.len());
        let off = a.iter().zip(&b).map(|(a, b)| (*a - *b).map(f32::abs).max_channel()).fold(0.0, f32::max);
        assert!(off < ROUNDED, "colours are off by {off}");
    }
}

#[track_caller]
fn assert_same(a: &SceneBuilder, b: &SceneBuilder, what: &str) {
    assert_eq!(a.objects.len(), b.objects.len(), "{what}");
    for (a_object, b_object) in a.objects.iter().zip(&b.objects) {
        assert!(corners(&a_object.mesh) == corners(&b_object.mesh), "{what}: a mesh differs");
        assert_same_colours(&a_object.mesh, &b_object.mesh);
        let material = |scene: &SceneBuilder, index: usize| {
            let spec = &scene.materials[index];
            let values: Vec<_> = spec.parameters.0.iter().map(|(k, v, _)| (k.clone(), v.clone())).collect();
            (spec.kind.clone(), values)
        };
        assert_eq!(material(a, a_object.material), material(b, b_object.material), "{what}");
    }
}

fn there(scene: &SceneBuilder, path: &Path) -> SceneBuilder {
    let warnings = write(path, scene, &WriteOptions::default()).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    read(path, &ReadOptions::default()).unwrap()
}

#[test]
fn asc_to_obj_to_asc_loses_nothing() {
    let Some(root) = scenes() else { return };
    let folder = tempfile::tempdir().unwrap();
    for name in ["ext_object_config", "floor_crlf", "teapot_cr", "teapot_floor_cr", "teapot_lf"] {
        let original = read(&root.join(format!("asc/{name}.asc")), &ReadOptions::default()).unwrap();
        let as_obj = there(&original, &folder.path().join(format!("{name}.obj")));
        let back = there(&as_obj, &folder.path().join(format!("{name}.asc")));
        assert_same(&original, &back, name);
        let vertices = |s: &SceneBuilder| s.objects.iter().map(|o| o.mesh.positions.len()).sum::<usize>();
        assert_eq!(vertices(&original), vertices(&back));
    }
}

#[test]
fn obj_comes_back_from_obj() {
    let Some(root) = scenes() else { return };
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "spot.obj",
        "teapot.obj",
        "tinyobj/cornell_box.obj",
        "tinyobj/cube-vertexcol.obj",
        "tinyobj/issue-138.obj",
    ] {
        let original = read(&root.join("obj").join(name), &ReadOptions::default()).unwrap();
        let back = there(&original, &folder.path().join("out.obj"));
        assert_same(&original, &back, name);
        let names = |s: &SceneBuilder| s.objects.iter().map(|o| o.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&original), names(&back));
    }
}

#[test]
fn ply_and_stl_come_back_as_text_and_as_binary() {
    let Some(root) = scenes() else { return };
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("ply/trimesh/suzanne.ply", "out.ply"),
        ("ply/trimesh/fuze.ply", "out.ply"),
        ("ply/assimp/float-color.ply", "out.ply"),
        ("stl/assimp/Spider_ascii.stl", "out.stl"),
        ("stl/trimesh/featuretype.STL", "out.stl"),
    ];
    for (name, out) in cases {
        let mut original = read(&root.join(name), &ReadOptions::default()).unwrap();
        if name.contains("fuze") {
            // Its texture is missing, and PLY files store none.
            original.materials[0].parameters.set("kd", 1.0f32);
        }
        for ascii in [false, true] {
            let path = folder.path().join(out);
            let warnings = write(&path, &original, &WriteOptions { ascii }).unwrap();
            assert!(warnings.is_empty() || name.contains("Spider"), "{name}: {warnings:?}");
            let back = read(&path, &ReadOptions::default()).unwrap();
            if name.contains("Spider") && !ascii {
                continue;
            }
            assert_same(&original, &back, name);
        }
    }
}

#[test]
fn specular_colours_come_back_from_ply() {
    let mut text = "triangle\n".to_owned();
    for corner in ["0 0 0", "1 0 0", "0 1 0"] {
        text.push_str(&format!("{corner} 0 0 1 0 0 .1 .2 .3 .4 .5 .6\n"));
    }
    let original = crate::read_text("asc", text).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let as_ply = there(&original, &folder.path().join("a.ply"));
    assert_same(&original, &there(&as_ply, &folder.path().join("a.asc")), "ks");
    assert_same_colours(&original.objects[0].mesh, &as_ply.objects[0].mesh);
}

/// Attributes that vertices can have, by the names that rows of the table of formats use.
const ATTRIBUTES: &[&str] = &["normals", "uv", "vertex-kd"];

/// Two closed meshes whose vertices have one thing more than positions.
fn pair(attribute: &str) -> SceneBuilder {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let mut mesh = Mesh {
        positions: corners.map(|p| p * 0.7 + 0.1).to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        ..Mesh::default()
    };
    match attribute {
        "normals" => mesh.normals = [-Vec3::ONE, Vec3::X, Vec3::Y, Vec3::Z].map(Vec3::normalize).to_vec(),
        "uv" => mesh.uvs = corners.map(|p| Vec2::new(p.x + 0.25 * p.z, 0.5 * p.y)).to_vec(),
        // Bytes of sRGB hold these exactly.
        _ => mesh.vertex_kd = corners.map(|p| Rgb::from_array(p.to_array())).to_vec(),
    }
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(bilux_scene::Spec::new("m", "phong").with("kd", 1.0f32));
    for name in ["one", "two"] {
        let mesh = Mesh { name: name.to_owned(), ..mesh.clone() };
        scene.objects.push(Object::new(name, Arc::new(mesh), material));
    }
    scene
}

/// The corners of all triangles: where they are in metres with y up, and what else they have.
fn all_corners(scene: &SceneBuilder, attribute: &str) -> (Vec<Vec3>, Vec<Vec3>) {
    let is_print = scene.unit == 0.001;
    let in_metres = |p: Vec3| if is_print { Vec3::new(p.x, p.z, -p.y) * 0.001 } else { p };
    let (mut places, mut values) = (Vec::new(), Vec::new());
    for Object { mesh, motion, .. } in &scene.objects {
        let place = motion.at(0.0);
        for i in mesh.triangles.iter().flatten().map(|&i| i as usize) {
            places.push(in_metres(place.point(mesh.positions[i])));
            values.extend(match attribute {
                "normals" => mesh.normals.get(i).copied(),
                "uv" => mesh.uvs.get(i).map(|uv| uv.extend(0.0)),
                _ => mesh.vertex_kd.get(i).map(|kd| Vec3::from(kd.to_array())),
            });
        }
    }
    (places, values)
}

/// Whatever can be written keeps positions, and of the rest what its row of the table says, and nothing else.
#[test]
fn every_format_that_is_written_keeps_what_its_row_says() {
    let folder = tempfile::tempdir().unwrap();
    let are_alike = |a: &[Vec3], b: &[Vec3]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (*a - *b).abs().max_element() < 1e-6)
    };
    let mut wrong = Vec::new();
    for row in SCENE_FORMATS.iter().filter(|row| row.writes()) {
        let has = |what: &str| row.capabilities.iter().any(|known| known == &what || known == &"models");
        for (extension, attribute) in
            row.extensions.iter().flat_map(|e| ATTRIBUTES.iter().map(move |a| (e, a)))
        {
            let original = pair(attribute);
            let path = folder.path().join(format!("{attribute}.{extension}"));
            write(&path, &original, &WriteOptions::default()).unwrap();
            let back = read(&path, &ReadOptions::default()).unwrap();
            let [(places, values), (places_back, values_back)] =
                [&original, &back].map(|scene| all_corners(scene, attribute));
            let what = format!("{attribute} of .{extension}");
            if !are_alike(&places, &places_back) {
                wrong.push(format!("positions with {what}: {places_back:?} for {places:?}"));
            }
            // 3MF has texture coordinates for its textures only.
            let keeps = has(attribute) && !(row.entry.name == "3mf" && *attribute == "uv");
            if are_alike(&values, &values_back) != keeps {
                wrong.push(format!("{what}: {values_back:?} for {values:?}"));
            }
            if has("objects") && back.objects.len() != 2 {
                wrong.push(format!("{what}: {} objects", back.objects.len()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
