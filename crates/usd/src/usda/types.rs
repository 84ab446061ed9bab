//! The types of attributes, by their names in text.

/// Elements that the values of a type consist of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Integers,
    Floats,
    Doubles,
    /// Quaternions, whose real part comes first in text.
    Turns,
    Texts,
    Assets,
    Dictionary,
}

/// Class and numbers in a tuple; the roles of types, such as `color`, follow from the rest of their names.
const TYPES: &[(&str, Class, usize)] = &[
    ("bool", Class::Integers, 1),
    ("uchar", Class::Integers, 1),
    ("int", Class::Integers, 1),
    ("uint", Class::Integers, 1),
    ("int64", Class::Doubles, 1),
    ("uint64", Class::Doubles, 1),
    ("int2", Class::Integers, 2),
    ("int3", Class::Integers, 3),
    ("int4", Class::Integers, 4),
    ("half", Class::Floats, 1),
    ("float", Class::Floats, 1),
    ("double", Class::Doubles, 1),
    ("timecode", Class::Doubles, 1),
    ("string", Class::Texts, 1),
    ("token", Class::Texts, 1),
    ("opaque", Class::Texts, 1),
    ("group", Class::Texts, 1),
    ("pathExpression", Class::Texts, 1),
    ("asset", Class::Assets, 1),
    ("dictionary", Class::Dictionary, 1),
    ("matrix2d", Class::Doubles, 4),
    ("matrix3d", Class::Doubles, 9),
    ("matrix4d", Class::Doubles, 16),
    ("frame4d", Class::Doubles, 16),
    ("quatd", Class::Turns, 4),
    ("quatf", Class::Turns, 4),
    ("quath", Class::Turns, 4),
];

/// The class of a type without its brackets, and the numbers in a tuple; `None` for a type that is not known.
pub(super) fn type_named(name: &str) -> Option<(Class, usize)> {
    if let Some((_, class, width)) = TYPES.iter().find(|(known, ..)| *known == name) {
        return Some((*class, *width));
    }
    let known = ["point", "normal", "vector", "color", "texCoord", "half", "float", "double"];
    let rest = known.iter().find_map(|role| name.strip_prefix(role))?;
    let width = rest.bytes().next().filter(|b| (b'2'..=b'4').contains(b))? - b'0';
    let class = match (&rest[1..], name.starts_with("double")) {
        ("d", _) | ("", true) => Class::Doubles,
        ("f" | "h" | "", _) => Class::Floats,
        _ => return None,
    };
    Some((class, usize::from(width)))
}
