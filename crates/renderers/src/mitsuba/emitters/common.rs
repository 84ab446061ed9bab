//! Properties that lights share.

use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_math::{DMat4, Rgb};

/// Placement of a light.
pub(super) fn to_world(plugin: &Plugin) -> Result<DMat4, FormatError> {
    Ok(plugin.placement("to_world")?.map_or(DMat4::IDENTITY, |placement| placement.start()))
}

/// The colour of a light, which is white if none is given.
pub(super) fn shine(maker: &mut Maker, plugin: &Plugin, name: &'static str) -> Result<Rgb, FormatError> {
    let colour = maker.even(plugin, name, Meaning::Light)?.unwrap_or(Rgb::WHITE);
    Ok(colour * plugin.number_or("scale", 1.0)?.max(0.0) as f32)
}
