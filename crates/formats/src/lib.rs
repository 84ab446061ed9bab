//! Scene files: .asc, OBJ, PLY, STL and the native TOML, in and out.
