//! Nodes, and what moves them and what they hold.

pub(crate) mod animation;
pub(crate) mod area_lights;
pub(crate) mod cameras;
pub(crate) mod instances;
pub(crate) mod lights;
pub(crate) mod nodes;
pub(crate) mod place;
pub(crate) mod posed;
pub(crate) mod skin;
