//! What a reader may do and how a writer should.

/// What reading a scene may take and open.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// The most bytes that the files and what they decode to may take together.
    pub max_memory: u64,
    /// Whether files outside the scene's own folder may be opened.
    pub allow_outside: bool,
    /// Whether what would be a warning is an error.
    pub strict: bool,
    /// Faces of a mesh without normals look smooth where they meet at less than this angle, in degrees;
    /// at 0 nothing is added to the mesh, and its faces look flat.
    pub crease_angle: f32,
}

impl Default for ReadOptions {
    /// 4 GiB, nothing outside, warnings, and creases at 40 degrees.
    fn default() -> ReadOptions {
        ReadOptions { max_memory: 4 << 30, allow_outside: false, strict: false, crease_angle: 40.0 }
    }
}

/// How a scene is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Text where a format has both text and binary (PLY, STL).
    pub ascii: bool,
}
