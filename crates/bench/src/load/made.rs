//! The files to read if none are given: a wavy square in each format, and a box with very many instances.

use bilux::Error;
use bilux::formats::{FormatError, WriteOptions, write};
use bilux::math::transcendental::{cos, powf_f64, sin};
use bilux::math::{Vec2, Vec3};
use bilux::scene::{Mesh, Object, SceneBuilder};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The formats, and the bytes per vertex in each, including its two triangles; of 3MF, before they are packed.
const FORMATS: [(&str, f64); 5] =
    [("glb", 56.0), ("obj", 222.0), ("ply", 58.0), ("usda", 125.0), ("3mf", 149.0)];

/// Writes a GLB, an OBJ, a PLY, a USDA and a 3MF of about `bytes` bytes each, the last one before it is packed, and a GLB with this many
/// instances; returns their paths.
///
/// # Errors
/// If a file cannot be written.
pub fn make(folder: &Path, bytes: u64, instances: u32) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for (extension, per_vertex) in FORMATS {
        let side = (bytes as f64 / per_vertex).sqrt().max(2.0) as u32;
        let mut scene = SceneBuilder::default();
        scene.add_material(bilux::scene::Spec::new("plain", "diffuse"));
        scene.objects.push(Object::new("waves", Arc::new(waves(side)), 0));
        let path = folder.join(format!("waves.{extension}"));
        write(&path, &scene, &WriteOptions::default())?;
        files.push(path);
    }
    let path = folder.join("instances.glb");
    let failed = |source| FormatError::Io { path: path.clone(), action: "write it", source };
    fs::write(&path, boxes(instances)).map_err(failed)?;
    files.push(path);
    Ok(files)
}

/// A square with `side` vertices in each direction, with normals and texture coordinates.
fn waves(side: u32) -> Mesh {
    let step = 1.0 / (side - 1) as f32;
    let places = (0..side * side).map(|i| Vec2::new((i % side) as f32 * step, (i / side) as f32 * step));
    let mut mesh = Mesh::default();
    for uv in places {
        let (x, z) = (uv.x * 40.0, uv.y * 40.0);
        mesh.positions.push(Vec3::new(uv.x, 0.02 * sin(x) * cos(z), uv.y));
        let slope = Vec3::new(-0.8 * cos(x) * cos(z), 1.0, 0.8 * sin(x) * sin(z));
        mesh.normals.push(slope.normalize());
        mesh.uvs.push(uv);
    }
    for row in 0..side - 1 {
        for a in (row * side..).take(side as usize - 1) {
            mesh.triangles.extend([[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]);
        }
    }
    mesh
}

/// A GLB with many instances of one box, by `EXT_mesh_gpu_instancing`.
fn boxes(count: u32) -> Vec<u8> {
    let side = powf_f64(f64::from(count), 1.0 / 3.0).ceil() as u32;
    let mut binary = Vec::new();
    let mut floats = |list: &mut dyn Iterator<Item = f32>| {
        let start = binary.len();
        list.for_each(|x| binary.extend(x.to_le_bytes()));
        [start, binary.len() - start]
    };
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| bit as f32 * 0.5);
    let corners = floats(&mut (0..8).flat_map(corner));
    let place = |i: u32| [i % side, i / side % side, i / side / side].map(|k| k as f32);
    let places = floats(&mut (0..count).flat_map(place));
    let quads: [[u16; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let indices = [binary.len(), 72];
    for [a, b, c, d] in quads {
        [a, b, c, a, c, d].iter().for_each(|i| binary.extend(i.to_le_bytes()));
    }
    let view =
        |[start, length]: [usize; 2]| json!({ "buffer": 0, "byteOffset": start, "byteLength": length });
    let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } } });
    let text = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "extensions": instancing }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 2 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [0.5, 0.5, 0.5] },
            { "bufferView": 1, "componentType": 5126, "count": count, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5123, "count": 36, "type": "SCALAR" },
        ],
        "bufferViews": [view(corners), view(places), view(indices)],
        "buffers": [{ "byteLength": binary.len() }],
    });
    let mut text = text.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let whole = 12 + 8 + text.len() + 8 + binary.len();
    let head = [b"glTF".as_slice(), &word(2), &word(whole), &word(text.len()), b"JSON"].concat();
    [head, text, word(binary.len()).to_vec(), b"BIN\0".to_vec(), binary].concat()
}
