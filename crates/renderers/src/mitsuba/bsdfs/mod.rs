//! Materials of surfaces; the table is [`BSDFS`].

pub(super) use adapters::black;
pub(super) use layered::rough_base_factor;

mod adapters;
mod layered;
mod measured_indices;
mod normals;
mod plain;
mod principled;
mod rough_boundary;

use super::maker::Maker;
use super::plugin::{Plugin, row};
use bilux_import::FormatError;
use bilux_scene::Spec;
use std::rc::Rc;

/// Builds a material; `None` for a boundary that is invisible.
type Make = fn(&mut Maker, &Plugin) -> Result<Option<Spec>, FormatError>;

/// Every material; those of version 0.5 come last.
const BSDFS: &[(&str, Make)] = &[
    ("blendbsdf", adapters::blend),
    ("bumpmap", normals::bump_map),
    ("conductor", plain::conductor),
    ("dielectric", plain::dielectric),
    ("diffuse", plain::diffuse),
    ("mask", adapters::mask),
    ("normalmap", normals::normal_map),
    ("null", plain::null),
    ("plastic", layered::plastic),
    ("pplastic", layered::plastic),
    ("principled", principled::principled),
    ("principledthin", principled::thin),
    ("roughconductor", plain::rough_conductor),
    ("roughdielectric", plain::rough_dielectric),
    ("roughplastic", layered::rough_plastic),
    ("thindielectric", plain::thin_dielectric),
    ("twosided", adapters::two_sided),
    ("hair", plain::not_shown),
    ("measured", plain::not_shown),
    ("measured_polarized", plain::not_shown),
    ("circular", plain::filter),
    ("polarizer", plain::filter),
    ("retarder", plain::filter),
    ("coating", layered::coating),
    ("difftrans", plain::diffuse_transmission),
    ("hk", plain::not_shown),
    ("irawan", plain::not_shown),
    ("mixturebsdf", adapters::mixture),
    ("phong", plain::phong),
    ("roughdiffuse", plain::rough_diffuse),
    ("ward", plain::ward),
];

/// The material of a plugin; `None` for a boundary that is invisible.
pub(super) fn material(maker: &mut Maker, plugin: &Rc<Plugin>) -> Result<Option<Spec>, FormatError> {
    let make = match row(plugin, BSDFS) {
        Ok(make) => *make,
        Err(error) => {
            let (said, place) = (error.to_string(), format!("{}: ", plugin.at));
            let what = format!("a material is grey: {}", said.strip_prefix(&place).unwrap_or(&said));
            maker.note(&what, &plugin.at);
            plain::grey
        }
    };
    let made = maker.within(plugin, |maker| make(maker, plugin))?;
    plugin.report_unused(&mut maker.diagnostics);
    Ok(made.map(|spec| {
        let name = if plugin.id.is_empty() { spec.name.clone() } else { plugin.id.clone() };
        Spec { name, span: plugin.at.clone(), ..spec }
    }))
}
