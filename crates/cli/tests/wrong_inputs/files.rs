//! Wrong files.

use super::Case;

/// Each case with its files.
pub(crate) const CASES: &[Case] = &[
    Case::file("an empty file", 1, &[("empty.obj", b"")], "render empty.obj -o out.png"),
    Case::file(
        "a file that is cut off",
        1,
        &[("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1")],
        "render cut.obj -o out.png",
    ),
    Case::file(
        "a key of a TOML scene that is misspelt",
        1,
        &[("a.toml", b"[camera]\npositon = [0, 0, 5]\n")],
        "render a.toml -o out.png",
    ),
];
