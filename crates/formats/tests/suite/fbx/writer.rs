//! Writes small FBX files, binary and as text.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// A value of a node.
#[derive(Clone, Debug)]
pub(super) enum V {
    Int(i32),
    Long(i64),
    Double(f64),
    Text(String),
    /// A name with its class.
    Name(&'static str, &'static str),
    Bytes(Vec<u8>),
    Ints(Vec<i32>),
    Longs(Vec<i64>),
    Floats(Vec<f32>),
    Doubles(Vec<f64>),
}

/// A node.
#[derive(Clone, Debug)]
pub(super) struct N {
    pub(super) name: &'static str,
    pub(super) values: Vec<V>,
    pub(super) children: Vec<N>,
}

pub(super) fn n(name: &'static str, values: Vec<V>, children: Vec<N>) -> N {
    N { name, values, children }
}

pub(super) fn text(text: &str) -> V {
    V::Text(text.to_owned())
}

/// A property with numbers.
pub(super) fn p(name: &str, numbers: &[f64]) -> N {
    let head = [text(name), text(""), text(""), text("A")];
    n("P", head.into_iter().chain(numbers.iter().map(|&x| V::Double(x))).collect(), vec![])
}

/// A property with a text.
pub(super) fn ps(name: &str, value: &str) -> N {
    n("P", [name, "KString", "", "", value].map(text).to_vec(), vec![])
}

/// The properties of an object.
pub(super) fn properties(list: Vec<N>) -> N {
    n("Properties70", vec![], list)
}

/// An object with its number.
pub(super) fn object(class: &'static str, id: i64, name: &'static str, kind: &str, children: Vec<N>) -> N {
    n(class, vec![V::Long(id), V::Name(name, class), text(kind)], children)
}

/// A connection of two objects, or of one and a property of the other.
pub(super) fn link(source: i64, target: i64, property: &str) -> N {
    let mut values =
        vec![text(if property.is_empty() { "OO" } else { "OP" }), V::Long(source), V::Long(target)];
    values.extend((!property.is_empty()).then(|| text(property)));
    n("C", values, vec![])
}

/// The nodes of a whole file.
pub(super) fn file(settings: Vec<N>, objects: Vec<N>, links: Vec<N>) -> Vec<N> {
    vec![
        n(
            "FBXHeaderExtension",
            vec![],
            vec![
                n("FBXHeaderVersion", vec![V::Int(1003)], vec![]),
                n("FBXVersion", vec![V::Int(7400)], vec![]),
            ],
        ),
        n("GlobalSettings", vec![], vec![properties(settings)]),
        n("Objects", vec![], objects),
        n("Connections", vec![], links),
    ]
}

/// The nodes in binary, of a version; arrays are packed or not.
pub(super) fn binary(version: u32, packed: bool, nodes: &[N]) -> Vec<u8> {
    let mut out = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    out.extend(version.to_le_bytes());
    let wide = version >= 7500;
    nodes.iter().for_each(|node| put(node, wide, packed, &mut out));
    out.extend(vec![0; if wide { 25 } else { 13 }]);
    out
}

fn number(value: usize, wide: bool) -> Vec<u8> {
    if wide { (value as u64).to_le_bytes().to_vec() } else { (value as u32).to_le_bytes().to_vec() }
}

fn put(node: &N, wide: bool, packed: bool, out: &mut Vec<u8>) {
    let start = out.len();
    let values: Vec<u8> = node.values.iter().flat_map(|value| encoded(value, packed)).collect();
    out.extend([0, node.values.len(), values.len()].iter().flat_map(|&value| number(value, wide)));
    out.push(node.name.len() as u8);
    out.extend(node.name.bytes());
    out.extend(values);
    if !node.children.is_empty() {
        node.children.iter().for_each(|child| put(child, wide, packed, out));
        out.extend(vec![0; if wide { 25 } else { 13 }]);
    }
    let end = number(out.len(), wide);
    out[start..start + end.len()].copy_from_slice(&end);
}

fn encoded(value: &V, packed: bool) -> Vec<u8> {
    let array = |kind: u8, count: usize, bytes: Vec<u8>| {
        let bytes = if packed { zipped(&bytes) } else { bytes };
        let head = [count as u32, u32::from(packed), bytes.len() as u32];
        [vec![kind], head.iter().flat_map(|x| x.to_le_bytes()).collect(), bytes].concat()
    };
    let string = |kind: u8, bytes: &[u8]| [&[kind][..], &(bytes.len() as u32).to_le_bytes(), bytes].concat();
    match value {
        V::Int(x) => [&b"I"[..], &x.to_le_bytes()].concat(),
        V::Long(x) => [&b"L"[..], &x.to_le_bytes()].concat(),
        V::Double(x) => [&b"D"[..], &x.to_le_bytes()].concat(),
        V::Text(text) => string(b'S', text.as_bytes()),
        V::Name(name, class) => string(b'S', format!("{name}\0\x01{class}").as_bytes()),
        V::Bytes(bytes) => string(b'R', bytes),
        V::Ints(list) => array(b'i', list.len(), list.iter().flat_map(|x| x.to_le_bytes()).collect()),
        V::Longs(list) => array(b'l', list.len(), list.iter().flat_map(|x| x.to_le_bytes()).collect()),
        V::Floats(list) => array(b'f', list.len(), list.iter().flat_map(|x| x.to_le_bytes()).collect()),
        V::Doubles(list) => array(b'd', list.len(), list.iter().flat_map(|x| x.to_le_bytes()).collect()),
    }
}

pub(super) fn zipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The nodes as text.
pub(super) fn as_text(nodes: &[N]) -> String {
    let mut out = "; FBX 7.4.0 project file\n; ------\n\n".to_owned();
    nodes.iter().for_each(|node| put_text(node, 0, &mut out));
    out
}

fn put_text(node: &N, depth: usize, out: &mut String) {
    let indent = "\t".repeat(depth);
    let list =
        |items: Vec<String>| format!("*{} {{\n{indent}\ta: {}\n{indent}}}", items.len(), items.join(","));
    let values: Vec<String> = node
        .values
        .iter()
        .map(|value| match value {
            V::Int(x) => x.to_string(),
            V::Long(x) => x.to_string(),
            V::Double(x) => x.to_string(),
            V::Text(text) => format!("\"{text}\""),
            V::Name(name, class) => format!("\"{class}::{name}\""),
            V::Bytes(bytes) => format!("\"{}\"", base64(bytes)),
            V::Ints(all) => list(all.iter().map(ToString::to_string).collect()),
            V::Longs(all) => list(all.iter().map(ToString::to_string).collect()),
            V::Floats(all) => list(all.iter().map(ToString::to_string).collect()),
            V::Doubles(all) => list(all.iter().map(ToString::to_string).collect()),
        })
        .collect();
    out.push_str(&format!("{indent}{}: {}", node.name, values.join(", ")));
    if !node.children.is_empty() {
        out.push_str(" {\n");
        node.children.iter().for_each(|child| put_text(child, depth + 1, out));
        out.push_str(&format!("{indent}}}"));
    }
    out.push('\n');
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bytes
        .chunks(3)
        .flat_map(|chunk| {
            let bits =
                chunk.iter().fold(0u32, |sum, &byte| sum << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
            (0..4).map(move |i| match i <= chunk.len() {
                true => DIGITS[(bits >> (18 - 6 * i)) as usize & 63] as char,
                false => '=',
            })
        })
        .collect()
}
