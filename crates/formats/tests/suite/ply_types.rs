//! PLY: every numeric type at every place that allows it, in text and in both byte orders, compared with the
//! numbers that were written.

use crate::{read_text, warnings};
use bilux_math::colour::srgb_decode;
use bilux_math::{Rgb, Vec3};

/// A file under construction from numbers, each with its own type.
struct File {
    encoding: &'static str,
    bytes: Vec<u8>,
}

impl File {
    fn new(encoding: &'static str, header: &str) -> File {
        File { encoding, bytes: format!("ply\nformat {encoding} 1.0\n{header}end_header\n").into_bytes() }
    }

    fn push(&mut self, kind: &str, number: f64) {
        if self.encoding == "ascii" {
            self.bytes.extend(format!("{number} ").bytes());
            return;
        }
        let mut bytes = match kind {
            "char" => (number as i8).to_le_bytes().to_vec(),
            "uchar" => (number as u8).to_le_bytes().to_vec(),
            "short" => (number as i16).to_le_bytes().to_vec(),
            "ushort" => (number as u16).to_le_bytes().to_vec(),
            "int" => (number as i32).to_le_bytes().to_vec(),
            "uint" => (number as u32).to_le_bytes().to_vec(),
            "float" => (number as f32).to_le_bytes().to_vec(),
            _ => number.to_le_bytes().to_vec(),
        };
        if self.encoding == "binary_big_endian" {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn end_line(&mut self) {
        if self.encoding == "ascii" {
            self.bytes.push(b'\n');
        }
    }
}

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn indices_and_their_counts_are_of_any_type_in_both_byte_orders() {
    // Above 256, a number in the wrong byte order is another number; both 0x0102 and 0x0201 are valid.
    let wide: [(&str, u32); 6] = [
        ("char", 100),
        ("uchar", 200),
        ("short", 0x0201),
        ("ushort", 0x0201),
        ("int", 0x0201),
        ("uint", 0x0201),
    ];
    for (count, (index, most)) in
        ["uchar", "ushort", "short", "int"].into_iter().flat_map(|c| wide.map(|w| (c, w)))
    {
        for (encoding, more) in ENCODINGS.into_iter().flat_map(|e| [(e, false), (e, true)]) {
            let total = most + 1;
            let property = if more { "property ushort flags\n" } else { "" };
            let mut file = File::new(
                encoding,
                &format!(
                    "element vertex {total}\nproperty float x\nproperty double y\nproperty short z\nelement face 2\n\
                     property list {count} {index} vertex_indices\n{property}"
                ),
            );
            for i in 0..total {
                file.push("float", f64::from(i));
                file.push("double", f64::from(i % 2));
                file.push("short", f64::from(i % 3) - 1.0);
                file.end_line();
            }
            let faces = [[0, most / 2, most], [1, most, most / 2]];
            for face in faces {
                file.push(count, 3.0);
                face.iter().for_each(|&corner| file.push(index, f64::from(corner)));
                if more {
                    file.push("ushort", 7.0);
                }
                file.end_line();
            }
            let name = format!("{encoding}, {count} {index}, {more}");
            let scene = read_text("ply", &file.bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
            let mesh = &scene.objects[0].mesh;
            let corner = |i: u32| mesh.positions[i as usize];
            let wanted = |i: u32| Vec3::new(i as f32, (i % 2) as f32, (i % 3) as f32 - 1.0);
            assert_eq!(mesh.triangles.len(), 2, "{name}");
            for (triangle, face) in mesh.triangles.iter().zip(faces) {
                assert_eq!(triangle.map(corner), face.map(wanted), "{name}");
            }
            assert_eq!(warnings(&scene), "", "{name}");
        }
    }
}

#[test]
fn colours_are_of_any_type_in_both_byte_orders() {
    // The stored values, and the value that means 1: 0x1234 is not 0x3412.
    let kinds: [(&str, [f64; 3], f64); 4] = [
        ("uchar", [255.0, 18.0, 0.0], 255.0),
        ("ushort", [65535.0, f64::from(0x1234), 255.0], 65535.0),
        ("float", [1.0, 0.25, 0.5], 1.0),
        ("double", [1.0, 0.25, 0.5], 1.0),
    ];
    for ((kind, stored, one), encoding) in kinds.into_iter().flat_map(|k| ENCODINGS.map(|e| (k, e))) {
        let mut file = File::new(
            encoding,
            &format!(
                "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty {kind} red\n\
                 property {kind} green\nproperty {kind} blue\nelement face 1\n\
                 property list uchar ushort vertex_indices\n"
            ),
        );
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
            [x, y, 0.0].iter().for_each(|&x| file.push("float", x));
            stored.iter().for_each(|&c| file.push(kind, c));
            file.end_line();
        }
        file.push("uchar", 3.0);
        [0.0, 1.0, 2.0].iter().for_each(|&i| file.push("ushort", i));
        file.end_line();
        let scene =
            read_text("ply", &file.bytes).unwrap_or_else(|error| panic!("{kind}, {encoding}: {error}"));
        let part = |i: usize| (stored[i] / one) as f32;
        let light = |i: usize| srgb_decode(part(i));
        let wanted = Rgb::new(light(0), light(1), light(2));
        for colour in &scene.objects[0].mesh.vertex_kd {
            let off = (*colour - wanted).map(f32::abs).max_channel();
            assert!(off < 1e-6, "{kind}, {encoding}: {colour:?}, not {wanted:?}");
        }
        assert_eq!(scene.objects[0].mesh.vertex_kd.len(), 3);
    }
}
