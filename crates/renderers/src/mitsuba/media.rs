//! Participating media.

use super::grid_volume::GridVolume;
use super::maker::{Maker, Meaning};
use super::plugin::{Plugin, row};
use bilux_import::FormatError;
use bilux_import::appearance::filling::{Density, Medium};
use bilux_import::tables::grids::COLOURS;
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::media::Grid;
use std::rc::Rc;

/// A medium that is the same everywhere, or one of a density that varies.
type Make = fn(&mut Maker, &Plugin) -> Result<Medium, FormatError>;

const MEDIA: &[(&str, Make)] = &[("homogeneous", homogeneous), ("heterogeneous", heterogeneous)];

/// The medium of a plugin.
pub(super) fn medium(maker: &mut Maker, plugin: &Rc<Plugin>) -> Result<Medium, FormatError> {
    let make = row(plugin, MEDIA)?;
    let mut medium = maker.within(plugin, |maker| make(maker, plugin))?;
    medium.anisotropy = anisotropy(maker, plugin)?;
    plugin.ignore(&["sample_emitters", "has_spectral_extinction", "method", "step_size"]);
    plugin.report_unused(&mut maker.diagnostics);
    Ok(medium)
}

/// The mean cosine of the phase function.
fn anisotropy(maker: &mut Maker, plugin: &Plugin) -> Result<f32, FormatError> {
    let Some(phase) = maker.document.part_of(plugin, "phase")? else { return Ok(0.0) };
    match phase.kind.as_str() {
        "isotropic" => Ok(0.0),
        "hg" => Ok(phase.number_or("g", 0.8)? as f32),
        _ => {
            maker.not_shown(&phase);
            Ok(0.0)
        }
    }
}

/// Absorption and scattering of an extinction and an albedo.
fn split(extinction: Rgb, albedo: Rgb, scale: f32) -> [Rgb; 2] {
    let extinction = extinction * scale;
    [extinction * albedo.map(|a| 1.0 - a), extinction * albedo]
}

fn homogeneous(maker: &mut Maker, plugin: &Plugin) -> Result<Medium, FormatError> {
    let scale = plugin.number_or("scale", 1.0)? as f32;
    if plugin.has("material") {
        maker
            .diagnostics
            .not_shown(&format!("'material' of {}", plugin.named()), || plugin.place("material"));
    }
    // Those of version 0.5.
    let absorption = maker.even(plugin, "sigma_a", Meaning::Number)?;
    let scattering = maker.even(plugin, "sigma_s", Meaning::Number)?;
    let [absorption, scattering] = if absorption.is_some() || scattering.is_some() {
        [absorption, scattering].map(|part| part.unwrap_or(Rgb::BLACK) * scale)
    } else {
        let albedo = maker.even(plugin, "albedo", Meaning::Surface)?.unwrap_or(Rgb::grey(0.75));
        let extinction = maker.even(plugin, "sigma_t", Meaning::Number)?.unwrap_or(Rgb::WHITE);
        split(extinction, albedo, scale)
    };
    Ok(Medium { absorption, scattering, ..Medium::default() })
}

/// The extinction of the grid `sigma_t`, or of version 0.5's `density`, times the scale.
fn heterogeneous(maker: &mut Maker, plugin: &Plugin) -> Result<Medium, FormatError> {
    let scale = plugin.number_or("scale", 1.0)? as f32;
    let name = if plugin.has("density") { "density" } else { "sigma_t" };
    let extinction = volume(maker, plugin, name)?;
    let albedo = match volume(maker, plugin, "albedo")? {
        Some(albedo) => {
            maker.note("an albedo that varies is replaced by its mean", &plugin.place("albedo"));
            albedo.mean_in(extinction.as_ref()).map(|a| a.min(1.0))
        }
        None => maker.even(plugin, "albedo", Meaning::Surface)?.unwrap_or(Rgb::grey(0.75)),
    };
    let (colour, density) = match extinction {
        Some(volume) => (volume.tint(), Some(volume.density)),
        None => (maker.even(plugin, name, Meaning::Number)?.unwrap_or(Rgb::WHITE), None),
    };
    if plugin.has("emission") {
        maker
            .diagnostics
            .not_shown(&format!("'emission' of {}", plugin.named()), || plugin.place("emission"));
    }
    let [absorption, scattering] = split(colour, albedo, scale);
    Ok(Medium { absorption, scattering, density, ..Medium::default() })
}

/// The volume of a property, if that is a grid.
fn volume(maker: &mut Maker, plugin: &Plugin, name: &'static str) -> Result<Option<GridVolume>, FormatError> {
    let Some(property) = plugin.find(name) else { return Ok(None) };
    let part = maker.document.part(property)?.filter(|part| part.kind == "gridvolume");
    let Some(volume) = part else { return Ok(None) };
    volume.ignore(&["filter_type", "wrap_mode", "raw", "accel"]);
    let (file, at) = volume.file()?;
    let (_, file) = maker.files().locate(file, &at, maker.reading)?;
    let folder = maker.files().folder.clone();
    let uses_box = volume.flag("use_grid_bbox", false)?;
    let density = match maker.reading.grid_if_there(folder.as_deref(), (&file, ""), &at)? {
        Ok(grid) => grid,
        Err(why) => {
            maker.note(&format!("{why}: it is taken as 1 everywhere"), &at);
            return Ok(None);
        }
    };
    let mut channels = Vec::new();
    if maker.reading.has_colours(folder.as_deref(), &file, &at)? {
        for colour in COLOURS {
            channels.push(maker.reading.grid(folder.as_deref(), (&file, colour), &at)?);
        }
    }
    let to_world = volume.placement("to_world")?.map_or(DMat4::IDENTITY, |placement| placement.start());
    // Without the box of its file, it fills the unit cube.
    let to_world = if uses_box { to_world } else { to_world * to_unit_cube(&density) };
    volume.report_unused(&mut maker.diagnostics);
    Ok(Some(GridVolume { density: Density { grid: density, to_world }, channels }))
}

/// From the space of a grid to the unit cube that its voxels fill.
fn to_unit_cube(grid: &Grid) -> DMat4 {
    let size = DVec3::from(grid.size().map(|side| side.max(1) as f64));
    DMat4::from_scale(size.recip()) * grid.to_object().matrix().as_dmat4().inverse()
}
