//! The scenes that come with the benchmark.

use super::names::check;
use bilux::Error;
use bilux::scene::{SceneBuilder, Spec};

/// The width and height of the pictures: whole blocks of [`BLOCK`](super::BLOCK) pixels.
pub const SIZE: (u32, u32) = (128, 96);

/// The scenes, by the names of their generators, each with the file of its reference.
pub const SCENES: &[(&str, &[u8])] = &[
    ("daylight", include_bytes!("../../references/daylight.exr")),
    ("indirect", include_bytes!("../../references/indirect.exr")),
    ("lampshades", include_bytes!("../../references/lampshades.exr")),
    ("caustics", include_bytes!("../../references/caustics.exr")),
    ("pool", include_bytes!("../../references/pool.exr")),
    ("bidirectional", include_bytes!("../../references/bidirectional.exr")),
    ("door-ajar", include_bytes!("../../references/door-ajar.exr")),
    ("many-lights", include_bytes!("../../references/many-lights.exr")),
];

pub(super) fn generated(name: &str) -> Result<SceneBuilder, Error> {
    bilux::generate(&Spec::new("", name))
}

/// The rows of [`SCENES`] with these names, in the order of [`SCENES`].
pub(super) fn chosen_scenes(names: &[String]) -> Result<Vec<(&'static str, &'static [u8])>, Error> {
    let known: Vec<String> = SCENES.iter().map(|(name, _)| (*name).to_owned()).collect();
    names.iter().try_for_each(|name| check("scene of `bench render`", name, &known))?;
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| n == name);
    Ok(SCENES.iter().copied().filter(|(name, _)| wanted(name)).collect())
}
