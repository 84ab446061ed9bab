//! Cameras, which look along +z with +x to the left.

use super::film::size;
use super::maker::Maker;
use super::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::input::names::unknown;
use bilux_import::world::placement::{half_tangent, view_of};
use bilux_math::DMat4;
use bilux_math::transcendental::atan2_f64;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Parameters, Spec};
use std::rc::Rc;

/// The cameras that are known; those after the first three are no eyes.
const SENSORS: [&str; 10] = [
    "perspective",
    "thinlens",
    "orthographic",
    "radiancemeter",
    "mradiancemeter",
    "irradiancemeter",
    "distant",
    "mdistant",
    "telecentric",
    "perspective_rdist",
];

/// The cameras of a sensor.
pub(super) fn cameras(maker: &mut Maker, sensor: &Rc<Plugin>) -> Result<Vec<CameraSpec>, FormatError> {
    if sensor.kind == "batch" {
        let parts = maker.document.parts_of(sensor, "sensor")?;
        let mut all = Vec::new();
        for (_, part) in parts {
            all.extend(maker.within(sensor, |maker| cameras(maker, &part))?);
        }
        return Ok(all);
    }
    let kind = match sensor.kind.as_str() {
        "orthographic" | "telecentric" => "orthographic",
        "perspective" | "thinlens" | "perspective_rdist" => "perspective",
        "spherical" => "panorama",
        other if SENSORS.contains(&other) => {
            maker.not_shown(sensor);
            return Ok(Vec::new());
        }
        other => return Err(unknown("sensor", other, SENSORS, &sensor.at)),
    };
    let placement = sensor.placement("to_world")?.as_deref().cloned().unwrap_or_default();
    let place = |matrix: &DMat4| {
        view_of(matrix).ok_or_else(|| {
            FormatError::malformed(
                "this sensor has a scale of zero: correct its 'to_world'",
                sensor.at.clone(),
            )
        })
    };
    let start = placement.start();
    let mut spec = Spec { name: sensor.id.clone(), span: sensor.at.clone(), ..Spec::new("", kind) };
    spec.parameters = place(&start)?;
    if start.determinant() < 0.0 {
        spec.parameters.set("mirrored", true);
    }
    let [width, height] = size(maker, sensor)?.map(|side| side as f64);
    match kind {
        "orthographic" => {
            // The film is two units wide before its transform.
            let tall = 2.0 * start.y_axis.truncate().length() * height / width;
            spec.parameters.set("height", tall.clamp(1e-9, 1e9) as f32);
        }
        "perspective" => set_view(maker, sensor, width / height, &mut spec.parameters)?,
        _ => {}
    }
    let mut keyframes = Vec::new();
    if placement.0.len() > 1 {
        for (time, matrix) in &placement.0 {
            keyframes.push((*time as f32, place(matrix)?));
        }
    }
    let ignored = [
        "near_clip",
        "far_clip",
        "srf",
        "shutter_open",
        "shutter_close",
        "focus_distance",
        "aperture_radius",
    ];
    sensor.ignore(&ignored);
    if sensor.has("kc") {
        maker.diagnostics.not_shown("the distortion of a sensor", || sensor.place("kc"));
    }
    sensor.report_unused(&mut maker.diagnostics);
    Ok(vec![CameraSpec { spec, keyframes }])
}

/// Sets how wide a camera sees, and how sharp.
fn set_view(
    maker: &mut Maker,
    sensor: &Plugin,
    aspect: f64,
    parameters: &mut Parameters,
) -> Result<(), FormatError> {
    let half = half_height(sensor, aspect)?;
    let degrees = 2.0 * atan2_f64(half, 1.0).to_degrees();
    if !(0.01..=179.0).contains(&degrees) {
        let what = "a field of view is out of range: it is limited to 0.01 to 179 degrees";
        maker.note(what, &sensor.place("fov"));
    }
    parameters.set_at("fov", (degrees.clamp(0.01, 179.0) as f32).into(), sensor.place("fov"));
    for (key, name) in
        [("principal_x", "principal_point_offset_x"), ("principal_y", "principal_point_offset_y")]
    {
        let offset = sensor.number_or(name, 0.0)?;
        if offset != 0.0 {
            parameters.set(key, (0.5 - offset).clamp(-100.0, 100.0) as f32);
        }
    }
    if sensor.kind == "thinlens" {
        let radius = sensor.number_or("aperture_radius", 0.0)?;
        parameters.set("aperture", radius.clamp(0.0, 1e6) as f32);
        parameters.set("focus", sensor.number_or("focus_distance", 0.0)?.clamp(0.0, 1e9) as f32);
    }
    Ok(())
}

/// Half the height of the film at distance 1, from the field of view along one of its axes.
fn half_height(sensor: &Plugin, aspect: f64) -> Result<f64, FormatError> {
    let diagonal = (1.0 + aspect * aspect).sqrt();
    let Some(fov) = sensor.number("fov")? else {
        // The diagonal of 35 mm film; the default is a lens of 50 mm.
        let text = sensor.text("focal_length")?.unwrap_or("50mm");
        let number = text.trim().trim_end_matches("mm").trim().parse::<f64>();
        let length = number.ok().filter(|length| *length > 0.0).ok_or_else(|| {
            let message = "'focal_length' must be a length above 0, such as 50mm";
            FormatError::malformed(message, sensor.place("focal_length"))
        })?;
        let film = (36f64 * 36.0 + 24.0 * 24.0).sqrt();
        return Ok(0.5 * film / length / diagonal);
    };
    let half = half_tangent(fov.clamp(0.0, 179.9) as f32);
    Ok(match sensor.text("fov_axis")?.unwrap_or("x") {
        "x" => half / aspect,
        "y" => half,
        "diagonal" => half / diagonal,
        "smaller" => half / aspect.min(1.0),
        "larger" => half / aspect.max(1.0),
        other => {
            let known = ["x", "y", "diagonal", "smaller", "larger"];
            return Err(unknown("axis", other, known, &sensor.place("fov_axis")));
        }
    })
}
