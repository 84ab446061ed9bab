//! Writes OBJ.

use super::mtl_write::{one_line, write_library};
use bilux_import::FormatError;
use bilux_import::bytes::float::push_f32s;
use bilux_import::geometry::colours::encoded;
use bilux_import::output::bake::{in_place, name_of, warn_of_scene};
use bilux_import::output::writing::Writing;
use bilux_import::world::frame::statement;
use bilux_scene::{Mesh, SceneBuilder};
use std::io::Write;

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    warn_of_scene(scene, "OBJ", writing);
    if let Some(said) = statement(scene) {
        writing.main.extend_from_slice(format!("# {said}\n").as_bytes());
    }
    let names = write_library(scene, writing)?;
    let mut counts = Counts { positions: 1, uvs: 1, normals: 1 };
    for object in &scene.objects {
        let out = &mut writing.main;
        let name = one_line(name_of(object));
        out.extend_from_slice(format!("o {name}\n").as_bytes());
        if let Some(Some(material)) = names.get(object.material) {
            out.extend_from_slice(format!("usemtl {material}\n").as_bytes());
        }
        let mesh = in_place(object, writing);
        if !mesh.vertex_ks.is_empty() {
            writing.warn("OBJ files cannot store ks of vertices: left out");
        }
        vertices(&mesh, &mut writing.main);
        faces(&mesh, &mut counts, &mut writing.main);
    }
    Ok(())
}

/// The indices at which the next object starts.
struct Counts {
    positions: usize,
    uvs: usize,
    normals: usize,
}

fn vertices(mesh: &Mesh, out: &mut Vec<u8>) {
    let mut line = |key: &str, numbers: &[&[f32]]| {
        out.extend_from_slice(key.as_bytes());
        for part in numbers.iter().filter(|part| !part.is_empty()) {
            out.push(b' ');
            push_f32s(out, part);
        }
        out.push(b'\n');
    };
    for (i, p) in mesh.positions.iter().enumerate() {
        let colour = mesh.vertex_kd.get(i).copied().map(encoded);
        line("v", &[&p.to_array(), colour.as_ref().map_or(&[], |c| &c[..])]);
    }
    mesh.uvs.iter().for_each(|uv| line("vt", &[&uv.to_array()]));
    mesh.normals.iter().for_each(|n| line("vn", &[&n.to_array()]));
}

fn faces(mesh: &Mesh, counts: &mut Counts, out: &mut Vec<u8>) {
    if mesh.normals.is_empty() {
        // Otherwise readers would smooth flat faces.
        out.extend_from_slice(b"s off\n");
    }
    let (uv, normal) = (!mesh.uvs.is_empty(), !mesh.normals.is_empty());
    for triangle in &mesh.triangles {
        out.push(b'f');
        for i in triangle.map(|i| i as usize) {
            let (v, t, n) = (counts.positions + i, counts.uvs + i, counts.normals + i);
            // Writing to a Vec cannot fail.
            let _ = match (uv, normal) {
                (true, true) => write!(out, " {v}/{t}/{n}"),
                (true, false) => write!(out, " {v}/{t}"),
                (false, true) => write!(out, " {v}//{n}"),
                (false, false) => write!(out, " {v}"),
            };
        }
        out.push(b'\n');
    }
    for point in &mesh.points {
        out.extend_from_slice(format!("p {}\n", counts.positions + *point as usize).as_bytes());
    }
    for line in &mesh.lines {
        let [a, b] = line.map(|i| counts.positions + i as usize);
        out.extend_from_slice(format!("l {a} {b}\n").as_bytes());
    }
    counts.positions += mesh.positions.len();
    counts.uvs += mesh.uvs.len();
    counts.normals += mesh.normals.len();
}
