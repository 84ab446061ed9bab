//! Layers, and the values that they hold.

pub(crate) mod layer;
pub(crate) mod list_op;
pub(crate) mod value;
