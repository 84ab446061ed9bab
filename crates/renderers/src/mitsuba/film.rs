//! Film, sampler and integrator, as settings that a render may follow.

use super::maker::Maker;
use super::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::input::names::unknown;
use bilux_scene::{Parameters, Value};
use std::rc::Rc;

/// The size of a film if it does not say.
const SIZE: [i64; 2] = [768, 576];

/// The largest depth, which stands for none.
const NO_LIMIT: i64 = 1000;

/// The width and height of a sensor's film.
pub(super) fn size(maker: &Maker, sensor: &Plugin) -> Result<[i64; 2], FormatError> {
    let Some(film) = maker.document.part_of(sensor, "film")? else { return Ok(SIZE) };
    let side = |name, default| Ok::<_, FormatError>(film.integer(name)?.unwrap_or(default).clamp(1, 1 << 20));
    Ok([side("width", SIZE[0])?, side("height", SIZE[1])?])
}

/// The settings that a sensor makes.
pub(super) fn settings(
    maker: &mut Maker,
    sensor: &Plugin,
    settings: &mut Parameters,
) -> Result<(), FormatError> {
    let [width, height] = size(maker, sensor)?;
    let film = maker.document.part_of(sensor, "film")?;
    let at = film.as_ref().map_or(&sensor.at, |film| &film.at);
    settings.set_at("size", Value::Text(format!("{width}x{height}")), at.clone());
    if let Some(film) = film {
        read_film(maker, &film, settings)?;
    } else {
        settings.set("filter", "gaussian");
    }
    if let Some(sampler) = maker.document.part_of(sensor, "sampler")? {
        if let Some(samples) = sampler.integer("sample_count")? {
            let at = sampler.place("sample_count");
            settings.set_at("spp", Value::Integer(samples.clamp(1, 1 << 31)), at);
        }
        if let Some(seed) = sampler.integer("seed")? {
            settings.set_at("seed", Value::Integer(seed.max(0)), sampler.place("seed"));
        }
        plug_unused(maker, &sampler, &["jitter", "scramble", "dimension", "strata"]);
    }
    Ok(())
}

/// Looks up what does not matter here, and reports the rest.
fn plug_unused(maker: &mut Maker, plugin: &Plugin, names: &[&'static str]) {
    plugin.ignore(names);
    plugin.report_unused(&mut maker.diagnostics);
}

fn read_film(maker: &mut Maker, film: &Rc<Plugin>, settings: &mut Parameters) -> Result<(), FormatError> {
    if film.kind == "specfilm" {
        maker.note("spectral films are not supported: pictures are RGB", &film.at);
    }
    let whole = size_of_film(film)?;
    let crop = ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"];
    let [x, y, width, height] = crop.map(|name| film.integer(name));
    let part = [x?.unwrap_or(0), y?.unwrap_or(0), width?.unwrap_or(whole[0]), height?.unwrap_or(whole[1])];
    if part != [0, 0, whole[0], whole[1]] {
        let [x, y, width, height] = part;
        let what =
            format!("the whole film is rendered, not only a part of it; use --crop {x},{y},{width},{height}");
        maker.note(&what, &film.at);
    }
    match maker.document.part_of(film, "rfilter")? {
        Some(filter) => read_filter(maker, &filter, settings)?,
        None => settings.set("filter", "gaussian"),
    }
    plug_unused(
        maker,
        film,
        &[
            "file_format",
            "pixel_format",
            "component_format",
            "sample_border",
            "compensate",
            "banner",
            "gamma",
            "high_quality_edges",
            "exposure",
            "attach_log",
            "channels",
            "variable",
            "label",
            "tonemap_method",
            "key",
            "burn",
            "fov",
        ],
    );
    Ok(())
}

fn size_of_film(film: &Plugin) -> Result<[i64; 2], FormatError> {
    Ok([film.integer("width")?.unwrap_or(SIZE[0]), film.integer("height")?.unwrap_or(SIZE[1])])
}

/// Mitsuba's name of a filter, the name in Bilux, and whether it is the same.
const FILTERS: [(&str, &str, bool); 7] = [
    ("box", "box", true),
    ("gaussian", "gaussian", true),
    ("tent", "tent", true),
    ("mitchell", "gaussian", false),
    ("catmullrom", "gaussian", false),
    ("lanczos", "blackman-harris", false),
    ("windowedsinc", "blackman-harris", false),
];

fn read_filter(maker: &mut Maker, filter: &Plugin, settings: &mut Parameters) -> Result<(), FormatError> {
    let Some((name, ours, is_same)) = FILTERS.iter().find(|row| row.0 == filter.kind) else {
        let names = FILTERS.iter().map(|row| row.0);
        return Err(unknown("reconstruction filter", &filter.kind, names, &filter.at));
    };
    let is_same = *is_same
        && match *name {
            "gaussian" => filter.number_or("stddev", 0.5)? == 0.5,
            "tent" => filter.number_or("radius", 1.0)? == 1.0,
            _ => true,
        };
    plug_unused(maker, filter, &["radius", "lobes", "A", "B", "stddev"]);
    if !is_same {
        let what = format!("the pixel filter is '{ours}' instead of this one");
        maker.note(&what, &filter.at);
    }
    settings.set_at("filter", (*ours).into(), filter.at.clone());
    Ok(())
}

/// Integrators that render with another one inside.
const WRAPPERS: [&str; 5] = ["aov", "moment", "stokes", "adaptive", "irrcache"];
/// Integrators whose pictures are the light of a scene.
const KNOWN: [&str; 19] = [
    "path",
    "volpath",
    "volpathmis",
    "direct",
    "ptracer",
    "bdpt",
    "mlt",
    "pssmlt",
    "erpt",
    "sppm",
    "ppm",
    "photonmapper",
    "volpath_simple",
    "prb",
    "prb_basic",
    "prbvolpath",
    "direct_projective",
    "prb_projective",
    "vpl",
];

/// The maximum depth that an integrator asks for; the renderer chooses the integrator.
pub(super) fn depth(
    maker: &mut Maker,
    integrator: &Rc<Plugin>,
    settings: &mut Parameters,
) -> Result<(), FormatError> {
    if WRAPPERS.contains(&integrator.kind.as_str()) {
        let inner = maker.document.part_of(integrator, "integrator")?;
        plug_unused(maker, integrator, &["aovs", "max_error", "p_value", "max_sample_factor"]);
        return match inner {
            Some(inner) => maker.within(integrator, |maker| depth(maker, &inner, settings)),
            None => Ok(()),
        };
    }
    if !KNOWN.contains(&integrator.kind.as_str()) {
        let what = format!("the integrator '{}' is not supported: light is rendered", integrator.kind);
        maker.note(&what, &integrator.at);
    }
    let at = integrator.place("max_depth");
    let given = integrator.integer("max_depth")?.unwrap_or(-1);
    // One edge more than scattering events.
    let events = match given {
        _ if integrator.kind == "direct" => 1,
        depth if depth < 0 => NO_LIMIT,
        depth => (depth - 1).clamp(0, NO_LIMIT),
    };
    settings.set_at("max_depth", Value::Integer(events), at);
    if integrator.flag("hide_emitters", false)? {
        let at = integrator.place("hide_emitters");
        maker.note("lights cannot be hidden: they are visible", &at);
    }
    plug_unused(
        maker,
        integrator,
        &[
            "rr_depth",
            "version",
            "strict_normals",
            "shading_samples",
            "emitter_samples",
            "bsdf_samples",
            "samples_per_pass",
            "block_size",
            "light_image",
            "sample_direct",
            "timeout",
        ],
    );
    Ok(())
}
