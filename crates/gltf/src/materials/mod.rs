//! Materials, and the textures and pictures that they read.

pub(crate) mod alpha;
pub(crate) mod draft;
pub(crate) mod glass;
pub(crate) mod glossiness;
pub(crate) mod material;
pub(crate) mod pictures;
pub(crate) mod remapped;
pub(crate) mod scatter;
pub(crate) mod textures;
pub(crate) mod variants;
