//! Writes STL.

use super::binary::HEADER;
use bilux_import::FormatError;
use bilux_import::bytes::float::push_f32s;
use bilux_import::bytes::text::whole_file;
use bilux_import::output::bake::{corners, flat_normal, in_place, name_of, warn_of_materials, warn_of_scene};
use bilux_import::output::writing::Writing;
use bilux_math::Vec3;
use bilux_scene::{Mesh, SceneBuilder};

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    warn_of_scene(scene, "STL", writing);
    warn_of_materials(scene, "STL", writing);
    let ascii = writing.options.ascii;
    if !ascii {
        if scene.objects.len() > 1 {
            writing.warn("binary STL files hold one object: all objects are merged");
        }
        // Readers take a file that begins with 'solid' for text.
        writing.main = b"binary STL".to_vec();
        writing.main.resize(HEADER, b' ');
    }
    let mut count = 0usize;
    for object in &scene.objects {
        let mesh = in_place(object, writing);
        for (what, given) in
            [("normals of vertices", !mesh.normals.is_empty()), ("texture coordinates", !mesh.uvs.is_empty())]
        {
            if given {
                writing.warn(format!("STL files cannot store {what}: left out"));
            }
        }
        if !(mesh.vertex_kd.is_empty() && mesh.vertex_ks.is_empty()) {
            writing.warn("STL files cannot store colours: left out");
        }
        let out = &mut writing.main;
        match ascii {
            true => write_ascii(&mesh, name_of(object), out),
            false => count += write_binary(&mesh, out),
        }
    }
    if !ascii {
        let Ok(count) = u32::try_from(count) else {
            let message = "a binary STL file holds at most 4,294,967,295 triangles: write it as text";
            return Err(FormatError::malformed(message, whole_file(&writing.stem.as_str().into())));
        };
        writing.main[HEADER - 4..HEADER].copy_from_slice(&count.to_le_bytes());
    }
    Ok(())
}

fn facets(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 4]> {
    mesh.triangles.iter().filter_map(|&triangle| {
        let [a, b, c] = corners(mesh, triangle)?;
        Some([flat_normal([a, b, c]), a, b, c])
    })
}

fn write_binary(mesh: &Mesh, out: &mut Vec<u8>) -> usize {
    let mut count = 0;
    for facet in facets(mesh) {
        out.extend(facet.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes));
        out.extend([0; 2]);
        count += 1;
    }
    count
}

fn write_ascii(mesh: &Mesh, name: &str, out: &mut Vec<u8>) {
    let name = name.replace(['\n', '\r'], " ");
    out.extend_from_slice(format!("solid {name}\n").as_bytes());
    for [normal, corners @ ..] in facets(mesh) {
        out.extend_from_slice(b"facet normal ");
        push_f32s(out, &normal.to_array());
        out.extend_from_slice(b"\nouter loop\n");
        for corner in corners {
            out.extend_from_slice(b"vertex ");
            push_f32s(out, &corner.to_array());
            out.push(b'\n');
        }
        out.extend_from_slice(b"endloop\nendfacet\n");
    }
    out.extend_from_slice(format!("endsolid {name}\n").as_bytes());
}
