//! Materials, textures and media as files describe them.

pub mod as_metal;
pub mod emissive;
pub mod environment_maps;
pub mod filling;
pub mod fitting;
pub mod fresnel;
pub mod heights;
pub mod phong;
pub mod principled_draft;
pub mod roughness;
pub mod spectra;
pub mod texture_or_value;
