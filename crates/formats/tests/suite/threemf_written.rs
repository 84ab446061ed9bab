//! 3MF as it is written.

use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::{Rgb, Transform, Vec2, Vec3};
use bilux_scene::texture::Filter;
use bilux_scene::{Axis, Mesh, Object, SceneBuilder, Spec, Texture, UpHint, Value};
use std::sync::Arc;

/// A box with corners of their own on each side, as most files have them.
fn box_of(size: Vec3) -> Mesh {
    let mut mesh = Mesh { name: "box".into(), ..Mesh::default() };
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let normal = Vec3::AXES[axis] * sign;
            let (u, v) = (Vec3::AXES[(axis + 1) % 3] * sign, Vec3::AXES[(axis + 2) % 3]);
            let side = Mesh::quad((normal - u - v) * 0.5, u, v);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(side.positions.iter().map(|p| *p * size));
            mesh.uvs.extend(side.uvs);
            mesh.triangles.extend(side.triangles.iter().map(|t| t.map(|i| first + i)));
        }
    }
    mesh
}

fn there(scene: &SceneBuilder) -> (SceneBuilder, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.3mf");
    let said = write(&path, scene, &WriteOptions::default()).unwrap();
    let back = read(&path, &ReadOptions { strict: true, ..ReadOptions::default() }).unwrap();
    (back, said.into_iter().map(|warning| warning.message).collect())
}

fn dressed(spec: Spec, mesh: Mesh) -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(spec);
    scene.objects.push(Object::new("a", Arc::new(mesh), material));
    scene
}

fn size(scene: &SceneBuilder) -> Vec3 {
    scene.bounds(0.0).extent()
}

/// Metres with y upwards become millimetres with z upwards; files that state neither are taken as slicers take them.
#[test]
fn units_and_axes_are_those_of_printing() {
    let mut scene = dressed(Spec::new("default", "phong"), box_of(Vec3::new(0.01, 0.02, 0.03)));
    let (back, said) = there(&scene);
    assert!(said.is_empty(), "{said:?}");
    assert_eq!((back.unit, back.up, back.objects.len()), (0.001, UpHint::Is(Axis::Z), 1));
    assert!((size(&back) - Vec3::new(10.0, 30.0, 20.0)).length() < 1e-4, "{}", size(&back));
    // The highest point stays the highest.
    scene.objects[0] = scene.objects[0].clone().placed(Transform::translate(Vec3::Y).unwrap());
    assert!((there(&scene).0.bounds(0.0).max.z - 1010.0).abs() < 1e-2);
    scene.up = UpHint::Usually(Axis::Z);
    assert!((size(&there(&scene).0) - Vec3::new(0.01, 0.02, 0.03)).length() < 1e-6);
    (scene.up, scene.unit) = (UpHint::Is(Axis::Z), 0.0254);
    assert!((size(&there(&scene).0) - Vec3::new(0.254, 0.508, 0.762)).length() < 1e-5);
}

#[test]
fn corners_are_shared_and_open_meshes_are_named() {
    let (back, _) = there(&dressed(Spec::new("default", "phong"), box_of(Vec3::ONE)));
    let mesh = &back.objects[0].mesh;
    assert!(mesh.is_closed() && mesh.triangles.len() == 12);
    let mut open = box_of(Vec3::ONE);
    open.triangles.pop();
    open.triangles.push([0, 0, 1]);
    let (back, said) = there(&dressed(Spec::new("default", "phong"), open));
    assert_eq!(back.objects[0].mesh.triangles.len(), 11);
    assert!(said.iter().any(|line| line.starts_with("1 of the 1 meshes are not closed")), "{said:?}");
    assert!(said.iter().any(|line| line.contains("corners coincide")), "{said:?}");
}

#[test]
fn colours_textures_and_copies_come_back() {
    let mut scene = dressed(
        Spec::new("red", "principled").with("base_color", Value::triple([1.0, 0.0, 0.0])),
        box_of(Vec3::ONE),
    );
    let second = scene.objects[0].clone().placed(Transform::translate(Vec3::X * 3.0).unwrap());
    scene.objects.push(second);
    let mut coloured = box_of(Vec3::ONE);
    coloured.vertex_kd = coloured.positions.iter().map(|p| Rgb::new(p.x + 0.5, 1.0, 0.0)).collect();
    let white = scene.add_material(Spec::new("white", "principled").with("base_color", 1.0));
    scene.objects.push(Object::new("coloured", Arc::new(coloured), white));
    scene.textures.push(Arc::new(Texture { filter: Filter::Linear, ..Texture::missing("t") }));
    let painted = scene.add_material(Spec::new("p", "principled").with("base_color", Value::Texture(0)));
    scene.objects.push(Object::new("painted", Arc::new(box_of(Vec3::ONE)), painted));
    let (back, _) = there(&scene);
    assert!(Arc::ptr_eq(&back.objects[0].mesh, &back.objects[1].mesh));
    assert_eq!(back.objects.len(), 4);
    let of = |i: usize| &back.materials[back.objects[i].material];
    assert_eq!(of(0).colour("base_color"), Some(Rgb::new(1.0, 0.0, 0.0)));
    let mesh = &back.objects[2].mesh;
    let off =
        mesh.positions.iter().zip(&mesh.vertex_kd).map(|(p, c)| (c.r - p.x - 0.5).abs() + (c.g - 1.0).abs());
    assert!(!mesh.vertex_kd.is_empty() && off.fold(0.0, f32::max) < 1e-5);
    let Some((Value::Texture(index), _)) = of(3).parameters.find("base_color") else { panic!("no texture") };
    let (a, b) = (&scene.textures[0], &back.textures[*index]);
    let at = Vec2::new(0.3, 0.9);
    assert_eq!(a.at_one(at), b.at_one(at));
    let corners =
        |mesh: &Mesh| -> f32 { mesh.triangles.iter().flatten().map(|&i| mesh.uvs[i as usize].y).sum() };
    assert_eq!(corners(&back.objects[3].mesh), corners(&scene.objects[3].mesh));
}
