//! The settings of a session: what the user asks for, what a viewer needs, and what small pictures change.

use super::pace::divided;
use super::{Level, SAMPLES};
use bilux::scene::{Parameters, Value};
use bilux::transport::integrators::INTEGRATORS;

/// What a viewer sets unless the user does: denoising is a choice, and the tree does not depend on the size of the picture.
pub(super) fn with_defaults(user: &Parameters) -> Parameters {
    let mut all = user.clone();
    for (key, value) in [
        ("denoise", Value::from("off")),
        ("build", Value::from("balanced")),
        ("spp", Value::Integer(SAMPLES)),
    ] {
        if all.find(key).is_none() {
            all.set(key, value);
        }
    }
    all
}

/// Sets the size of a level and, for small pictures, path tracing: it needs no pilot render, and shows nearly the same.
pub(super) fn set_level(all: &mut Parameters, scene: &Parameters, size: [u32; 2], level: Level) {
    let divisor = match level {
        Level::Preview(divisor) => divisor,
        Level::Full => 1,
    };
    let [width, height] = divided(size, divisor);
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
