//! The settings of a session: what the user asks for, what a viewer needs, and what small pictures change.

use bilux::scene::{Parameters, Value};
use bilux::transport::integrators::INTEGRATORS;
use bilux::{JobRequest, Settings};

/// The maximum number of samples of each pixel, if neither the user nor the scene says it.
const SAMPLES: i64 = 1024;

/// Level of refinement that is being rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    /// A picture whose sides are divided by this, as soon as possible.
    Preview(u32),
    /// A picture whose sides are divided by this, and which is clean.
    Clean(u32),
    /// The picture itself.
    Full,
}

impl Level {
    /// By what the sides of its pictures are divided.
    pub(crate) fn divisor(self) -> u32 {
        match self {
            Level::Preview(divisor) | Level::Clean(divisor) => divisor,
            Level::Full => 1,
        }
    }
}

/// Settings of the user, and where there are none, those of the viewer: the tree does not depend on the size of the picture.
pub(crate) fn with_defaults(user: &Parameters) -> Parameters {
    let mut all = user.clone();
    for (key, value) in [("build", Value::from("balanced")), ("spp", Value::Integer(SAMPLES))] {
        if all.find(key).is_none() {
            all.set(key, value);
        }
    }
    all
}

/// Request for a picture with the user's settings and the viewer's.
pub(crate) fn request(user: &Parameters, max_memory: u64) -> JobRequest {
    JobRequest::from(&with_defaults(user)).max_memory(max_memory)
}

/// Settings of the camera, which are about the scene that they were made for.
const OF_THE_CAMERA: [&str; 8] = ["camera", "eye", "look_at", "zoom", "orbit", "focal", "up", "front"];

/// Leaves out what was said of the camera of another scene.
pub(crate) fn forget_camera(user: &mut Parameters) {
    user.0.retain(|(key, ..)| !OF_THE_CAMERA.contains(&key.as_str()));
}

/// Settings at a time, if one is given.
pub(crate) fn at_time(user: &Parameters, time: Option<&Value>) -> Parameters {
    let mut all = user.clone();
    if let Some(time) = time {
        all.set("time", time.clone());
    }
    all
}

/// The name of the denoiser that settings ask for. If they leave it open, it is the best one, since pictures are shown
/// before they have all their samples; the classic modes have little noise, and a look of their own.
pub(crate) fn denoiser_of(settings: &Settings) -> Option<&str> {
    match settings.denoise.as_str() {
        "off" => None,
        "display" => (!settings.integrator.classic).then_some("auto"),
        name => Some(name),
    }
}

/// Sets the size of a level and, for small pictures, path tracing: it needs no pilot render, and shows nearly the same.
pub(crate) fn set_level(all: &mut Parameters, scene: &Parameters, size: [u32; 2], level: Level) {
    let [width, height] = divided(size, level.divisor());
    all.set("size", format!("{width}x{height}"));
    let chosen = all.find("integrator").or_else(|| scene.find("integrator")).map(|(value, _)| value);
    let is_quick = INTEGRATORS.iter().any(|row| {
        let is_chosen = chosen.is_some_and(|value| *value == Value::from(row.entry.name));
        is_chosen && (row.classic || row.entry.name == "occlusion" || row.entry.name == "path")
    });
    if level != Level::Full && !is_quick {
        all.set("integrator", "path");
    }
}

/// A size with its sides divided, about: of the sizes near by, the one whose shape is most like the whole, because the
/// studio's camera stands where the shape wants it, and nothing may jump when a larger picture follows. No side is 0.
pub(crate) fn divided(size: [u32; 2], divisor: u32) -> [u32; 2] {
    if divisor <= 1 {
        return size.map(|side| side.max(1));
    }
    let [width, height] = size.map(|side| f64::from(side.max(1)));
    let least = size[1].div_ceil(divisor).max(1);
    let with_height = |high: u32| {
        let wide = (f64::from(high) * width / height).round().max(1.0);
        let shape = wide * height / (f64::from(high) * width);
        (shape.max(1.0 / shape), [wide as u32, high])
    };
    let all = (least..=least + least / 8).map(with_height);
    all.reduce(|best, next| if next.0 < best.0 { next } else { best }).map_or(size, |(_, size)| size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_divided_size_has_the_shape_of_the_whole() {
        assert_eq!(divided([1280, 720], 16), [80, 45]);
        assert_eq!(divided([3, 1], 12), [3, 1]);
        assert_eq!(divided([7, 5], 1), [7, 5]);
        for size in [[390, 844], [844, 390], [1017, 733], [2560, 1301], [500, 500]] {
            for divisor in 2..=16 {
                let [width, height] = divided(size, divisor).map(f64::from);
                let shape = width / height * f64::from(size[1]) / f64::from(size[0]);
                assert!((shape - 1.0).abs() < 0.012, "{size:?} / {divisor}: {width} x {height}");
                let smaller = f64::from(size[1]) / height;
                assert!(
                    smaller <= f64::from(divisor) && smaller > f64::from(divisor) * 0.8,
                    "{size:?} {divisor}"
                );
            }
        }
    }
}
