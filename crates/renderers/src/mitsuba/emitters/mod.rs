//! Lights; the table is [`EMITTERS`].

mod area;
mod common;
mod distant;
mod environment;
mod near;

pub(super) use area::{Emission, emission};

use super::maker::Maker;
use super::plugin::{Plugin, row};
use bilux_import::FormatError;
use bilux_scene::Spec;
use std::rc::Rc;

/// Builds a light, of several if its colour varies; none if it is not supported.
type Make = fn(&mut Maker, &Plugin) -> Result<Vec<Spec>, FormatError>;

/// Every light that is not on a shape.
const EMITTERS: &[(&str, Make)] = &[
    ("collimated", not_shown),
    ("constant", environment::constant),
    ("directional", distant::directional),
    ("envmap", environment::map),
    ("point", near::point),
    ("projector", near::projector),
    ("sky", distant::sky),
    ("spot", near::spot),
    ("sun", distant::sky),
    ("sunsky", distant::sky),
    ("timed_sunsky", not_shown),
];

/// A light that is not on a shape.
pub(super) fn light(maker: &mut Maker, plugin: &Rc<Plugin>) -> Result<Vec<Spec>, FormatError> {
    let made = row(plugin, EMITTERS)?(maker, plugin)?;
    plugin.ignore(&["sampling_weight", "scene_bsphere"]);
    plugin.report_unused(&mut maker.diagnostics);
    Ok(made
        .into_iter()
        .map(|spec| Spec { name: plugin.id.clone(), span: plugin.at.clone(), ..spec })
        .collect())
}

fn not_shown(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    maker.not_shown(plugin);
    plugin.properties.iter().for_each(|property| property.used.set(true));
    Ok(Vec::new())
}
