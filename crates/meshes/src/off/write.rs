//! Writes OFF.

use super::columns::{Columns, FLAT_COMMENT};
use bilux_import::FormatError;
use bilux_import::bytes::float::push_f32s;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::colours::encoded;
use bilux_import::output::bake::{in_place, warn_of_materials, warn_of_scene};
use bilux_import::output::writing::Writing;
use bilux_import::world::frame::statement;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, SceneBuilder};
use std::borrow::Cow;

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    warn_of_scene(scene, "OFF", writing);
    warn_of_materials(scene, "OFF", writing);
    if scene.objects.len() > 1 {
        writing.warn("OFF files hold one object: all objects are merged");
    }
    let meshes: Vec<Cow<Mesh>> = scene.objects.iter().map(|object| in_place(object, writing)).collect();
    if meshes.iter().any(|mesh| !mesh.vertex_ks.is_empty()) {
        writing.warn("OFF files cannot store specular colours: left out");
    }
    let vertices: usize = meshes.iter().map(|mesh| mesh.positions.len()).sum();
    if u32::try_from(vertices).is_err() {
        let message = "an OFF file holds at most 4,294,967,295 vertices: split the scene";
        return Err(FormatError::malformed(message, whole_file(&writing.stem.as_str().into())));
    }
    let columns = Columns {
        normals: meshes.iter().any(|mesh| !mesh.normals.is_empty()),
        colours: meshes.iter().any(|mesh| !mesh.vertex_kd.is_empty()),
        uvs: meshes.iter().any(|mesh| !mesh.uvs.is_empty()),
    };
    let faces: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    push_header(columns, [vertices, faces], statement(scene), &mut writing.main);
    for mesh in &meshes {
        (0..mesh.positions.len()).for_each(|i| push_vertex(columns, mesh, i, &mut writing.main));
    }
    let mut first = 0;
    for mesh in &meshes {
        for [a, b, c] in mesh.triangles.iter().map(|triangle| triangle.map(|i| i + first)) {
            writing.main.extend_from_slice(format!("3 {a} {b} {c}\n").as_bytes());
        }
        first += mesh.positions.len() as u32;
    }
    Ok(())
}

fn push_header(columns: Columns, [vertices, faces]: [usize; 2], comment: Option<String>, out: &mut Vec<u8>) {
    let prefix = |given: bool, prefix: &'static str| if given { prefix } else { "" };
    let (uvs, colours) = (prefix(columns.uvs, "ST"), prefix(columns.colours, "C"));
    out.extend_from_slice(format!("{uvs}{colours}{}OFF\n", prefix(columns.normals, "N")).as_bytes());
    if let Some(said) = comment {
        out.extend_from_slice(format!("# {said}\n").as_bytes());
    }
    if !columns.normals {
        // Otherwise Bilux's reader would smooth flat faces.
        out.extend_from_slice(&[b"# ", FLAT_COMMENT, b"\n"].concat());
    }
    out.extend_from_slice(format!("{vertices} {faces} 0\n").as_bytes());
}

fn push_vertex(columns: Columns, mesh: &Mesh, i: usize, out: &mut Vec<u8>) {
    push_f32s(out, &mesh.positions[i].to_array());
    let mut more = |given: bool, values: &[f32]| {
        if given {
            out.push(b' ');
            push_f32s(out, values);
        }
    };
    // If one mesh has a column, all do; a zero normal stands for a missing one.
    more(columns.normals, &mesh.normals.get(i).copied().unwrap_or(Vec3::ZERO).to_array());
    more(columns.colours, &encoded(mesh.vertex_kd.get(i).copied().unwrap_or(Rgb::WHITE)));
    more(columns.uvs, &mesh.uvs.get(i).copied().unwrap_or(Vec2::ZERO).to_array());
    out.push(b'\n');
}
