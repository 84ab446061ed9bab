//! Meshes as the bytes of a PLY file: for files of that format, and beside the scenes of others.

use crate::bytes::float::push_f32s;
use crate::geometry::colours::{as_bytes, encoded};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;

/// Encodes meshes merged into one, with a comment; `None` if there are too many vertices.
pub fn encode(meshes: &[&Mesh], ascii: bool, comment: Option<&str>) -> Option<Vec<u8>> {
    let columns = Columns::of(meshes);
    let vertices: usize = meshes.iter().map(|m| m.positions.len()).sum();
    let triangles: usize = meshes.iter().map(|m| m.triangles.len()).sum();
    i32::try_from(vertices).ok()?;
    let lines = if triangles > 0 { 0 } else { meshes.iter().map(|m| m.lines.len()).sum() };
    let mut out = columns.header(ascii, comment, [vertices, triangles, lines]).into_bytes();
    for mesh in meshes {
        for i in 0..mesh.positions.len() {
            columns.push_vertex(mesh, i, ascii, &mut out);
        }
    }
    let mut first = 0u32;
    for mesh in meshes {
        for triangle in &mesh.triangles {
            let indices = triangle.map(|i| i + first);
            if ascii {
                out.extend_from_slice(format!("3 {} {} {}\n", indices[0], indices[1], indices[2]).as_bytes());
            } else {
                out.push(3);
                out.extend(indices.into_iter().flat_map(u32::to_le_bytes));
            }
        }
        for [from, to] in mesh.lines.iter().filter(|_| lines > 0).map(|ends| ends.map(|i| i + first)) {
            match ascii {
                true => out.extend_from_slice(format!("{from} {to}\n").as_bytes()),
                false => out.extend([from, to].into_iter().flat_map(u32::to_le_bytes)),
            }
        }
        first += mesh.positions.len() as u32;
    }
    Some(out)
}

/// The columns written for each vertex. If one mesh has a column, all do.
struct Columns {
    normals: bool,
    uvs: bool,
    kd: Option<Colours>,
    ks: Option<Colours>,
}

/// Colours that are exact in 8 bits are written as bytes, since other programs expect that.
#[derive(Clone, Copy, PartialEq)]
enum Colours {
    Bytes,
    Floats,
}

impl Columns {
    fn of(meshes: &[&Mesh]) -> Columns {
        let colours = |of: fn(&Mesh) -> &Vec<Rgb>| {
            let any = meshes.iter().any(|m| !of(m).is_empty());
            let exact = meshes.iter().all(|m| of(m).iter().all(|&c| as_bytes(c).is_some()));
            any.then_some(if exact { Colours::Bytes } else { Colours::Floats })
        };
        Columns {
            normals: meshes.iter().any(|m| !m.normals.is_empty()),
            uvs: meshes.iter().any(|m| !m.uvs.is_empty()),
            kd: colours(|m| &m.vertex_kd),
            ks: colours(|m| &m.vertex_ks),
        }
    }

    fn header(&self, ascii: bool, comment: Option<&str>, [vertices, triangles, lines]: [usize; 3]) -> String {
        let format = if ascii { "ascii" } else { "binary_little_endian" };
        // Otherwise Bilux's reader would smooth flat faces.
        let shading = if self.normals { "" } else { "comment shading flat\n" };
        let comment = comment.map_or_else(String::new, |said| format!("comment {said}\n"));
        let mut header = format!("ply\nformat {format} 1.0\n{comment}{shading}element vertex {vertices}\n");
        let mut properties = |scalar: &str, names: &[&str]| {
            names.iter().for_each(|name| header.push_str(&format!("property {scalar} {name}\n")));
        };
        properties("float", &["x", "y", "z"]);
        if self.normals {
            properties("float", &["nx", "ny", "nz"]);
        }
        if self.uvs {
            properties("float", &["u", "v"]);
        }
        let scalar = |colours: Colours| if colours == Colours::Bytes { "uchar" } else { "float" };
        if let Some(colours) = self.kd {
            properties(scalar(colours), &["red", "green", "blue"]);
        }
        if let Some(colours) = self.ks {
            properties(scalar(colours), &["specular_red", "specular_green", "specular_blue"]);
        }
        if lines > 0 {
            header.push_str(&format!("element edge {lines}\nproperty int vertex1\nproperty int vertex2\n"));
        } else {
            header.push_str(&format!("element face {triangles}\nproperty list uchar int vertex_indices\n"));
        }
        header.push_str("end_header\n");
        header
    }

    fn push_vertex(&self, mesh: &Mesh, i: usize, ascii: bool, out: &mut Vec<u8>) {
        let mut floats = |values: &[f32]| {
            if ascii {
                push_f32s(out, values);
                out.push(b' ');
            } else {
                out.extend(values.iter().flat_map(|v| v.to_le_bytes()));
            }
        };
        floats(&mesh.positions[i].to_array());
        if self.normals {
            // A zero normal stands for a missing one.
            floats(&mesh.normals.get(i).copied().unwrap_or(Vec3::ZERO).to_array());
        }
        if self.uvs {
            floats(&mesh.uvs.get(i).copied().unwrap_or(Vec2::ZERO).to_array());
        }
        for (colours, values) in [(self.kd, &mesh.vertex_kd), (self.ks, &mesh.vertex_ks)] {
            let value = values.get(i).copied().unwrap_or(Rgb::WHITE);
            match colours {
                None => {}
                Some(Colours::Floats) => {
                    if ascii {
                        push_f32s(out, &encoded(value));
                        out.push(b' ');
                    } else {
                        out.extend(encoded(value).iter().flat_map(|v| v.to_le_bytes()));
                    }
                }
                Some(Colours::Bytes) => {
                    let bytes = as_bytes(value).unwrap_or([255; 3]);
                    if ascii {
                        out.extend_from_slice(format!("{} {} {} ", bytes[0], bytes[1], bytes[2]).as_bytes());
                    } else {
                        out.extend(bytes);
                    }
                }
            }
        }
        if ascii {
            out.pop();
            out.push(b'\n');
        }
    }
}
