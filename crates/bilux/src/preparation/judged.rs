//! Judgement of a scene's own light, and what it means for the exposure.

use bilux_math::transcendental::{log2, powf};
use bilux_transport::Illumination;

/// The fraction that it must reach to count for the exposure.
const SOME: f32 = 0.05;
/// The outgoing radiance of a white surface that a display shows well, and by how many stops that may be missed.
const SURFACE: [f32; 2] = [0.5, 1.5];
/// Radiance of an emitter that a display shows well, and by how many stops that may be missed, where nothing else is visible.
const EMITTER: [f32; 2] = [1.0, 3.0];
/// Own light is faint that reaches at most this fraction of the visible surfaces, makes a white one there at most this bright in the median, and
/// whose power is at most this much per area of the scene's outline: what is around it, such as the studio's ground, is not among the surfaces.
const FAINT: [f32; 3] = [0.02, 0.01, 0.005];
/// Exposures are multiples of this many stops.
const STEP: f32 = 0.25;

/// Judgement of a scene's own light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Judged {
    /// Whether it lights what is visible; `None` if the file describes its surroundings, so that nothing is to be decided.
    pub(crate) is_enough: Option<bool>,
    /// Whether the user may wonder, and is told.
    pub(crate) is_said: bool,
    pub(crate) measured: Illumination,
    /// Power of all own light over the area of the outline of a sphere around the scene, in W/m².
    pub(crate) power: f32,
}

impl Judged {
    /// The exposure, in stops, with which a display shows what the scene's own light lights; 0 where it is as bright as usual, or
    /// lights next to nothing.
    pub(crate) fn exposure(&self) -> f32 {
        let Illumination { surfaces, lit, touched, level, faint, glow } = self.measured;
        let (level, [wanted, tolerance]) = match surfaces > 0.0 {
            // Nothing at all would be seen of what faint lamps light; a few bright places are seen as they are.
            true if lit == 0.0 && touched >= SOME => (faint, SURFACE),
            true if lit < SOME => return 0.0,
            true => (level, SURFACE),
            false => (glow, EMITTER),
        };
        let stops = if level > 0.0 { log2(wanted / level) } else { 0.0 };
        // Where its own light is dim, the studio's is not.
        let is_usual = stops.abs() <= tolerance || stops > 0.0 && self.is_enough == Some(false);
        if is_usual { 0.0 } else { (stops / STEP).round() * STEP }
    }

    /// Whether the studio's light leaves next to nothing of it to be seen.
    pub(crate) fn is_faint(&self) -> bool {
        let ([reach, level, power], measured) = (FAINT, &self.measured);
        let is_seen = measured.lit > reach || measured.faint > level || self.power > power;
        self.is_enough == Some(false) && measured.surfaces > 0.0 && !is_seen
    }

    /// Brightness of the scene, as a multiple of the usual one.
    pub(crate) fn brightness(&self) -> f32 {
        powf(2.0, -self.exposure())
    }

    pub(crate) fn decision(&self, added: Option<&str>) -> Option<String> {
        let percent = (self.measured.lit * 100.0).round();
        let added = added.unwrap_or("nothing");
        Some(match self.is_enough? {
            true if added != "nothing" => format!(
                "its own lights light it: they reach {percent}% of the visible surfaces; the studio adds {added} \
                 (--env none leaves them out)"
            ),
            true => format!(
                "only its own lights light it: they reach {percent}% of the visible surfaces (--preset studio adds \
                 the studio's)"
            ),
            false if self.measured.surfaces == 0.0 => format!(
                "the studio lights it with {added}: everything visible in it is an emitter that lights nothing else \
                 (--env none turns the studio off)"
            ),
            false => format!(
                "the studio lights it with {added}: its own lights reach only {percent}% of the visible surfaces \
                 (--env none turns the studio off)"
            ),
        })
    }
}
