//! Cameras, which look along the x axis of their node.

use super::attributes::{self, Attribute};
use super::document::{Properties, display_name};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::DVec3;
use bilux_math::transcendental::{atan2_f64, tan_f64};
use bilux_scene::Spec;
use bilux_scene::cameras::CameraSpec;

const MILLIMETRES_PER_INCH: f64 = 25.4;

/// The width of the view of an orthographic camera with a zoom of 1, in units of the file.
const ORTHOGRAPHIC_WIDTH: f64 = 30.0;

/// The camera of a node, if it has one.
pub(super) fn camera(
    placed: &Placed,
    posed: &Posed,
    graph: &Graph,
    diagnostics: &mut Diagnostics,
) -> Option<CameraSpec> {
    let Attribute { properties, index } = attributes::of_kind("Camera", placed.model, posed)?;
    let object = posed.document.object(placed.model);
    let at = posed.document.object(index).node.at();
    let forward = attributes::direction(placed, DVec3::X, posed, graph);
    let up = placed.world.transform_vector3(DVec3::Y).try_normalize();
    let (Some(forward), Some(up)) = (forward, up) else {
        diagnostics.note("a camera's node has a scale of zero: left out", || at);
        return None;
    };
    let position = placed.world.w_axis.truncate();
    // Far from the origin, 32-bit floats may not resolve one metre.
    let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
    let is_orthographic = properties.integer("CameraProjectionType") == Some(1);
    let kind = if is_orthographic { "orthographic" } else { "perspective" };
    let mut spec = Spec::new(&display_name(object.name), kind)
        .with("position", position.as_vec3())
        .with("look_at", ahead.as_vec3())
        .with("up", up.as_vec3());
    spec.span = at;
    let view = View::of(&properties);
    if is_orthographic {
        let zoom = properties.number("OrthoZoom").filter(|zoom| *zoom > 0.0).unwrap_or(1.0);
        let width = if posed.document.settings.is_of_blender { zoom } else { zoom * ORTHOGRAPHIC_WIDTH };
        let height = width * posed.document.settings.unit / view.aspect.max(1.0);
        spec.parameters.set("height", height.clamp(1e-9, 1e9) as f32);
    } else {
        let degrees = 2.0 * atan2_f64(view.half_height, 1.0).to_degrees();
        spec.parameters.set("fov", degrees.clamp(0.01, 179.0) as f32);
        spec.parameters.set("frame", view.aspect.clamp(0.0, 1000.0) as f32);
    }
    Some(CameraSpec { spec, keyframes: Vec::new() })
}

/// Field of view of a camera.
struct View {
    /// Width over height.
    aspect: f64,
    /// Half of the height at a distance of 1.
    half_height: f64,
}

/// Ways in which a camera states its field of view.
const BOTH_ANGLES: i64 = 0;
const HORIZONTAL_ANGLE: i64 = 1;
const FOCAL_LENGTH: i64 = 3;

impl View {
    fn of(properties: &Properties) -> View {
        let positive = |name: &str| properties.number(name).filter(|number| *number > 0.0);
        let film = [positive("FilmWidth").unwrap_or(0.816), positive("FilmHeight").unwrap_or(0.612)];
        let height = film[1] * positive("FilmSqueezeRatio").unwrap_or(1.0);
        let of_film = film[0] / height;
        let sides = [("AspectWidth", "AspectW"), ("AspectHeight", "AspectH")];
        let [width_of, height_of] = sides.map(|(name, old)| positive(name).or_else(|| positive(old)));
        let aspect = match properties.integer("AspectRatioMode").unwrap_or(0) {
            // A fixed side in pixels, and the other one as a factor on it.
            3 => height_of.map(|factor| factor.recip()),
            4 => width_of,
            _ => width_of.zip(height_of).map(|(width, height)| width / height),
        };
        let aspect = aspect.filter(|aspect| (1e-3..1e3).contains(aspect)).unwrap_or(of_film);
        let half = |degrees: f64| tan_f64((degrees.clamp(0.01, 179.0) / 2.0).to_radians());
        let angle = |name: &str| half(positive(name).unwrap_or(40.0));
        let half_height = match properties.integer("ApertureMode").unwrap_or(2) {
            BOTH_ANGLES => angle("FieldOfViewY"),
            HORIZONTAL_ANGLE => angle("FieldOfView") / aspect,
            FOCAL_LENGTH => {
                let focal = positive("FocalLength").unwrap_or(35.0);
                // The film gate is wider or narrower than the picture: which side of it fits?
                let by_width = match properties.integer("GateFit").unwrap_or(0) {
                    2 => true,
                    3 => aspect > of_film,
                    4 => aspect < of_film,
                    _ => false,
                };
                let seen = if by_width { film[0] / aspect } else { height };
                seen * MILLIMETRES_PER_INCH / focal / 2.0
            }
            _ => angle("FieldOfView"),
        };
        View { aspect, half_height }
    }
}
