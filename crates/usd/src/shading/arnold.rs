//! Arnold's shaders that MaterialX has too, under other names. [Arnold 7.3, shaders]

/// Prefix of the identifiers of Arnold's shaders.
pub(super) const PREFIX: &str = "arnold:";

/// Nodes, and what MaterialX calls them.
const NODES: [(&str, &str); 12] = [
    ("standard_surface", "standard_surface_surfaceshader"),
    ("image", "image_color3"),
    ("flat", "constant_color3"),
    ("multiply", "multiply_color3"),
    ("divide", "divide_color3"),
    ("add", "add_color3"),
    ("subtract", "subtract_color3"),
    ("mix_rgba", "mix_color3"),
    ("complement", "invert_color3"),
    ("normal_map", "normalmap"),
    ("color_correct", "colorcorrect_color3"),
    ("range", "range_color3"),
];

/// Inputs as MaterialX calls them, and Arnold's names.
const INPUTS: [(&str, &str); 10] = [
    ("file", "filename"),
    ("sourceColorSpace", "color_space"),
    ("uaddressmode", "swrap"),
    ("vaddressmode", "twrap"),
    ("in", "input"),
    ("in1", "input1"),
    ("in2", "input2"),
    ("bg", "input1"),
    ("fg", "input2"),
    ("value", "color"),
];

/// Name in MaterialX of a node with this identifier.
pub(super) fn node(id: &str) -> Option<&'static str> {
    let name = id.strip_prefix(PREFIX)?;
    NODES.iter().find(|(own, _)| *own == name).map(|(_, other)| *other)
}

/// Name in Arnold of an input.
pub(super) fn input(name: &str) -> Option<&'static str> {
    INPUTS.iter().find(|(other, _)| *other == name).map(|(_, own)| *own)
}
