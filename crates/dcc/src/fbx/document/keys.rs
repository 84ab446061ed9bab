//! Names and numbers of objects.

use crate::fbx::tree::Value;

/// The index of an object in the document.
pub(in crate::fbx) type Index = u32;

/// The object that stands for the scene.
pub(in crate::fbx) const ROOT: Index = 0;

/// Key of an object in connections: a number since version 7, a name before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key<'d> {
    Number(i64),
    Name(&'d [u8]),
}

impl<'d> Key<'d> {
    pub(super) fn of(value: Value<'d>) -> Option<Key<'d>> {
        match value {
            Value::Integer(number) => Some(Key::Number(number)),
            Value::Text(name) => Some(Key::Name(name)),
            _ => None,
        }
    }
}
