//! Brightness of skies, whoever made them.

mod formula;
mod given;
mod sky;

pub(super) use formula::{Weather, level_irradiance};
pub(super) use given::given;
pub(super) use sky::{Form, Sky, form};
