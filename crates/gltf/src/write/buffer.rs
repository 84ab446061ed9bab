//! The binary part: bytes, buffer views and accessors.

use serde_json::{Value as Json, json};

/// The bytes under construction.
#[derive(Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Json>,
    accessors: Vec<Json>,
}

/// Component type codes of the specification.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

impl Buffer {
    /// Adds bytes as a view, aligned to four bytes.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Adds vectors of N numbers as an accessor of vertices, optionally with bounds.
    pub(super) fn vectors<const N: usize>(&mut self, vectors: &[[f32; N]], bounds: bool) -> usize {
        self.floats(vectors, bounds, Some(ARRAY_BUFFER))
    }

    /// Adds vectors of N numbers as an accessor of something other than vertices.
    pub(super) fn keys<const N: usize>(&mut self, keys: &[[f32; N]]) -> usize {
        self.floats(keys, N == 1, None)
    }

    fn floats<const N: usize>(&mut self, vectors: &[[f32; N]], bounds: bool, target: Option<u32>) -> usize {
        let bytes: Vec<u8> = vectors.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, target);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let mut accessor =
            json!({ "bufferView": view, "componentType": FLOAT, "count": vectors.len(), "type": kind });
        if bounds {
            let ends = |pick: fn(f32, f32) -> f32| {
                let first = vectors.first().copied().unwrap_or([0.0; N]);
                vectors.iter().fold(first, |end, v| std::array::from_fn(|i| pick(end[i], v[i])))
            };
            accessor["min"] = json!(ends(f32::min).to_vec());
            accessor["max"] = json!(ends(f32::max).to_vec());
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds an accessor of indices.
    pub(super) fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        let count = indices.len();
        self.accessors.push(
            json!({ "bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR" }),
        );
        self.accessors.len() - 1
    }

    /// Returns the views, the accessors and the bytes.
    pub(super) fn finish(mut self) -> (Vec<Json>, Vec<Json>, Vec<u8>) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        (self.views, self.accessors, self.bytes)
    }
}

/// Combines JSON and bytes into a GLB file.
pub(super) fn container(mut text: Vec<u8>, binary: Vec<u8>) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut chunks = vec![(*b"JSON", text)];
    if !binary.is_empty() {
        chunks.push((*b"BIN\0", binary));
    }
    let length = 12 + chunks.iter().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&(length as u32).to_le_bytes());
    for (kind, bytes) in chunks {
        out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        out.extend_from_slice(&kind);
        out.extend_from_slice(&bytes);
    }
    out
}
