//! Participating media: the same everywhere, or as dense as a grid says.

use super::grid_media::GridMaker;
use super::loader::{Loader, SpectrumType};
use super::parameters::ParameterList;
use bilux_import::FormatError;
use bilux_import::appearance::filling::{Density, Medium};
use bilux_math::{DMat4, Rgb};

/// Measured media: scattering (reduced) and absorption per millimetre. [Jensen 2001, figure 5]
const MEASURED: &[(&str, [f32; 3], [f32; 3])] = &[
    ("Apple", [2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046]),
    ("Chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19]),
    ("Chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.20]),
    ("Cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]),
    ("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    ("Marble", [2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071]),
    ("Potato", [0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12]),
    ("Skimmilk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
    ("Skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    ("Skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
    ("Spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0]),
    ("Wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
];

/// Scattering and absorption of a measured medium.
pub(super) fn measured(name: &str) -> Option<[Rgb; 2]> {
    let (_, scattering, absorption) = MEASURED.iter().find(|(known, ..)| *known == name)?;
    Some([Rgb::from_array(*scattering), Rgb::from_array(*absorption)])
}

/// The medium with these parameters, in a space with this transform to world space.
pub(super) fn read(
    name: &str,
    list: &ParameterList,
    to_world: DMat4,
    loader: &mut Loader,
) -> Result<Medium, FormatError> {
    let kind = list.text("type")?.unwrap_or("homogeneous").to_owned();
    let scale = list.finite("scale", 1.0)?;
    let anisotropy = list.finite("g", 0.0)?;
    let mut grids = GridMaker { name, list, to_world, loader };
    let ([absorption, scattering], density) = match kind.as_str() {
        "homogeneous" => (coefficients(list, grids.loader)?, None),
        "uniformgrid" => (coefficients(list, grids.loader)?, Some(grids.uniform("density")?)),
        "nanovdb" => (coefficients(list, grids.loader)?, Some(grids.nanovdb()?)),
        "cloud" => (coefficients(list, grids.loader)?, Some(grids.cloud()?)),
        "rgbgrid" => {
            let (coefficients, density) = grids.coloured()?;
            (coefficients, Some(density))
        }
        _ => {
            let what = format!("a medium of type '{kind}' is not supported");
            grids.loader.note(&what, || list.at.clone());
            return Ok(Medium::default());
        }
    };
    let temperature = grids.temperature(&kind)?;
    let (mut radiance, emission_grid) = emission(&kind, &mut grids)?;
    if let Some(temperature) = &temperature {
        let older = list.finite("LeScale", 1.0)?;
        let factor = if kind == "nanovdb" { list.finite("Lescale", older)? } else { 1.0 };
        radiance = Rgb::grey(factor * temperature.brightest());
    }
    list.report_unused(&mut loader.diagnostics);
    let (absorption, scattering) = (absorption * scale, scattering * scale);
    let emission = radiance;
    Ok(Medium { absorption, scattering, anisotropy, density, emission, emission_grid, temperature })
}

/// The radiance of a medium, and the grid that varies it.
fn emission(kind: &str, grids: &mut GridMaker) -> Result<(Rgb, Option<Density>), FormatError> {
    let list = grids.list;
    if kind == "rgbgrid" && list.has("Le") {
        grids.loader.note("emission by a medium of type 'rgbgrid' is not supported", || list.place("Le"));
    }
    if kind == "rgbgrid" || kind == "nanovdb" {
        list.has("Lescale");
        list.has("LeScale");
        return Ok((Rgb::BLACK, None));
    }
    let radiance = grids.loader.spectrum(list, "Le", SpectrumType::Light)?.unwrap_or(Rgb::BLACK);
    if kind == "uniformgrid" && list.has("Lescale") {
        return Ok((radiance, Some(grids.uniform("Lescale")?)));
    }
    Ok((radiance * list.finite("Lescale", 1.0)?, None))
}

/// Absorption and scattering of a medium, without its scale.
fn coefficients(list: &ParameterList, loader: &mut Loader) -> Result<[Rgb; 2], FormatError> {
    let preset = list.text("preset")?;
    let preset = match preset.map(|name| (name, measured(name))) {
        Some((name, None)) => {
            let what = format!("the measured medium '{name}' is not known and is ignored");
            loader.note(&what, || list.place("preset"));
            None
        }
        Some((_, known)) => known,
        None => None,
    };
    if let Some([scattering, absorption]) = preset {
        return Ok([absorption, scattering]);
    }
    let mut given = |name| -> Result<Rgb, FormatError> {
        Ok(loader.spectrum(list, name, SpectrumType::Number)?.unwrap_or(Rgb::WHITE))
    };
    Ok([given("sigma_a")?, given("sigma_s")?])
}
