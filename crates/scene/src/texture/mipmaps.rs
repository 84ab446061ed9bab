//! Which textures get coarser levels, and when.

use super::{Filter, Texture, levels};
use bilux_math::parallel::for_each;
use std::collections::HashMap;
use std::sync::Arc;

/// True if coarser levels of a texture are of use: it is filtered, and nothing depends on the exact value of single
/// texels.
///
/// Only colours qualify, since light is proportional to them, but not to roughness.
pub(crate) fn has_use(texture: &Texture) -> bool {
    let blends = texture.filter == Filter::Linear && texture.threshold.is_none() && !texture.is_data;
    blends
        && texture.formula().is_none()
        && texture.image.is_whole()
        && levels::is_divisible([texture.width(), texture.height()])
}

/// Builds the coarser levels of textures that have none yet; textures of the same image share them.
pub(crate) fn build(textures: &[&Arc<Texture>]) {
    let key = |texture: &Texture| (Arc::as_ptr(&texture.image), texture.is_data && texture.image.is_bytes());
    let mut pictures: HashMap<_, Vec<&Texture>> = HashMap::new();
    for texture in textures.iter().copied().filter(|texture| texture.levels.is_unfilled()) {
        pictures.entry(key(texture)).or_default().push(texture);
    }
    let pictures: Vec<_> = pictures.into_values().collect();
    for_each(&pictures, |sharers| {
        let levels = levels::of(&sharers[0].image, sharers[0].is_data);
        for texture in sharers.iter() {
            texture.levels.fill(levels.clone());
        }
    });
}
